//! How far a sweep is: a bar on a terminal, a line now and then in a log.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::report::duration;
use super::say;

/// Time between two lines of a log.
const PAUSE: Duration = Duration::from_secs(10);

const BAR: &str = "{bar:30} {human_pos}/{human_len} designs, {per_sec}, {eta} left";

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
            let style = ProgressStyle::with_template(BAR).expect("the template is valid");
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
    let rate = done as f64 / elapsed.as_secs_f64();
    let left = duration((total - done) as f64 / rate);
    format!("{done}/{total} designs, {rate:.0}/s, {left} left")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_rate_and_time_left() {
        let elapsed = Duration::from_secs(10);
        assert_eq!(line(12_000, 100_000, elapsed), "12000/100000 designs, 1200/s, 73 s left");
    }
}
