//! Time to condense one lane batch of bodies to their ring, one core, and how near that is to the arithmetic peak:
//! `cargo bench --bench condense`.
//!
//! First a table a mesh level: unknowns, counted floating-point operations a body (`CondensationPlan::operations`), the
//! median time a body, GFLOP/s and their share of the peak, which a loop of independent multiply-adds measures. Then
//! divan's figures of the same batches.

use std::time::Instant;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use jointsweep::mechanics::body::{Body, MAX_PARAMETERS, annulus};
use jointsweep::mechanics::compliance::lane_condensation::CondensationPlan;
use jointsweep::mechanics::compliance::pressure_space::PressureSpace;
use jointsweep::mechanics::element::ElementKind;
use jointsweep::mechanics::grading::{GradingClass, LEVEL_COUNT};
use jointsweep::mechanics::material::Idealization;
use jointsweep::mechanics::real::LANES;
use pulp::{Arch, Simd, WithSimd};

/// Plates of ratio 3 and a little less: one class, one topology.
fn bodies() -> [Body; LANES] {
    std::array::from_fn(|lane| {
        let mut parameters = [0.0; MAX_PARAMETERS];
        parameters[0] = 3.0 - 0.01 * lane as f64;
        let poissons_ratio = 0.2 + 0.03 * lane as f64;
        let idealization = Idealization::PlaneStress;
        Body { shape: &annulus::SHAPE, parameters, support: 0, poissons_ratio, idealization }
    })
}

fn plan(level: usize) -> CondensationPlan {
    let body = &bodies()[0];
    let class = GradingClass::of(body, ElementKind::Quad8, level);
    CondensationPlan::new(body, class.grading(body.shape.end_angle), &PressureSpace::new(10, 2.4))
}

/// Multiply-adds that do not wait for each other, as many as hide their latency.
const CHAINS: usize = 16;
const LINKS: usize = 100_000;

struct Peak;

impl WithSimd for Peak {
    /// Operations done.
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> usize {
        let (factor, term) = black_box((simd.splat_f64s(0.5), simd.splat_f64s(1.0)));
        let mut sums = [simd.splat_f64s(0.0); CHAINS];
        for _ in 0..LINKS {
            for sum in &mut sums {
                *sum = simd.mul_add_f64s(factor, *sum, term);
            }
        }
        black_box(sums);
        2 * CHAINS * LINKS * S::F64_LANES
    }
}

/// Median seconds of `work`.
fn median(runs: usize, mut work: impl FnMut()) -> f64 {
    let mut seconds: Vec<f64> = (0..runs)
        .map(|_| {
            let started = Instant::now();
            work();
            started.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[runs / 2]
}

fn main() {
    let operations = Arch::new().dispatch(Peak) as f64;
    let peak = operations / median(101, || _ = Arch::new().dispatch(Peak));
    println!("peak {:.1} GFLOP/s", peak / 1e9);
    println!("level  unknowns   elements  factorise       arcs  FLOP/body   us/body  GFLOP/s  of peak");
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
            operations.arcs,
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
