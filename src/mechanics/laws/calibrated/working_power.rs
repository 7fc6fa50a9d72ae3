//! F = k delta^n over the decade up to the greatest load of the design: for programs that take no other law.

use super::power::{fit, formula, value};
use super::{CalibratedLaw, Samples};

pub static LAW: CalibratedLaw = CalibratedLaw {
    name: "power-decade",
    outside: "goes on as a power: not to be used outside its decade",
    constants: &["k", "n"],
    range: Samples::working_decade,
    fit,
    value,
    formula,
};
