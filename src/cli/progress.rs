//! How far a sweep is: a bar on a terminal, a line now and then in a log.

use std::fmt::Write;
use std::io::IsTerminal;
use std::ops::Range;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use super::report::duration;
use super::say;

/// Time between two lines of a log.
const PAUSE: Duration = Duration::from_secs(10);

pub enum Progress {
    Silent,
    Bar(ProgressBar),
    Lines { before: u64, done: u64, total: u64, started: Instant, next: Instant },
}

impl Progress {
    /// Of the designs `asked`, which may be a shard's, of which those before `left` were done by an earlier run.
    pub fn of(asked: &Range<u64>, left: &Range<u64>, quiet: bool) -> Progress {
        let (before, total) = counted(asked, left);
        Progress::new(before, total, quiet)
    }

    /// Of `total` designs, of which `before` were done by an earlier run.
    pub fn new(before: u64, total: u64, quiet: bool) -> Progress {
        if quiet {
            return Progress::Silent;
        }
        if std::io::stderr().is_terminal() {
            // The mean rate from the start on: indicatif's own takes seconds to find a fast sweep's.
            let words = move |state: &ProgressState, out: &mut dyn Write| {
                _ = out.write_str(&line(before, state.pos(), state.len().unwrap_or(0), state.elapsed()));
            };
            let style = ProgressStyle::with_template("{bar:30} {words}").expect("the template is valid");
            let style = style.with_key("words", words);
            return Progress::Bar(ProgressBar::new(total).with_position(before).with_style(style));
        }
        let started = Instant::now();
        Progress::Lines { before, done: before, total, started, next: started + PAUSE }
    }

    /// More designs are done.
    pub fn advance(&mut self, designs: u64) {
        match self {
            Progress::Silent => {}
            Progress::Bar(bar) => bar.inc(designs),
            Progress::Lines { before, done, total, started, next } => {
                *done += designs;
                let now = Instant::now();
                if now >= *next && done < total {
                    say(&line(*before, *done, *total, now - *started));
                    *next = now + PAUSE;
                }
            }
        }
    }

    pub fn finish(&self) {
        if let Progress::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

/// How many of the designs are done already, and how many there are.
fn counted(asked: &Range<u64>, left: &Range<u64>) -> (u64, u64) {
    (left.start - asked.start, asked.end - asked.start)
}

fn line(before: u64, done: u64, total: u64, elapsed: Duration) -> String {
    if done == before {
        return format!("{done}/{total} designs");
    }
    let rate = (done - before) as f64 / elapsed.as_secs_f64();
    let left = duration(total.saturating_sub(done) as f64 / rate);
    format!("{done}/{total} designs, {rate:.0}/s, {left} left")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_rate_and_time_left() {
        let elapsed = Duration::from_secs(10);
        assert_eq!(line(0, 12_000, 100_000, elapsed), "12000/100000 designs, 1200/s, 73 s left");
        assert_eq!(line(10_000, 12_000, 100_000, elapsed), "12000/100000 designs, 200/s, 7 min left");
        assert_eq!(line(0, 0, 100, elapsed), "0/100 designs");
    }

    #[test]
    fn a_shard_is_counted_by_itself() {
        assert_eq!(counted(&(28_579..57_159), &(28_579..57_159)), (0, 28_580));
        assert_eq!(counted(&(28_579..57_159), &(30_000..57_159)), (1421, 28_580));
        assert_eq!(counted(&(0..100), &(7..100)), (7, 100));
    }
}
