//! Thin walls: when a ring is taken for a Winkler bed, and what is lost where walls are thin.
//!
//! Where a ring is much thinner than the contact is wide, each place of it yields by itself, like the springs of a
//! Winkler bed: u = lambda p. Its compliance to the trial pressures has a closed form, lambda W with
//!
//! ```text
//!   W_jk = integral of p_j p_k d(phi) = 1/(2 b) integral of cos(2 j tau) cos(2 k tau) (1 + b^2 cos^2 tau)/sin(tau) d(tau).
//! ```
//!
//! With h_m = 2 (1 + 1/3 + ... + 1/(2 m - 1)) the integral of cos(2 m tau)/sin(tau) is that of 1/sin(tau) less h_m. The
//! former is infinite, because a bed bears no edge singularity. Cut off it is the number `EDGE`, the same for all j and k,
//! which multiplies the square of the sum of the coefficients, the strength of the singularity.

use super::arc::MAX_TERMS;
use crate::mechanics::body::{Body, THINNEST_RING};
use crate::mechanics::material::Idealization;
use crate::mechanics::real::Real;

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

/// Adds the compliance of a bed, lambda W, to the lower triangle of a matrix; b = tan(eps/2).
#[inline(always)]
pub fn add_bed<T: Real, const TERMS: usize>(matrix: &mut [[T; TERMS]; TERMS], lambda: T, b: T) {
    let number = T::from_f64;
    let half_square = number(0.5) * b * b;
    let scale = number(0.5) * lambda / b;
    // cos(2 j tau) cos(2 k tau) and its product with cos(2 tau), which is the part of cos^2.
    let with_cosine = number(1.0) + half_square;
    for (row, entries) in matrix.iter_mut().enumerate() {
        for (column, entry) in entries[..=row].iter_mut().enumerate() {
            let pair = |m: usize, n: usize| DEFICITS[m] + DEFICITS[n];
            let (sum, difference) = (row + column, row - column);
            let plain = EDGE - 0.5 * pair(sum, difference);
            let above = pair(sum + 1, difference + 1);
            let below = pair(sum.abs_diff(1), difference.abs_diff(1));
            let times_cosine = EDGE - 0.25 * (above + below);
            *entry += scale * (with_cosine * number(plain) + half_square * number(times_cosine));
        }
    }
}

/// lambda: displacement under uniform pressure, over the pressure, of a ring from radius 1 to `fixed_radius`, where it
/// is held, for Young's modulus 1. Lame's solution, lambda_0 of `series`, free of cancellation.
pub fn bed_compliance(fixed_radius: f64, poissons_ratio: f64, idealization: Idealization) -> f64 {
    // In plane stress u = A (1 - nu) r + B (1 + nu)/r and sigma_rr = A - B/r^2, with u(fixed_radius) = 0 and
    // sigma_rr(1) = -1; plane strain has nu/(1 - nu) and E/(1 - nu^2) in their place.
    let ratio = match idealization {
        Idealization::PlaneStress => poissons_ratio,
        Idealization::PlaneStrain => poissons_ratio / (1.0 - poissons_ratio),
    };
    let modulus = idealization.plane_modulus_ratio(poissons_ratio);
    let square = fixed_radius * fixed_radius;
    let width = ((fixed_radius - 1.0) * (fixed_radius + 1.0)).abs();
    (1.0 - ratio) * (1.0 + ratio) * width / ((1.0 + ratio) + (1.0 - ratio) * square) / modulus
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

/// |ln r| of walls, with the error of the work that interpolation between half angles leaves in a body of nu = 0.3 in plane
/// stress: the worst of 60 half angles from 0.06 to 92 deg, a quarter more (the test below measures it again).
const CURVE_ERRORS: [(f64, f64); 7] = [
    (THINNEST_RING, 6e-4),
    (0.03, 2.5e-4),
    (0.05, 5e-5),
    (0.08, 8e-6),
    (0.12, 1.2e-6),
    (0.2, 6e-8),
    (0.35, 3e-9),
];

/// Walls from this on leave less than 1e-5 whatever the material up to nu = 0.49.
pub const THIN: f64 = 0.15;

/// The error of the work that goes into a body at a contact half angle, rad, for its thin walls alone: of the bed, or
/// of interpolation between half angles.
pub fn thin_wall_error(body: &Body, half_angle: f64) -> f64 {
    let wall = body.depth_range().0;
    let flow = flow(body.poissons_ratio, body.idealization).abs();
    if wall < THINNEST_RING {
        // Of a parabola of pressure the term of g is 2.5 g (t/a)^2 of the energy and 1.5 of it in the force; wider contacts
        // have up to 2. The rest is what the ends of the contact do, 0.035 (t/a)^2 (tests/thin_walls.rs).
        return (2.0 * flow + 0.05) * (wall / half_angle).powi(2);
    }
    // Straight lines in the logarithms.
    let place = CURVE_ERRORS.windows(2).find(|pair| wall < pair[1].0);
    let Some([(from, at_from), (to, at_to)]) = place.map(|pair| [pair[0], pair[1]]) else { return 0.0 };
    let between = (wall / from).ln() / (to / from).ln();
    (1.0 + 1.5 * flow) * at_from * (at_to / at_from).powf(between)
}
