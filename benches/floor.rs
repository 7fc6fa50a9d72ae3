//! How far the sweep of 10,000 all-different designs (`configs/random.toml`) is from its arithmetic floor, one core:
//! floating-point operations counted, the time of the stages, and what the operations alone would take at the measured
//! peak: `cargo bench --bench floor`.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::path::Path;

use jointsweep::internals::engine::body_request::{Fidelity, TopologyKey};
use jointsweep::internals::engine::plan::JointPlan;
use jointsweep::internals::engine::sweep::{SweepOptions, run};
use jointsweep::internals::mechanics::compliance::arc::packed_count;
use jointsweep::internals::mechanics::compliance::lane_condensation::{CondensationPlan, Operations};
use jointsweep::internals::mechanics::compliance::ring_modes::RingModes;
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::grading::GradingClass;
use jointsweep::internals::mechanics::real::LANES;
use jointsweep::internals::study::config::Study;

#[path = "common/peak.rs"]
mod peak;

/// The operations of condensing every body on the two meshes of the first attempt (a thirtieth of them are solved
/// again on a third), without the near fields' references.
fn condensation(study: &Study) -> Operations {
    let mut of_topology = HashMap::new();
    let mut sum = Operations { elements: 0, factorise: 0, modes: 0 };
    for case in study.cases().unwrap() {
        let plan = JointPlan::cheapest(&case.unwrap(), study.solve.method, study.solve.accuracy).unwrap();
        for request in plan.requests() {
            let Fidelity::Mesh { level } = request.fidelity else { continue };
            let operations = *of_topology.entry(hash(TopologyKey::of(&request))).or_insert_with(|| {
                let class = GradingClass::of(&request.body, ElementKind::Quad8, level);
                let grading = class.grading(request.body.shape.end_angle);
                CondensationPlan::new(&request.body, grading, RingModes::of(&class)).operations()
            });
            sum.elements += operations.elements;
            sum.factorise += operations.factorise;
            sum.modes += operations.modes;
        }
    }
    sum
}

fn hash(value: impl std::hash::Hash) -> u64 {
    use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
    BuildHasherDefault::<DefaultHasher>::default().hash_one(value)
}

/// Operations of the contact of one design with 6 trial pressures at 16 nodes and 8 modes a body, ten loads; all lanes counted.
fn contact() -> f64 {
    // Steps of eight searches at a time, seen on this sweep, and operations of each: Clenshaw's sums of seven functions.
    const STEPS: f64 = 6.0;
    let (terms, nodes, modes) = (6.0, 16.0, 8.0);
    let entries = packed_count(6) as f64;
    // Both kernels; then of each body the works of the modes before a mode, and its products with both.
    let compliance = nodes * entries * 4.0 + 2.0 * nodes * modes * (modes * terms + 4.0 * entries);
    // Cholesky, two right-hand sides to and fro, the sums over them, the pressure between its zeros.
    let solve =
        nodes * (terms * terms * terms / 3.0 + 4.0 * terms * terms + 16.0 * terms + 8.0 * terms * terms);
    let transform = 2.0 * nodes * nodes * LANES as f64;
    let share = nodes * 4.0 * entries;
    compliance + solve + transform + share + STEPS * LANES as f64 * nodes * 7.0 * 4.0
}

fn main() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/random.toml");
    let study = Study::load(&path).unwrap();
    let designs = study.design_count() as f64;
    let peak = peak::peak();

    let mut fastest: Option<Vec<(&str, f64)>> = None;
    let total = |stages: &[(&str, f64)]| stages.iter().map(|(_, seconds)| seconds).sum::<f64>();
    for _ in 0..7 {
        let statistics = run(&study, &SweepOptions { threads: 1, ..Default::default() }, &mut |_| {
            Ok(ControlFlow::Continue(()))
        });
        let stages = statistics.unwrap().stages;
        let stages: Vec<_> = stages.iter().map(|(name, time)| (*name, time.as_secs_f64())).collect();
        if fastest.as_ref().is_none_or(|fastest| total(&stages) < total(fastest)) {
            fastest = Some(stages);
        }
    }

    let Operations { elements, factorise, modes } = condensation(&study);
    let condensation = (elements + factorise + modes) as f64;
    println!("peak {:.0} GFLOP/s; {designs} designs, one thread, the fastest of 7 runs", peak / 1e9);
    println!(
        "condensation, kFLOP a design: elements {:.0}, factors {:.0}, modes {:.0}",
        elements as f64 / designs / 1e3,
        factorise as f64 / designs / 1e3,
        modes as f64 / designs / 1e3
    );
    println!("stage                           us/design  kFLOP/design  us at peak  of peak");
    for (stage, seconds) in fastest.unwrap() {
        let time = seconds / designs * 1e6;
        let operations = match stage {
            "condensation" => condensation / designs,
            "contact" => contact(),
            _ => {
                println!("{stage:<32}{time:>9.1}");
                continue;
            }
        };
        let floor = operations / peak * 1e6;
        println!(
            "{stage:<32}{time:>9.1}{:>14.0}{floor:>12.1}{:>7.0} %",
            operations / 1e3,
            100.0 * floor / time
        );
    }
}
