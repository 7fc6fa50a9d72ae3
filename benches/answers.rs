//! Designs a second that `[select]` and `[reduce]` are answered for in the place of rows, one core, ten loads a design; items are
//! designs: `cargo bench --bench answers`.

use std::ops::ControlFlow;
use std::path::Path;

use divan::Bencher;
use divan::counter::ItemsCount;
use jointsweep::internals::engine::outcome::DesignOutcome;
use jointsweep::internals::engine::sweep::{self, SweepOptions};
use jointsweep::internals::output::sinks::{Rows, Sinks};
use jointsweep::internals::study::config::Study;

const CONFIG: &str = r#"
[joint]
idealization     = "plane-stress"
hole_radius      = { from = "5 mm", to = "20 mm" }
radial_clearance = { from = "10 um", to = "200 um", spacing = "log" }
thickness        = { from = "4 mm", to = "12 mm" }
[joint.pin]
model             = "rigid-core"
core_radius_ratio = 0.2
youngs_modulus    = "210 GPa"
poissons_ratio    = 0.3
[joint.plate]
model              = "annulus"
outer_radius_ratio = { from = 2, to = 5 }
youngs_modulus     = "70 GPa"
poissons_ratio     = 0.33
[load]
force = { from = "1 kN", to = "10 kN", count = 10 }
[sampling]
method = "sobol"
count  = 8192
"#;

const SELECT: &str =
    "[select]\nkeep = \"peak_pressure < 100 MPa and tangent_stiffness > 1e5 N/mm and status == 'ok'\"\n";

const REDUCE: &str = r#"[reduce]
statistics = ["tangent_stiffness", "peak_pressure"]
quantiles  = [0.5]
best       = { by = "tangent_stiffness / (hole_radius * thickness)", count = 5 }
histogram  = { of = "peak_pressure", bins = 12 }
"#;

/// What is asked: nothing but the counts of the manifest, one answer of each kind, or all of them.
const ASKED: [(&str, &str, &str); 7] = [
    ("counts", "", "[output]\ntable = false\nlaws = false\n"),
    ("select", SELECT, "[output]\ntable = false\n"),
    ("statistics", "", "[reduce]\nstatistics = ['tangent_stiffness', 'peak_pressure']\n"),
    ("quantile", "", "[reduce]\nstatistics = ['tangent_stiffness', 'peak_pressure']\nquantiles = [0.5]\n"),
    ("best", "", "[reduce]\nbest = { by = 'tangent_stiffness / (hole_radius * thickness)', count = 5 }\n"),
    ("histogram", "", "[reduce]\nhistogram = { of = 'peak_pressure', bins = 12 }\n"),
    ("all", SELECT, REDUCE),
];

fn study(asked: &str) -> Study {
    let (_, select, reduce) = ASKED.iter().find(|(name, ..)| *name == asked).expect("it is listed");
    Study::from_text(Path::new("answers.toml"), format!("{CONFIG}{select}{reduce}")).expect("it is sound")
}

/// Each portion of designs, as a sweep gives it.
fn portions(study: &Study, designs: u64) -> Vec<Vec<DesignOutcome>> {
    let mut portions: Vec<Vec<DesignOutcome>> = Vec::new();
    let mut receive = |outcome: DesignOutcome| {
        match portions.last_mut() {
            Some(portion) if !outcome.case.index.is_multiple_of(designs) => portion.push(outcome),
            _ => portions.push(vec![outcome]),
        }
        Ok(ControlFlow::Continue(()))
    };
    sweep::run(study, &SweepOptions::default(), &mut receive).expect("it can be solved");
    portions
}

fn main() {
    divan::main();
}

/// The work of all threads, and of the one that joins what they have found.
#[divan::bench(args = ASKED.map(|(name, ..)| name))]
fn answers(bencher: Bencher, asked: &str) {
    let study = study(asked);
    let sinks = Sinks::of(&study);
    let portions = portions(&study, 1024);
    let designs = portions.iter().map(Vec::len).sum::<usize>();
    bencher
        .counter(ItemsCount::new(designs))
        .with_inputs(|| (portions.clone(), sinks.answers()))
        .bench_local_values(|(portions, mut answers)| {
            for portion in portions {
                let Rows { answers: more, .. } = sinks.rows(portion.into());
                if let (Some(answers), Some(more)) = (&mut answers, &more) {
                    answers.merge(more).expect("they are of the same config");
                }
            }
            answers
        });
}
