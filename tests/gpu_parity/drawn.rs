//! Designs that a device draws itself, against those that the processor draws.

use std::ops::Range;
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use jointsweep::internals::engine::backend::drawn::DrawnDesigns;
use jointsweep::internals::engine::backend::gpu::drawn_joints::drawn_numbers;
use jointsweep::internals::engine::backend::joints::{BatchedJoint, JOINT_NUMBERS, JointBatch, SolvedJoints};
use jointsweep::internals::engine::backend::{Device, Works};
use jointsweep::internals::engine::body_request::Group;
use jointsweep::internals::engine::drawing::Chosen;
use jointsweep::internals::engine::interpolation::drawn_on_device::Drawing;
use jointsweep::internals::engine::interpolation::fit_plan::InterpolationPlan;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::question::Asker;
use jointsweep::internals::output::counts::Counts;
use jointsweep::internals::output::sinks::Sinks;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::design::DesignCase;

use super::answers::{answered, text};
use super::*;

const LATIN: &str = "method = 'latin-hypercube'\ncount = 300000\nseed = 7";
const SOBOL: &str = "method = 'sobol'\ncount = 200000\nseed = 3";

/// Looks at what it is given, and does nothing with it.
struct Onlooker<'a>(&'a Mutex<Seen>);

#[derive(Default)]
struct Seen {
    /// Of the processor: all numbers, and its joints.
    numbers: Vec<f32>,
    joints: Vec<BatchedJoint>,
    /// Of the device: the same, and where each design is.
    drawn: Vec<f32>,
    designs: Vec<[u32; 4]>,
    /// Where the numbers of a design have places of tables, which are whole.
    stride: usize,
}

impl Device for Onlooker<'_> {
    fn begin(&mut self, _: &[Group]) -> Result<(), GpuError> {
        unreachable!("fits are made before")
    }

    fn finish(&mut self) -> Result<Works, GpuError> {
        unreachable!("nothing is begun")
    }

    fn solves_joints(&self) -> SolvedJoints {
        SolvedJoints::Interpolated
    }

    fn begin_joints(&mut self, batch: &JointBatch) -> Result<(), GpuError> {
        let mut seen = self.0.lock().unwrap();
        let numbers = batch.numbers.within(0..batch.numbers.count());
        (seen.numbers, seen.joints) = (numbers.flatten().copied().collect(), batch.joints.clone());
        Ok(())
    }

    fn begin_drawn(&mut self, drawn: &DrawnDesigns) -> Result<bool, GpuError> {
        let mut seen = self.0.lock().unwrap();
        seen.stride = drawn.settings.stride as usize;
        (seen.drawn, seen.designs) = drawn_numbers(device(), drawn)?;
        Ok(true)
    }

    fn stages(&self) -> Vec<(&'static str, Duration)> {
        Vec::new()
    }

    fn worst_residual(&self) -> f64 {
        0.0
    }

    fn solves(&self) -> u64 {
        0
    }
}

fn study(joint: &str, loads: &str, sampling: &str, accuracy: &str) -> Study {
    let text = format!(
        r#"
{joint}
[load]
{loads}
[sampling]
{sampling}
[solve]
accuracy = "{accuracy}"
[select]
keep = "thickness > 4 mm and (hole_radius * thickness > 60 mm^2 or step == 1) and idealization != 'plane-strain' and peak_pressure < 100 MPa"
[reduce]
{ASKED}
[output]
laws = false
"#
    );
    Study::from_text(Path::new("drawn.toml"), text).unwrap()
}

/// Nothing of inputs alone, of which the processor tells what is extreme.
const ASKED: &str = r#"
statistics = ["tangent_stiffness / (thickness * plate_poissons_ratio)", "peak_pressure"]
quantiles  = [0.1, 0.5]
best       = { by = "tangent_stiffness / (hole_radius * thickness)", count = 7 }
pareto     = { largest = "tangent_stiffness", smallest = "peak_pressure" }
histogram  = { of = "peak_pressure", bins = 12 }
"#;

const SIZES: &str = r#"
[joint]
idealization     = ["plane-stress", "plane-strain"]
hole_radius      = { from = "5 mm", to = "100 mm", spacing = "log" }
radial_clearance = { from = "0.01 mm", to = "0.2 mm", spacing = "log" }
thickness        = ["4 mm", "8 mm", "12 mm"]
"#;

const CORED_DISCS: &str = r#"
[joint.pin]
model             = "rigid-core"
core_radius_ratio = { from = 0.05, to = 0.6 }
youngs_modulus    = { from = "70 GPa", to = "210 GPa" }
poissons_ratio    = { from = 0.1, to = 0.45 }
"#;

const HALF_DISCS: &str = r#"
[joint.pin]
model             = "rigid-midplane"
youngs_modulus    = "210 GPa"
poissons_ratio    = { from = -0.2, to = 0.48 }
"#;

const ANNULI: &str = r#"
[joint.plate]
model              = "annulus"
outer_radius_ratio = { from = 1.2, to = 50, spacing = "log" }
youngs_modulus     = { from = "1 GPa", to = "210 GPa", spacing = "log" }
poissons_ratio     = { from = 0.1, to = 0.45 }
"#;

const BLOCKS: &str = r#"
[joint.plate]
model            = "block"
half_width_ratio = { from = 1.3, to = 5 }
depth_ratio      = { from = 1.3, to = 8, spacing = "log" }
height_ratio     = { from = 1.3, to = 5 }
support          = ["base", "outer"]
youngs_modulus   = { from = "70 GPa", to = "210 GPa" }
poissons_ratio   = { from = 0.1, to = 0.46 }
"#;

/// One value after the other of all quantities that have any.
const ZIP: &str = r#"
[joint]
idealization     = "plane-stress"
hole_radius      = { from = "5 mm", to = "9 mm", count = 30000 }
radial_clearance = { from = "10 um", to = "200 um", spacing = "log", count = 30000 }
thickness        = "5 mm"
[joint.pin]
model             = "rigid-core"
core_radius_ratio = { from = 0.05, to = 0.6, count = 30000 }
youngs_modulus    = "210 GPa"
poissons_ratio    = { from = -0.3, to = 0.45, count = 30000 }
[joint.plate]
model              = "annulus"
outer_radius_ratio = { from = 1.3, to = 50, spacing = "log", count = 30000 }
youngs_modulus     = "70 GPa"
poissons_ratio     = 0.3
"#;

/// With few values of each quantity.
const GRID: &str = r#"
[joint]
idealization     = ["plane-strain", "plane-stress"]
hole_radius      = { from = "5 mm", to = "100 mm", spacing = "log", count = 30 }
radial_clearance = ["0.01 mm", "0.02 mm", "0.1 mm"]
thickness        = "5 mm"
[joint.pin]
model             = "rigid-core"
core_radius_ratio = { from = 0.05, to = 0.6, count = 23 }
youngs_modulus    = "210 GPa"
poissons_ratio    = [0.25, 0.45, 0.3]
[joint.plate]
model              = "annulus"
outer_radius_ratio = { from = 1.3, to = 50, spacing = "log", count = 17 }
youngs_modulus     = ["70 GPa", "210 GPa"]
poissons_ratio     = 0.45
"#;

/// The numbers of some designs, drawn on either side: how many both have, how many only one has, and the greatest difference of a number,
/// relative, of coordinates absolute.
fn compare(study: &Study, numbers: Range<u64>) -> (usize, usize, f64) {
    let seen = Mutex::default();
    let sinks = Sinks::of(study);
    let asking = sinks.asking().unwrap();
    let asker = &asking as &dyn Asker;
    let plan = InterpolationPlan::of_study(study);
    assert!(plan.is_some());
    let drawing = Drawing::of(study, asker.question()).unwrap();
    let cases: Vec<DesignCase> = study.cases_at(numbers.clone()).unwrap().map(Result::unwrap).collect();
    let mut ladder = Ladder::new(study.solve).interpolating(plan).asked_by(Some(asker));
    // Fits are made on the processor.
    ladder.answers(&cases[..1]);
    let mut ladder = ladder.on(Box::new(Onlooker(&seen)));
    assert!(ladder.begin_count(cases.clone()).is_ok());
    assert!(ladder.begin_drawn(&drawing, numbers).is_some());
    drop(ladder);
    let Seen { numbers, joints, drawn, designs, stride } = seen.into_inner().unwrap();
    assert!(designs.len() == cases.len() && joints.len() <= cases.len());
    let mut of_processor =
        joints.iter().map(|joint| &numbers[joint.numbers_at as usize..][..stride]).peekable();
    let (mut both, mut worst, mut apart) = (0, 0.0_f64, 0);
    for (case, [at, _, loads, _]) in cases.iter().zip(designs) {
        // What tells designs from those around: hole radius, clearance and all of the plate.
        let own = |numbers: &[f32]| {
            let scene = JOINT_NUMBERS + 2 * case.steps.len();
            let clearance = case.joint.radial_clearance / case.joint.hole_radius;
            let plate = &numbers[7..11];
            let found = &drawn[at as usize..][..stride][7..11];
            numbers[scene] == case.joint.hole_radius as f32
                && numbers[scene + 3] == clearance as f32
                && (loads == 0 || plate.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-4))
        };
        let own = of_processor.next_if(|numbers| own(numbers));
        if own.is_some() != (loads > 0) {
            apart += 1;
        }
        let Some(own) = own.filter(|_| loads > 0) else { continue };
        both += 1;
        for (place, (found, expected)) in drawn[at as usize..][..stride].iter().zip(own).enumerate() {
            let is_coordinate = place < 4 || (7..11).contains(&place);
            let size = if is_coordinate { 1.0 } else { expected.abs() };
            let difference = f64::from((found - expected).abs());
            if difference > 0.0 {
                worst = worst.max(difference / f64::from(size));
            }
            assert!(worst < 1e-3, "{place}: {found} {expected} of {case:?}");
        }
    }
    assert!(of_processor.next().is_none());
    (both, apart, worst)
}

/// All samplers, kinds of bodies and of loads, at either count of trial pressures.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn numbers_of_drawn_designs_are_the_processors() {
    let indentation = "indentation = { from = '0.001 mm', to = '0.1 mm', count = 10, spacing = 'log' }";
    let force = "force = ['1 kN', '5 kN', '20 kN']";
    let offset = "offset = ['0.21 mm', '0.3 mm']";
    let concentric = [SIZES, CORED_DISCS, ANNULI].concat();
    let blocks = [SIZES, CORED_DISCS, BLOCKS].concat();
    let halves = [SIZES, HALF_DISCS, ANNULI].concat();
    for (joint, loads, sampling, accuracy) in [
        (&concentric, indentation, LATIN, "1 %"),
        (&concentric, offset, SOBOL, "0.1 %"),
        (&blocks, force, SOBOL, "1 %"),
        (&halves, indentation, LATIN, "1 %"),
        (&concentric, force, LATIN, "0.1 %"),
        (&GRID.to_string(), force, "method = 'grid'", "1 %"),
        (&ZIP.to_string(), force, "method = 'zip'", "1 %"),
    ] {
        let study = study(joint, loads, sampling, accuracy);
        // Beyond the first block of a Sobol sequence.
        for first in [0, study.design_count() / 2] {
            let (both, apart, worst) = compare(&study, first..first + 2000);
            println!("{loads} {sampling}: {both}, {apart} by one alone, {worst:.1e}");
            assert!(both > 1000 && apart < 10 && worst < 1e-6, "{both} {apart} {worst:e}");
        }
    }
}

/// Where what is calculated of inputs is compared with an equal number, a rounding would decide: such designs are left to the processor.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn comparisons_that_a_rounding_would_decide_are_left_open() {
    let text =
        study(GRID, "force = '5 kN'", "method = 'grid'", "1 %").source_text().replace("60 mm^2", "25 mm^2");
    let study = Study::from_text(Path::new("drawn.toml"), text).unwrap();
    // Holes of 5 mm come first, the thickness is 5 mm everywhere.
    let of_first = study.cases().unwrap().take_while(|case| case.as_ref().unwrap().joint.hole_radius == 5.0);
    let of_first = of_first.count() as u64;
    assert!(of_first > 500);
    let (both, apart, _) = compare(&study, of_first - 500..of_first + 500);
    assert_eq!((both, apart), (500, 500));
}

/// The answers of designs that are drawn on the device are the processor's, however a run is cut.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn answers_of_drawn_designs_are_the_processors() {
    let all = count(800, 1600);
    let force = "force = ['1 kN', '5 kN', '20 kN']";
    // At 0.1 % some curves have six trial pressures and others ten.
    for (plate, sampling, accuracy) in
        [(ANNULI, LATIN, "1 %"), (ANNULI, SOBOL, "0.1 %"), (BLOCKS, SOBOL, "1 %")]
    {
        // Of middling walls: whatever is left to meshes the device condenses in f32.
        let joint = [SIZES, CORED_DISCS, plate].concat();
        let joint =
            joint.replace("from = 1.2, to = 50", "from = 2, to = 5").replace("from = 1.3", "from = 2");
        // Fits of blocks on their base take software long.
        let joint = if is_long() { joint } else { joint.replace("[\"base\", \"outer\"]", "\"outer\"") };
        let study = study(&joint, force, sampling, accuracy);
        let answered = |designs: Chosen, on_device, threads| answered(&study, designs, on_device, threads);
        let on_device = |designs, threads| answered(Chosen::Range(designs), Some(Making::Trusted), threads);
        let found = on_device(0..all, 2);
        // Fits of blocks rest on meshes: the device's, too. What is listed the processor draws.
        let expected = match plate {
            BLOCKS => answered(Chosen::Listed((0..all).collect()), Some(Making::Trusted), 2),
            _ => answered(Chosen::Range(0..all), None, 2),
        };
        let [of_sums, _] = super::answers::compare(&found.answers, &expected.answers);
        let ([counted, candidates], asked) = (found.counted, found.statistics.asked);
        println!("{counted} counted, {candidates} solved again, sums differ by {of_sums:.1e}; {asked:?}");
        assert!(of_sums < 3e-5 && 10 * counted > 8 * all && 2 * candidates < all);
        let of =
            |counts: &Counts| (counts.designs, counts.rows, counts.kept_rows, counts.by_status.by_text());
        assert_eq!(of(&found.counts), of(&expected.counts));
        assert!(found.counts.kept_rows.unwrap() > all / 4);
        // Designs do not go up: of each batch tables alone. Those of fits, which go up once, are large at 0.1 %, and fits of blocks have samples.
        let is_small = plate == ANNULI && accuracy == "1 %";
        assert!(!is_small || asked.bytes_up < 70_000 * asked.submits, "{asked:?}");
        let mut parts = on_device(0..611, 8);
        let more = on_device(611..all, 2);
        parts.answers.merge(&more.answers).unwrap();
        for (name, bytes) in found.answers.files() {
            assert_eq!(text(&parts.answers, name).as_bytes(), bytes, "{name}");
        }
        assert_eq!(parts.counted[0] + more.counted[0], counted);
        // All bodies are different: of each side as many as designs.
        assert_eq!(found.statistics.distinct_bodies, expected.statistics.distinct_bodies);
    }
}

/// What no device draws the processor does: designs whose joints are in no fit that a device has room for, and questions of inputs.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn what_a_device_does_not_draw_the_processor_does() {
    let of_inputs = ASKED.replace("peak_pressure", "min(thickness, 5 mm)");
    for (pin, accuracy, asked, is_counted) in
        [(HALF_DISCS, "0.1 %", ASKED, false), (CORED_DISCS, "1 %", &of_inputs, true)]
    {
        let study = study(&[SIZES, pin, ANNULI].concat(), "force = ['1 kN', '5 kN']", SOBOL, accuracy);
        let config = study.source_text().replace(ASKED, asked);
        let study = Study::from_text(Path::new("drawn.toml"), config).unwrap();
        let answered = |on_device| answered(&study, Chosen::Range(0..300), on_device, 2);
        let (found, expected) = (answered(Some(Making::Trusted)), answered(None));
        assert_eq!((found.counts.designs, found.counts.rows), (300, expected.counts.rows));
        assert_eq!(found.counted[0] > 0, is_counted, "{:?}", found.counted);
        let best = [&found, &expected].map(|own| text(&own.answers, "best.csv").lines().count());
        assert!(best[0] == 8 && best[1] == 8, "{best:?}");
    }
}
