//! Measures what the parts of a sweep cost on one core of this machine, for the forecasts of `jointsweep run --dry-run`, for
//! `explain`, and for the choice of which bodies are interpolated.
//!
//! ```text
//! cargo run --release --example unit_costs > unit_costs.csv     # a minute; then over src/engine/unit_costs.csv
//! ```
//!
//! Times are those of the processor, medians of several runs; of whole sweeps and programs the least. A number of the file makes
//! the sums of `engine::unit_costs` come closest to them, by least squares of the relative errors, rounded up to two digits. How
//! far off the sums still are is printed beside, as the greatest factor.

use std::hint::black_box;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::Command;
use std::time::{Instant, SystemTime};

use jointsweep::internals::engine::body_request::{BodyRequest, concentric, mesh_class, mesh_size};
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::law_fit::{law_case, laws_of};
use jointsweep::internals::engine::plan::JointPlan;
use jointsweep::internals::engine::refusal::is_bounded;
use jointsweep::internals::engine::spaces::SpaceKey;
use jointsweep::internals::engine::sweep::{self, Digest, SweepOptions};
use jointsweep::internals::engine::unit_costs::{
    Unit, batch, curve, design, interpolated_design, near_field_works, row, series, space, space_modes,
    space_ring_modes, spread_modes, spread_ring_modes, topology,
};
use jointsweep::internals::mechanics::body::{Body, Side, annulus, block, cored_disc, half_disc};
use jointsweep::internals::mechanics::compliance::lane_condensation::CondensationPlan;
use jointsweep::internals::mechanics::compliance::pressure_space::{JointCompliance, Tilt};
use jointsweep::internals::mechanics::compliance::ring_modes::RingModes;
use jointsweep::internals::mechanics::compliance::{BodyCompliance, Boundary};
use jointsweep::internals::mechanics::contact::curve::ContactCurve;
use jointsweep::internals::mechanics::contact::curve_space::{CurveSpace, Variable};
use jointsweep::internals::mechanics::contact::outlines::Outlines;
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::mechanics::real::LANES;
use jointsweep::internals::output::folder::ResultFolder;
use jointsweep::internals::output::host::{Host, processor_seconds};
use jointsweep::internals::output::manifest::Conditions;
use jointsweep::internals::output::recorder::Recorder;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions, Study};

/// Runs of which the median is taken, and the least time of each, s.
const RUNS: usize = 9;
const SHORTEST: f64 = 1e-3;

/// Runs of whole sweeps, and of a program that does nothing, of which the least is taken.
const RUNS_OF_SWEEPS: usize = 5;
const RUNS_OF_PROGRAM: usize = 50;

/// A unit takes at least this share of what it would take if nothing else did.
const LEAST_SHARE: f64 = 0.01;

/// Trial pressures and nodes.
const SPACES: [(usize, usize); 6] = [(6, 24), (6, 32), (10, 24), (10, 48), (16, 48), (24, 64)];

/// Counts of modes of exact bodies and of ring modes.
const MODES: [usize; 4] = [10, 50, 200, 1000];
const RING_MODES: [usize; 4] = [8, 16, 24, 48];

/// Mesh levels that sweeps come to.
const LEVELS: usize = 5;

/// Bytes that are written before what a sweep makes once is timed, so that nothing of it is in the caches.
const OTHER_BYTES: usize = 32 << 20;

/// Argument with which this program runs the smallest sweep there is.
const SMALLEST: &str = "smallest";

/// How much of which units something is, and how long it took, s.
struct Measured {
    amounts: Vec<(Unit, f64)>,
    seconds: f64,
}

impl Measured {
    fn new(amounts: &[&[(Unit, f64)]], seconds: f64) -> Measured {
        Measured { amounts: amounts.concat(), seconds }
    }

    fn amount(&self, unit: Unit) -> f64 {
        self.amounts.iter().filter(|(own, _)| *own == unit).map(|(_, amount)| amount).sum()
    }
}

fn median(runs: usize, mut run: impl FnMut() -> f64) -> f64 {
    let mut seconds: Vec<f64> = (0..runs).map(|_| run()).collect();
    seconds.sort_by(f64::total_cmp);
    seconds[runs / 2]
}

/// For what other programs disturb most.
fn least(runs: usize, mut run: impl FnMut() -> f64) -> f64 {
    (0..runs).map(|_| run()).fold(f64::INFINITY, f64::min)
}

fn now() -> f64 {
    processor_seconds().expect("a system that tells the processor time of a program")
}

/// Processor time of work that a sweep does once, s.
fn time_once<T>(mut work: impl FnMut() -> T) -> f64 {
    let mut other = vec![0_u8; OTHER_BYTES];
    median(RUNS, || {
        black_box(&mut other).iter_mut().step_by(64).for_each(|byte| *byte = byte.wrapping_add(1));
        let started = now();
        black_box(work());
        now() - started
    })
}

/// Processor time of one of many repeats of some work, s.
fn time<T>(mut work: impl FnMut() -> T) -> f64 {
    let mut of = |repeats: usize| {
        let started = now();
        (0..repeats).for_each(|_| _ = black_box(work()));
        now() - started
    };
    let mut repeats = 1;
    while of(repeats) < SHORTEST {
        repeats *= 2;
    }
    median(RUNS, || of(repeats)) / repeats as f64
}

/// The times of these units, s, that explain what was measured best.
fn fit(what: &str, units: &[Unit], measured: &[Measured]) -> Vec<(Unit, f64)> {
    let mut free = units.to_vec();
    let mut found = least_squares(&free, measured);
    while let Some(place) = found.iter().position(|value| *value <= 0.0) {
        free.remove(place);
        found = least_squares(&free, measured);
    }
    let value = |unit: &Unit| {
        let alone = measured.iter().map(|one| one.seconds / one.amount(*unit)).fold(f64::INFINITY, f64::min);
        let own = free.iter().position(|one| one == unit).map_or(0.0, |place| found[place]);
        (*unit, rounded_up(own.max(LEAST_SHARE * alone)))
    };
    let values: Vec<(Unit, f64)> = units.iter().map(value).collect();
    let ratios = measured.iter().map(|one| {
        let of_unit = |(unit, value): &(Unit, f64)| value * one.amount(*unit);
        values.iter().map(of_unit).sum::<f64>() / one.seconds
    });
    let (least, most) = ratios
        .fold((f64::INFINITY, 0.0), |(least, most), ratio| (f64::min(least, ratio), f64::max(most, ratio)));
    eprintln!("{what}: {least:.2} to {most:.2} of {} times", measured.len());
    values
}

/// The least sum of squared relative errors: Gauss's elimination of the normal equations.
fn least_squares(units: &[Unit], measured: &[Measured]) -> Vec<f64> {
    let count = units.len();
    let mut rows = vec![vec![0.0; count + 1]; count];
    for one in measured {
        let relative: Vec<f64> = units.iter().map(|unit| one.amount(*unit) / one.seconds).collect();
        for i in 0..count {
            (0..count).for_each(|j| rows[i][j] += relative[i] * relative[j]);
            rows[i][count] += relative[i];
        }
    }
    for i in 0..count {
        let pivot = rows[i].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(j, _)| *j != i) {
            let factor = row[i] / pivot[i];
            row.iter_mut().zip(&pivot).for_each(|(value, other)| *value -= factor * other);
        }
    }
    (0..count).map(|i| rows[i][count] / rows[i][i]).collect()
}

/// Rounded up to two digits.
fn rounded_up(value: f64) -> f64 {
    let unit = 10.0_f64.powf(value.log10().floor() - 1.0);
    (value / unit).ceil() * unit
}

fn key((terms, nodes): (usize, usize)) -> SpaceKey {
    SpaceKey { half_ring: false, terms, nodes, variable: Variable::Root }
}

fn made(key: SpaceKey) -> CurveSpace {
    CurveSpace::new(key.variable, key.terms, key.nodes, key.limit())
}

/// Bodies whose compliance has so many modes, whatever they are worth.
fn in_modes(count: usize) -> BodyCompliance {
    let modes = || (0..=count).map(|n| 1e-3 * n as f64).collect();
    let boundary = Boundary::Modes { normal: modes(), along: modes() };
    BodyCompliance { even: 1.0, odd: 0.3, bed: 0.0, boundary, second: Vec::new() }
}

fn in_ring_modes(count: usize) -> BodyCompliance {
    let works = vec![1e-3; count * (count + 1)];
    let boundary = Boundary::RingModes(RingModes::whole(5, count), works);
    BodyCompliance { even: 1.0, odd: 0.3, bed: 0.0, boundary, second: Vec::new() }
}

/// Pressure spaces, with what bodies need in them.
fn spaces() -> Vec<Measured> {
    let mut measured = Vec::new();
    for key in SPACES.map(key) {
        let own = space(key).0;
        let with = |body: &BodyCompliance| {
            time_once(|| {
                let mut space = made(key);
                space.pressures.prepare(body);
                space
            })
        };
        measured.push(Measured::new(&[&own], time_once(|| made(key))));
        for count in MODES {
            measured.push(Measured::new(&[&own, &space_modes(key, count).0], with(&in_modes(count))));
        }
        for count in RING_MODES {
            let amounts = [&own[..], &space_ring_modes(key, count).0];
            measured.push(Measured::new(&amounts, with(&in_ring_modes(count))));
        }
    }
    measured
}

/// Of pins, as at a clearance of a hundredth of the radius.
const TILT: Tilt = Tilt { first: 0.01, second: 1e-4 };

/// The compliance of one body to the trial pressures of a space.
fn spreads() -> Vec<Measured> {
    let mut measured = Vec::new();
    for key in SPACES.map(key) {
        let mut space = made(key);
        let mut spread = |body: BodyCompliance| {
            space.pressures.prepare(&body);
            time(|| space.pressures.joint(&[(&body, 1.0)], TILT))
        };
        for count in MODES {
            measured.push(Measured::new(&[&spread_modes(key, count).0], spread(in_modes(count))));
        }
        for count in RING_MODES {
            measured.push(Measured::new(&[&spread_ring_modes(key, count).0], spread(in_ring_modes(count))));
        }
    }
    measured
}

/// The curve of a joint, with the pin's share of the work at each node.
fn curves() -> Vec<Measured> {
    let of_space = |key: SpaceKey| {
        let mut space = made(key);
        let bodies =
            [cored_discs()[2].clone(), annuli()[2].clone()].map(|body| concentric(&body).compliance());
        bodies.iter().for_each(|body| space.pressures.prepare(body));
        let outlines = Outlines::new(0.01);
        let [pin, plate] = bodies.each_ref().map(|body| space.pressures.joint(&[(body, 1.0)], Tilt::NONE));
        let seconds = time(|| {
            let mut moved = Vec::new();
            space.to_hole(&plate, &outlines, &mut moved);
            let plate = JointCompliance { values: moved.into(), ..plate };
            let curve = ContactCurve::new(&space, &[&pin, &plate], outlines)?;
            Some(curve.states.work_shares(&space.pressures, &pin))
        });
        Measured::new(&[&curve(key).0], seconds)
    };
    SPACES.map(key).map(of_space).into()
}

fn body(shape: &'static jointsweep::internals::mechanics::body::Shape, parameters: [f64; 3]) -> Body {
    Body {
        shape,
        parameters,
        support: 0,
        poissons_ratio: 0.3,
        idealization: Idealization::PlaneStrain,
        lining: Default::default(),
        all_around: false,
    }
}

fn annuli() -> Vec<Body> {
    [1.05, 1.2, 3.0, 30.0].map(|ratio| body(&annulus::SHAPE, [ratio, 0.0, 0.0])).into()
}

fn cored_discs() -> Vec<Body> {
    [0.95, 0.8, 0.3, 0.05].map(|ratio| body(&cored_disc::SHAPE, [ratio, 0.0, 0.0])).into()
}

/// Of all shapes and depths.
fn bodies() -> Vec<Body> {
    let sides = [[1.06, 1.5, 1.1], [1.2, 1.5, 1.5], [2.0, 3.0, 1.6], [5.0, 5.0, 5.0]];
    let blocks = sides.into_iter().flat_map(|sides| {
        let base = body(&block::SHAPE, sides);
        [base.clone(), Body { support: 1, ..base }]
    });
    let half_disc = body(&half_disc::SHAPE, [0.0; 3]);
    annuli().into_iter().chain(cored_discs()).chain([half_disc]).chain(blocks).collect()
}

/// Topologies and lane batches of meshes.
fn meshes() -> [Vec<Measured>; 2] {
    let (mut topologies, mut batches) = (Vec::new(), Vec::new());
    for body in bodies() {
        for level in 0..LEVELS {
            if !is_bounded(&body, level) {
                continue;
            }
            let (class, size) = (mesh_class(&body, level), mesh_size(&body, level));
            let modes = RingModes::of(&class);
            let plan = || CondensationPlan::new(&body, class.grading(body.shape.end_angle), modes);
            topologies.push(Measured::new(&[&topology(size, modes.count).0], time_once(plan)));
            let (plan, lanes) = (plan(), std::array::from_fn::<_, LANES, _>(|_| body.clone()));
            let seconds = time(|| plan.condense(&lanes));
            batches.push(Measured::new(&[&batch(size).0], seconds));
        }
    }
    [topologies, batches]
}

/// Exact bodies, and the exact works of near fields.
fn exact_bodies() -> [Vec<Measured>; 2] {
    let bodies = || annuli().into_iter().chain(cored_discs()).map(|body| concentric(&body));
    let of_series =
        bodies().map(|body| Measured::new(&[&series(body.modes_needed()).0], time(|| body.compliance())));
    // Those of near fields are neither thinner nor deeper.
    let references = bodies().filter(|body| (0.1..2.0).contains(&body.fixed_radius_ratio.ln().abs()));
    let of_near_fields = references.flat_map(|body| {
        let side = if body.fixed_radius_ratio < 1.0 { Side::Pin } else { Side::Plate };
        let lists: [[Vec<f64>; 2]; LANES] = std::array::from_fn(|_| body.boundary_modes());
        RING_MODES.map(|count| {
            let seconds = time_once(|| RingModes::whole(5, count).works_of_modes(side, &lists));
            Measured::new(&[&near_field_works(body.highest_mode(), count, LANES).0], seconds)
        })
    });
    [of_series.collect(), of_near_fields.collect()]
}

/// What is done with designs: their bodies are interpolated or on meshes, their rows written or only counted.
#[derive(Clone, Copy)]
struct Kind {
    is_interpolated: bool,
    is_written: bool,
}

const ON_MESHES: Kind = Kind { is_interpolated: false, is_written: true };

/// Designs on meshes with moduli of their own, and bodies of one shape or of many.
fn study(designs: usize, rows: usize, kind: Kind) -> Study {
    let [core, outer, interpolation] = match kind.is_interpolated {
        true => ["{ from = 0.05, to = 0.6 }", "{ from = 1.2, to = 50, spacing = \"log\" }", "auto"],
        false => ["0.3", "3.0", "off"],
    };
    let answers = if kind.is_written { "" } else { "[reduce]\nstatistics = [\"force\", \"peak_pressure\"]" };
    let text = format!(
        r#"
[joint]
idealization = "plane-stress"
hole_radius = {{ from = "5 mm", to = "100 mm" }}
radial_clearance = {{ from = "0.01 mm", to = "0.2 mm" }}
thickness = {{ from = "1 mm", to = "50 mm" }}
[joint.pin]
model = "rigid-core"
core_radius_ratio = {core}
youngs_modulus = {{ from = "70 GPa", to = "210 GPa" }}
poissons_ratio = 0.3
[joint.plate]
model = "annulus"
outer_radius_ratio = {outer}
youngs_modulus = {{ from = "1 GPa", to = "210 GPa" }}
poissons_ratio = 0.3
[load]
indentation = {{ from = "0.001 mm", to = "0.1 mm", count = {rows}, spacing = "log" }}
[sampling]
method = "latin-hypercube"
count = {designs}
seed = 1
[solve]
method = "fe"
accuracy = "1 %"
interpolation = "{interpolation}"
{answers}
"#
    );
    Study::from_text(Path::new("unit_costs.toml"), text).expect("a config")
}

/// A sweep on one thread, with what a run writes.
fn run_sweep(study: &Study) {
    let folder = std::env::temp_dir().join(format!("jointsweep-unit-costs-{}", std::process::id()));
    let claim = ResultFolder::of_run(Some(&folder), study).claim("of unit costs").expect("a folder");
    let conditions = Conditions { gpu: None, threads: 1, started: SystemTime::now(), anew: false };
    let mut recorder = Recorder::new(claim, study, &conditions).expect("a recorder");
    let options = SweepOptions { threads: 1, ..SweepOptions::default() };
    let sinks = recorder.sinks();
    let digest = Digest { designs: sinks.portion(), make: &|solved| sinks.rows(solved) };
    let mut receive = |rows| recorder.write(&rows).map(|()| ControlFlow::Continue(()));
    let statistics = sweep::run_digested(study, &options, &digest, &mut receive).expect("a sweep");
    recorder.finish(&statistics).expect("a result");
    std::fs::remove_dir_all(&folder).expect("a folder");
}

/// Its processor time, s.
fn sweep_seconds(study: &Study) -> f64 {
    least(RUNS_OF_SWEEPS, || {
        let started = now();
        run_sweep(study);
        now() - started
    })
}

/// What further designs of a sweep take, with few rows and with many; `known` are the times of units that were measured before.
fn designs(kind: Kind, known: &[(Unit, f64)]) -> Vec<Measured> {
    let counts = if kind.is_interpolated { [20_000, 50_000] } else { [2_000, 8_000] };
    let more = (counts[1] - counts[0]) as f64;
    let of_rows = |rows: usize| {
        let [few, many] = counts.map(|count| study(count, rows, kind));
        let mut seconds = (sweep_seconds(&many) - sweep_seconds(&few)) / more;
        let row = row(kind.is_written);
        if kind.is_interpolated {
            return Measured::new(&[&interpolated_design(rows as f64, row).0], seconds);
        }
        let case = many.cases().expect("designs").next().expect("a design").expect("a design");
        let plan = JointPlan::cheapest(&case, many.solve.method, many.solve.accuracy).expect("a plan");
        let amounts = plan.meshed().flat_map(|BodyRequest { body, .. }| {
            spread_ring_modes(plan.space, RingModes::of(&mesh_class(body, plan.level)).count).0
        });
        for (unit, amount) in amounts.chain(curve(plan.space).0) {
            seconds -= amount * known.iter().find(|(own, _)| *own == unit).map_or(0.0, |(_, value)| *value);
        }
        Measured::new(&[&design(rows as f64, row).0], seconds)
    };
    [2, 20].map(of_rows).into()
}

/// The fit of all laws to the states of a design whose bodies are solved.
fn laws() -> Vec<Measured> {
    let working = (1e-3, 0.1);
    let solve = SolveOptions { method: MethodChoice::Series, ..SolveOptions::default() };
    let study = study(1, 2, ON_MESHES);
    let case = study.cases().expect("designs").next().expect("a design").expect("a design");
    let case = law_case(&case, working);
    let answer = Ladder::new(solve).answers(std::slice::from_ref(&case)).remove(0);
    vec![Measured::new(&[&[(Unit::Laws, 1.0)]], time(|| laws_of(&case, &answer, working)))]
}

/// Of the smallest sweep, from the start of its program to the end, s.
fn process_seconds() -> f64 {
    let this = std::env::current_exe().expect("a path of this program");
    least(RUNS_OF_PROGRAM, || {
        let started = Instant::now();
        let status = Command::new(&this).arg(SMALLEST).status().expect("a run of this program");
        assert!(status.success(), "{status}");
        started.elapsed().as_secs_f64()
    })
}

fn main() {
    if std::env::args().nth(1).is_some_and(|argument| argument == SMALLEST) {
        run_sweep(&study(1, 2, ON_MESHES));
        black_box(Host::current());
        return;
    }
    let mut known = vec![(Unit::Process, rounded_up(process_seconds()))];
    known.extend(fit(
        "spaces",
        &[Unit::SpaceNode, Unit::SpacePair, Unit::SpaceMode, Unit::SpaceRingMode],
        &spaces(),
    ));
    let [of_series, of_near_fields] = exact_bodies();
    known.extend(fit("series", &[Unit::SeriesBody, Unit::SeriesMode], &of_series));
    let [topologies, batches] = meshes();
    known.extend(fit("batches", &[Unit::BatchStart, Unit::BatchUnknown, Unit::BatchFactor], &batches));
    known.extend(fit("topologies", &[Unit::TopologyUnknown, Unit::TopologyLoad], &topologies));
    known.extend(fit("near fields", &[Unit::NearFieldMode], &of_near_fields));
    let units = [Unit::SpreadNumber, Unit::SpreadMode, Unit::SpreadRingMode];
    known.extend(fit("spreads", &units, &spreads()));
    known.extend(fit("curves", &[Unit::CurveNode, Unit::CurvePair], &curves()));
    let interpolated = Kind { is_interpolated: true, ..ON_MESHES };
    let kinds = [ON_MESHES, interpolated, Kind { is_written: false, ..interpolated }];
    let of_designs: Vec<Measured> = kinds.into_iter().flat_map(|kind| designs(kind, &known)).collect();
    known.extend(fit(
        "designs",
        &[Unit::Design, Unit::Row, Unit::AnsweredRow, Unit::InterpolatedDesign],
        &of_designs,
    ));
    known.extend(fit("laws", &[Unit::Laws], &laws()));
    let mut table = csv::Writer::from_writer(std::io::stdout());
    table.write_record(["name", "value", "unit"]).unwrap();
    for (unit, value) in known {
        table.serialize((unit, format!("{value:.1e}"), "s")).unwrap();
    }
}
