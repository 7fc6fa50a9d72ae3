//! K u = f for one body and many right-hand sides, stored one after the other.

pub mod cholesky;
pub mod pcg;
