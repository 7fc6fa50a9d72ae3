//! The state of a joint at one contact half angle, and what can be read from its pressure.

use crate::mechanics::compliance::arc::{ContactArc, MAX_TERMS};

/// Tension that truncation may leave at the edge, over the peak pressure.
const TENSION: f64 = 0.01;

/// The joint at one contact half angle, whole joint (both halves), per unit thickness, hole radius 1, and per unit of
/// the centres' offset e; forces in the unit of the moduli.
#[derive(Clone, Copy, Debug)]
pub struct ArcState {
    pub arc: ContactArc,
    /// delta/e: 0 without load, 1 for a neat fit.
    pub indentation: f64,
    /// F/e.
    pub force: f64,
    /// dF/d delta.
    pub tangent_stiffness: f64,
    /// Strain energy of both bodies over e^2.
    pub energy: f64,
    pub(super) terms: usize,
    /// Coefficients of the trial pressures over e.
    pub(super) pressure: [f64; MAX_TERMS],
}

impl ArcState {
    /// The last two trial pressures over the largest, squared: of that order is what leaving out further ones costs in
    /// the force.
    pub fn truncation(&self) -> f64 {
        let tail = self.pressure[self.terms - 2..self.terms].iter().map(|c| c.abs()).sum::<f64>();
        let most = self.pressure[..self.terms].iter().fold(f64::MIN_POSITIVE, |most, c| most.max(c.abs()));
        (tail / most).powi(2)
    }

    /// dR/e; negative beyond the angle of a neat fit, where no clearance reaches.
    pub fn clearance(&self) -> f64 {
        1.0 - self.indentation
    }

    /// Contact pressure over e at the load line.
    pub fn peak_pressure(&self) -> f64 {
        let alternating =
            |sum: f64, (k, value): (usize, &f64)| if k % 2 == 0 { sum + value } else { sum - value };
        self.pressure[..self.terms].iter().enumerate().fold(0.0, alternating) / (2.0 * self.arc.b)
    }

    /// Whether there is no tension: looked at between the zeros of the highest trial pressure.
    pub fn pressure_is_positive(&self) -> bool {
        // p(tau) > 0 where the sum of c_k cos(2 k tau) is; at tau = i pi/(2 count) each cosine is one of 2 count.
        let count = 2 * self.terms;
        let turn = 2.0 * (std::f64::consts::PI / count as f64).cos();
        let mut cosines = [0.0; 4 * MAX_TERMS];
        (cosines[0], cosines[1]) = (1.0, 0.5 * turn);
        for i in 2..2 * count {
            cosines[i] = turn * cosines[i - 1] - cosines[i - 2];
        }
        let series = |i: usize| -> f64 {
            let mut turned = 0;
            let terms = self.pressure[..self.terms].iter().map(|c| {
                let term = c * cosines[turned];
                turned += i;
                turned -= if turned >= 2 * count { 2 * count } else { 0 };
                term
            });
            terms.sum()
        };
        let least = -TENSION * series(count);
        (1..=count).all(|i| series(i) >= least)
    }

    /// Contact pressure over e at tau, 0 < tau <= pi/2; phi = `arc.angle(tau)`.
    pub fn pressure_at(&self, tau: f64) -> f64 {
        let series: f64 = self.pressure[..self.terms]
            .iter()
            .enumerate()
            .map(|(k, c)| c * (2.0 * k as f64 * tau).cos())
            .sum();
        let s = self.arc.b * tau.cos();
        series * (1.0 + s * s) / (2.0 * self.arc.b * tau.sin())
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    /// A state with the first of so many terms; the rest is of no account.
    fn state(terms: usize, pressure: &[f64]) -> ArcState {
        let mut padded = [0.0; MAX_TERMS];
        padded[..pressure.len()].copy_from_slice(pressure);
        ArcState {
            arc: ContactArc::new(1.2),
            indentation: 0.25,
            force: f64::NAN,
            tangent_stiffness: f64::NAN,
            energy: f64::NAN,
            terms,
            pressure: padded,
        }
    }

    /// 1 - cos(2 tau) is a pressure without singularity; its integral is pi/2 c_0 and its value at the load line the peak.
    #[test]
    fn the_pressure_has_its_resultant_and_its_peak() {
        let state = state(2, &[1.0, -1.0]);
        assert!((state.pressure_at(FRAC_PI_2) / state.peak_pressure() - 1.0).abs() < 1e-15);
        assert!((state.peak_pressure() * state.arc.b - 1.0).abs() < 1e-15);
        // Midpoints in tau, differences of the angle: the error falls as the square of the count.
        let count = 2000;
        let step = FRAC_PI_2 / f64::from(count);
        let piece = |i: i32| {
            let tau = f64::from(i) * step;
            let width = state.arc.angle(tau) - state.arc.angle(tau + step);
            state.pressure_at(tau + 0.5 * step) * width
        };
        let resultant: f64 = (0..count).map(piece).sum();
        assert!((resultant / (0.5 * PI) - 1.0).abs() < 1e-6, "{resultant}");
    }

    /// Tension below a percent of the peak is what truncation leaves; 2 % near the edge, or any at the load line, is not.
    #[test]
    fn tension_is_found_wherever_it_is() {
        let positive = |pressure: &[f64]| state(10, pressure).pressure_is_positive();
        assert!(positive(&[1.0, -1.0]) && positive(&[1.0, -1.03]) && positive(&[1.0, 0.5, 0.2]));
        assert!(!positive(&[1.0, -1.05]));
        assert!(!positive(&[1.0, 1.5]));
        // 1 + 2 cos(4 tau): between edge and load line.
        assert!(!positive(&[1.0, 0.0, 2.0]));
    }

    #[test]
    fn truncation_is_the_square_of_the_tail() {
        assert!((state(4, &[0.5, -2.0, 0.1, -0.3]).truncation() - 0.04).abs() < 1e-15);
        assert!((state(4, &[0.5, -2.0, 0.1, -0.3]).clearance() - 0.75).abs() < 1e-15);
    }
}
