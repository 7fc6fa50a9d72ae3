//! A law for one pair of bodies. The one place where inputs and results of all laws are checked.

use std::ops::Bound::{Excluded, Included};

use super::law_error::{LawError, POSITIVE, check, finite};
use super::logarithmic::Logarithmic;
use super::pair::Pair;
use super::power::Power;
use super::wedge::Wedge;

/// Force against indentation, both zero at first touch and rising together. Units are those of the `Pair`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    law: &'static str,
    form: Form,
    indentation_limit: f64,
    force_limit: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    Logarithmic(Logarithmic),
    Power(Power),
    Wedge(Wedge),
}

impl Curve {
    /// The law's own limit of indentation, or the pin's radius where that is less: deeper, and the pin's centre has
    /// left the hole.
    pub(super) fn new(
        law: &'static str,
        pair: &Pair,
        form: Form,
        indentation_limit: f64,
    ) -> Result<Curve, LawError> {
        let own_limit = check(law, "indentation limit", indentation_limit, POSITIVE)?;
        let mut curve =
            Curve { law, form, indentation_limit: own_limit.min(pair.pin_radius), force_limit: 0.0 };
        curve.force_limit = check(law, "force limit", curve.form.force(curve.indentation_limit), POSITIVE)?;
        Ok(curve)
    }

    /// A logarithmic law; it ends where the indentation has its maximum.
    pub(super) fn logarithmic(
        law: &'static str,
        pair: &Pair,
        multiple: f64,
        constant: f64,
    ) -> Result<Curve, LawError> {
        check(law, "radial clearance", pair.radial_clearance, POSITIVE)?;
        let form = Logarithmic::new(pair.effective_modulus, pair.radial_clearance, multiple, constant);
        Curve::new(law, pair, Form::Logarithmic(form), form.largest_indentation())
    }

    /// The indentation where the law ends; it does not belong to the range.
    pub fn indentation_limit(&self) -> f64 {
        self.indentation_limit
    }

    /// The force per thickness where the law ends; it does not belong to the range.
    pub fn force_limit(&self) -> f64 {
        self.force_limit
    }

    /// F/t for 0 <= delta < `indentation_limit`.
    pub fn force_per_thickness(&self, indentation: f64) -> Result<f64, LawError> {
        // Finite, because the force only rises and `force_limit` is.
        Ok(self.form.force(self.allowed(indentation)?))
    }

    /// delta for 0 <= F/t < `force_limit`.
    pub fn indentation(&self, force_per_thickness: f64) -> Result<f64, LawError> {
        let allowed = (Included(0.0), Excluded(self.force_limit));
        let force = check(self.law, "force per thickness", force_per_thickness, allowed)?;
        if force == 0.0 {
            return Ok(0.0);
        }
        finite(self.law, "indentation", self.form.indentation(force))
    }

    /// (dF/d delta)/t for 0 <= delta < `indentation_limit`, the exact derivative of `force_per_thickness`.
    pub fn tangent_stiffness_per_thickness(&self, indentation: f64) -> Result<f64, LawError> {
        let indentation = self.allowed(indentation)?;
        finite(self.law, "tangent stiffness per thickness", self.form.tangent_stiffness(indentation))
    }

    fn allowed(&self, indentation: f64) -> Result<f64, LawError> {
        check(self.law, "indentation", indentation, (Included(0.0), Excluded(self.indentation_limit)))
    }
}

impl Form {
    fn force(&self, indentation: f64) -> f64 {
        match self {
            Form::Logarithmic(form) => form.force(indentation),
            Form::Power(form) => form.force(indentation),
            Form::Wedge(form) => form.force(indentation),
        }
    }

    fn indentation(&self, force: f64) -> f64 {
        match self {
            Form::Logarithmic(form) => form.indentation(force),
            Form::Power(form) => form.indentation(force),
            Form::Wedge(form) => form.indentation(force),
        }
    }

    fn tangent_stiffness(&self, indentation: f64) -> f64 {
        match self {
            Form::Logarithmic(form) => form.tangent_stiffness(indentation),
            Form::Power(form) => form.tangent_stiffness(indentation),
            Form::Wedge(form) => form.tangent_stiffness(indentation),
        }
    }
}
