//! Time of whole sweeps without files, all stages on one thread and on two, start of the threads included; items are
//! designs: `cargo bench --bench sweep`. `jointsweep bench` measures whole processes.

use std::ops::ControlFlow;
use std::path::Path;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use jointsweep::internals::engine::sweep::{SweepOptions, run};
use jointsweep::internals::study::config::Study;

/// A config of the repository.
fn study(name: &str) -> Study {
    Study::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("configs").join(name)).unwrap()
}

/// A tenth of `configs/random.toml`.
fn a_thousand_all_different() -> Study {
    let text = study("random.toml").source_text().replace("count  = 10000", "count  = 1000");
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("thousand.toml");
    std::fs::write(&path, text).unwrap();
    let study = Study::load(&path).unwrap();
    assert_eq!(study.design_count(), 1000);
    study
}

fn measure(bencher: Bencher, study: &Study, threads: usize) {
    let designs = ItemsCount::new(study.design_count() as usize);
    bencher.counter(designs).bench_local(|| {
        let mut rows = 0;
        run(study, &SweepOptions { threads, ..Default::default() }, &mut |outcome| {
            rows += black_box(outcome).steps.len();
            Ok(ControlFlow::Continue(()))
        })
        .unwrap();
        rows
    });
}

fn main() {
    divan::main();
}

#[divan::bench(args = [1, 2], sample_count = 20)]
fn liu2007(bencher: Bencher, threads: usize) {
    measure(bencher, &study("liu2007.toml"), threads);
}

#[divan::bench(args = [1, 2], sample_count = 20)]
fn quickstart(bencher: Bencher, threads: usize) {
    measure(bencher, &study("quickstart.toml"), threads);
}

#[divan::bench(args = [1, 2], sample_count = 10)]
fn thousand_all_different(bencher: Bencher, threads: usize) {
    measure(bencher, &a_thousand_all_different(), threads);
}
