//! Time to condense one lane batch of bodies to their ring, one core, and how near that is to the arithmetic peak:
//! `cargo bench --bench condense`.
//!
//! First a table of mesh levels, of plates of ratio 3 and of thin rings of ratio 1.1: unknowns, counted floating-point
//! operations a body (`CondensationPlan::operations`), the median time a body, GFLOP/s and their share of the peak, which a
//! loop of independent multiply-adds measures; `single`: in single precision, twice as many bodies against twice the peak;
//! `alone`: one body after the other, in double precision. Then divan's figures of the batches of ratio 3.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use jointsweep::internals::mechanics::body::{Body, MAX_PARAMETERS, annulus};
use jointsweep::internals::mechanics::compliance::lane_condensation::CondensationPlan;
use jointsweep::internals::mechanics::compliance::ring_modes::RingModes;
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::grading::{GradingClass, LEVEL_COUNT};
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::mechanics::real::LANES;
use jointsweep::internals::mechanics::singles::SINGLES;

#[path = "common/peak.rs"]
mod peak;

use peak::{median, peak};

/// Of which the median is told.
const RUNS: usize = 31;

/// Outer radius ratios: deep plates, and thin rings, whose bands are the widest.
const RATIOS: [f64; 2] = [3.0, 1.1];

/// Plates of a ratio and a little less: one class, one topology.
fn bodies<const COUNT: usize>(ratio: f64) -> [Body; COUNT] {
    std::array::from_fn(|lane| {
        let mut parameters = [0.0; MAX_PARAMETERS];
        parameters[0] = ratio * (1.0 - 5e-4 * (lane % LANES) as f64);
        let poissons_ratio = 0.2 + 0.015 * lane as f64;
        let idealization = Idealization::PlaneStress;
        Body {
            shape: &annulus::SHAPE,
            parameters,
            support: 0,
            poissons_ratio,
            idealization,
            lining: Default::default(),
            all_around: false,
        }
    })
}

fn plan(ratio: f64, level: usize) -> CondensationPlan {
    let body = &bodies::<1>(ratio)[0];
    let class = GradingClass::of(body, ElementKind::Quad8, level);
    CondensationPlan::new(body, class.grading(body.shape.end_angle), RingModes::of(&class))
}

fn main() {
    let peak = peak();
    println!("peak {:.1} GFLOP/s", peak / 1e9);
    println!(
        "ratio level             unknowns   elements  factorise      modes  FLOP/body   us/body  GFLOP/s  of peak"
    );
    let double = (0..LEVEL_COUNT).map(|level| (level, "double"));
    let alone = (0..LEVEL_COUNT).map(|level| (level, "alone"));
    let rows: Vec<_> = double.chain([(0, "single"), (1, "single")]).chain(alone).collect();
    for (ratio, &(level, precision)) in
        RATIOS.iter().flat_map(|ratio| rows.iter().map(move |row| (*ratio, row)))
    {
        let (bodies, twice_as_many) = (bodies::<LANES>(ratio), bodies::<SINGLES>(ratio));
        let plan = plan(ratio, level);
        let operations = plan.operations();
        let in_double = || _ = black_box(plan.condense(&bodies));
        let in_turn = || bodies.iter().for_each(|body| _ = black_box(plan.condense_alone(body)));
        let in_singles = || _ = black_box(plan.condense_in_singles(&twice_as_many));
        let (seconds, peak) = match precision {
            "double" => (median(RUNS, in_double) / LANES as f64, peak),
            "alone" => (median(RUNS, in_turn) / LANES as f64, peak),
            _ => (median(RUNS, in_singles) / SINGLES as f64, 2.0 * peak),
        };
        let rate = operations.total() as f64 / seconds;
        println!(
            "{ratio:>5} {level:>5} {precision:>9} {:>9} {:>10} {:>10} {:>10} {:>10} {:>9.2} {:>8.1} {:>7.0} %",
            plan.unknown_count(),
            operations.elements,
            operations.factorise,
            operations.modes,
            operations.total(),
            seconds * 1e6,
            rate / 1e9,
            100.0 * rate / peak,
        );
    }
    divan::main();
}

/// Items are bodies.
#[divan::bench(args = 0..LEVEL_COUNT)]
fn condense(bencher: Bencher, level: usize) {
    let (plan, bodies) = (plan(RATIOS[0], level), bodies::<LANES>(RATIOS[0]));
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| plan.condense(black_box(&bodies)));
}
