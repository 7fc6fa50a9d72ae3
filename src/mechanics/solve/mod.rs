//! K u = f: `cholesky`, `pcg` and, in mixed precision, `refine` for one body and many right-hand sides, stored one
//! after the other; `band` for many bodies of one topology and loads on their rings alone.

pub mod cholesky;
pub mod pcg;
pub mod refine;
pub mod band;
