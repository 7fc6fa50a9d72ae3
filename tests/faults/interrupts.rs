//! Ctrl-C, whatever a design is doing.

use std::time::{Duration, Instant};

use crate::common::workdir::{Ended, Workdir};
use crate::kills::{end, send};
use crate::slow_config;

/// The time from the signal to the end of the process, when it is sent so long after the start; and what the run said.
fn interrupted_after(work: &Workdir, delay: Duration, signal: &str) -> (Duration, Ended) {
    let child = work.start(&["run", "slow.toml", "--threads", "1"]);
    std::thread::sleep(delay);
    let sent = Instant::now();
    send(signal, &child);
    let ended = end(child);
    (sent.elapsed(), ended)
}

/// The first batch takes two seconds and more: no design ends by itself before the run does. Of three tries the shortest counts,
/// because the machine may be busy.
#[test]
fn a_run_ends_within_a_second_whatever_it_is_doing() {
    let work = Workdir::new("slow-design");
    work.write("slow.toml", &slow_config());
    for signal in ["-INT", "-TERM"] {
        let times = [0.2, 0.5, 0.9].map(|delay| {
            let (time, ended) = interrupted_after(&work, Duration::from_secs_f64(delay), signal);
            let ended = ended.expect(130);
            assert_eq!(ended.stderr, "interrupted: 0 of 64 designs are done\n");
            time
        });
        println!("{signal}: {times:?}");
        assert!(times.iter().min() < Some(&Duration::from_secs(1)), "{times:?}");
    }
    // No row came, so nothing is left but the lock, which holds nobody.
    assert!(
        !work.path("out/slow/manifest.json").exists() && !work.path("out/slow/table.csv.partial").exists()
    );
    let dry = work.run(&["run", "slow.toml", "--dry-run"]).expect(0);
    assert!(dry.stdout.contains("designs         64"), "{}", dry.stdout);
}
