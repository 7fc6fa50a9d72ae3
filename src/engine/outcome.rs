//! What one load step of one design came to. mm, N, MPa.

use crate::engine::status::{Failure, Status};
use crate::mechanics::laws::calibrated::FittedLaw;
use crate::study::design::DesignCase;

/// How a number was found, cheapest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    ClosedForm,
    Series,
    /// Between bodies solved by one of the others.
    Interpolated,
    Fe,
}

impl Method {
    /// The name in configs and tables.
    pub fn name(self) -> &'static str {
        match self {
            Method::ClosedForm => "closed-form",
            Method::Series => "series",
            Method::Interpolated => "interpolated",
            Method::Fe => "fe",
        }
    }
}

/// What has computed a design.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BackendKind {
    Cpu,
    Gpu,
}

impl BackendKind {
    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            BackendKind::Cpu => "cpu",
            BackendKind::Gpu => "gpu",
        }
    }
}

/// The state of contact after one load step. Everything is for the whole joint (both halves, times thickness).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// mm; of press fits the offset and the overlap, e + |dR|.
    pub indentation: f64,
    /// Of the pin from where pin and hole are concentric, of press fits from where they are at rest, e, mm: the clearance and the indentation.
    pub offset: f64,
    /// N.
    pub force: f64,
    /// dF/d delta, N/mm.
    pub tangent_stiffness: f64,
    /// Where the pressure vanishes, at the hole's centre, from the load line, rad; `None` where the method does not say.
    pub contact_half_angle: Option<f64>,
    /// The greatest, MPa, per area of the hole; `None` where the method does not say.
    pub peak_pressure: Option<f64>,
    /// Where that is, at the hole's centre from the load line, rad; `None` where the method does not say.
    pub peak_pressure_angle: Option<f64>,
    /// Strain energy of both bodies, mJ; `None` where the method does not say.
    pub energy: Option<f64>,
    /// Estimated relative error of the force, displacements being small.
    pub force_error: f64,
    /// Estimated relative difference of the force from laws of finite displacement; `None` where the method does not say.
    pub linearity_error: Option<f64>,
    pub method: Method,
}

/// One row of the table: a response with remarks, or why there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct StepOutcome {
    /// `None` where the status is a failure, and only there.
    pub response: Option<Response>,
    pub status: Status,
}

impl StepOutcome {
    pub fn failed(failure: Failure) -> StepOutcome {
        StepOutcome { response: None, status: Status::Failed(failure.into()) }
    }
}

/// An outcome for each step of a design, in order.
#[derive(Clone, Debug)]
pub struct Answer {
    pub backend: BackendKind,
    pub steps: Vec<StepOutcome>,
}

/// The laws of one design.
#[derive(Clone, Debug, Default)]
pub struct DesignLaws {
    pub laws: Vec<FittedLaw>,
    /// Which of them to take, and why.
    pub recommended: Option<(usize, &'static str)>,
    /// dF/d delta of ever larger loads, N/mm: that of a neat fit.
    pub stiffness_of_large_loads: Option<f64>,
    /// C of small loads, delta = F/(pi E* t) [ln(E* t dR/F) + C].
    pub small_load_constant: Option<f64>,
    /// Why there are no laws.
    pub missing: Option<&'static str>,
}

impl DesignLaws {
    pub fn missing(why: &'static str) -> DesignLaws {
        DesignLaws { missing: Some(why), ..DesignLaws::default() }
    }
}

/// A design with its answer.
#[derive(Clone, Debug)]
pub struct DesignOutcome {
    pub case: DesignCase,
    pub backend: BackendKind,
    pub steps: Vec<StepOutcome>,
    /// `None` where they were not asked for.
    pub laws: Option<Box<DesignLaws>>,
}

impl DesignOutcome {
    pub fn new(case: DesignCase, Answer { backend, steps }: Answer) -> DesignOutcome {
        DesignOutcome { case, backend, steps, laws: None }
    }
}
