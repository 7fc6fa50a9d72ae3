//! Hertz's line contact of a cylinder in a hole: two half-planes pressed together by a parabolic gap.
//!
//! a^2 = 4 F/(pi E* k), k = 1/R1 - 1/R2 = dR/(R1 R2), p = p0 sqrt(1 - x^2/a^2), p0 = 2 F/(pi a); F per thickness.
//! In two dimensions the theory gives no indentation of its own.

use std::f64::consts::PI;
use std::ops::Bound::{Excluded, Included};

use super::law_error::{LawError, POSITIVE, check, finite};
use super::pair::Pair;

pub const CITATION: &str = "H. Hertz, J. reine angew. Math. 92 (1881) 156-171; \
     K. L. Johnson, Contact Mechanics, Cambridge University Press (1985) sect. 4.2(c)";
pub const RANGE: &str = "a < R1, and there only a coarse guide: against Persson's solution for similar materials the \
     peak pressure is 3 % low at eps = 15 deg, 11 % at 30 deg, 24 % at 45 deg";

const LAW: &str = "hertz";

/// One state of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HertzContact {
    contact_half_width: f64,
    peak_pressure: f64,
}

impl HertzContact {
    /// For 0 < F/t while the contact is narrower than the pin.
    pub fn from_force(pair: &Pair, force_per_thickness: f64) -> Result<Self, LawError> {
        check(LAW, "radial clearance", pair.radial_clearance, POSITIVE)?;
        let force = check(LAW, "force per thickness", force_per_thickness, POSITIVE)?;
        let square = 4.0 * force / (PI * pair.effective_modulus * pair.relative_curvature());
        let narrow = (Excluded(0.0), Excluded(pair.pin_radius));
        let contact_half_width = check(LAW, "contact half width", square.sqrt(), narrow)?;
        let peak_pressure = finite(LAW, "peak pressure", 2.0 * force / (PI * contact_half_width))?;
        Ok(HertzContact { contact_half_width, peak_pressure })
    }

    /// a, the half width of the flat contact strip.
    pub fn contact_half_width(&self) -> f64 {
        self.contact_half_width
    }

    /// p0.
    pub fn peak_pressure(&self) -> f64 {
        self.peak_pressure
    }

    /// p at the distance x >= 0 from the load line; zero outside the contact.
    pub fn pressure(&self, distance: f64) -> Result<f64, LawError> {
        let distance = check(LAW, "distance", distance, (Included(0.0), Included(f64::MAX)))?;
        let ratio = distance / self.contact_half_width;
        Ok(self.peak_pressure * ((1.0 - ratio) * (1.0 + ratio)).max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn width_and_pressure_of_a_worked_case() {
        // R1 = 9, R2 = 10, E* = 1e5, F = 100: 1/R = 1/90, a = sqrt(36000/(pi 1e5)), p0 = sqrt(F E*/(pi R)).
        let contact = HertzContact::from_force(&Pair::steel(10.0, 1.0, 1.0), 100.0).unwrap();
        let half_width = (36_000.0 / (PI * 1e5)).sqrt();
        // 1e-14: round-off of a handful of operations (9 is 10 - 1 exactly).
        assert!((contact.contact_half_width() / half_width - 1.0).abs() < 1e-14);
        assert!((contact.peak_pressure() / (100.0 * 1e5 / (PI * 90.0)).sqrt() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_pressure_carries_the_load() {
        let contact = HertzContact::from_force(&Pair::steel(10.0, 1.0, 1.0), 100.0).unwrap();
        // x = a sin t makes the integrand smooth and periodic: the midpoint rule is exact to round-off.
        let count = 64;
        let step = PI / f64::from(count);
        let a = contact.contact_half_width();
        let force: f64 = (0..count)
            .map(|i| (-PI / 2.0 + (f64::from(i) + 0.5) * step).sin_cos())
            .map(|(sine, cosine)| contact.pressure(a * sine.abs()).unwrap() * a * cosine * step)
            .sum();
        assert!((force / 100.0 - 1.0).abs() < 1e-13, "{force}");
        assert_eq!(contact.pressure(1.1 * a), Ok(0.0));
    }

    #[test]
    fn refuses_a_neat_fit_no_load_and_a_contact_as_wide_as_the_pin() {
        let pair = Pair::steel(10.0, 1.0, 1.0);
        assert!(HertzContact::from_force(&Pair::steel(10.0, 0.0, 1.0), 1.0).is_err());
        for force in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(HertzContact::from_force(&pair, force).is_err(), "{force}");
        }
        // a = R1 at F = (pi/4) E* R1^2/R.
        let limit = PI / 4.0 * 1e5 * 81.0 / 90.0;
        assert!(HertzContact::from_force(&pair, 0.999 * limit).is_ok());
        assert!(matches!(HertzContact::from_force(&pair, 1.001 * limit), Err(LawError::OutOfRange { .. })));
        assert!(HertzContact::from_force(&pair, 1.0).unwrap().pressure(f64::NAN).is_err());
    }
}
