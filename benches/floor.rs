//! How far sweeps of all-different designs are from their arithmetic floor, one core: floating-point operations counted, the time of the
//! stages, and what the operations alone would take at the measured peak: `cargo bench --bench floor`. Plates in rings with whole pins
//! (`configs/random.toml`) and with half ones, and blocks (`configs/hypercube-block.toml`), at 1 % and 0.1 %, 2,000 designs each, no body
//! interpolated.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::path::Path;

use jointsweep::internals::engine::accuracy::single_precision::{accuracy_bears_singles, body_bears_singles};
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
use jointsweep::internals::study::setting::Setting;

#[path = "common/peak.rs"]
mod peak;

/// Operations that the first attempt at every design takes; near fields' references and further attempts are left out.
#[derive(Default)]
struct Counted {
    elements: u64,
    factorise: u64,
    modes: u64,
    /// What of these is in single precision, two numbers in the place of one.
    in_singles: u64,
    contact: f64,
}

impl Counted {
    fn of(study: &Study) -> Counted {
        let mut of_topology = HashMap::new();
        let mut sum = Counted::default();
        for case in study.cases().unwrap() {
            let plan = JointPlan::cheapest(&case.unwrap(), study.solve.method, study.solve.accuracy).unwrap();
            let mut modes_of_bodies = Vec::new();
            for request in plan.requests() {
                let Fidelity::Mesh { level } = request.fidelity else { continue };
                let class = GradingClass::of(&request.body, ElementKind::Quad8, level);
                let operations = of_topology.entry(hash(TopologyKey::of(&request))).or_insert_with(|| {
                    let grading = class.grading(request.body.shape.end_angle);
                    CondensationPlan::new(&request.body, grading, RingModes::of(&class)).operations()
                });
                let Operations { elements, factorise, modes } = *operations;
                sum.elements += elements;
                sum.factorise += factorise;
                sum.modes += modes;
                if accuracy_bears_singles(study.solve.accuracy) && body_bears_singles(&request.body, &class) {
                    sum.in_singles += operations.total();
                }
                modes_of_bodies.push(RingModes::of(&class).count as f64);
            }
            sum.contact += contact(&plan, &modes_of_bodies);
        }
        sum
    }

    fn condensation(&self) -> f64 {
        (self.elements + self.factorise + self.modes) as f64
    }

    /// As many operations in double precision as take as long at the peak.
    fn condensation_in_double(&self) -> f64 {
        self.condensation() - 0.5 * self.in_singles as f64
    }
}

fn hash(value: impl std::hash::Hash) -> u64 {
    use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
    BuildHasherDefault::<DefaultHasher>::default().hash_one(value)
}

/// Operations of the contact of one design, with the modes of its meshed bodies; all lanes counted.
fn contact(plan: &JointPlan, modes_of_bodies: &[f64]) -> f64 {
    // Of ten loads two searches of eight, three steps each as seen on these sweeps, and the functions of a load that a step sums.
    const STEPS: f64 = 2.0 * 3.0;
    const FUNCTIONS_OF_LOAD: f64 = 8.0;
    const SIDES: f64 = 3.0;
    const FUNCTIONS: f64 = 12.0;
    let (terms, nodes, lanes) = (plan.space.terms as f64, plan.space.nodes as f64, LANES as f64);
    let entries = packed_count(plan.space.terms) as f64;
    // Both kernels; then of each body what works make of all modes, and the products of these with the modes.
    let of_modes = |modes: &f64| 2.0 * nodes * modes * (modes * terms + entries);
    let compliance = nodes * entries * 4.0 + modes_of_bodies.iter().map(of_modes).sum::<f64>();
    // Cholesky, right-hand sides to and fro, the sums over them, the pressure between its zeros.
    let solve = nodes
        * (terms * terms * terms / 3.0 + SIDES * 2.0 * terms * terms + 24.0 * terms + 8.0 * terms * terms);
    // Values at the nodes to coefficients, even and odd apart; from arcs of the pin to those of the hole.
    let transform = nodes * nodes * FUNCTIONS + 2.0 * nodes * nodes * entries;
    let share = nodes * 4.0 * entries;
    compliance + solve + transform + share + STEPS * lanes * nodes * FUNCTIONS_OF_LOAD * 3.0
}

/// A config with so few designs, none of whose bodies is interpolated.
fn study(path: &str, text: String, accuracy: &str) -> Study {
    let settings = ["solve.method=fe", "solve.interpolation=off", "sampling.count=2000"].map(String::from);
    let settings: Vec<Setting> = settings
        .iter()
        .chain([&format!("solve.accuracy={accuracy}")])
        .map(|text| Setting::parse(text, "floor").unwrap())
        .collect();
    Study::from_text_with(Path::new(path), text, &settings).unwrap()
}

fn main() {
    let peak = peak::peak();
    println!(
        "peak {:.0} GFLOP/s in double precision, twice as many in single; 2,000 designs, one thread, the fastest of 7 runs",
        peak / 1e9
    );
    let rings = include_str!("../configs/random.toml");
    let blocks = include_str!("../configs/hypercube-block.toml");
    let half_pins = rings.replace("rigid-core", "rigid-midplane");
    let half_pins: Vec<&str> =
        half_pins.lines().filter(|line| !line.starts_with("core_radius_ratio")).collect();
    for (name, text) in
        [("whole pins in rings", rings), ("half pins in rings", &half_pins.join("\n")), ("blocks", blocks)]
    {
        for accuracy in ["1 %", "0.1 %"] {
            println!("\n{name}, {accuracy}");
            told(&study(name, text.to_string(), accuracy), peak);
        }
    }
}

fn told(study: &Study, peak: f64) {
    let designs = study.design_count() as f64;
    let mut fastest: Option<Vec<(&str, f64)>> = None;
    let total = |stages: &[(&str, f64)]| stages.iter().map(|(_, seconds)| seconds).sum::<f64>();
    for _ in 0..7 {
        let statistics = run(study, &SweepOptions { threads: 1, ..Default::default() }, &mut |_| {
            Ok(ControlFlow::Continue(()))
        });
        let stages = statistics.unwrap().stages;
        let stages: Vec<_> = stages.iter().map(|(name, time)| (*name, time.as_secs_f64())).collect();
        if fastest.as_ref().is_none_or(|fastest| total(&stages) < total(fastest)) {
            fastest = Some(stages);
        }
    }
    let counted = Counted::of(study);
    println!(
        "condensation, kFLOP a design: elements {:.0}, factors {:.0}, modes {:.0}",
        counted.elements as f64 / designs / 1e3,
        counted.factorise as f64 / designs / 1e3,
        counted.modes as f64 / designs / 1e3
    );
    println!("stage                           us/design  kFLOP/design  us at peak  of peak");
    for (stage, seconds) in fastest.unwrap() {
        let time = seconds / designs * 1e6;
        let [operations, in_double] = match stage {
            "condensation" => {
                [counted.condensation(), counted.condensation_in_double()].map(|all| all / designs)
            }
            "contact" => [counted.contact / designs; 2],
            _ if seconds == 0.0 => continue,
            _ => {
                println!("{stage:<32}{time:>9.1}");
                continue;
            }
        };
        let floor = in_double / peak * 1e6;
        println!(
            "{stage:<32}{time:>9.1}{:>14.0}{floor:>12.1}{:>7.0} %",
            operations / 1e3,
            100.0 * floor / time
        );
    }
}
