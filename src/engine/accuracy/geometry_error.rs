//! What the geometry of the model leaves of a force: outlines to second order in the clearance, and displacements that are small.
//! No mesh mends either.

use std::f64::consts::FRAC_PI_6;

use crate::engine::outcome::Response;
use crate::mechanics::body::THINNEST_RING;
use crate::mechanics::contact::outlines::Outlines;
use crate::study::design::JointDesign;

/// Of the clearance ratio cubed; less in narrow contacts, below 30 deg. Half of 300 joints have less than a tenth of it, none of those
/// without rubber more (docs/theory.md, section 10; `tests/mechanics/geometry.rs`).
pub const OF_CUBE: f64 = 0.5;
pub const OF_SINE: f64 = 2.0;

/// What pushes along the skin of a pin shears its wall: this of the clearance ratio cubed, times the pin's share, sin^2 of the half
/// angle, and by how much a wall resists squeezing more than shear. Of pins whose wall is thicker than `WALL` radii of the core,
/// |ln r|, the less the thicker it is.
pub const OF_SHEAR: f64 = 0.04;
pub const WALL: f64 = std::f64::consts::LN_2;
/// More than that resistance no wall of the joints seen had: it yields along itself.
pub const STIFFEST: f64 = 40.0;

/// Of the clearance ratio squared, where second order is not known: times the share of a pin that is not concentric, and as `OF_SHEAR` of
/// walls that are taken for beds.
pub const OF_HELD: f64 = 0.1;
const OF_BED: f64 = 0.16;

/// From this clearance ratio on a row says so, whatever is left.
pub const WIDEST_CLEARANCE: f64 = 0.5;

/// Relative error of a joint's force by the outlines being those of second order in the clearance.
pub struct OutlineError {
    /// In wide contacts.
    of_all: f64,
    /// Per sin^2 of the half angle.
    of_shear: f64,
}

impl OutlineError {
    /// The shares of the work are taken for those of the moduli.
    pub fn of(joint: &JointDesign, outlines: &Outlines) -> OutlineError {
        let of_pin = joint.share_of_pin();
        let kappa = joint.idealization.kolosov(joint.pin.contact_material().poissons_ratio);
        let resistance = ((kappa + 1.0) / (kappa - 1.0)).min(STIFFEST);
        let body = joint.body(&joint.pin);
        let depth = body.nearest_depth();
        let wall = (2.0 * (WALL - depth)).exp().min(1.0);
        let of_wall = of_pin * resistance * wall;
        let (ratio, square) = (outlines.radial_clearance, outlines.square());
        let [all, shear] = if !body.shape.concentric {
            [OF_HELD * of_pin, 0.0]
        } else if depth < THINNEST_RING && body.lining.is_empty() {
            [0.0, OF_BED * of_wall]
        } else {
            [0.0, ratio * OF_SHEAR * of_wall]
        };
        OutlineError { of_all: square * (ratio * OF_CUBE + all), of_shear: square * shear }
    }

    /// Of wide contacts, and per sin^2 of the half angle.
    pub fn numbers(&self) -> [f64; 2] {
        [self.of_all, self.of_shear]
    }

    /// At a contact half angle, rad.
    pub fn at(&self, half_angle: f64) -> f64 {
        let sine = half_angle.sin();
        let of_width = if half_angle < FRAC_PI_6 { OF_SINE * sine } else { 1.0 };
        of_width * (self.of_all + self.of_shear * sine * sine)
    }
}

/// Of `linearity_error`, by which laws that agree at small strain differ from it and from each other.
pub const OF_STRAIN: f64 = 2.0;

/// Estimated relative difference of the force from laws of finite displacement and strain (docs/theory.md, section 10).
pub fn linearity_error(joint: &JointDesign, response: &Response) -> f64 {
    let softest = joint.pin.least_modulus().min(joint.plate.least_modulus());
    let displacement = response.indentation / joint.hole_radius;
    OF_STRAIN * displacement.max(response.peak_pressure.unwrap_or(0.0) / softest)
}

/// Below this no row remarks on it.
pub const LARGE_DISPLACEMENT: f64 = 0.01;
