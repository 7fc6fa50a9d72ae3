//! What is asked of all rows together, counted on a device, against the processor that has every row.

use std::ops::{ControlFlow, Range};
use std::path::Path;

use jointsweep::internals::engine::backend::Counts as Asked;
use jointsweep::internals::engine::backend::choice::GpuChoice;
use jointsweep::internals::engine::backend::joints::SolvedJoints;
use jointsweep::internals::engine::drawing::Chosen;
use jointsweep::internals::engine::question::{Asker, TRUSTED};
use jointsweep::internals::engine::sweep::{self, Digest, SolvedDesigns, Statistics, SweepOptions};
use jointsweep::internals::lab::gpu::measured_sweep::SWEEPS;
use jointsweep::internals::output::counts::Counts;
use jointsweep::internals::output::reduce::Reductions;
use jointsweep::internals::output::sinks::{Rows, Sinks};
use jointsweep::internals::study::config::Study;

use super::*;

/// Bodies and sizes all different, with loads of a kind.
fn study(loads: &str, select: &str, reduce: &str) -> Study {
    let text = format!(
        r#"
[joint]
idealization     = ["plane-stress", "plane-strain"]
hole_radius      = {{ from = "5 mm", to = "20 mm" }}
radial_clearance = {{ from = "10 um", to = "200 um", spacing = "log" }}
thickness        = ["4 mm", "8 mm", "12 mm"]
[joint.pin]
model             = "rigid-core"
core_radius_ratio = {{ from = 0.2, to = 0.5 }}
youngs_modulus    = {{ from = "70 GPa", to = "210 GPa" }}
poissons_ratio    = 0.3
[joint.plate]
model              = "annulus"
outer_radius_ratio = {{ from = 2, to = 5 }}
youngs_modulus     = {{ from = "50 GPa", to = "210 GPa" }}
poissons_ratio     = {{ from = 0.25, to = 0.4 }}
[load]
{loads}
[sampling]
method = "sobol"
count  = 300000
[select]
keep = "{select}"
[reduce]
{reduce}
[output]
laws = false
"#
    );
    Study::from_text(Path::new("asked.toml"), text).unwrap()
}

pub struct Answered {
    pub answers: Reductions,
    pub counts: Counts,
    pub statistics: Statistics,
    /// Designs that were counted, and those of them that were solved once more.
    pub counted: [u64; 2],
}

/// The answers of some designs, on a device that counts rows of interpolated joints with kernels made so, or on the processor alone.
pub fn answered(study: &Study, designs: Chosen, on_device: Option<Making>, threads: usize) -> Answered {
    let joints = SolvedJoints::Interpolated;
    let gpu =
        on_device.map(|making| GpuChoice { joints, making, ..GpuChoice::new(device(), Precision::F32) });
    answered_by(study, designs, gpu, true, threads)
}

/// The same by any choice of a device, which `counts` rows if it can.
fn answered_by(
    study: &Study,
    designs: Chosen,
    gpu: Option<GpuChoice>,
    counts: bool,
    threads: usize,
) -> Answered {
    let sinks = Sinks::of(study);
    let asking = sinks.asking().unwrap();
    let asker = counts.then_some(&asking as &dyn Asker);
    let options = SweepOptions { threads, gpu, asker, designs, ..SweepOptions::default() };
    let make = |solved: SolvedDesigns| {
        let of_device = solved.on_device.as_ref();
        let counted = of_device.map_or([0; 2], |own| [own.counted.designs, own.candidates.len() as u64]);
        (sinks.rows(solved), counted)
    };
    let (mut answers, mut counts, mut counted) = (sinks.answers().unwrap(), Counts::default(), [0; 2]);
    let digest = Digest { designs: sinks.portion(), make: &make };
    let mut receive = |(rows, more): (Rows, [u64; 2])| {
        answers.merge(&rows.answers.unwrap())?;
        counts.merge(&rows.counts);
        counted = [counted[0] + more[0], counted[1] + more[1]];
        Ok(ControlFlow::Continue(()))
    };
    let statistics = sweep::run_digested(study, &options, &digest, &mut receive).unwrap();
    assert_eq!(statistics.fallback, None);
    Answered { answers, counts, statistics, counted }
}

pub fn text(answers: &Reductions, name: &str) -> String {
    let files = answers.files();
    let (_, bytes) = files.iter().find(|(own, _)| *own == name).unwrap();
    String::from_utf8(bytes.clone()).unwrap()
}

/// The greatest relative difference of what is told of sums and quantiles; all else is the same to the bit, and what is told of the
/// errors bounds them.
pub fn compare(found: &Reductions, expected: &Reductions) -> [f64; 2] {
    let mut worst = [0.0_f64; 2];
    for (name, _) in expected.files() {
        let (found, expected) = (text(found, name), text(expected, name));
        if name != "statistics.csv" {
            assert_eq!(found, expected, "{name}");
            assert!(expected.lines().count() > 3, "{expected}");
            continue;
        }
        assert_eq!(found.lines().count(), expected.lines().count());
        for (found, expected) in found.lines().zip(expected.lines()).skip(1) {
            let [own, theirs] = [found, expected].map(|line| line.split(',').collect::<Vec<_>>());
            assert_eq!(own[..3], theirs[..3]);
            let of_kind = match own[2] {
                "mean" | "standard_deviation" => 0,
                quantile if quantile.starts_with("quantile") => 1,
                _ => {
                    assert_eq!(own, theirs);
                    continue;
                }
            };
            let [own, theirs] = [own, theirs].map(|cells| [3, 4].map(|place| cells[place].parse().unwrap()));
            let [value, error]: [f64; 2] = own;
            let difference = (value / theirs[0] - 1.0_f64).abs();
            assert!(difference <= error + theirs[1], "{found} {expected}");
            assert!(error >= TRUSTED);
            worst[of_kind] = worst[of_kind].max(difference);
        }
    }
    worst
}

const ALL: &str = r#"
statistics = ["indentation", "offset", "force", "tangent_stiffness", "peak_pressure", "energy", "linearity_error", "thickness",
              "2 deg - contact_half_angle", "sqrt(force / 1 N) * log(thickness / 1 mm)^2"]
quantiles  = [0.1, 0.5]
best       = [{ by = "tangent_stiffness / (hole_radius * thickness)", count = 7 }, { by = "energy", order = "smallest", count = 3 }]
pareto     = { largest = "tangent_stiffness", smallest = ["peak_pressure", "thickness"] }
histogram  = [{ of = "peak_pressure", bins = 12 }, { of = "indentation", from = "0.001 mm", to = "0.03 mm", bins = 10, spacing = "log" }]
"#;

const DESIGNS: u64 = 1200;

/// The same counts, and numbers as the manifest has them; the greatest estimate of an error is known so well, relative.
fn assert_alike(found: &Counts, expected: &Counts, of_errors: f64) {
    let of = |counts: &Counts| {
        (counts.designs, counts.rows, counts.kept_rows, counts.failed_rows, counts.by_status.by_text())
    };
    assert_eq!(of(found), of(expected));
    assert!(found.kept_rows.unwrap() > found.designs / 2);
    assert!((found.greatest_linearity_error / expected.greatest_linearity_error - 1.0).abs() < 1e-4);
    assert!((found.greatest_force_error / expected.greatest_force_error - 1.0).abs() < of_errors);
    for (own, theirs) in found.forces_n.unwrap().iter().zip(expected.forces_n.unwrap()) {
        assert!((own / theirs - 1.0).abs() < 1e-4);
    }
}

/// Each kind of answer, loads of either kind, conditions of inputs, loads and results.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn counted_answers_are_the_processors() {
    let (mut worst, mut more) = ([0.0_f64; 2], 0);
    let batch_size = GpuChoice::new(device(), Precision::F32).batch_size(true) as u64;
    let batches = 1 + (DESIGNS - 64).div_ceil(batch_size);
    for (loads, select) in [
        (
            "force = ['1 kN', '2 kN', '5 kN']",
            "force <= 2 kN and thickness > 4 mm and peak_pressure < 100 MPa",
        ),
        (
            "indentation = { from = '0.002 mm', to = '0.02 mm', count = 4 }",
            "step != 1 and force_error < 0.5 %",
        ),
        (
            "offset = { from = '0.21 mm', to = '0.23 mm', count = 3 }",
            "status == 'ok' or peak_pressure > 50 MPa",
        ),
    ] {
        let study = study(loads, select, ALL);
        let [found, expected] = [Some(Making::Checked), None]
            .map(|on_device| answered(&study, Chosen::Range(0..DESIGNS), on_device, 2));
        let of_answers = compare(&found.answers, &expected.answers);
        worst = [worst[0].max(of_answers[0]), worst[1].max(of_answers[1])];
        let [counted, candidates] = found.counted;
        println!("{loads}: {counted} counted, {candidates} solved again, {:?}", found.statistics.asked);
        assert!(10 * counted > 8 * DESIGNS, "{counted} {select}");
        // Small batches have little to compare with.
        assert!(2 * candidates < DESIGNS, "{candidates}");
        assert_alike(&found.counts, &expected.counts, 0.1);
        // One submission and one wait a batch, and few that values far out have asked for: of large batches none may be left.
        let Asked { submits, waits, .. } = found.statistics.asked;
        assert!(submits == waits && (batches..batches + 2).contains(&waits), "{waits} of {batches}");
        more += waits - batches;
    }
    assert!(more > 0 || batches < 5);
    println!("sums differ by {:.1e}, quantiles by {:.1e}", worst[0], worst[1]);
    // What is found in f32 differs by a few roundings.
    assert!(worst[0] < 3e-5, "{worst:?}");
}

/// Angles of narrow contacts and of wide ones are as sure as all else, whatever the device's own functions are worth.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn half_angles_are_the_processors() {
    let reduce = "statistics = ['contact_half_angle']";
    for loads in ["force = ['20 N', '50 N']", "indentation = ['0.1 mm', '0.5 mm']"] {
        let study = study(loads, "thickness > 4 mm", reduce);
        let [found, expected] = [Some(Making::Checked), None]
            .map(|on_device| answered(&study, Chosen::Range(0..DESIGNS), on_device, 2));
        let [of_sums, _] = compare(&found.answers, &expected.answers);
        let of = |name: &str| {
            text(&expected.answers, "statistics.csv")
                .lines()
                .find(|line| line.contains(name))
                .unwrap()
                .to_string()
        };
        println!("{loads}: {of_sums:.1e}, {} {}", of("mean"), found.counted[0]);
        assert!(2 * found.counted[0] > DESIGNS, "{:?}", found.counted);
        assert!(of_sums < 5e-6, "{of_sums:e}");
    }
}

/// The study with bodies on meshes, each condensed.
fn on_meshes(study: &Study) -> Study {
    let text = format!("{}[solve]\nmethod = \"fe\"\ninterpolation = \"off\"\n", study.source_text());
    Study::from_text(Path::new("asked.toml"), text).unwrap()
}

/// The same of bodies on meshes, whose works never leave the device: what it counts is what its rows come to where they come back.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn rows_of_bodies_on_meshes_are_counted_too() {
    let by = GpuChoice { joints: SolvedJoints::All, ..GpuChoice::new(device(), Precision::F32) };
    let (many, few) = (count(900, 1200), count(200, 400));
    let of_meshes = "step != 1 and method == 'fe' and method != 'interpolated'";
    for (name, designs, study) in [
        ("forces", many, study("force = ['1 kN', '2 kN', '5 kN']", "peak_pressure < 100 MPa", ALL)),
        (
            "indentations",
            many,
            study("indentation = { from = '0.002 mm', to = '0.02 mm', count = 4 }", of_meshes, ALL),
        ),
        ("concentric, 0.1 %", few, SWEEPS[1].answers(few, false).unwrap()),
        ("blocks", few, SWEEPS[2].answers(few, false).unwrap()),
    ] {
        let study = if study.interpolation { on_meshes(&study) } else { study };
        let answered =
            |counts, threads| answered_by(&study, Chosen::Range(0..designs), Some(by), counts, threads);
        let [found, expected] = [true, false].map(|counts| answered(counts, 2));
        let [of_sums, _] = compare(&found.answers, &expected.answers);
        let [waits, of_rows] = [&found, &expected].map(|own| own.statistics.asked.waits);
        let [counted, candidates] = found.counted;
        println!(
            "{name}: {counted} counted, {candidates} solved again, {waits} waits ({of_rows}), {of_sums:.1e}"
        );
        assert!(10 * counted > 6 * designs && 2 * candidates < designs, "{counted} {candidates}");
        // Crews that begin all at once have little to compare with, but not for long. In the short form they answer the short sweeps.
        if designs == few || is_long() {
            let [of_crews, candidates] = answered(true, 8).counted;
            println!("{of_crews} counted by crews, {candidates} solved again");
            assert!(of_crews == counted && 2 * candidates < designs, "{of_crews} {counted} {candidates}");
        }
        assert_eq!(found.statistics.designs_on_cpu, 0);
        let batches = 1 + (designs - 64).div_ceil(by.batch_size(false) as u64);
        // Beside the waits of all attempts one a batch for those designs that are solved again; none for first attempts of which it is known what
        // they leave to be wanted.
        assert!((batches..=of_rows + batches).contains(&waits), "{waits}, {of_rows}");
        assert!(of_sums < 3e-5, "{of_sums:e}");
        assert_alike(&found.counts, &expected.counts, 0.02);
    }
}

/// What is counted does not depend on where a run was cut, nor on how many crews have counted; of interpolated bodies and of those on meshes.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn counted_answers_of_parts_join_to_the_same_bytes() {
    let interpolated = study("force = ['1 kN', '5 kN']", "peak_pressure < 200 MPa", ALL);
    for (joints, study) in [
        (SolvedJoints::Interpolated, &interpolated),
        (SolvedJoints::All, &on_meshes(&interpolated)),
        (SolvedJoints::All, &SWEEPS[1].answers(300, false).unwrap()),
    ] {
        let making = Making::Trusted;
        let by = GpuChoice { joints, making, ..GpuChoice::new(device(), Precision::F32) };
        let answered = |designs: Range<u64>, threads| {
            answered_by(study, Chosen::Range(designs), Some(by), true, threads)
        };
        let whole = answered(0..300, 8);
        let (mut parts, more) = (answered(0..187, 2), answered(187..300, 2));
        parts.answers.merge(&more.answers).unwrap();
        for (name, bytes) in whole.answers.files() {
            assert_eq!(text(&parts.answers, name).as_bytes(), bytes, "{name}");
        }
        assert!(whole.counted[0] > 230, "{:?}", whole.counted);
        assert_eq!(parts.counted[0] + more.counted[0], whole.counted[0]);
    }
}
