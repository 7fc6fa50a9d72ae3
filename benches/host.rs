//! What processors do around a GPU, in time of all threads a design: sweeps of designs that are all different, finite elements at 1 % and, the
//! sixth and ninth, at 0.1 %, with kernels that do nothing; the fifth and all from the seventh on ask for answers alone, the seventh of designs that
//! the device draws, those behind it of condensed bodies. `condense`: from the bodies of a batch to their works or to the states of their joints, or from interpolated joints to these; `rest`: plans, keys, near fields, contact, what is judged. `cargo bench --bench host [-- DESIGNS [REPEATS [LINE]]]`, of one line where its number is given. Any Vulkan device will do, software too; no table is written.
//! The first two batches are told apart, as `begin`, in s: they make what all have in common. The first of some repeats lays out the topologies
//! that the others find on the device.

use jointsweep::internals::engine::backend::gpu::context::{AdapterChoice, Adapters};
use jointsweep::internals::engine::backend::precision::Precision;
use jointsweep::internals::engine::threads::pool;
use jointsweep::internals::lab::gpu::host_cost::HostCost;
use jointsweep::internals::lab::gpu::measured_sweep::SWEEPS;

/// Designs of a batch, as for a real GPU.
const BATCH: usize = 8192;
const DRAWN_BATCH: usize = 65_536;

/// What is done with the bodies of a sweep, and with the rows of interpolated ones.
#[derive(Clone, Copy, Debug, PartialEq)]
enum How {
    Condensed,
    Interpolated,
    Counted,
    /// The same of designs that the device draws.
    Drawn,
    /// Condensed, and their rows counted.
    CondensedAndCounted,
}

fn main() {
    let mut numbers = std::env::args().skip(1).filter_map(|argument| argument.parse::<u64>().ok());
    let designs = numbers.next().unwrap_or(100_000);
    let repeats = numbers.next().unwrap_or(3);
    let line = numbers.next();
    let gpu = Adapters::enumerate().open(AdapterChoice::Named("")).unwrap_or_else(|error| panic!("{error}"));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    println!("{}, {} threads", gpu.facts.name, threads);
    let pool = pool(threads).unwrap_or_else(|error| panic!("{error}"));
    let lines = [
        (&SWEEPS[0], Precision::F32, How::Condensed),
        (&SWEEPS[0], Precision::Mixed, How::Condensed),
        (&SWEEPS[2], Precision::F32, How::Condensed),
        (&SWEEPS[0], Precision::F32, How::Interpolated),
        (&SWEEPS[0], Precision::F32, How::Counted),
        (&SWEEPS[1], Precision::F32, How::Condensed),
        (&SWEEPS[0], Precision::F32, How::Drawn),
        (&SWEEPS[0], Precision::F32, How::CondensedAndCounted),
        (&SWEEPS[1], Precision::F32, How::CondensedAndCounted),
        (&SWEEPS[2], Precision::F32, How::CondensedAndCounted),
    ];
    for (number, (sweep, precision, how)) in (1..).zip(lines) {
        if line.is_some_and(|line| line != number) {
            continue;
        }
        let study = match how {
            How::Counted | How::Drawn => sweep.answers(designs, true),
            How::CondensedAndCounted => sweep.answers(designs, false),
            _ => sweep.study(designs, how == How::Interpolated),
        };
        let study = study.unwrap();
        println!(
            "\n{}, {how:?} at {}, {}, {designs} designs; us of processor time a design",
            sweep.scene,
            sweep.accuracy,
            precision.name()
        );
        println!("{:>10} {:>10} {:>10} {:>10} {:>10}", "begin, s", "drawing", "condense", "rest", "all");
        let mut last = HostCost::default();
        for _ in 0..repeats {
            let (batch, draws) = if how == How::Drawn { (DRAWN_BATCH, true) } else { (BATCH, false) };
            let cost = HostCost::of(&study, &gpu, precision, &pool, batch, draws);
            last = cost.unwrap_or_else(|error| panic!("{error}"));
            let each = |seconds: f64| 1e6 * seconds / last.designs as f64;
            println!(
                "{:>10.2} {:>10.2} {:>10.2} {:>10.2} {:>10.2}",
                last.beginning,
                each(last.drawing),
                each(last.condensing),
                each(last.solving - last.condensing),
                each(last.drawing + last.solving),
            );
        }
        println!("{} designs on the device; {:?}; {} calls", last.on_device, last.counts, last.calls);
        println!("{:?}", last.stages);
    }
}
