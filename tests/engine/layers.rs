//! Joints with layers as the engine takes them: thin layers, pressures that peak beside the load line, and what is refused.

use crate::common::length::count;
use crate::common::random::Random;
use crate::common::stepped_ring::{Beyond, Ring};
use crate::common::true_outlines::true_state;
use jointsweep::internals::engine::explain::Explainer;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::StepOutcome;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::design::{DesignCase, JointDesign};
use jointsweep::{Dimensions, Idealization, Joint, Layer, Load, Material, MethodChoice, Options, Part};
use std::path::Path;

const STEEL: Material = Material { youngs_modulus: 210e3, poissons_ratio: 0.3 };

fn layer(thickness: f64, youngs_modulus: f64, poissons_ratio: f64) -> Layer {
    Layer::new(thickness, Material { youngs_modulus, poissons_ratio })
}

/// A steel pin of 10 mm in a plate with layers.
fn joint(clearance: f64, material: Material, layers: &[Layer]) -> JointDesign {
    let pin = Part::new("rigid-core", &[("core_radius_ratio", 0.2)], None, STEEL).unwrap();
    let plate = Part::new("annulus", &[("outer_radius_ratio", 3.0)], None, material).unwrap();
    let sizes = Dimensions { hole_radius: 10.0, radial_clearance: clearance, thickness: 1.0 };
    let plate = plate.with_layers(layers).unwrap();
    Joint::new(sizes, Idealization::PlaneStrain, pin, plate).unwrap().design().clone()
}

fn solved(joint: JointDesign, method: MethodChoice, accuracy: f64, load: Load) -> StepOutcome {
    let case = DesignCase { index: 0, joint, steps: vec![load].into() };
    Ladder::new(Options { accuracy, method }).solve(&[case]).remove(0).steps[0].clone()
}

/// Coatings of a hundredth down to a thirty-thousandth of the radius, from rubber to what is stiffer than what they lie on, against references
/// with all modes: what is said of them holds, and where nothing is said they are right.
#[test]
fn thin_layers_are_right_or_say_so() {
    let mut random = Random::new(181);
    let (mut compared, mut bounded, mut met, mut worst_met, mut worst_peak) = (0, 0, 0, 0.0_f64, 0.0_f64);
    let all = count(10, 30) as usize;
    for _ in 0..all {
        let thickness = random.log(3e-5, 1e-2);
        let modulus = 210e3 * random.log(1e-4, 10.0);
        let poissons_ratio = random.linear(0.0, 0.45);
        let beyond = Beyond { radius_ratio: 1.0 + thickness, youngs_modulus: 210e3, poissons_ratio: 0.3 };
        let steel = |fixed_radius_ratio| Ring {
            fixed_radius_ratio,
            youngs_modulus: 210e3,
            poissons_ratio: 0.3,
            idealization: Idealization::PlaneStrain,
            beyond: &[],
        };
        let plate =
            Ring { youngs_modulus: modulus, poissons_ratio, beyond: vec![beyond].leak(), ..steel(3.0) };
        let half_angle = random.log(0.05, 1.2);
        let state = true_state([steel(0.2), plate], 1e-3, half_angle);
        let joint = joint(0.01, STEEL, &[layer(10.0 * thickness, modulus, poissons_ratio)]);
        let found = solved(joint, MethodChoice::Auto, 1e-3, Load::Indentation(10.0 * state.indentation));
        let response = found.response.unwrap_or_else(|| panic!("{}", found.status));
        // The reference's force is per thickness, over the radius; E in MPa.
        let off = (response.force / (10.0 * state.force) - 1.0).abs();
        println!(
            "t {thickness:.1e}, E {modulus:.1e}, eps {half_angle:.2}: off {off:.1e}, said {:.1e}, {}",
            response.force_error, found.status
        );
        compared += 1;
        bounded += usize::from(off <= response.force_error);
        if response.force_error <= 1e-3 {
            met += 1;
            worst_met = worst_met.max(off);
            // At the load line, where a thin coating presses most.
            let peak = response.peak_pressure.unwrap() / state.peak_pressure - 1.0;
            assert!(peak.abs() < 0.02, "{peak}");
            worst_peak = worst_peak.max(peak.abs());
        }
    }
    println!(
        "{bounded} of {compared} bounded, {met} at the accuracy asked; worst of these {worst_met:.1e}, peak {worst_peak:.1e}"
    );
    assert!(compared == all && 100 * bounded >= 95 * compared, "{bounded} of {compared}");
    assert!(5 * met >= 4 * compared, "{met} of {compared}");
    assert!(worst_met > 0.0 && worst_met < 1e-3, "{worst_met:e}");
}

/// A soft layer on the pin that is resolved and one in the hole so thin that it is a bed: the joint yields as a body, then as a bed, as the
/// contact grows. Against references with all modes what is said holds, and slopes are those of the forces.
#[test]
fn beds_beside_soft_layers_are_right_or_say_so() {
    let (radius, clearance) = (10.0, 0.01);
    let (mut compared, mut worst_met) = (0, 0.0_f64);
    for (pin_thickness, plate_thickness) in [(0.06, 0.04), (0.2, 0.04), (0.05, 0.02)] {
        for half_angle in [0.05, 0.2, 0.7] {
            let soft = Material { youngs_modulus: 400.0, poissons_ratio: 0.3 };
            let ring = |fixed_radius_ratio, interface| Ring {
                fixed_radius_ratio,
                youngs_modulus: soft.youngs_modulus,
                poissons_ratio: soft.poissons_ratio,
                idealization: Idealization::PlaneStrain,
                beyond: vec![Beyond { radius_ratio: interface, youngs_modulus: 210e3, poissons_ratio: 0.3 }]
                    .leak(),
            };
            let rings = [
                ring(0.2, 1.0 - pin_thickness / (radius - clearance)),
                ring(3.0, 1.0 + plate_thickness / radius),
            ];
            let state = true_state(rings, clearance / radius, half_angle);
            let bare = joint(clearance, STEEL, &[Layer::new(plate_thickness, soft)]);
            let pin = bare.pin.clone().with_layers(&[Layer::new(pin_thickness, soft)]).unwrap();
            let joint = JointDesign { pin, ..bare };
            let load = |share: f64| Load::Indentation(share * radius * state.indentation);
            for (method, accuracy) in [
                (MethodChoice::Auto, 1e-2),
                (MethodChoice::Auto, 1e-3),
                (MethodChoice::Fe, 1e-2),
                (MethodChoice::Fe, 1e-3),
                (MethodChoice::Fe, 1e-4),
            ] {
                let at = |share| solved(joint.clone(), method, accuracy, load(share)).response.unwrap();
                let [before, found, after] = [0.999, 1.0, 1.001].map(at);
                let off = (found.force / (radius * state.force) - 1.0).abs();
                assert!(
                    off <= found.force_error,
                    "{half_angle}: off {off:.1e}, said {:.1e}",
                    found.force_error
                );
                let secant = (after.force - before.force) / (after.indentation - before.indentation);
                let slope_off = (found.tangent_stiffness / secant - 1.0).abs();
                assert!(slope_off < 0.01, "{half_angle}: {slope_off}");
                compared += 1;
                if found.force_error <= 1e-3 {
                    worst_met = worst_met.max(off);
                }
            }
        }
    }
    println!("{compared} compared, those said to be within 1e-3 off by {worst_met:.1e}");
    assert!(compared == 45 && worst_met > 0.0 && worst_met < 1e-3, "{worst_met:e}");
}

/// Random joints with up to two layers on either side: what is said of their answers at three accuracies holds between nearly any two of
/// them, and where it does not by little.
#[test]
fn answers_at_other_accuracies_are_within_both_errors() {
    let mut random = Random::new(182);
    let (mut compared, mut joints, mut beyond, mut worst) = (0, 0, 0, 0.0_f64);
    for _ in 0..count(40, 400) {
        let clearance = random.log(3e-3, 0.2);
        // Every other joint has a soft layer on both sides, of which one may be a bed.
        let soft = joints % 2 == 0;
        let mut layers = || -> Vec<Layer> {
            if soft {
                return vec![layer(random.log(0.1, 1.0), random.log(1e2, 2e3), 0.3)];
            }
            let layers = (2.5 * random.unit()) as usize;
            (0..layers).map(|_| layer(random.log(0.01, 1.6), random.log(1e2, 5e4), 0.3)).collect()
        };
        let [of_pin, of_plate] = [layers(), layers()];
        let pin = match random.unit() < 0.5 {
            true => Part::new("rigid-midplane", &[], None, STEEL).unwrap(),
            false => Part::new("rigid-core", &[("core_radius_ratio", 0.2)], None, STEEL).unwrap(),
        };
        let plate = Part::new("annulus", &[("outer_radius_ratio", 3.0)], None, STEEL).unwrap();
        let sizes = Dimensions { hole_radius: 50.0, radial_clearance: clearance, thickness: 10.0 };
        let [pin, plate] =
            [(pin, of_pin), (plate, of_plate)].map(|(part, own)| part.with_layers(&own).unwrap());
        let joint = Joint::new(sizes, Idealization::PlaneStrain, pin, plate).unwrap().design().clone();
        let steps = [0.03, 0.1, 0.3, 1.0, 2.5].map(|share| Load::Indentation(share * clearance)).to_vec();
        let case = DesignCase { index: 0, joint, steps: steps.into() };
        let solve = |accuracy| {
            let method = MethodChoice::Auto;
            Ladder::new(Options { accuracy, method }).solve(std::slice::from_ref(&case)).remove(0).steps
        };
        let [coarse, middle, fine] = [1e-2, 1e-3, 1e-4].map(solve);
        for (one, other) in [(&coarse, &middle), (&coarse, &fine), (&middle, &fine)] {
            for (one, other) in one.iter().zip(other) {
                let (Some(one), Some(other)) = (one.response, other.response) else { continue };
                let apart = (one.force / other.force - 1.0).abs();
                let said = one.force_error + other.force_error;
                compared += 1;
                beyond += usize::from(apart > said);
                worst = worst.max(apart / said);
            }
        }
        joints += 1;
    }
    println!(
        "{compared} pairs of answers of {joints} joints, {beyond} beyond both errors, by {worst:.2} at most"
    );
    assert!(compared > 12 * joints && 200 * beyond <= compared, "{beyond} of {compared}");
    assert!(worst > 0.1 && worst < 1.5, "{worst}");
}

/// A stiff sleeve on a soft layer presses most beside the load line, and the row says how much and where.
#[test]
fn a_sleeve_on_a_soft_layer_presses_most_aside() {
    let soft = Material { youngs_modulus: 200.0, poissons_ratio: 0.4 };
    let joint = joint(0.02, soft, &[layer(0.5, 210e3, 0.3)]);
    let curve = Joint::try_from(joint.clone())
        .unwrap()
        .curve(Options { accuracy: 1e-3, ..Options::default() })
        .unwrap();
    let load = Load::Indentation(0.02);
    let state = curve.at(load).unwrap();
    let (angle, peak) = (state.peak_pressure_angle.unwrap(), state.peak_pressure.unwrap());
    let pressures = curve.pressure(load, 4000).unwrap();
    let most = pressures.iter().fold((0.0, 0.0), |most, point| if point.1 > most.1 { *point } else { most });
    println!("{peak} MPa at {} deg; {} at the load line, {most:?}", angle.to_degrees(), pressures[0].1);
    assert!(angle > 0.8 && peak > 1.3 * pressures[0].1, "{angle} {peak}");
    assert!((most.0 - angle).abs() < 0.02 && (most.1 / peak - 1.0).abs() < 1e-3, "{most:?} {angle} {peak}");
    // The bare joint has its peak at the load line.
    let bare = joint_of(&joint, &[]);
    let state = solved(bare, MethodChoice::Auto, 1e-3, load).response.unwrap();
    assert_eq!(state.peak_pressure_angle, Some(0.0));
}

fn joint_of(joint: &JointDesign, layers: &[Layer]) -> JointDesign {
    JointDesign { plate: joint.plate.clone().with_layers(layers).unwrap(), ..joint.clone() }
}

/// Bodies with layers on meshes are said to be, with why.
#[test]
fn lined_blocks_are_explained() {
    let text = std::fs::read_to_string("configs/bush.toml").unwrap();
    let block = "model = \"block\"\nhalf_width_ratio = 2.0\ndepth_ratio = 3.0\nheight_ratio = 2.0\n";
    let start = text.find("model              = \"annulus\"").unwrap();
    let end = start + text[start..].find("youngs_modulus").unwrap();
    let text = format!("{}{block}{}", &text[..start], &text[end..]);
    let study = Study::from_text(Path::new("lined.toml"), text).unwrap();
    let case = study.cases().unwrap().next().unwrap().unwrap();
    let explained = Explainer::new(&study).explain(&case);
    assert!(explained.chosen.starts_with("mesh levels"), "{explained:?}");
    let is_lined = |line: &String| {
        line.starts_with("block: mesh level") && line.contains("through 1 layer on the processor")
    };
    assert!(explained.bodies.iter().any(is_lined), "{explained:?}");
}

/// Half a disc in a lined plate takes a mesh for the one and modes for the other.
#[test]
fn a_half_disc_runs_in_a_lined_plate() {
    let lined = joint(0.05, STEEL, &[layer(1.0, 3e3, 0.4)]);
    let half_disc = Part::new("rigid-midplane", &[], None, STEEL).unwrap();
    let at =
        |joint: JointDesign| solved(joint, MethodChoice::Auto, 1e-3, Load::Force(100.0)).response.unwrap();
    let whole = at(lined.clone());
    let half = at(JointDesign { pin: half_disc.clone(), ..lined.clone() });
    // The liner is most of what yields, so that the pins differ little; the bare plate is far stiffer.
    assert!((half.indentation / whole.indentation - 1.0).abs() < 0.05, "{half:?} {whole:?}");
    let bare = at(JointDesign { pin: half_disc, ..joint_of(&lined, &[]) });
    assert!(bare.indentation < 0.5 * half.indentation, "{bare:?} {half:?}");
}

#[test]
fn what_no_layers_can_have_is_refused() {
    let lined = joint(0.05, STEEL, &[layer(1.0, 3e3, 0.4)]);
    let load = Load::Force(100.0);
    let said = |joint: JointDesign, method| solved(joint, method, 1e-2, load).status.to_string();
    assert_eq!(said(lined.clone(), MethodChoice::ClosedForm), "failed: closed forms know no layers");
    assert_eq!(said(lined.clone(), MethodChoice::Series), "large displacement");
    // The sizes of a sweep may leave nothing of the wall.
    let mut thick = lined.clone();
    thick.plate.parameters[0] = 1.1;
    assert_eq!(
        said(thick, MethodChoice::Auto),
        "failed: the layers of the plate are 1 mm thick; they must be thinner than its wall, 1 mm"
    );
    // Told as they are, with digits by which they differ.
    for (thickness, told) in [(25.0, "25"), (12.5, "12.5"), (10.001, "10.001"), (1e9, "1e9")] {
        let mut thick = lined.clone();
        thick.plate.parameters[0] = 2.0;
        thick.plate = thick.plate.with_layers(&[layer(thickness, 3e3, 0.4)]).unwrap();
        let wanted =
            format!("the layers of the plate are {told} mm thick; they must be thinner than its wall, 10 mm");
        assert_eq!(said(thick, MethodChoice::Auto), format!("failed: {wanted}"));
    }
    let wall = |part: &Part| {
        Joint::new(
            Dimensions { hole_radius: 10.0, radial_clearance: 0.05, thickness: 1.0 },
            Idealization::PlaneStrain,
            Part::new("rigid-core", &[], None, STEEL).unwrap(),
            part.clone(),
        )
    };
    let too_thick = Part::new("annulus", &[("outer_radius_ratio", 1.05)], None, STEEL).unwrap();
    let said =
        wall(&too_thick.clone().with_layers(&[layer(0.6, 3e3, 0.4)]).unwrap()).unwrap_err().to_string();
    assert!(said.contains("layers: 0.6 mm of the plate: must be below its wall, 0.5"), "{said}");
    let said = too_thick.clone().with_layers(&[layer(0.0, 3e3, 0.4)]).unwrap_err().to_string();
    assert!(said.contains("layer 1: thickness: 0: must be above 0"), "{said}");
    let block = |layer| {
        let ratios = [("half_width_ratio", 1.5), ("depth_ratio", 2.0), ("height_ratio", 3.0)];
        Part::new("block", &ratios, None, STEEL).unwrap().with_layers(&[layer]).unwrap()
    };
    let said = wall(&block(layer(6.0, 3e3, 0.4))).unwrap_err().to_string();
    assert!(said.contains("layers: 6 mm of the plate: must be below its wall, 5"), "{said}");
    // Layers may leave less of a block than meshes carry.
    let of_block = |thickness| JointDesign { plate: block(layer(thickness, 3e3, 0.4)), ..lined.clone() };
    let status = |thickness| {
        let auto = solved(of_block(thickness), MethodChoice::Auto, 1e-2, Load::Force(1.0)).status;
        auto.to_string()
    };
    assert_eq!(
        status(4.7),
        "failed: the layers of the plate leave a wall of 2 % of their radius; the thinnest that meshes carry is 5 %"
    );
    assert_eq!(status(4.0), "ok");
    // Half a disc bears layers down to its centre, no further.
    let half_disc = Part::new("rigid-midplane", &[], None, STEEL).unwrap();
    let half_disc = half_disc.with_layers(&[layer(10.0, 3e3, 0.4)]).unwrap();
    let refused = JointDesign { pin: half_disc, ..lined.clone() }.check().unwrap_err().to_string();
    assert!(refused.contains("layers: 10 mm of the pin: must be below its wall, 9.95 mm"), "{refused}");
}

/// A sweep large enough to interpolate leaves lined joints to their modes, and says so.
#[test]
fn lined_joints_are_not_interpolated() {
    let text = std::fs::read_to_string("configs/hypercube.toml").unwrap();
    let layers = "\n[[joint.plate.layers]]\nthickness_ratio = 0.05\nyoungs_modulus = \"3 GPa\"\npoissons_ratio = 0.4\n\n[load]";
    let study = Study::from_text(
        Path::new("lined.toml"),
        text.replacen("[load]", layers, 1).replace("\"fe\"", "\"auto\""),
    )
    .unwrap();
    let case = study.cases().unwrap().next().unwrap().unwrap();
    let explained = Explainer::new(&study).explain(&case);
    assert_eq!(explained.chosen, "series");
    let why = explained.ruled_out.iter().find(|(what, _)| what == "interpolation across bodies").unwrap();
    assert_eq!(why.1, "knows no layers");
}
