//! How far a sweep is: a bar on a terminal, a line now and then in a log.

use std::fmt::Write;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use super::report::duration;
use super::say;

/// Time between two lines of a log.
const PAUSE: Duration = Duration::from_secs(10);

pub enum Progress {
    Silent,
    Bar(ProgressBar),
    Lines { done: u64, total: u64, started: Instant, next: Instant },
}

impl Progress {
    pub fn new(total: u64, quiet: bool) -> Progress {
        if quiet {
            return Progress::Silent;
        }
        if std::io::stderr().is_terminal() {
            // The mean rate from the start on: indicatif's own takes seconds to find a fast sweep's.
            let words = |state: &ProgressState, out: &mut dyn Write| {
                _ = out.write_str(&line(state.pos(), state.len().unwrap_or(0), state.elapsed()));
            };
            let style = ProgressStyle::with_template("{bar:30} {words}").expect("the template is valid");
            let style = style.with_key("words", words);
            return Progress::Bar(ProgressBar::new(total).with_style(style));
        }
        let started = Instant::now();
        Progress::Lines { done: 0, total, started, next: started + PAUSE }
    }

    /// One more design is done.
    pub fn advance(&mut self) {
        match self {
            Progress::Silent => {}
            Progress::Bar(bar) => bar.inc(1),
            Progress::Lines { done, total, started, next } => {
                *done += 1;
                let now = Instant::now();
                if now >= *next && done < total {
                    say(&line(*done, *total, now - *started));
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

fn line(done: u64, total: u64, elapsed: Duration) -> String {
    if done == 0 {
        return format!("0/{total} designs");
    }
    let rate = done as f64 / elapsed.as_secs_f64();
    let left = duration(total.saturating_sub(done) as f64 / rate);
    format!("{done}/{total} designs, {rate:.0}/s, {left} left")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_rate_and_time_left() {
        let elapsed = Duration::from_secs(10);
        assert_eq!(line(12_000, 100_000, elapsed), "12000/100000 designs, 1200/s, 73 s left");
        assert_eq!(line(0, 100, elapsed), "0/100 designs");
    }
}
