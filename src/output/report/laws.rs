//! Laws drawn beside the curve of a joint.

use crate::engine::ladder::Ladder;
use crate::engine::law_fit::laws_of_all;
use crate::engine::outcome::DesignLaws;
use crate::mechanics::compliance::near_field::InCommon;
use crate::mechanics::laws::LAWS;
use crate::study::config::{MethodChoice, SolveOptions};
use crate::study::design::{DesignCase, JointDesign};

/// A law with its constants: what the report draws and judges.
pub struct DrawnLaw {
    pub name: String,
    /// N, at an indentation in mm; NaN outside the law's range.
    pub force: Box<dyn Fn(f64) -> f64>,
    /// Greatest relative misfit of the force: of a calibrated law over its own range, of a published one over the range of
    /// the design's rows; infinite where the law ends before.
    pub worst_misfit: f64,
    /// As text to paste; empty where there is none.
    pub formula: String,
    /// Whether users should take this one.
    pub recommended: bool,
    /// Whether its constants were fitted to this joint.
    pub calibrated: bool,
}

/// Laws calibrated to a joint that works between two indentations, mm, as `jointsweep laws` has them; and why one of them
/// is recommended.
pub fn calibrated(
    joint: &JointDesign,
    working: (f64, f64),
    options: SolveOptions,
) -> (Vec<DrawnLaw>, Option<&'static str>) {
    if options.method == MethodChoice::ClosedForm {
        return (Vec::new(), None);
    }
    let case = DesignCase { index: 0, joint: joint.clone(), steps: Vec::new().into() };
    let mut ladder = Ladder::new(options).sharing(InCommon::ALL);
    let found = laws_of_all(&mut ladder, &[(&case, Some(working))]).pop();
    let DesignLaws { laws, recommended, .. } = found.unwrap_or_default();
    let drawn = laws.into_iter().enumerate().map(|(place, law)| {
        let (low, high) = law.range;
        let [worst_misfit, _] = law.force_misfit;
        let (name, formula) = (law.law.name.to_string(), law.formula());
        let inside = (low * (1.0 - 1e-6))..=(high * (1.0 + 1e-6));
        let force = move |indentation: f64| {
            if inside.contains(&indentation) { law.force(indentation) } else { f64::NAN }
        };
        let recommended = recommended.is_some_and(|(best, _)| best == place);
        DrawnLaw { name, force: Box::new(force), worst_misfit, formula, recommended, calibrated: true }
    });
    (drawn.collect(), recommended.map(|(_, why)| why))
}

/// Published laws, as far as they have a curve for these bodies, judged by points of the joint's own curve: indentation
/// and force.
pub fn published(joint: &JointDesign, points: &[(f64, f64)]) -> Vec<DrawnLaw> {
    let Ok(pair) = joint.pair() else { return Vec::new() };
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
            formula: String::new(),
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
