//! What choices are compared with: the exact modes where both bodies have them, else a mesh finer than any choice's.

use crate::engine::body_request::Fidelity;
use crate::lab::tradeoff::answer::States;
use crate::lab::tradeoff::families::series::solve;
use crate::lab::tradeoff::joints::{Terms, is_concentric};
use crate::mechanics::compliance::arc::MAX_TERMS;
use crate::mechanics::grading::REFERENCE_LEVEL;
use crate::study::design::DesignCase;

/// The best answers there are, and what they rest on.
pub struct Oracle {
    pub states: States,
    /// Designs by exact modes and `MAX_TERMS` trial pressures.
    pub by_series: usize,
    /// Designs on the mesh of `REFERENCE_LEVEL`.
    pub by_mesh: usize,
}

impl Oracle {
    pub fn new(cases: &[DesignCase]) -> Oracle {
        let (exact, meshed): (Vec<DesignCase>, Vec<DesignCase>) =
            cases.iter().cloned().partition(|case| is_concentric(&case.joint));
        let mut of_exact = solve(Terms::Fixed(MAX_TERMS), Fidelity::Series, &exact).states.into_iter();
        let fidelity = Fidelity::Mesh { level: REFERENCE_LEVEL };
        let mut of_meshed = solve(Terms::ByDepth, fidelity, &meshed).states.into_iter();
        let states = cases.iter().map(|case| {
            let own = if is_concentric(&case.joint) { of_exact.next() } else { of_meshed.next() };
            own.unwrap_or_default()
        });
        Oracle { states: states.collect(), by_series: exact.len(), by_mesh: meshed.len() }
    }
}
