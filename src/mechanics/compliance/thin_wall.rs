//! Rings so thin that they are taken for Winkler beds.
//!
//! Where a ring is much thinner than the contact is wide, each place of it yields by itself: u = lambda p. Its compliance to the
//! trial pressures has a closed form, lambda W with
//!
//! ```text
//!   W_jk = integral of p_j p_k d(phi) = 1/(2 b) integral of cos(2 j tau) cos(2 k tau) (1 + b^2 cos^2 tau)/sin(tau) d(tau).
//! ```
//!
//! With h_m = 2 (1 + 1/3 + ... + 1/(2 m - 1)) the integral of cos(2 m tau)/sin(tau) is that of 1/sin(tau) less h_m. The
//! former is infinite, because a bed bears no edge singularity. Cut off it is the number `EDGE`, the same for all j and k,
//! which multiplies the square of the sum of the coefficients, the strength of the singularity.

use super::arc::{MAX_TERMS, packed_count};
use crate::mechanics::body::{Body, THINNEST_RING};
use crate::mechanics::material::Idealization;

/// The integral of 1/sin(tau), cut off. It only enters the stiffness, by 0.1 % (10 trial pressures) and less between 5 and 20;
/// below 5 the compliance of 24 trial pressures is not positive definite.
const EDGE: f64 = 7.0;

/// h_m for m = 0, 1, ...
const DEFICITS: [f64; 2 * MAX_TERMS] = {
    let mut deficits = [0.0; 2 * MAX_TERMS];
    let mut m = 1;
    while m < deficits.len() {
        deficits[m] = deficits[m - 1] + 2.0 / (2 * m - 1) as f64;
        m += 1;
    }
    deficits
};

/// W, packed, on an arc of b = tan(eps/2).
pub fn bed_matrix(b: f64, terms: usize) -> Vec<f64> {
    let half_square = 0.5 * b * b;
    let mut matrix = Vec::with_capacity(packed_count(terms));
    for row in 0..terms {
        for column in 0..=row {
            // cos(2 j tau) cos(2 k tau) and its product with cos(2 tau), which is the part of cos^2.
            let pair = |m: usize, n: usize| DEFICITS[m] + DEFICITS[n];
            let (sum, difference) = (row + column, row - column);
            let plain = EDGE - 0.5 * pair(sum, difference);
            let above = pair(sum + 1, difference + 1);
            let below = pair(sum.abs_diff(1), difference.abs_diff(1));
            let times_cosine = EDGE - 0.25 * (above + below);
            matrix.push(0.5 / b * ((1.0 + half_square) * plain + half_square * times_cosine));
        }
    }
    matrix
}

/// lambda: displacement under uniform pressure, over the pressure, of a ring from radius 1 to `fixed_radius_ratio`, where it
/// is held, for Young's modulus 1. Lame's solution, lambda_0 of `series`, free of cancellation.
pub fn bed_compliance(fixed_radius_ratio: f64, poissons_ratio: f64, idealization: Idealization) -> f64 {
    // In plane stress u = A (1 - nu) r + B (1 + nu)/r and sigma_rr = A - B/r^2, with u(fixed_radius_ratio) = 0 and
    // sigma_rr(1) = -1; plane strain has nu/(1 - nu) and E/(1 - nu^2) in their place.
    let ratio = match idealization {
        Idealization::PlaneStress => poissons_ratio,
        Idealization::PlaneStrain => poissons_ratio / (1.0 - poissons_ratio),
    };
    let modulus = idealization.plane_modulus_ratio(poissons_ratio);
    // Over the square of the greater radius, which then cannot overflow.
    let small = if fixed_radius_ratio > 1.0 { 1.0 / fixed_radius_ratio } else { fixed_radius_ratio };
    let width = (1.0 - small) * (1.0 + small);
    let square = small * small;
    let [inner, outer] = if fixed_radius_ratio > 1.0 { [square, 1.0] } else { [1.0, square] };
    (1.0 - ratio) * (1.0 + ratio) * width / ((1.0 + ratio) * inner + (1.0 - ratio) * outer) / modulus
}

/// g of a flat strip that is held below: under a pressure that varies slowly it yields by lambda (p - g t^2 p''), t its
/// thickness. Large where it is nearly incompressible and yields by flowing aside.
fn flow(poissons_ratio: f64, idealization: Idealization) -> f64 {
    // Through the strip, z from below and s its inverse: sigma_z = 1 gives u_z = yielding z, the sideways stress share
    // sigma_z drives a shear n share (z - t), that the sideways displacement, and this by continuity n^2 t^3 of u_z.
    let (yielding, share) = match idealization {
        Idealization::PlaneStress => (1.0 - poissons_ratio * poissons_ratio, poissons_ratio),
        Idealization::PlaneStrain => {
            let rest = 1.0 - poissons_ratio;
            ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio) / rest, poissons_ratio / rest)
        }
    };
    let inverse_shear_modulus = 2.0 * (1.0 + poissons_ratio);
    share / 3.0 * (share * inverse_shear_modulus / yielding - 1.0)
}

/// The error of the work that goes into a body at a contact half angle, rad, for being taken for a bed.
pub fn bed_error(body: &Body, half_angle: f64) -> f64 {
    let wall = body.depth_range().0;
    if wall >= THINNEST_RING {
        return 0.0;
    }
    strip_error(body.poissons_ratio, body.idealization, wall / half_angle)
}

/// The same of a strip that is so thin beside half the contact's width.
pub fn strip_error(poissons_ratio: f64, idealization: Idealization, thickness: f64) -> f64 {
    let flow = flow(poissons_ratio, idealization).abs();
    // Of a parabola of pressure the term of g is 2.5 g (t/a)^2 of the energy and 1.5 of it in the force; wider contacts
    // have up to 2. The rest is what the ends of the contact do, 0.035 (t/a)^2 (tests/engine/thin_walls.rs).
    (2.0 * flow + 0.05) * thickness.powi(2)
}
