//! Laws drawn beside the curve of a joint.

use crate::mechanics::laws::{LAWS, Pair};
use crate::study::design::JointDesign;

/// A law with its constants: what the report draws and judges.
pub struct DrawnLaw {
    pub name: String,
    /// N, at an indentation in mm; NaN outside the law's range.
    pub force: Box<dyn Fn(f64) -> f64>,
    /// Greatest relative misfit of the force over the range of the design's rows; infinite where the law ends before.
    pub worst_misfit: f64,
    /// Whether users should take this one.
    pub recommended: bool,
    /// Whether its constants were fitted to this joint.
    pub calibrated: bool,
}

/// Published laws, as far as they have a curve for these bodies, judged by points of the joint's own curve: indentation
/// and force.
pub fn published(joint: &JointDesign, points: &[(f64, f64)]) -> Vec<DrawnLaw> {
    let pair = Pair::new(
        joint.hole_radius,
        joint.radial_clearance,
        joint.thickness,
        &joint.pin.material,
        &joint.plate.material,
        joint.idealization,
    );
    let Ok(pair) = pair else { return Vec::new() };
    let thickness = joint.thickness;
    let drawn = LAWS.into_iter().filter_map(|law| {
        let curve = law.curve(&pair).ok()?;
        let force = move |indentation: f64| {
            curve.force_per_thickness(indentation).map_or(f64::NAN, |force| force * thickness)
        };
        let worst_misfit = worst(&force, points);
        Some(DrawnLaw {
            name: law.name.to_string(),
            force: Box::new(force),
            worst_misfit,
            recommended: false,
            calibrated: false,
        })
    });
    drawn.collect()
}

/// The greatest relative misfit; infinite where the law has no force.
pub fn worst(force: &dyn Fn(f64) -> f64, points: &[(f64, f64)]) -> f64 {
    let misfits = points.iter().map(|&(indentation, expected)| (force(indentation) / expected - 1.0).abs());
    misfits.fold(0.0, |worst, misfit| if misfit.is_nan() { f64::INFINITY } else { f64::max(worst, misfit) })
}
