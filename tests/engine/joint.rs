//! The library as another program uses it: a joint, its curve, and errors for what cannot be.

use std::f64::consts::PI;

use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::study::design::DesignCase;
use jointsweep::{
    Curve, Dimensions, Error, Idealization, Joint, Load, Material, MethodChoice, Options, Part, solve,
};

const STEEL: Material = Material { youngs_modulus: 210e3, poissons_ratio: 0.3 };
const SIZES: Dimensions = Dimensions { hole_radius: 10.0, radial_clearance: 0.05, thickness: 8.0 };

fn plate() -> Part {
    Part::new("annulus", &[("outer_radius_ratio", 3.0)], None, STEEL).unwrap()
}

fn joint(pin: &str, sizes: Dimensions) -> Joint {
    Joint::new(sizes, Idealization::PlaneStress, Part::new(pin, &[], None, STEEL).unwrap(), plate()).unwrap()
}

fn curve(joint: &Joint, accuracy: f64) -> Curve {
    joint.curve(Options { accuracy, method: MethodChoice::Auto }).unwrap()
}

/// One resolution for the whole curve: the slope is that of the force, the work that of the force, and rows of a table agree.
#[test]
fn a_curve_is_one_smooth_function() {
    for pin in ["rigid-core", "rigid-midplane"] {
        let joint = joint(pin, SIZES);
        let curve = curve(&joint, 1e-3);
        let mut rows = 0;
        for exponent in -30..=20 {
            let delta = 0.05 * 10f64.powf(0.1 * f64::from(exponent));
            let Ok(state) = curve.at(Load::Indentation(delta)) else {
                assert!(pin == "rigid-midplane" && delta > 0.5, "{pin} {delta}");
                continue;
            };
            rows += 1;
            let step = 1e-4 * delta;
            let slope =
                (curve.force(delta + step).unwrap() - curve.force(delta - step).unwrap()) / (2.0 * step);
            assert!((slope / state.tangent_stiffness - 1.0).abs() < 2e-5, "{pin} {delta} {slope} {state:?}");
            assert!((curve.indentation(state.force).unwrap() / delta - 1.0).abs() < 1e-8);
            assert!(state.force_error < 1e-3);
        }
        assert!(rows > 40, "{rows}");
        let steps = vec![Load::Indentation(0.01), Load::Indentation(0.05), Load::Force(2e4)];
        let case = DesignCase { index: 0, joint: joint.design().clone(), steps: steps.clone().into() };
        let table = Ladder::new(Options { accuracy: 1e-3, method: MethodChoice::Auto }).solve(&[case]);
        let answers = solve(&joint, &steps, Options { accuracy: 1e-3, method: MethodChoice::Auto }).unwrap();
        for (own, row) in answers.iter().zip(&table[0].steps) {
            let (own, row) = (own.response.unwrap(), row.response.unwrap());
            assert!((own.force / row.force - 1.0).abs() < 1e-3 && own.method == row.method);
        }
    }
}

/// The pressure along the arc carries the force, begins with the peak and ends with nothing.
#[test]
fn the_pressure_along_the_arc_carries_the_force() {
    for (pin, clearance) in
        [("rigid-core", 0.05), ("rigid-core", 0.5), ("rigid-midplane", 0.05), ("rigid-core", 0.0)]
    {
        let sizes = Dimensions { radial_clearance: clearance, ..SIZES };
        let curve = curve(&joint(pin, sizes), 1e-4);
        for delta in [0.002, 0.02, 0.2] {
            let state = curve.at(Load::Indentation(delta)).unwrap();
            let points = curve.pressure(Load::Indentation(delta), 401).unwrap();
            assert_eq!(points.len(), 401);
            assert!((points[0].1 / state.peak_pressure.unwrap() - 1.0).abs() < 1e-9 && points[0].0 == 0.0);
            let (angle, pressure) = points[400];
            assert!(
                (angle - state.contact_half_angle.unwrap()).abs() < 1e-12
                    && pressure.abs() < 1e-6 * points[0].1
            );
            // The pressure acts along the hole's rays; the trapezoidal rule in arcs of equal change of the cosine.
            let resultant: f64 = points
                .windows(2)
                .map(|pair| {
                    let [(a, p), (b, q)] = [pair[0], pair[1]];
                    0.5 * (p * a.cos() + q * b.cos()) * (b - a)
                })
                .sum();
            let force = 2.0 * sizes.hole_radius * sizes.thickness * resultant;
            assert!(
                (force / state.force - 1.0).abs() < 1e-4,
                "{pin} {clearance} {delta} {force} {}",
                state.force
            );
        }
    }
    // Hertz, where contact is narrow: an ellipse.
    let curve = curve(&joint("rigid-core", SIZES), 1e-4);
    let points = curve.pressure(Load::Indentation(1e-4), 11).unwrap();
    let (end, peak) = (points[10].0, points[0].1);
    assert!(end < 0.1 * PI);
    for (angle, pressure) in points {
        assert!((pressure / peak - (1.0 - (angle / end).powi(2)).max(0.0).sqrt()).abs() < 2e-3, "{angle}");
    }
}

#[test]
fn what_cannot_be_is_refused_by_name() {
    let said = |error: Error| error.to_string();
    let part = |ratio: f64| Part::new("annulus", &[("outer_radius_ratio", ratio)], None, STEEL);
    assert_eq!(said(part(0.5).unwrap_err()), "outer_radius_ratio: 0.5: must be above 1");
    assert_eq!(
        said(Part::new("anulus", &[], None, STEEL).unwrap_err()),
        "model: `anulus`: not known; did you mean `annulus`? Allowed: `rigid-midplane`, `rigid-core`, `annulus`, `block`"
    );
    let ratio = Part::new("annulus", &[("outer_ratio", 2.0)], None, STEEL).unwrap_err();
    assert!(said(ratio).starts_with("outer_ratio: model `annulus` does not have this ratio; did you mean"));
    assert!(said(Part::new("annulus", &[], None, STEEL).unwrap_err()).contains("needs this ratio"));
    let ratios = [("half_width_ratio", 2.0), ("depth_ratio", 2.0), ("height_ratio", 2.0)];
    assert!(
        said(Part::new("block", &ratios, Some("bas"), STEEL).unwrap_err()).contains("did you mean `base`")
    );
    let soft = Material { poissons_ratio: 0.5, ..STEEL };
    assert!(
        said(Part::new("rigid-midplane", &[], None, soft).unwrap_err()).starts_with("poissons_ratio: 0.5: ")
    );
    let new = |sizes, pin, plate| Joint::new(sizes, Idealization::PlaneStress, pin, plate);
    let pin = || Part::new("rigid-core", &[], None, STEEL).unwrap();
    for (name, sizes) in [
        ("hole_radius", Dimensions { hole_radius: f64::NAN, ..SIZES }),
        ("radial_clearance", Dimensions { radial_clearance: -10.0, ..SIZES }),
        ("radial_clearance", Dimensions { radial_clearance: 10.0, ..SIZES }),
        ("thickness", Dimensions { thickness: 0.0, ..SIZES }),
    ] {
        assert!(said(new(sizes, pin(), plate()).unwrap_err()).starts_with(name));
    }
    assert!(said(new(SIZES, plate(), pin()).unwrap_err()).contains("`annulus` is not a model of a pin"));
    let joint = joint("rigid-midplane", SIZES);
    for options in [
        Options { accuracy: 0.0, method: MethodChoice::Auto },
        Options { accuracy: f64::NAN, method: MethodChoice::Auto },
        Options { accuracy: 0.01, method: MethodChoice::ClosedForm },
        Options { accuracy: 0.01, method: MethodChoice::Series },
    ] {
        assert!(joint.curve(options).is_err(), "{options:?}");
    }
    let curve = curve(&joint, 0.01);
    assert!(
        curve.force(-1.0).is_err()
            && curve.indentation(f64::NAN).is_err()
            && curve.force(f64::INFINITY).is_err()
    );
    let thin = Part::new("annulus", &[("outer_radius_ratio", 1.2)], None, STEEL).unwrap();
    let half_disc = Part::new("rigid-midplane", &[], None, STEEL).unwrap();
    let thin = new(SIZES, half_disc, thin).unwrap().curve(Options::default()).unwrap();
    assert_eq!(said(thin.force(50.0).unwrap_err()), "indentation 50 mm: failed: contact wider than 88 deg");
    assert_eq!(curve.force(0.0).unwrap(), 0.0);
}
