//! Press fits and offsets as the engine takes them: what they are solved with, and what is refused. What is true of them is held in
//! tests/mechanics/press_fits.rs.

use std::path::Path;

use jointsweep::internals::engine::explain::Explainer;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::law_fit::laws_of_all;
use jointsweep::internals::engine::outcome::{Method, StepOutcome};
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::design::{DesignCase, JointDesign};
use jointsweep::{Dimensions, Idealization, Joint, Layer, Load, Material, MethodChoice, Options, Part};

const STEEL: Material = Material { youngs_modulus: 210e3, poissons_ratio: 0.3 };

fn joint(radial_clearance: f64, plate: Part) -> JointDesign {
    let pin = Part::new("rigid-core", &[("core_radius_ratio", 0.2)], None, STEEL).unwrap();
    let sizes = Dimensions { hole_radius: 10.0, radial_clearance, thickness: 3.0 };
    Joint::new(sizes, Idealization::PlaneStress, pin, plate).unwrap().design().clone()
}

fn ring(ratio: f64) -> Part {
    Part::new("annulus", &[("outer_radius_ratio", ratio)], None, STEEL).unwrap()
}

fn block() -> Part {
    let ratios = [("half_width_ratio", 2.0), ("depth_ratio", 2.0), ("height_ratio", 2.0)];
    Part::new("block", &ratios, None, STEEL).unwrap()
}

fn solved(joint: &JointDesign, method: MethodChoice, loads: &[Load]) -> Vec<StepOutcome> {
    let case = DesignCase { index: 0, joint: joint.clone(), steps: loads.to_vec().into() };
    Ladder::new(Options { accuracy: 1e-3, method }).solve(&[case]).remove(0).steps
}

/// An offset is the clearance and the indentation, on meshes as well; before the bodies touch there is nothing.
#[test]
fn an_offset_is_the_clearance_and_the_indentation() {
    // Closed forms have no neat fit.
    for (plate, method, clearances) in [
        (ring(2.0), MethodChoice::Auto, &[0.0, 0.03125][..]),
        (block(), MethodChoice::Auto, &[0.0, 0.03125]),
        (ring(2.0), MethodChoice::ClosedForm, &[0.03125]),
    ] {
        for &clearance in clearances {
            let joint = joint(clearance, plate.clone());
            let [by_offset, by_indentation] = [
                [0.0, clearance, clearance + 0.0078125].map(Load::Offset),
                [0.0, 0.0, 0.0078125].map(Load::Indentation),
            ]
            .map(|loads| solved(&joint, method, &loads));
            assert_eq!(by_offset[1..], by_indentation[1..]);
            // Closed forms have no state without a load.
            if method != MethodChoice::ClosedForm {
                let [before, touch] = [0, 1].map(|step| by_offset[step].response.unwrap());
                assert_eq!((before.force, before.indentation, before.offset), (0.0, 0.0, 0.0));
                assert_eq!((touch.force, touch.indentation, touch.offset), (0.0, 0.0, clearance));
            }
            let pressed = by_offset[2].response.unwrap();
            assert!(pressed.force > 0.0);
            assert_eq!((pressed.indentation, pressed.offset), (0.0078125, clearance + 0.0078125));
            let by_force = solved(&joint, method, &[Load::Force(pressed.force)]).remove(0).response.unwrap();
            assert!((by_force.offset / pressed.offset - 1.0).abs() < 1e-4, "{}", by_force.offset);
        }
    }
}

#[test]
fn press_fits_are_solved_by_exact_modes() {
    let lined = ring(2.0).with_layers(&[Layer::new(1.0, STEEL)]).unwrap();
    for plate in [ring(2.0), lined] {
        for method in [MethodChoice::Auto, MethodChoice::Series] {
            let steps = solved(&joint(-0.02, plate.clone()), method, &[Load::Offset(0.0), Load::Force(1e4)]);
            for step in steps {
                let response = step.response.unwrap();
                assert_eq!(response.method, Method::Series);
                assert!(response.force_error < 1e-3 && step.status.to_string() == "ok", "{}", step.status);
                assert!(response.peak_pressure.unwrap() > 0.0 && response.energy.unwrap() > 0.0);
            }
        }
    }
}

/// sigma_r/u of rings under plane stress at their last radius, mm, from the one before where they are fixed: u = A r + B/r in each.
fn radial_stiffness(fixed: f64, rings: &[(f64, Material)]) -> f64 {
    let (mut before, mut stiffness) = (fixed, f64::INFINITY);
    for (radius, Material { youngs_modulus, poissons_ratio }) in rings {
        let modulus = youngs_modulus / (1.0 - poissons_ratio * poissons_ratio);
        let [sum, rest] = [1.0 + poissons_ratio, 1.0 - poissons_ratio].map(|share| modulus * share);
        // B/A.
        let ratio = match stiffness.is_finite() {
            true => (sum - stiffness * before) / (stiffness / before + rest / (before * before)),
            false => -before * before,
        };
        stiffness = (sum - rest * ratio / (radius * radius)) / (radius + ratio / radius);
        before = *radius;
    }
    stiffness
}

/// Layers so thin and soft that contacts with clearance take them for beds: the fit's pressure is Lame's, meshes agree, and blocks are
/// answered as well.
#[test]
fn press_fits_of_thin_layers_are_those_of_lame() {
    let overlap = 0.02;
    for (thickness, modulus) in [(0.002, 1e2), (0.02, 1e3), (0.02, 1.2e4)] {
        let layer = [Layer::new(thickness, Material { youngs_modulus: modulus, poissons_ratio: 0.3 })];
        let bare = joint(-overlap, ring(2.0));
        let radius = bare.hole_radius;
        let pin = bare.pin.clone().with_layers(&layer).unwrap();
        let plate = bare.plate.clone().with_layers(&layer).unwrap();
        // Each body by its own radius, which the compliance is over.
        let pin_radius = radius + overlap;
        let compliance = |is_lined: bool, own: f64, side: f64, fixed: f64| {
            let lined = [(own + side * thickness, STEEL), (own, layer[0].material)];
            let rings = if is_lined { &lined[..] } else { &[(own, STEEL)] };
            -side / (own / radius * radial_stiffness(fixed, rings))
        };
        for lined in [[true, false], [false, true], [true, true]] {
            let joint = JointDesign {
                pin: if lined[0] { pin.clone() } else { bare.pin.clone() },
                plate: if lined[1] { plate.clone() } else { bare.plate.clone() },
                ..bare.clone()
            };
            let core = joint.pin.parameters[0] * pin_radius;
            let yields = compliance(lined[0], pin_radius, -1.0, core)
                + compliance(lined[1], radius, 1.0, 2.0 * radius);
            for (method, bound) in [(MethodChoice::Auto, 1e-6), (MethodChoice::Fe, 1e-3)] {
                let loads = [Load::Offset(0.0), Load::Force(1e4)];
                let found = solved(&joint, method, &loads).into_iter().map(|step| step.response.unwrap());
                let found: Vec<_> = found.collect();
                let pressure = found[0].peak_pressure.unwrap();
                assert!((pressure * yields / overlap - 1.0).abs() < bound, "{lined:?}: {pressure}");
                assert!(found[1].offset > 0.0 && found[1].force_error < 0.01, "{}", found[1].force_error);
            }
            let in_block = JointDesign { plate: block(), ..joint };
            let plate = if lined[1] { in_block.plate.clone().with_layers(&layer).unwrap() } else { block() };
            let step = solved(&JointDesign { plate, ..in_block }, MethodChoice::Auto, &[Load::Offset(0.0)])
                .remove(0);
            assert!(step.response.unwrap().peak_pressure.unwrap() > 0.0);
        }
    }
}

#[test]
fn what_no_press_fit_can_be_is_refused() {
    let offset = [Load::Offset(0.01)];
    for (plate, method, load, problem) in [
        (ring(2.0), MethodChoice::ClosedForm, offset, "closed forms know no press fits"),
        (block(), MethodChoice::Series, offset, "series needs a rigid-core pin in an annulus"),
        (ring(1.01), MethodChoice::Auto, offset, "a wall of the press fit is below 2 % of the radius"),
        (
            ring(2.0),
            MethodChoice::Auto,
            [Load::Indentation(0.01)],
            "a press fit has no indentation; it is loaded by an offset or a force",
        ),
    ] {
        let joint = joint(-0.02, plate);
        let step = solved(&joint, method, &load).remove(0);
        assert_eq!(step.status.to_string(), format!("failed: {problem}"));
        assert!(step.response.is_none());
    }
    let half_pin = Part::new("rigid-midplane", &[], None, STEEL).unwrap();
    let half = JointDesign { pin: half_pin, ..joint(-0.02, block()) };
    let step = solved(&half, MethodChoice::Auto, &offset).remove(0);
    let problem = "half a pin is held by no press fit: the pin's model is rigid-core or tube";
    assert_eq!(step.status.to_string(), format!("failed: {problem}"));
    let curve = Joint::try_from(joint(-0.02, ring(2.0))).unwrap().curve(Options::default()).unwrap();
    assert!(curve.at(Load::Indentation(0.03)).unwrap_err().to_string().contains("a press fit has none"));
    assert!(curve.at(Load::Offset(0.01)).unwrap().force > 0.0);
}

/// Laws are of joints with clearance; a press fit says that it has none.
#[test]
fn press_fits_have_no_laws() {
    let steps = vec![Load::Offset(0.01), Load::Offset(0.1)];
    let case = DesignCase { index: 0, joint: joint(-0.02, ring(2.0)), steps: steps.into() };
    let mut ladder = Ladder::new(Options::default());
    let laws = laws_of_all(&mut ladder, &[(&case, Some((0.03, 0.12)))]).remove(0);
    assert!(laws.laws.is_empty());
    assert_eq!(laws.missing, Some("laws are of the indentation of joints with clearance"));
}

/// A sweep from press fits to clearances, large enough to be interpolated: its press fits are not.
#[test]
fn explain_says_what_press_fits_are_solved_with() {
    let config = r#"
[joint]
idealization = "plane-stress"
hole_radius = "10 mm"
radial_clearance = { from = "-0.02 mm", to = "0.02 mm" }
thickness = "1 mm"
[joint.pin]
model = "rigid-core"
core_radius_ratio = { from = 0.1, to = 0.4 }
youngs_modulus = "210 GPa"
poissons_ratio = { from = 0.2, to = 0.4 }
[joint.plate]
model = "annulus"
outer_radius_ratio = { from = 1.6, to = 3.0 }
youngs_modulus = "70 GPa"
poissons_ratio = 0.33
[load]
offset = ["10 um", "100 um"]
[sampling]
method = "sobol"
count = 200000
"#;
    let study = Study::from_text(Path::new("fits.toml"), config.into()).unwrap();
    let explainer = Explainer::new(&study);
    let (mut pressed, mut others) = (0, 0);
    for case in study.cases().unwrap().take(200) {
        let case = case.unwrap();
        let explained = explainer.explain(&case);
        if case.joint.is_press_fit() {
            let why = explained.ruled_out.iter().find(|(what, _)| what == "interpolation across bodies");
            assert_eq!((explained.chosen.as_str(), &*why.unwrap().1), ("series", "knows no press fits"));
            pressed += 1;
        } else {
            assert_eq!(explained.chosen, "interpolated");
            others += 1;
        }
    }
    assert!(pressed > 80 && others > 80, "{pressed} {others}");
}
