//! Questions that a device answers: what it is told, and what is read of the words that come back.

use std::path::Path;
use std::time::Duration;

use jointsweep::internals::engine::backend::adapter::GpuError;
use jointsweep::internals::engine::backend::drawn::DrawnDesigns;
use jointsweep::internals::engine::backend::joints::{JointBatch, SolvedJoints};
use jointsweep::internals::engine::backend::{Device, Works};
use jointsweep::internals::engine::body_request::Group;
use jointsweep::internals::engine::interpolation::drawn_on_device::Drawing;
use jointsweep::internals::engine::interpolation::fit_plan::InterpolationPlan;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::question::counted::{
    EXPONENTS, FIRST_EXPONENT, LEADING, Layout, PARTS, Told, Total, Verdict,
};
use jointsweep::internals::engine::question::formula::value;
use jointsweep::internals::engine::question::tables::Standing;
use jointsweep::internals::engine::question::{Asker, Limits, Question};
use jointsweep::internals::lab::gpu::measured_sweep::SWEEPS;
use jointsweep::internals::output::sinks::Sinks;
use jointsweep::internals::study::config::Study;

fn study(reduce: &str) -> Study {
    let text = format!(
        "[joint]\nidealization = 'plane-stress'\nhole_radius = '10 mm'\nradial_clearance = '0.1 mm'\nthickness = ['4 mm', '6 mm']\n\
         [joint.pin]\nmodel = 'rigid-core'\ncore_radius_ratio = 0.2\nyoungs_modulus = '210 GPa'\npoissons_ratio = 0.3\n\
         [joint.plate]\nmodel = 'annulus'\nouter_radius_ratio = 3\nyoungs_modulus = '70 GPa'\npoissons_ratio = 0.3\n\
         [load]\nforce = ['1 kN', '2 kN']\n[output]\nlaws = false\n[reduce]\n{reduce}\n"
    );
    Study::from_text(Path::new("asked.toml"), text).unwrap()
}

fn question(reduce: &str) -> Question {
    Question::of(&study(reduce)).unwrap()
}

const SKETCHED: &str = "statistics = ['peak_pressure']\nquantiles = [0.5]";

/// The words that a kernel leaves of some numbers of the first quantity, all in one design.
fn counted(layout: &Layout, numbers: &[f32]) -> Vec<u32> {
    let mut words = vec![0; layout.words(1)];
    let [sketch, sums] = layout.quantities[0];
    for number in numbers {
        let exponent = ((number.to_bits() >> 23) & 255) as i32 - 127 - FIRST_EXPONENT;
        let place = exponent as usize + if *number < 0.0 { EXPONENTS } else { 0 };
        let mantissa = (number.to_bits() & 0x7f_ffff) | 0x80_0000;
        words[sketch + place * LEADING + ((mantissa >> 13) & 1023) as usize] += 1;
        let own = &mut words[sums + place * PARTS..][..PARTS];
        let (high, low) = (mantissa >> 12, mantissa & 0xfff);
        own[0] += 1;
        for (at, part) in [(1, mantissa), (3, high * high), (5, high * low), (7, low * low)] {
            own[at] += part & 0xfff;
            own[at + 1] += part >> 12;
        }
    }
    words[Total::CountedDesigns as usize] = 1;
    words[Total::CountedRows as usize] = numbers.len() as u32;
    let verdicts = layout.words(0);
    words[verdicts] = Verdict::Counted as u32;
    words
}

/// Some words of a whole.
fn parts(words: &[u32], parts: Vec<std::ops::Range<usize>>) -> Told {
    let all = parts.iter().flat_map(|part| words[part.clone()].to_vec()).collect();
    Told { designs: 1, parts, all }
}

/// Sums and squares of counted numbers are those of the numbers themselves, to the nine digits that are told.
#[test]
fn counts_are_of_the_numbers() {
    let numbers = [3.5_f32, 1.0e-9, -2.75e3, 7.123_456e8, 3.5, -1.0, 123.456, 3.500_001];
    let study = study(SKETCHED);
    let question = Question::of(&study).unwrap();
    let words = counted(&question.layout, &numbers);
    let told = parts(&words, question.layout.worth_reading(&[None], 1));
    let (found, verdicts) = question.read(&told);
    assert_eq!((found.designs, found.rows, &verdicts[..]), (1, 8, &[Verdict::Counted][..]));
    let mut answers = Sinks::of(&study).answers().unwrap();
    answers.add_counted(&found, &question);
    let text = String::from_utf8(answers.files()[0].1.clone()).unwrap();
    let told = |name: &str| -> Vec<f64> {
        let line = text.lines().find(|line| line.contains(&format!(",{name},"))).unwrap();
        line.split(',').skip(3).take(2).map(|cell| cell.parse().unwrap()).collect()
    };
    let exact: Vec<f64> = numbers.iter().map(|number| f64::from(*number)).collect();
    let mean = exact.iter().sum::<f64>() / 8.0;
    let deviation = (exact.iter().map(|number| (number - mean).powi(2)).sum::<f64>() / 7.0).sqrt();
    assert_eq!(told("count")[0], 8.0);
    assert!((told("mean")[0] / mean - 1.0).abs() < 6e-9, "{text}");
    assert!((told("standard_deviation")[0] / deviation - 1.0).abs() < 6e-9, "{text}");
    // Of numbers of either sign what each is off by counts by its size.
    assert!(told("mean")[1] > 2e-4 && told("mean")[1] < 4e-4, "{text}");
}

/// What lies between the extremes is read, and where something lies beyond it is missed.
#[test]
fn what_is_not_read_is_missed() {
    let question = question(SKETCHED);
    let layout = &question.layout;
    let told = |range: Option<[f64; 2]>, numbers: &[f32]| {
        let parts_of = layout.worth_reading(&[range], 1);
        let read: usize = parts_of.iter().map(|part| part.len()).sum();
        (layout.is_whole(&parts(&counted(layout, numbers), parts_of)), read)
    };
    let (is_whole, all) = told(None, &[1e-9, -1e9]);
    assert!(is_whole);
    for (range, inside, beyond) in [
        ([5.0, 90.0], vec![2.1_f32, 5.0, 90.0, 255.0], vec![1.9_f32, 257.0, -5.0]),
        ([-90.0, -5.0], vec![-2.1, -255.0], vec![-1.9, -257.0, 5.0]),
        ([-3.0, 5.0], vec![1e-9, -1e-9, 15.0, -7.0], vec![16.5, -8.5]),
    ] {
        let (is_whole, read) = told(Some(range), &inside);
        assert!(is_whole && read < all, "{range:?}");
        for number in beyond {
            assert!(!told(Some(range), &[number]).0, "{range:?} {number}");
        }
    }
    // Six octaves of a thousand and 24, beside the sums.
    assert_eq!(told(Some([5.0, 90.0]), &[]).1 - told(Some([5.0, 5.0]), &[]).1, 4 * LEADING);
    // What never came counts nothing, and its designs are open, each of them: verdicts of those behind must not take their places.
    let (counted, verdicts) = question.read(&Told { designs: 3, ..Told::default() });
    assert_eq!((counted.designs, counted.forces, verdicts), (0, None, vec![Verdict::Open; 3]));
}

/// What is given is compared without rounding: a row that ties is no extreme one.
#[test]
fn given_values_are_compared_exactly() {
    let study = study(
        "statistics = ['thickness / 3']\npareto = { largest = 'thickness', smallest = 'peak_pressure' }",
    );
    let question = Question::of(&study).unwrap();
    let third = 4.0 / 3.0;
    for (limits, expected) in [
        ([third, -2.0], [0.0, 0.0]),
        ([third + 1e-12, -2.0], [1.0, 0.0]),
        ([third, -2.0 + 1e-12], [0.0, 1.0]),
        ([f64::INFINITY, f64::INFINITY], [1.0, 1.0]),
    ] {
        let points = vec![[-6.0, 3.0, 0.0], [-4.0, 2.0, 0.0]];
        let standing = Standing::new(&question, Limits { watches: limits.to_vec(), points });
        for (case, is_extreme) in study.cases().unwrap().zip(expected) {
            let case = case.unwrap();
            let mut numbers = Vec::new();
            standing.push_extremes(&case, 0, &mut numbers);
            // Thick ones are better: no point is below the thick one along this axis but its own.
            let rank = if case.joint.thickness == 6.0 { 1.0 } else { 2.0 };
            assert_eq!(numbers, [is_extreme, rank, 0.0], "{limits:?} {}", case.joint.thickness);
            assert_eq!(value(question.quantities[0].of.operations(), &case, 0), case.joint.thickness / 3.0);
        }
    }
}

/// Takes joints to count, and is gone when it is asked what it has counted.
struct Lost;

impl Device for Lost {
    fn begin(&mut self, _: &[Group]) -> Result<(), GpuError> {
        Ok(())
    }

    fn finish(&mut self) -> Result<Works, GpuError> {
        Err(lost())
    }

    fn solves_joints(&self) -> SolvedJoints {
        SolvedJoints::All
    }

    fn begin_whole(&mut self, groups: &[Group], batch: &JointBatch) -> Result<bool, GpuError> {
        assert!(batch.asked.is_some() && batch.joints.len() > 50 && !groups.is_empty());
        Ok(true)
    }

    fn begin_joints(&mut self, batch: &JointBatch) -> Result<(), GpuError> {
        assert!(batch.asked.is_some() && batch.joints.len() > 10);
        Ok(())
    }

    fn begin_drawn(&mut self, drawn: &DrawnDesigns) -> Result<bool, GpuError> {
        assert!(drawn.designs.len() == 50 && !drawn.tables.is_empty());
        Ok(true)
    }

    fn finish_answers(&mut self) -> Result<Vec<Told>, GpuError> {
        Err(lost())
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

fn lost() -> GpuError {
    GpuError::Lost { adapter: "the device".into(), problem: "unplugged".into() }
}

/// A device that is lost while it counts has counted nothing, and every design is left to the processor, who draws those that the device
/// was to draw.
#[test]
fn a_lost_device_leaves_all_designs() {
    let text = study(SKETCHED)
        .source_text()
        .replace("core_radius_ratio = 0.2", "core_radius_ratio = { from = 0.2, to = 0.4 }");
    let text = text.replace("outer_radius_ratio = 3", "outer_radius_ratio = { from = 2, to = 4 }");
    let study = Study::from_text(
        Path::new("asked.toml"),
        format!("{text}[sampling]\nmethod = 'sobol'\ncount = 100000\n"),
    )
    .unwrap();
    let sinks = Sinks::of(&study);
    let asking = sinks.asking().unwrap();
    let drawing = Drawing::of(&study, asking.question()).unwrap();
    for draws in [false, true] {
        let ladder = Ladder::new(study.solve).interpolating(InterpolationPlan::of_study(&study));
        let mut ladder = ladder.asked_by(Some(&asking)).on(Box::new(Lost));
        let cases: Vec<_> = study.cases().unwrap().skip(1000).take(50).map(Result::unwrap).collect();
        let counting = match draws {
            true => ladder.begin_drawn(&drawing, 1000..1050),
            false => ladder.begin_count(cases.clone()).ok(),
        };
        let (counted, left) = ladder.finish_count(&study, counting.unwrap()).unwrap().unwrap();
        assert_eq!((counted.designs, counted.rows), (0, 0));
        assert!(left.iter().all(|(_, verdict)| *verdict == Verdict::Open));
        assert!(left.iter().map(|(case, _)| case.index).eq(1000..1050));
        assert_eq!(ladder.library.lost(), Some(&lost()));
        // From then on nothing is begun.
        assert!(ladder.begin_count(cases).is_err() && ladder.begin_drawn(&drawing, 0..10).is_none());
    }
}

/// The same of bodies on meshes.
#[test]
fn a_lost_device_leaves_all_designs_on_meshes() {
    let study = SWEEPS[0].answers(60, false).unwrap();
    let sinks = Sinks::of(&study);
    let asking = sinks.asking().unwrap();
    let mut ladder = Ladder::new(study.solve).asked_by(Some(&asking)).on(Box::new(Lost));
    let cases: Vec<_> = study.cases().unwrap().map(Result::unwrap).collect();
    let counting = ladder.begin_count(cases.clone()).ok().unwrap();
    let (counted, left) = ladder.finish_count(&study, counting).unwrap().unwrap();
    assert_eq!((counted.designs, counted.rows), (0, 0));
    assert!(left.iter().all(|(_, verdict)| *verdict == Verdict::Open));
    assert!(left.iter().map(|(case, _)| case.index).eq(0..60));
    assert_eq!(ladder.library.lost(), Some(&lost()));
    assert!(ladder.begin_count(cases).is_err());
}

/// Where rows are written, too, or nothing is asked, nobody asks a device.
#[test]
fn rows_that_are_written_are_not_counted() {
    assert!(Question::of(&study(SKETCHED)).is_some());
    let with_table =
        study(&format!("{SKETCHED}\n")).source_text().replace("laws = false", "laws = false\ntable = true");
    assert!(Question::of(&Study::from_text(Path::new("asked.toml"), with_table).unwrap()).is_none());
    let with_laws = study(SKETCHED).source_text().replace("laws = false", "laws = true");
    assert!(Question::of(&Study::from_text(Path::new("asked.toml"), with_laws).unwrap()).is_none());
}
