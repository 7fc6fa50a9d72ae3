//! The pin and the hole as the closed forms see them.

use std::ops::Bound::{Excluded, Included};

use super::law_error::{LawError, POSITIVE, check, finite};
use crate::mechanics::material::{Idealization, Material, effective_modulus};

/// A pin in a hole. Lengths and moduli in any consistent units (forces follow), unless a law says otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// R1 = R2 - dR.
    pub(super) pin_radius: f64,
    /// R2.
    pub(super) hole_radius: f64,
    /// dR, radial.
    pub(super) radial_clearance: f64,
    /// t.
    pub(super) thickness: f64,
    /// E*, 1/E* = 1/E1' + 1/E2'.
    pub(super) effective_modulus: f64,
    /// Dundurs' alpha and beta of pin (first) and plate; both vanish for elastically similar bodies.
    pub(super) dundurs: [f64; 2],
}

impl Pair {
    /// Any finite geometry with 0 <= dR < R2; a neat fit (dR = 0) is a pair, though few laws have a curve for it.
    pub fn new(
        hole_radius: f64,
        radial_clearance: f64,
        thickness: f64,
        pin: &Material,
        plate: &Material,
        idealization: Idealization,
    ) -> Result<Pair, LawError> {
        check("pair", "hole radius", hole_radius, POSITIVE)?;
        check("pair", "radial clearance", radial_clearance, (Included(0.0), Excluded(hole_radius)))?;
        check("pair", "thickness", thickness, POSITIVE)?;
        for material in [pin, plate] {
            check("pair", "Young's modulus", material.youngs_modulus, POSITIVE)?;
            check("pair", "Poisson's ratio", material.poissons_ratio, (Excluded(-1.0), Excluded(0.5)))?;
        }
        let dundurs = dundurs(pin, plate, idealization);
        finite("pair", "Dundurs' alpha", dundurs[0])?;
        finite("pair", "Dundurs' beta", dundurs[1])?;
        let effective_modulus =
            check("pair", "effective modulus", effective_modulus(pin, plate, idealization), POSITIVE)?;
        let pin_radius = hole_radius - radial_clearance;
        Ok(Pair { pin_radius, hole_radius, radial_clearance, thickness, effective_modulus, dundurs })
    }

    /// 1/R = 1/R1 - 1/R2 = dR/(R1 R2), the relative curvature of the two surfaces; 0 for a neat fit.
    pub(super) fn relative_curvature(&self) -> f64 {
        self.radial_clearance / self.pin_radius / self.hole_radius
    }
}

/// alpha and beta = [G1 (k2 -+ 1) - G2 (k1 -+ 1)]/[G1 (k2 + 1) + G2 (k1 + 1)], upper sign "+" for alpha, "-" for beta;
/// G the shear modulus, k Kolosov's constant (Dundurs, J. Appl. Mech. 36, 1969, 650-652).
fn dundurs(pin: &Material, plate: &Material, idealization: Idealization) -> [f64; 2] {
    let shear = |material: &Material| material.youngs_modulus / (2.0 + 2.0 * material.poissons_ratio);
    let ratio = shear(pin) / shear(plate);
    let [k1, k2] = [pin, plate].map(|material| idealization.kolosov(material.poissons_ratio));
    let sum = ratio * (k2 + 1.0) + (k1 + 1.0);
    [(ratio * (k2 + 1.0) - (k1 + 1.0)) / sum, (ratio * (k2 - 1.0) - (k1 - 1.0)) / sum]
}

#[cfg(test)]
impl Pair {
    /// Steel in steel in plane stress: E* = 1e5.
    pub(super) fn steel(hole_radius: f64, radial_clearance: f64, thickness: f64) -> Pair {
        let steel = Material { youngs_modulus: 2e5, poissons_ratio: 0.3 };
        Pair::new(hole_radius, radial_clearance, thickness, &steel, &steel, Idealization::PlaneStress)
            .unwrap()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Material = Material { youngs_modulus: 200.0, poissons_ratio: 0.3 };

    #[test]
    fn alpha_is_the_contrast_of_the_plane_moduli() {
        // The identity alpha = (E1' - E2')/(E1' + E2'); round-off of a few operations.
        let soft = Material { youngs_modulus: 70.0, poissons_ratio: 0.45 };
        for idealization in Idealization::ALL {
            let [alpha, beta] = dundurs(&STEEL, &soft, idealization);
            let [e1, e2] = [STEEL, soft].map(|material| material.plane_modulus(idealization));
            assert!((alpha - (e1 - e2) / (e1 + e2)).abs() < 1e-15);
            assert!(beta.abs() > 1e-3, "these two materials differ in beta too: {beta}");
        }
    }

    #[test]
    fn beta_of_a_rigid_pin_in_plane_strain() {
        // G1 -> infinity gives beta = (k2 - 1)/(k2 + 1) = (1 - 2 nu)/(2 - 2 nu); 1e-9 is the modulus ratio.
        let rigid = Material { youngs_modulus: 2e11, poissons_ratio: 0.3 };
        let [alpha, beta] = dundurs(&rigid, &STEEL, Idealization::PlaneStrain);
        assert!((alpha - 1.0).abs() < 1e-8);
        assert!((beta - 0.4 / 1.4).abs() < 1e-8);
    }

    #[test]
    fn every_impossible_input_is_an_error() {
        let good = [1.0, 0.1, 1.0, 200.0, 0.3];
        let pair = |[radius, clearance, thickness, youngs_modulus, poissons_ratio]: [f64; 5]| {
            let material = Material { youngs_modulus, poissons_ratio };
            Pair::new(radius, clearance, thickness, &material, &STEEL, Idealization::PlaneStress)
        };
        assert!(pair(good).is_ok());
        for position in 0..5 {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0] {
                let mut bad = good;
                bad[position] = value;
                assert!(pair(bad).is_err(), "position {position}, value {value}");
            }
        }
        assert!(pair([1.0, 1.0, 1.0, 200.0, 0.3]).is_err(), "a pin of no radius");
        assert!(pair([1.0, 0.0, 1.0, 200.0, 0.3]).is_ok(), "a neat fit");
        assert!(pair([1.0, 0.1, 1.0, 200.0, 0.5]).is_err(), "an incompressible material");
    }
}
