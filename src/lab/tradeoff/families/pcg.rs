//! The meshes of a sweep condensed by conjugate gradients, by the residual they are stopped at: what the kernels of a GPU
//! do, on the processor.

use crate::lab::tradeoff::choice::{Choice, Family, Scope};
use crate::lab::tradeoff::families::cholesky::ring_path;
use crate::lab::tradeoff::ring_mesh::{Numbers, RingSolver};

pub static F64: Family =
    Family { name: "pcg-f64", about: "PCG f64, level 2", parameter: "relative residual" };

/// Without the variational correction.
pub static F64_PLAIN: Family = Family {
    name: "pcg-f64-uncorrected",
    about: "PCG f64, level 2, no variational correction",
    parameter: "relative residual",
};

pub static F32: Family =
    Family { name: "pcg-f32", about: "PCG f32, level 2", parameter: "relative residual" };

pub static MIXED: Family =
    Family { name: "pcg-mixed", about: "PCG f32 refined in f64, level 2", parameter: "relative residual" };

/// Fine enough that the mesh does not hide what the tolerance does.
const LEVEL: usize = 2;

pub fn in_f64<'a>(family: &Family, _: &Scope<'a>) -> Vec<Choice<'a>> {
    choices(family, Numbers::F64, true)
}

pub fn in_f64_plain<'a>(family: &Family, _: &Scope<'a>) -> Vec<Choice<'a>> {
    choices(family, Numbers::F64, false)
}

pub fn in_f32<'a>(family: &Family, _: &Scope<'a>) -> Vec<Choice<'a>> {
    choices(family, Numbers::F32, true)
}

pub fn in_mixed<'a>(family: &Family, _: &Scope<'a>) -> Vec<Choice<'a>> {
    choices(family, Numbers::Mixed, true)
}

fn choices<'a>(family: &Family, numbers: Numbers, corrected: bool) -> Vec<Choice<'a>> {
    let choice = |decade: i32| {
        let tolerance = 10f64.powi(-decade);
        let path = ring_path(LEVEL, RingSolver::Pcg { numbers, tolerance, corrected });
        family.choice(format!("residual {tolerance:.0e}"), Some(tolerance), move |cases| path.solve(cases))
    };
    (1..=8).map(choice).collect()
}
