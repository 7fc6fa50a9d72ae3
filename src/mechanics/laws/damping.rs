//! Dissipation in impact laws: F (1 + lambda v/v0), F elastic, v the speed of indentation, v0 that at first touch.
//!
//! lambda depends on the coefficient of restitution alone, e = - (speed after)/(speed before).

use std::ops::Bound::{Excluded, Included};

use super::law_error::{LawError, check, finite};

/// The factor lambda as four papers give it; all tend to zero for e -> 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damping {
    /// 3 (1 - e^2)/4, for e near 1: H. M. Lankarani & P. E. Nikravesh, J. Mechanical Design 112 (1990) 369-376.
    LankaraniNikravesh,
    /// 3 (1 - e)/2, for e near 1: K. H. Hunt & F. R. E. Crossley, J. Applied Mechanics 42 (1975) 440-445.
    HuntCrossley,
    /// (1 - e^2)/e, for every e > 0: Y. Gonthier et al., Multibody System Dynamics 11 (2004) 209-233.
    Gonthier,
    /// 8 (1 - e)/(5 e), for every e > 0: P. Flores et al., Multibody System Dynamics 25 (2011) 357-375.
    Flores,
}

impl Damping {
    pub const ALL: [Damping; 4] =
        [Damping::LankaraniNikravesh, Damping::HuntCrossley, Damping::Gonthier, Damping::Flores];

    pub fn name(self) -> &'static str {
        match self {
            Damping::LankaraniNikravesh => "lankarani-nikravesh",
            Damping::HuntCrossley => "hunt-crossley",
            Damping::Gonthier => "gonthier",
            Damping::Flores => "flores",
        }
    }

    /// lambda for 0 <= e <= 1; Gonthier's and Flores's are infinite at e = 0, which they exclude.
    pub fn factor(self, restitution: f64) -> Result<f64, LawError> {
        let lower = match self {
            Damping::LankaraniNikravesh | Damping::HuntCrossley => Included(0.0),
            Damping::Gonthier | Damping::Flores => Excluded(0.0),
        };
        let e = check(self.name(), "coefficient of restitution", restitution, (lower, Included(1.0)))?;
        let factor = match self {
            Damping::LankaraniNikravesh => 0.75 * (1.0 - e) * (1.0 + e),
            Damping::HuntCrossley => 1.5 * (1.0 - e),
            Damping::Gonthier => (1.0 - e) * (1.0 + e) / e,
            Damping::Flores => 1.6 * (1.0 - e) / e,
        };
        finite(self.name(), "damping factor", factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The restitution that F (1 + lambda v/v0) really has. With m v dv = - F (1 + lambda v/v0) d delta the elastic
    /// law drops out: u - ln(1 + lambda u)/lambda at u = 1 equals the same at u = - e. Bisection for e.
    fn restitution(lambda: f64) -> f64 {
        let side = |u: f64| u - (lambda * u).ln_1p() / lambda;
        let (mut low, mut high) = (0.0, 1.0f64.min(1.0 / lambda));
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if side(-middle) < side(1.0) { low = middle } else { high = middle }
        }
        low
    }

    #[test]
    fn the_dissipation_is_the_one_asked_for_when_it_is_small() {
        // To first order 1 - e = 2 lambda/3; the two first-order factors are right there, Gonthier's (4/3) and
        // Flores's (16/15) trade that limit for the strongly damped end. 0.02: the next order at 1 - e = 0.01.
        let ratio = |damping: Damping| (1.0 - restitution(damping.factor(0.99).unwrap())) / 0.01;
        assert!((ratio(Damping::LankaraniNikravesh) - 1.0).abs() < 0.02);
        assert!((ratio(Damping::HuntCrossley) - 1.0).abs() < 0.02);
        assert!((ratio(Damping::Gonthier) - 4.0 / 3.0).abs() < 0.02);
        assert!((ratio(Damping::Flores) - 16.0 / 15.0).abs() < 0.02);
    }

    #[test]
    fn only_the_later_two_reach_a_dead_stop() {
        // At e = 0.05 the first two still rebound with more than 0.3, the others within 0.05 of what was asked.
        for damping in Damping::ALL {
            let rebound = restitution(damping.factor(0.05).unwrap());
            match damping {
                Damping::LankaraniNikravesh | Damping::HuntCrossley => assert!(rebound > 0.3, "{rebound}"),
                Damping::Gonthier | Damping::Flores => assert!((rebound - 0.05).abs() < 0.05, "{rebound}"),
            }
        }
    }

    #[test]
    fn limits_and_refusals() {
        let at = |e: f64| Damping::ALL.map(|damping| damping.factor(e).ok());
        assert_eq!(at(1.0), [Some(0.0); 4]);
        assert_eq!(at(0.0), [Some(0.75), Some(1.5), None, None]);
        for e in [f64::NAN, f64::INFINITY, -0.1, 1.1] {
            assert_eq!(at(e), [None; 4], "e = {e}");
        }
        assert!(matches!(Damping::Gonthier.factor(0.0), Err(LawError::OutOfRange { .. })));
        // e so small that 1/e overflows is an error too, not an infinity.
        assert!(matches!(Damping::Flores.factor(1e-310), Err(LawError::NotFinite { .. })));
    }
}
