//! What a program that uses the library needs: a joint, its curve, and what is on it.

use crate::engine::joint_curve::JointCurve;
use crate::engine::joint_stresses::{CircleStresses, NoStresses};
use crate::engine::material_shares::{self, MaterialShare};
use crate::engine::outcome::{Response, StepOutcome};
use crate::engine::status::Status;
use crate::engine::threads::common_pool;
use crate::error::Error;
use crate::mechanics::body::Side;
use crate::mechanics::material::Idealization;
use crate::study::columns::side_name;
use crate::study::config::{MethodChoice, SolveOptions};
use crate::study::design::{JointDesign, Load, Part};

/// A joint that can be: every constructor has checked it.
#[derive(Clone, Debug)]
pub struct Joint(JointDesign);

/// Sizes of a joint, mm.
#[derive(Clone, Copy, Debug)]
pub struct Dimensions {
    pub hole_radius: f64,
    /// Hole radius less pin radius; 0 is a neat fit, less a press fit.
    pub radial_clearance: f64,
    pub thickness: f64,
}

impl Joint {
    /// Of a pin in a plate. An error says which value is impossible, and what is allowed.
    pub fn new(
        dimensions: Dimensions,
        idealization: Idealization,
        pin: Part,
        plate: Part,
    ) -> Result<Joint, Error> {
        let Dimensions { hole_radius, radial_clearance, thickness } = dimensions;
        Joint::try_from(JointDesign { idealization, hole_radius, radial_clearance, thickness, pin, plate })
    }

    pub fn design(&self) -> &JointDesign {
        &self.0
    }

    /// Solves its bodies; from then on any load costs microseconds.
    pub fn curve(&self, options: Options) -> Result<Curve, Error> {
        self.curve_after(None, options)
    }

    /// The same after the curve of another joint: bodies that both joints have are not solved again.
    pub(crate) fn curve_after(&self, before: Option<Curve>, options: Options) -> Result<Curve, Error> {
        if !(options.accuracy > 0.0 && options.accuracy < 1.0) {
            let problem = format!("{}: must be above 0 and below 1", options.accuracy);
            return Err(Error::Joint { quantity: "accuracy".into(), problem });
        }
        if options.method == MethodChoice::ClosedForm {
            let problem = "a closed form has no curve of the joint; see `mechanics::laws`".into();
            return Err(Error::Joint { quantity: "method".into(), problem });
        }
        common_pool()?;
        match JointCurve::after(before.map(|curve| curve.0), &self.0, options) {
            Ok(curve) => Ok(Curve(curve)),
            Err(failure) => Err(Error::Joint { quantity: String::new(), problem: failure.to_string() }),
        }
    }
}

impl TryFrom<JointDesign> for Joint {
    type Error = Error;

    fn try_from(design: JointDesign) -> Result<Joint, Error> {
        design.check()?;
        Ok(Joint(design))
    }
}

/// How a joint is to be solved: the relative error of the force, and by which method.
pub type Options = SolveOptions;

/// The curve of one joint: one smooth function of the load.
pub struct Curve(JointCurve);

impl Curve {
    pub fn joint(&self) -> Joint {
        Joint(self.0.joint().clone())
    }

    /// Answers with their status to loads, as rows of a table have them. Press fits have no indentation.
    pub fn answers(&self, loads: &[Load]) -> Result<Vec<StepOutcome>, Error> {
        self.check(loads)?;
        Ok(self.0.answers(loads))
    }

    /// Whether loads can be.
    fn check(&self, loads: &[Load]) -> Result<(), Error> {
        for load in loads {
            let quantity = match load {
                Load::Indentation(_) => "indentation",
                Load::Offset(_) => "offset",
                Load::Force(_) => "force",
            };
            let value = load.value();
            if matches!(load, Load::Indentation(_)) && self.0.joint().is_press_fit() {
                let problem = format!("{value}: a press fit has none; give an offset or a force");
                return Err(Error::Joint { quantity: quantity.into(), problem });
            }
            if !(value >= 0.0 && value.is_finite()) {
                let problem = format!("{value}: must be 0 or more, and finite");
                return Err(Error::Joint { quantity: quantity.into(), problem });
            }
        }
        Ok(())
    }

    /// The state under a load; an error where there is none.
    pub fn at(&self, load: Load) -> Result<Response, Error> {
        let step = self.answers(&[load])?.pop();
        let (response, status) = step.map_or((None, Status::OK), |step| (step.response, step.status));
        response.ok_or_else(|| Error::Joint { quantity: format!("{load}"), problem: status.to_string() })
    }

    /// N, at an indentation in mm.
    pub fn force(&self, indentation: f64) -> Result<f64, Error> {
        Ok(self.at(Load::Indentation(indentation))?.force)
    }

    /// mm, under a force in N.
    pub fn indentation(&self, force: f64) -> Result<f64, Error> {
        Ok(self.at(Load::Force(force))?.indentation)
    }

    /// dF/d delta, N/mm, at an indentation in mm.
    pub fn tangent_stiffness(&self, indentation: f64) -> Result<f64, Error> {
        Ok(self.at(Load::Indentation(indentation))?.tangent_stiffness)
    }

    /// The offset up to which a press fit stays closed all around, mm; `None` of joints with clearance.
    pub fn opening(&self) -> Option<f64> {
        self.0.opening()
    }

    /// Stresses under a load on circles of one side, from the contact on: the contact, each interface from both of its sides, the circle that is held, and those
    /// at further depths below the contact, mm, where there is room. Points are from the load line to the far side. Exact for concentric parts, of others to the accuracy of the curve,
    /// over the greatest. Empty before the bodies touch; an error where the load has no state, or no mesh tells the stresses so well.
    pub fn stresses(
        &self,
        side: Side,
        load: Load,
        points: usize,
        depths: &[f64],
    ) -> Result<Vec<CircleStresses>, Error> {
        self.at(load)?;
        self.0
            .stresses(side, load, points, depths)
            .map_err(|problem| no_stresses(self.0.joint().part(side), problem))
    }

    /// The contact pressure from the load line to where it ends: angles at the hole's centre, rad, and MPa per area of the hole.
    pub fn pressure(&self, load: Load, points: usize) -> Result<Vec<(f64, f64)>, Error> {
        self.at(load)?;
        Ok(self.0.pressure(load, points))
    }
}

fn no_stresses(part: &Part, problem: NoStresses) -> Error {
    let problem = format!("`{}`: {problem}", part.shape.name);
    Error::Joint { quantity: side_name(part.shape.side).into(), problem }
}

/// How much of the strain energy and of the force each material of a joint decides under loads (mm or N, not negative; press fits have
/// no indentation), the pin's first: `None` where a load has no answer, empty where it presses nothing.
pub fn material_shares(
    joint: &Joint,
    loads: &[Load],
    options: Options,
) -> Result<Vec<Option<Vec<MaterialShare>>>, Error> {
    let curve = joint.curve(options)?;
    curve.check(loads)?;
    Ok(material_shares::material_shares(curve.0, loads))
}

/// Answers to loads on a joint, with their status.
pub fn solve(joint: &Joint, loads: &[Load], options: Options) -> Result<Vec<StepOutcome>, Error> {
    joint.curve(options)?.answers(loads)
}
