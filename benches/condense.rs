//! Time to condense one lane batch of bodies to their ring, one core, and how near that is to the arithmetic peak:
//! `cargo bench --bench condense`.
//!
//! First a table a mesh level: unknowns, counted floating-point operations a body (`CondensationPlan::operations`), the
//! median time a body, GFLOP/s and their share of the peak, which a loop of independent multiply-adds measures. Then
//! divan's figures of the same batches.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use jointsweep::internals::mechanics::body::{Body, MAX_PARAMETERS, annulus};
use jointsweep::internals::mechanics::compliance::lane_condensation::CondensationPlan;
use jointsweep::internals::mechanics::compliance::ring_modes::RingModes;
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::grading::{GradingClass, LEVEL_COUNT};
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::mechanics::real::LANES;

#[path = "common/peak.rs"]
mod peak;

use peak::{median, peak};

/// Plates of ratio 3 and a little less: one class, one topology.
fn bodies() -> [Body; LANES] {
    std::array::from_fn(|lane| {
        let mut parameters = [0.0; MAX_PARAMETERS];
        parameters[0] = 3.0 - 0.01 * lane as f64;
        let poissons_ratio = 0.2 + 0.03 * lane as f64;
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

fn plan(level: usize) -> CondensationPlan {
    let body = &bodies()[0];
    let class = GradingClass::of(body, ElementKind::Quad8, level);
    CondensationPlan::new(body, class.grading(body.shape.end_angle), RingModes::of(&class))
}

fn main() {
    let peak = peak();
    println!("peak {:.1} GFLOP/s", peak / 1e9);
    println!("level  unknowns   elements  factorise      modes  FLOP/body   us/body  GFLOP/s  of peak");
    let bodies = bodies();
    for level in 0..LEVEL_COUNT {
        let plan = plan(level);
        let operations = plan.operations();
        let seconds = median(101, || _ = black_box(plan.condense(&bodies))) / LANES as f64;
        let rate = operations.total() as f64 / seconds;
        println!(
            "{level:>5} {:>9} {:>10} {:>10} {:>10} {:>10} {:>9.2} {:>8.1} {:>7.0} %",
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
    let (plan, bodies) = (plan(level), bodies());
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| plan.condense(black_box(&bodies)));
}
