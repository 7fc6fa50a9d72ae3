//! Persson's exact solution of a disc in the hole of an infinite plate, frictionless, of elastically similar materials.
//!
//! With b = tan(eps/2), E1' = 2 E* the plane modulus of ONE body, F per thickness:
//! E1' dR/F = I(b) = [2 - ln(1 + b^2) - 2 b^4]/[pi b^2 (1 + b^2)], and with y = tan(phi/2), s^2 = b^2 - y^2, u^2 = b^2 + 1
//! p R2/F = 2 s/(pi u (1 + y^2)) + ln[(u + s)/(u - s)]/(2 pi b^2 (1 + b^2)).
//! I(b) falls to zero at b = 0.913573, eps = 84.828 deg: the neat fit (dR = 0), and the limit of large loads.
//! It relates force, angle and pressure. It gives no indentation: an infinite plate has none.

use std::f64::consts::PI;
use std::ops::Bound::{Excluded, Included};

use super::law_error::{LawError, POSITIVE, check, finite};
use super::pair::Pair;

pub const CITATION: &str = "A. Persson, On the stress distribution of cylindrical elastic bodies in contact, Chalmers \
     (1964); M. Ciavarella & P. Decuzzi, Int. J. Solids Structures 38 (2001) 4507-4523 and 4525-4533";
pub const RANGE: &str = "elastically similar materials (both Dundurs' constants zero), every force > 0, \
     0 < eps < 84.828 deg; plates far larger than the hole: eps at equal force is 0.3 deg low at the outer ratio 10, \
     2 deg at 3, 5 deg at 1.5";

const LAW: &str = "persson";

/// b^2 where 2 - ln(1 + b^2) - 2 b^4 = 0.
const LARGEST_SQUARE: f64 = 0.834_615_245_477_657_2;
/// Dundurs' constants this small are unit conversions' round-off; their effect on the force is of the same order.
const SIMILAR: f64 = 1e-9;

/// One state of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerssonContact {
    force_per_thickness: f64,
    contact_half_angle: f64,
    /// b.
    half_tangent: f64,
    hole_radius: f64,
}

impl PerssonContact {
    /// The contact angle of a given force per thickness, F > 0; a neat fit is allowed.
    pub fn from_force(pair: &Pair, force_per_thickness: f64) -> Result<Self, LawError> {
        similar(pair)?;
        let force = check(LAW, "force per thickness", force_per_thickness, POSITIVE)?;
        let load_factor = PI * 2.0 * pair.effective_modulus * pair.radial_clearance / force;
        PerssonContact::new(pair, force, square_of(finite(LAW, "pi E' dR/F", load_factor)?).sqrt())
    }

    /// The force per thickness that opens a given contact angle, in rad; needs a clearance.
    pub fn from_contact_half_angle(pair: &Pair, contact_half_angle: f64) -> Result<Self, LawError> {
        similar(pair)?;
        check(LAW, "radial clearance", pair.radial_clearance, POSITIVE)?;
        let allowed = (Excluded(0.0), Excluded(largest_contact_half_angle()));
        let angle = check(LAW, "contact half angle", contact_half_angle, allowed)?;
        let b = (0.5 * angle).tan();
        let square = b * b;
        let force = 2.0 * pair.effective_modulus * pair.radial_clearance * PI * square * (1.0 + square)
            / remainder(square);
        PerssonContact::new(pair, check(LAW, "force per thickness", force, POSITIVE)?, b)
    }

    fn new(pair: &Pair, force_per_thickness: f64, half_tangent: f64) -> Result<Self, LawError> {
        let allowed = (Excluded(0.0), Included(largest_contact_half_angle()));
        let contact_half_angle = check(LAW, "contact half angle", 2.0 * half_tangent.atan(), allowed)?;
        let contact = PerssonContact {
            force_per_thickness,
            contact_half_angle,
            half_tangent,
            hole_radius: pair.hole_radius,
        };
        finite(LAW, "peak pressure", contact.at(0.0))?;
        Ok(contact)
    }

    /// F.
    pub fn force_per_thickness(&self) -> f64 {
        self.force_per_thickness
    }

    /// eps, rad.
    pub fn contact_half_angle(&self) -> f64 {
        self.contact_half_angle
    }

    /// p0.
    pub fn peak_pressure(&self) -> f64 {
        self.at(0.0)
    }

    /// p at the angle phi from the load line, |phi| <= pi; zero outside the contact.
    pub fn pressure(&self, angle: f64) -> Result<f64, LawError> {
        check(LAW, "angle", angle, (Included(-PI), Included(PI)))?;
        Ok(self.at((0.5 * angle).tan()))
    }

    /// p as a function of y = tan(phi/2); s and with it p is zero outside |y| < b.
    fn at(&self, y: f64) -> f64 {
        let b = self.half_tangent;
        let s = ((b - y) * (b + y)).max(0.0).sqrt();
        let u = b.hypot(1.0);
        // ln[(u + s)/(u - s)] = 2 artanh(s/u), which loses no digits for small contacts.
        let tail = (s / u).atanh() / (PI * b * b * (1.0 + b * b));
        self.force_per_thickness / self.hole_radius * (2.0 * s / (PI * u * (1.0 + y * y)) + tail)
    }
}

/// 84.828 deg in rad: the contact half angle of a neat fit at every load, and of a loose one at infinite load.
pub fn largest_contact_half_angle() -> f64 {
    2.0 * LARGEST_SQUARE.sqrt().atan()
}

fn similar(pair: &Pair) -> Result<(), LawError> {
    let [alpha, beta] = pair.dundurs;
    if alpha.abs() > SIMILAR || beta.abs() > SIMILAR {
        return Err(LawError::DissimilarMaterials { law: LAW, alpha, beta });
    }
    Ok(())
}

/// 2 - ln(1 + t) - 2 t^2 with t = b^2: what vanishes for a neat fit.
fn remainder(square: f64) -> f64 {
    2.0 - square.ln_1p() - 2.0 * square * square
}

/// t = b^2 with pi I(b) = c >= 0: the root of h(t) = 2 - ln(1 + t) - 2 t^2 - c t (1 + t).
///
/// h falls and is concave for t >= 0, so Newton's iteration from the right of the root falls to it monotonically;
/// h <= 0 both at 2/c and at the neat fit's t.
fn square_of(c: f64) -> f64 {
    let mut t = LARGEST_SQUARE.min(2.0 / c);
    // From the start, at most twice the root, quadratic convergence takes about five steps.
    for _ in 0..30 {
        let value = remainder(t) - c * t * (1.0 + t);
        let step = value / (1.0 / (1.0 + t) + 4.0 * t + c * (1.0 + 2.0 * t));
        t = (t + step).min(LARGEST_SQUARE);
        if step.abs() <= f64::EPSILON * t {
            break;
        }
    }
    t
}

#[cfg(test)]
mod tests {
    use super::super::HertzContact;
    use super::*;
    use crate::mechanics::material::{Idealization, Material};

    #[test]
    fn force_and_angle_are_inverse_from_end_to_end() {
        let pair = Pair::steel(10.0, 0.5, 1.0);
        let largest = largest_contact_half_angle();
        for fraction in [1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999, 1.0 - 1e-6, 1.0 - 1e-12] {
            let given = PerssonContact::from_contact_half_angle(&pair, fraction * largest).unwrap();
            let found = PerssonContact::from_force(&pair, given.force_per_thickness()).unwrap();
            // 1e-14: round-off. Near the largest angle the force varies much faster than the angle.
            assert!(
                (found.contact_half_angle() / given.contact_half_angle() - 1.0).abs() < 1e-14,
                "{fraction}"
            );
        }
    }

    #[test]
    fn the_largest_angle_is_the_neat_fits() {
        let degrees = largest_contact_half_angle().to_degrees();
        // The published figures' last digits.
        assert!((degrees - 84.828).abs() < 5e-4, "{degrees}");
        assert!((LARGEST_SQUARE.sqrt() - 0.913573).abs() < 5e-7);
        assert!(remainder(LARGEST_SQUARE).abs() < 1e-15, "round-off of 2 - 2");
        let neat = PerssonContact::from_force(&Pair::steel(10.0, 0.0, 1.0), 5.0).unwrap();
        assert_eq!(neat.contact_half_angle(), largest_contact_half_angle());
        // A huge load on a loose fit comes to the same: 1e-9 is E' dR/F.
        let huge = PerssonContact::from_force(&Pair::steel(10.0, 0.5, 1.0), 1e14).unwrap();
        assert!((huge.contact_half_angle() / largest_contact_half_angle() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_pressure_is_even_falls_and_ends_at_the_contacts_edge() {
        let contact = PerssonContact::from_contact_half_angle(&Pair::steel(10.0, 0.5, 1.0), 1.0).unwrap();
        let pressure = |angle: f64| contact.pressure(angle).unwrap();
        assert_eq!(pressure(0.0), contact.peak_pressure());
        let steps: Vec<f64> = (0..=100).map(|step| pressure(0.01 * f64::from(step))).collect();
        assert!(steps.windows(2).all(|pair| pair[1] < pair[0]));
        assert_eq!(pressure(0.4), pressure(-0.4));
        assert_eq!([pressure(1.0 + 1e-9), pressure(1.1), pressure(-PI)], [0.0; 3]);
        // A square root at the edge: a hundredth of the distance has a tenth of the pressure; 1 % is the next order.
        assert!((pressure(1.0 - 1e-6) / pressure(1.0 - 1e-4) - 0.1).abs() < 1e-3);
    }

    #[test]
    fn hertz_is_as_coarse_as_its_range_says() {
        // Large bodies, so that 1/R = dR/R2^2; the percentages of hertz::RANGE, rounded there to 1 %.
        let pair = Pair::steel(1e6, 1.0, 1.0);
        for (degrees, percent) in [(15.0f64, 3.0), (30.0, 11.0), (45.0, 24.0)] {
            let exact = PerssonContact::from_contact_half_angle(&pair, degrees.to_radians()).unwrap();
            let hertz = HertzContact::from_force(&pair, exact.force_per_thickness()).unwrap();
            let low = 100.0 * (1.0 - hertz.peak_pressure() / exact.peak_pressure());
            assert!((low - percent).abs() < 0.5, "{degrees} deg: {low} %");
        }
    }

    #[test]
    fn needs_both_dundurs_constants_to_vanish() {
        let steel = Material { youngs_modulus: 2e5, poissons_ratio: 0.3 };
        let aluminium = Material { youngs_modulus: 7e4, poissons_ratio: 0.3 };
        // Equal E' in plane stress, so alpha = 0; another Poisson's ratio, so beta is not.
        let same_modulus = Material { youngs_modulus: 2e5, poissons_ratio: 0.45 };
        for other in [aluminium, same_modulus] {
            let pair = Pair::new(10.0, 0.5, 1.0, &steel, &other, Idealization::PlaneStress).unwrap();
            let errors =
                [PerssonContact::from_force(&pair, 1.0), PerssonContact::from_contact_half_angle(&pair, 1.0)];
            for error in errors {
                assert!(matches!(error, Err(LawError::DissimilarMaterials { .. })), "{error:?}");
            }
        }
    }

    #[test]
    fn refuses_impossible_forces_and_angles() {
        let pair = Pair::steel(10.0, 0.5, 1.0);
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 0.0] {
            assert!(PerssonContact::from_force(&pair, value).is_err(), "force {value}");
            assert!(PerssonContact::from_contact_half_angle(&pair, value).is_err(), "angle {value}");
        }
        let beyond = PerssonContact::from_contact_half_angle(&pair, largest_contact_half_angle());
        assert!(matches!(beyond, Err(LawError::OutOfRange { .. })));
        // A neat fit has one angle and no force that goes with it.
        let neat = PerssonContact::from_contact_half_angle(&Pair::steel(10.0, 0.0, 1.0), 1.0);
        assert!(matches!(neat, Err(LawError::OutOfRange { quantity: "radial clearance", .. })), "{neat:?}");
        let contact = PerssonContact::from_force(&pair, 1.0).unwrap();
        assert!(contact.pressure(f64::NAN).is_err() && contact.pressure(4.0).is_err());
        // Extremes of f64: E' dR/F, then the pressure, too large for a number.
        let faint = PerssonContact::from_force(&pair, f64::MIN_POSITIVE);
        assert!(matches!(faint, Err(LawError::NotFinite { .. })), "{faint:?}");
        let tiny = PerssonContact::from_force(&Pair::steel(1e-200, 1e-201, 1.0), 1e200);
        assert!(matches!(tiny, Err(LawError::NotFinite { .. })), "{tiny:?}");
    }
}
