//! Joints on a device and on the processor, which has the same fits and bodies.

use jointsweep::internals::engine::accuracy::single_precision::OF_CONTACT_IN_SINGLES;
use jointsweep::internals::engine::backend::Counts;
use jointsweep::internals::engine::backend::joints::SolvedJoints;
use jointsweep::internals::engine::expected_contact::ExpectedContact;
use jointsweep::internals::engine::interpolation::fit_plan::InterpolationPlan;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::{BackendKind, DesignOutcome, Method};
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::{DesignCase, JointDesign, Load, Part};

use super::watched::{Given, Watching};
use super::*;
use crate::common::draws::{concentric, disc_in_block, draw, half_disc_in_annulus};
use crate::common::random::Random;

/// Of the sweeps that the designs drawn here stand for.
const COUNT: u64 = 1_000_000;

fn interpolating<'a>(options: SolveOptions, cases: &[DesignCase]) -> Ladder<'a> {
    let joints: Vec<JointDesign> = cases.iter().map(|case| case.joint.clone()).collect();
    let plan = InterpolationPlan::new(&options, COUNT, &joints);
    assert!(plan.is_some());
    Ladder::new(options).interpolating(plan)
}

/// The outcomes of designs by a ladder whose device solves joints, and of the first few of them by themselves; and how many joints had a workgroup
/// alone, and how many went two at a time.
fn on_device(ladder: Ladder, cases: &[DesignCase], few: usize) -> ([Vec<DesignOutcome>; 2], [usize; 2]) {
    let (outcomes, Given { together, .. }, _) = on(device(), ladder, [cases, &cases[..few]]);
    (outcomes, together)
}

/// The outcomes of some designs and then of others by the processor's fits and bodies, what the device was given, and what was asked of it.
fn on<const N: usize>(
    gpu: &GpuDevice,
    ladder: Ladder,
    cases: [&[DesignCase]; N],
) -> ([Vec<DesignOutcome>; N], Given, Counts) {
    let watching = Watching { joints: SolvedJoints::All, leaves_bodies: true };
    let (outcomes, given, counts) = watching.solve(gpu, ladder, cases);
    (outcomes.try_into().unwrap(), given, counts)
}

/// The greatest relative differences of forces and indentations, stiffnesses, peak pressures, energies, half angles, and errors told, and how many
/// designs the device has solved.
pub fn compare(found: &[DesignOutcome], expected: &[DesignOutcome], method: Method) -> ([f64; 6], usize) {
    let (mut worst, mut on_device) = ([0.0_f64; 6], 0);
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(found.steps.len(), expected.steps.len());
        on_device += usize::from(found.backend == BackendKind::Gpu);
        for (found, expected) in found.steps.iter().zip(&expected.steps) {
            let methods = [found, expected].map(|step| step.response.map(|response| response.method));
            if methods != [Some(method); 2] {
                continue;
            }
            let [a, b] = [found, expected].map(|step| step.response.unwrap());
            let of = |a: f64, b: f64| if a == b { 0.0 } else { (a / b - 1.0).abs() };
            let errors = [
                of(a.force, b.force).max(of(a.indentation, b.indentation)),
                of(a.tangent_stiffness, b.tangent_stiffness),
                of(a.peak_pressure.unwrap(), b.peak_pressure.unwrap()),
                of(a.energy.unwrap(), b.energy.unwrap()),
                of(a.contact_half_angle.unwrap(), b.contact_half_angle.unwrap()),
                (a.force_error - b.force_error).abs(),
            ];
            worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
        }
    }
    (worst, on_device)
}

/// Designs of a kind of plate, some of them neat, some with wide clearances, with loads of the one kind or the other, and some without a first load.
pub fn designs(seed: u64, count: u64, shapes: fn(&mut Random) -> (Part, Part)) -> Vec<DesignCase> {
    let mut cases = draw(seed, count, shapes);
    let mut random = Random::new(seed + 1);
    for DesignCase { index, joint, steps } in &mut cases {
        joint.radial_clearance = joint.hole_radius * random.log(1e-5, 0.052);
        let mut size = joint.radial_clearance;
        if *index % 7 == 0 {
            // A neat fit.
            (joint.radial_clearance, size) = (0.0, 1e-3 * joint.hole_radius);
        }
        let indentations = (0..3).map(|_| random.log(0.02, 20.0) * size);
        let mut loads: Vec<Load> = if *index % 3 == 0 {
            // About what these indentations ask for.
            let modulus = joint.pin.material.youngs_modulus.min(joint.plate.material.youngs_modulus);
            indentations.map(|length| Load::Force(0.3 * modulus * joint.thickness * length)).collect()
        } else {
            indentations.map(Load::Indentation).collect()
        };
        if *index % 5 == 0 {
            loads.insert(0, Load::Indentation(0.0));
        }
        *steps = loads.into();
    }
    cases
}

/// A block on its base of which one side varies: more would take longer to fit than all else.
fn disc_in_simple_block(random: &mut Random) -> (Part, Part) {
    let (pin, mut plate) = disc_in_block(random);
    (plate.parameters[1], plate.parameters[2], plate.support) = (2.5, 3.0, 0);
    (pin, plate)
}

/// As meshes at 0.1 % are fitted well enough.
pub fn concentric_and_mild(random: &mut Random) -> (Part, Part) {
    let (mut pin, mut plate) = concentric(random);
    pin.parameters[0] = pin.parameters[0].clamp(0.05, 0.6);
    plate.parameters[0] = plate.parameters[0].max(1.3);
    for part in [&mut pin, &mut plate] {
        part.material.poissons_ratio = part.material.poissons_ratio.clamp(0.1, 0.45);
    }
    (pin, plate)
}

/// Indentations and forces on every kind of plate, by the fits of the processor.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn interpolated_joints_are_those_of_the_processor() {
    for (name, accuracy, cases) in [
        ("concentric", 1e-2, designs(81, 500, concentric)),
        // Ten trial pressures in wide contacts.
        ("concentric, 0.1 %", 1e-3, designs(85, 200, concentric_and_mild)),
        ("half disc in annulus", 1e-2, designs(82, 250, half_disc_in_annulus)),
        ("disc in block", 1e-2, designs(83, 250, disc_in_simple_block)),
    ] {
        let options = SolveOptions { accuracy, method: MethodChoice::Fe };
        let expected = interpolating(options, &cases).solve(&cases);
        let ([found, few], [alone, in_pairs]) = on_device(interpolating(options, &cases), &cases, 40);
        let (worst, on_device) = compare(&found, &expected, Method::Interpolated);
        let shown = worst.map(|worst| format!("{worst:.1e}")).join(" ");
        println!("{name}: {on_device} of {}, {alone} alone, {in_pairs} in pairs, {shown}", cases.len());
        assert!(on_device * 10 > 9 * cases.len(), "{name}: {on_device}");
        // Few nodes are enough for fits of whole pins at a percent.
        let is_in_pairs = accuracy == 1e-2 && name != "half disc in annulus";
        assert_eq!(in_pairs > cases.len() / 3, is_in_pairs, "{name}: {in_pairs}");
        let is_wide = |outcome: &&DesignOutcome| {
            outcome.backend == BackendKind::Gpu && ExpectedContact::of(&outcome.case).half_angle > 1.5
        };
        // Which have ten trial pressures at 0.1 %.
        assert!(found.iter().filter(is_wide).count() * 20 > cases.len(), "{name}");
        // Seen: 4.0e-6, on software; other devices round otherwise.
        let [of_force, .., of_error] = worst;
        assert!(greatest(worst) < 3e-5, "{name}: {shown}");
        // The rows say what single precision leaves.
        assert!(of_force < OF_CONTACT_IN_SINGLES, "{name}: {shown}");
        assert!((of_error / OF_CONTACT_IN_SINGLES - 1.0).abs() < 0.5, "{name}: {shown}");
        // However many there are at a time.
        assert_eq!(rows(&few), rows(&found[..40]), "{name}");
    }
}

/// Bodies on meshes of every kind of plate, and exact pins in blocks.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn joints_of_meshes_are_those_of_the_processor() {
    for (name, accuracy, method, cases) in [
        ("concentric", 1e-2, MethodChoice::Fe, designs(91, 400, concentric)),
        ("concentric, 0.1 %", 1e-3, MethodChoice::Fe, designs(95, 200, concentric)),
        ("half disc in annulus", 1e-2, MethodChoice::Fe, designs(92, 200, half_disc_in_annulus)),
        ("disc in block", 1e-2, MethodChoice::Auto, designs(93, 200, disc_in_block)),
    ] {
        let options = SolveOptions { accuracy, method };
        let expected = Ladder::new(options).solve(&cases);
        let ([found, few], _) = on_device(Ladder::new(options), &cases, 40);
        let (worst, on_device) = compare(&found, &expected, Method::Fe);
        let shown = worst.map(|worst| format!("{worst:.1e}")).join(" ");
        println!("{name}: {on_device} of {} on the device, {shown}", cases.len());
        assert!(on_device * 10 > 8 * cases.len(), "{name}: {on_device}");
        assert!(greatest(worst) < 6e-5, "{name}: {shown}");
        // However many there are at a time.
        assert_eq!(rows(&few), rows(&found[..40]), "{name}");
    }
}

/// Tables for which there is no room together come in turns, and the rows are the same.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn tables_without_room_come_in_turns() {
    let options = SolveOptions { accuracy: 1e-2, method: MethodChoice::Fe };
    let cases = designs(97, 120, concentric);
    let ([expected], _, counts) = on(device(), Ladder::new(options), [&cases]);
    let mut small = device().clone();
    // Enough for those of any joint.
    small.facts.limits.binding_bytes = 2_400_000;
    let ([found], _, of_small) = on(&small, Ladder::new(options), [&cases]);
    println!("{counts:?} {of_small:?}");
    assert!(found.iter().filter(|outcome| outcome.backend == BackendKind::Gpu).count() > 100);
    assert_eq!(rows(&found), rows(&expected));
    assert!(of_small.submits > counts.submits && of_small.bytes_up > counts.bytes_up + 1_000_000);
    assert_eq!(of_small.bytes_down, counts.bytes_down);
}

/// All that a row says.
pub fn rows(outcomes: &[DesignOutcome]) -> Vec<String> {
    outcomes.iter().map(|outcome| format!("{:?} {:?}", outcome.backend, outcome.steps)).collect()
}
