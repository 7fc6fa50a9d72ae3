//! What is said before a sweep and after it.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use jointsweep::internals::engine::cost::Estimate;
use jointsweep::internals::engine::explain::percent;
use jointsweep::internals::engine::unit_costs::Pace;
use jointsweep::internals::output::counts::Counts;
use jointsweep::internals::output::export;
use jointsweep::internals::output::folder::MANIFEST;
use jointsweep::internals::output::manifest::Manifest;
use jointsweep::internals::output::manifest_parts::Shard;
use jointsweep::internals::output::origin::Origin;
use jointsweep::internals::output::report::has_page;
use jointsweep::internals::output::results::Results;

use super::sbatch::shell_word;

/// The most causes of failure that are listed; the table has them all.
const CAUSES: usize = 10;

/// On a machine of a pace.
pub fn estimate(estimate: &Estimate, pace: Pace, table: &Path) -> String {
    let mut text = String::new();
    let mut line = |name, value: String| _ = writeln!(text, "{name:<16}{value}");
    let is_of_all = estimate.looked_at == estimate.designs;
    let counted = |count: u64| if is_of_all { count.to_string() } else { about(count) };
    line("designs", estimate.designs.to_string());
    if !is_of_all {
        line("looked at", format!("{} of them, spread over the sweep", estimate.looked_at));
    }
    line("rows", estimate.rows.to_string());
    line("distinct bodies", counted(estimate.distinct_bodies));
    if estimate.interpolated > 0 {
        line("interpolated", format!("{} designs", counted(estimate.interpolated)));
    }
    if estimate.refused > 0 {
        line("refused", format!("{} designs; `jointsweep explain` says why", counted(estimate.refused)));
    }
    line("unknowns", counted(estimate.unknowns));
    let seconds = duration(estimate.time.at(pace));
    line("core time", format!("about {seconds} on this machine, which the threads share"));
    line("table", table.display().to_string());
    text
}

/// An estimated count, to three digits.
pub fn about(count: u64) -> String {
    let unit = 10_u64.pow(count.max(1).ilog10().saturating_sub(2));
    let rounded = (count.saturating_add(unit / 2) / unit).saturating_mul(unit);
    format!("about {rounded}")
}

/// What a run came to, where it is, and what to do with it; with `verbose` how long each stage took.
pub fn summary(manifest: &Manifest, dir: &Path, verbose: bool) -> String {
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
    if verbose {
        _ = writeln!(text, "time by stage, summed over the threads:");
        for (stage, seconds) in &manifest.stage_seconds {
            _ = writeln!(text, "  {stage:<32}{}", duration(seconds.as_f64().unwrap_or(0.0)));
        }
    }
    if let Some(on_cpu) = counts.designs_on_cpu.filter(|count| *count > 0) {
        _ = writeln!(text, "{} came from the processor", plural(on_cpu, "design", "designs"));
    }
    let mut remarks = counts.by_status.by_text();
    let ok = remarks.remove("ok").unwrap_or(0);
    remarks.retain(|status, _| !counts.by_status.failures().contains_key(status));
    match (ok == counts.rows, counts.rows) {
        (true, 1) => text += "the row is ok\n",
        (true, rows) => _ = writeln!(text, "all {rows} rows are ok"),
        (false, rows) => _ = writeln!(text, "{ok} of {} ok", plural(rows, "row is", "rows are")),
    }
    if !remarks.is_empty() {
        let rows = remarks.values().sum();
        _ = writeln!(text, "answered with a remark: {}", plural(rows, "row", "rows"));
        text += &causes(&remarks);
    }
    if counts.failed_rows > 0 {
        let rows = plural(counts.failed_rows, "row", "rows");
        _ = writeln!(text, "failed: {rows} of {}", plural(counts.failed_designs, "design", "designs"));
        text += &causes(counts.by_status.failures());
    }
    if let Some([least, greatest]) = counts.forces_n {
        let [least, greatest] = [least, greatest].map(newtons);
        let to = if least == greatest { String::new() } else { format!(" to {greatest}") };
        _ = writeln!(text, "force: {least}{to}");
        let [force, linearity] = [counts.greatest_force_error, counts.greatest_linearity_error].map(percent);
        _ = writeln!(text, "force_error: {force} at most; linearity_error: {linearity} at most");
    }
    if let Some(kept) = counts.kept_rows {
        _ = writeln!(text, "kept: {kept} of {}", plural(counts.rows, "row", "rows"));
    }
    for remark in &manifest.remarks {
        _ = writeln!(text, "warning: {remark}");
    }
    text += "written:\n";
    for name in manifest.file_names().chain([MANIFEST]) {
        _ = writeln!(text, "  {}", dir.join(name).display());
    }
    // What others would be refused is not named.
    let mut next = String::new();
    if let Some(results) = counts.forces_n.and_then(|_| Results::open(dir).ok()) {
        let dir = shell_word(&dir.display().to_string());
        if has_page(&results) {
            _ = writeln!(next, "  jointsweep report {dir}    a page to look at");
        }
        if ok == counts.rows && results.rows(&export::source::NEEDED).is_ok() {
            let design = if counts.designs > 1 { " --design 0" } else { "" };
            _ = writeln!(next, "  jointsweep export {dir}{design} --to python    a table for a simulator");
        }
    }
    if !next.is_empty() {
        text += &format!("next:\n{next}");
    }
    text
}

/// A force as a person says it.
fn newtons(force: f64) -> String {
    let (value, unit) = match force {
        f if f >= 1e6 => (1e-6 * f, "MN"),
        f if f >= 1e3 => (1e-3 * f, "kN"),
        f => (f, "N"),
    };
    // Three digits, without the zeros that say nothing.
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if rounded != 0.0 && rounded < 1e-3 { format!("{rounded:e} {unit}") } else { format!("{rounded} {unit}") }
}

/// What is said of a run that did not go to its end, and where its rows are.
pub fn interrupted(manifest: &Manifest, rows: Option<&Path>) -> String {
    let Counts { designs, designs_asked, .. } = manifest.counts;
    let done = format!("interrupted: {designs} of {designs_asked} designs are done");
    if designs == 0 {
        return done;
    }
    let rows = rows.map_or(String::new(), |rows| format!(", their rows are in {}", rows.display()));
    format!("{done}{rows}; the same command goes on from there")
}

/// What is said of a run that goes on where another has stopped, after so many designs of those asked, and of a damage that was found.
pub fn going_on(done: u64, asked: u64, damage: Option<&str>) -> String {
    let goes_on = match done {
        0 => "beginning anew".into(),
        _ => format!("{done} of {asked} designs were done before; going on"),
    };
    damage.map_or(goes_on.clone(), |damage| format!("warning: {damage}; {goes_on}"))
}

/// What is said instead of running a config again.
pub fn already_done(origin: &Origin, table: &Path) -> String {
    let by = match &origin.commit {
        Some(commit) => format!("version {}, commit {commit}", origin.version),
        None => format!("version {}", origin.version),
    };
    format!(
        "already complete, nothing to do: the same config was run before (by {by}, on {}); --again makes it anew\n{}\n",
        origin.computed_by,
        table.display()
    )
}

/// What became of failed rows that were done again.
pub fn done_again(rows: u64, origin: &Origin, table: &Path) -> String {
    let still = origin.counts.failed_rows;
    let rows = plural(rows, "failed row was", "failed rows were");
    format!("{rows} done again, {still} still failed\n{}\n", table.display())
}

/// Which designs a shard has.
pub fn shard(shard: &Shard, file: &Path) -> String {
    let Shard { designs, shard, of, .. } = shard;
    let count = plural(designs.end - designs.start, "design", "designs");
    let which = if designs.is_empty() {
        String::new()
    } else {
        format!(", {} to {}", designs.start, designs.end - 1)
    };
    format!("shard {shard} of {of}: {count}{which}\n{}\n", file.display())
}

/// What a shard came to.
pub fn shard_summary(manifest: &Manifest, file: &Path) -> String {
    let counts = &manifest.counts;
    let failed = match counts.failed_designs {
        0 => String::new(),
        failed => format!(", of which {failed} failed"),
    };
    format!(
        "{}{failed}, {} in {} ({}, {})\nwritten:\n  {}\n",
        plural(counts.designs, "design", "designs"),
        plural(counts.rows, "row", "rows"),
        duration(manifest.wall_seconds),
        manifest.computed_by(),
        plural(manifest.threads as u64, "thread", "threads"),
        file.display(),
    )
}

/// What was put together from shards, now or before.
pub fn merged(origin: &Origin, dir: &Path, is_new: bool) -> String {
    let counts = &origin.counts;
    let said = if is_new { "written" } else { "already merged, nothing to do; --again does it anew" };
    let mut text = format!(
        "{}, {}, {} failed\n{said}:\n",
        plural(counts.designs, "design", "designs"),
        plural(counts.rows, "row", "rows"),
        counts.failed_rows,
    );
    for name in origin.files.iter().map(|(name, _)| name.as_str()).chain([MANIFEST]) {
        _ = writeln!(text, "  {}", dir.join(name).display());
    }
    text
}

/// The statuses of rows, the most frequent first.
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

pub fn plural(count: u64, one: &str, many: &str) -> String {
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
    fn forces_have_three_digits() {
        let forces = [
            (0.0, "0 N"),
            (1.23456e-7, "1.23e-7 N"),
            (12.0, "12 N"),
            (999.9, "1000 N"),
            (4_530.0, "4.53 kN"),
            (2.5e6, "2.5 MN"),
        ];
        for (force, expected) in forces {
            assert_eq!(newtons(force), expected);
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
