//! When and on what a run happened.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;

/// What has made a result.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Program {
    pub program: &'static str,
    version: &'static str,
    /// Of the source, with `-dirty` where it was changed since; absent where it was built without its history.
    #[serde(skip_serializing_if = "Option::is_none")]
    commit: Option<&'static str>,
}

impl Program {
    pub const CURRENT: Program = Program {
        program: env!("CARGO_PKG_NAME"),
        version: env!("CARGO_PKG_VERSION"),
        commit: option_env!("JOINTSWEEP_COMMIT"),
    };

    /// "jointsweep 0.1.0 (1234567)".
    pub fn in_words(&self) -> String {
        in_words(self.program, self.version, self.commit)
    }
}

/// "jointsweep 0.1.0 (1234567)".
pub fn in_words(program: &str, version: &str, commit: Option<&str>) -> String {
    let commit = commit.map_or(String::new(), |commit| format!(" ({commit})"));
    format!("{program} {version}{commit}")
}

#[derive(Clone, Debug, Serialize)]
pub struct Host {
    pub os: &'static str,
    pub arch: &'static str,
    /// The model of the CPU, where the system tells it.
    pub cpu: Option<String>,
    /// Logical processors of the machine, where the system tells it.
    pub processors: Option<usize>,
}

impl Host {
    pub fn current() -> Host {
        // Linux asks each processor for its frequency as its part of the file is read, which takes milliseconds: no more of it is
        // read than the first one's.
        let cpuinfo = File::open("/proc/cpuinfo").map(|file| BufReader::with_capacity(READ_AT_ONCE, file));
        let online = std::fs::read_to_string("/sys/devices/system/cpu/online");
        Host {
            os: std::env::consts::OS,
            arch: std::env::consts::ARCH,
            cpu: cpuinfo.ok().and_then(cpu_model),
            processors: online.ok().and_then(|ranges| processors(&ranges)),
        }
    }
}

/// The most memory this process has had at once, bytes, where the system tells it.
pub fn peak_memory() -> Option<u64> {
    peak_resident(&std::fs::read_to_string("/proc/self/status").ok()?)
}

/// VmHWM in the text of Linux's /proc/self/status, bytes.
fn peak_resident(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kibibytes)
}

/// Time that processors have spent on this process so far, all threads, in it and for it in the system, s; where the
/// system tells it. Other programs on the machine hardly change it.
#[cfg(unix)]
pub fn processor_seconds() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

#[cfg(not(unix))]
pub fn processor_seconds() -> Option<f64> {
    None
}

/// Bytes; the part of a processor in /proc/cpuinfo is ten times as long.
const READ_AT_ONCE: usize = 128;

/// How many there are in ranges such as "0-3,8".
fn processors(ranges: &str) -> Option<usize> {
    let count = |range: &str| -> Option<usize> {
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        (last.parse::<usize>().ok()? + 1).checked_sub(first.parse().ok()?)
    };
    ranges.trim().split(',').map(count).sum()
}

/// The model name in Linux's /proc/cpuinfo.
fn cpu_model(cpuinfo: impl BufRead) -> Option<String> {
    let line = cpuinfo.lines().map_while(Result::ok).find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_string())
}

/// s from a moment until now; 0 where the clock was set back.
pub fn seconds_since(moment: SystemTime) -> f64 {
    moment.elapsed().map_or(0.0, |time| time.as_secs_f64())
}

/// A moment in UTC to the second, after RFC 3339.
pub fn utc(moment: SystemTime) -> String {
    let seconds = moment.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (days, time) = (seconds / 86_400, seconds % 86_400);

    // From days to a date in the Gregorian calendar, counted in eras of 400 years that start on 1 March, so that
    // the leap day is the last of its year (H. Hinnant, "chrono-Compatible Low-Level Date Algorithms").
    let days = days + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = 400 * era + year_of_era + u64::from(month <= 2);

    let (hour, minute, second) = (time / 3600, time / 60 % 60, time % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    /// Expected texts from `date --utc --date=@SECONDS +%FT%TZ`.
    #[test]
    fn moments_are_written_as_the_system_writes_them() {
        let moments = [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_735_689_599, "2024-12-31T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ];
        for (seconds, expected) in moments {
            assert_eq!(utc(UNIX_EPOCH + Duration::from_secs(seconds)), expected);
        }
    }

    #[test]
    fn the_cpu_model_is_read_where_there_is_one() {
        let x86 = "processor\t: 0\nmodel\t\t: 1\nmodel name\t: Fast CPU @ 3.0GHz\nmodel name\t: again\n";
        assert_eq!(cpu_model(x86.as_bytes()).as_deref(), Some("Fast CPU @ 3.0GHz"));
        assert_eq!(cpu_model("processor\t: 0\n".as_bytes()), None);
        for (ranges, count) in
            [("0-1\n", Some(2)), ("0\n", Some(1)), ("0-3,8,10-11\n", Some(7)), ("", None), ("3-1", None)]
        {
            assert_eq!(processors(ranges), count, "{ranges}");
        }
    }

    /// Some work takes some time; none goes backwards.
    #[cfg(unix)]
    #[test]
    fn processor_time_grows_with_work() {
        let before = processor_seconds().unwrap();
        let sum: f64 = (1..2_000_000).map(|i| f64::from(i).sqrt()).sum();
        let after = processor_seconds().unwrap();
        assert!(sum > 0.0 && after > before && after < before + 60.0, "{before} {after}");
    }

    #[test]
    fn peak_memory_is_in_bytes() {
        let status = "Name:\tjointsweep\nVmPeak:\t  999 kB\nVmHWM:\t   4096 kB\nVmRSS:\t  12 kB\n";
        assert_eq!(peak_resident(status), Some(4096 * 1024));
        assert_eq!(peak_resident("Name:\tjointsweep\n"), None);
    }
}
