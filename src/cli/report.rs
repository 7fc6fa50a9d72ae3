//! What is said before a sweep and after it.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use jointsweep::engine::cost::Estimate;
use jointsweep::engine::explain::percent;
use jointsweep::output::manifest::{Counts, Manifest, Origin};

/// The most causes of failure that are listed; the table has them all.
const CAUSES: usize = 10;

pub fn estimate(estimate: &Estimate, table: &Path) -> String {
    let mut text = String::new();
    let mut line = |name, value: String| _ = writeln!(text, "{name:<16}{value}");
    line("designs", estimate.designs.to_string());
    line("rows", estimate.rows.to_string());
    line("distinct bodies", estimate.distinct_bodies.to_string());
    if estimate.interpolated > 0 {
        line("interpolated", format!("{} designs", estimate.interpolated));
    }
    if estimate.refused > 0 {
        line("refused", format!("{} designs; `jointsweep explain` says why", estimate.refused));
    }
    line("unknowns", estimate.unknowns.to_string());
    line("core time", format!("about {}, which the threads share", duration(estimate.seconds)));
    line("table", table.display().to_string());
    text
}

pub fn summary(manifest: &Manifest, table: &Path) -> String {
    let counts = &manifest.counts;
    let wall = duration(manifest.wall_seconds);
    let mut text = String::new();
    _ = writeln!(
        text,
        "{}, {}, {} in {wall} ({}, {})",
        plural(counts.designs, "design", "designs"),
        plural(counts.rows, "row", "rows"),
        plural(counts.distinct_bodies, "distinct body", "distinct bodies"),
        manifest.computed_by(),
        plural(manifest.threads as u64, "thread", "threads"),
    );
    _ = writeln!(text, "time by stage, summed over the threads:");
    for (stage, seconds) in &manifest.stage_seconds {
        _ = writeln!(text, "  {stage:<32}{}", duration(seconds.as_f64().unwrap_or(0.0)));
    }
    if let Some(on_cpu) = counts.designs_on_cpu.filter(|count| *count > 0) {
        _ = writeln!(text, "{} came from the processor", plural(on_cpu, "design", "designs"));
    }
    if counts.greatest_linearity_error > 0.0 {
        let most = percent(counts.greatest_linearity_error);
        _ = writeln!(text, "linearity_error: {most} at most");
    }
    if counts.failed_rows > 0 {
        let rows = plural(counts.failed_rows, "row", "rows");
        _ = writeln!(text, "failed: {rows} of {}", plural(counts.failed_designs, "design", "designs"));
        text += &causes(counts.by_status.failures());
    }
    _ = writeln!(text, "{}", table.display());
    text
}

/// What is said of a run that did not go to its end, and where its rows are.
pub fn interrupted(manifest: &Manifest, rows: &Path) -> String {
    let Counts { designs, designs_asked, .. } = manifest.counts;
    let done = format!("interrupted: {designs} of {designs_asked} designs are done");
    if designs == 0 { done } else { format!("{done}; their rows are in {}", rows.display()) }
}

/// What is said instead of running a config again.
pub fn already_done(origin: &Origin, table: &Path) -> String {
    let by = match &origin.commit {
        Some(commit) => format!("version {}, commit {commit}", origin.version),
        None => format!("version {}", origin.version),
    };
    format!(
        "already complete, nothing to do: the same config was run before (by {by}); --again makes it anew\n{}\n",
        table.display()
    )
}

/// The causes of failure, the most frequent first.
fn causes(failures: &BTreeMap<String, u64>) -> String {
    let mut causes: Vec<_> = failures.iter().collect();
    causes.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    let mut text = String::new();
    for (status, count) in causes.iter().take(CAUSES) {
        _ = writeln!(text, "  {count:>8}  {status}");
    }
    if causes.len() > CAUSES {
        _ = writeln!(text, "  and {}", plural((causes.len() - CAUSES) as u64, "more cause", "more causes"));
    }
    text
}

fn plural(count: u64, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Lines of as many cells each: the first column to the left, the others to the right.
pub fn aligned<const N: usize>(lines: &[[String; N]]) -> String {
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for line in lines {
        text += &format!("{:<w$}", line[0], w = width(0));
        for (column, cell) in line.iter().enumerate().skip(1) {
            text += &format!("  {cell:>w$}", w = width(column));
        }
        text.push('\n');
    }
    text
}

/// A time as a person says it.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s > 0.0 && s < 1e-4 => format!("{:.0} us", s * 1e6),
        s if s < 0.1 => format!("{:.1} ms", s * 1e3),
        s if s < 10.0 => format!("{s:.2} s"),
        s if s < 119.5 => format!("{s:.0} s"),
        s if s < 119.5 * 60.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_short() {
        let times = [
            (0.0, "0.0 ms"),
            (5e-5, "50 us"),
            (0.0123, "12.3 ms"),
            (3.21, "3.21 s"),
            (38.4, "38 s"),
            (600.0, "10 min"),
            (9000.0, "2.5 h"),
        ];
        for (seconds, expected) in times {
            assert_eq!(duration(seconds), expected);
        }
    }

    #[test]
    fn the_most_frequent_causes_come_first_and_the_list_ends() {
        let failures: BTreeMap<String, u64> = (1..=12).map(|n| (format!("cause {n:02}"), n)).collect();
        let text = causes(&failures);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), CAUSES + 1);
        assert_eq!(lines[0], "        12  cause 12");
        assert_eq!(lines[CAUSES], "  and 2 more causes");
    }
}
