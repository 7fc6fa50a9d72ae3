//! `series`: the exact compliance of rotationally symmetric bodies, mode by mode.
//!
//! A pressure p_n cos(n phi) on the ring of an annulus or a cored disc, its other boundary fixed, gives the normal
//! displacement lambda_n p_n cos(n phi). With Kolosov's constant kappa the fields of mode n are Michell's (J. R.
//! Barber, Elasticity, tables 8.1 and 9.1). Where the fixed boundary is far, lambda_n tends to
//!
//! ```text
//!   lambda_n = c [n +- beta]/(n^2 - 1),   c = (kappa + 1)/(4 mu),   beta = (kappa - 1)/(kappa + 1),
//! ```
//!
//! plus for a hole and minus for a disc, whose sums are known in closed form (`PressureSpace`); what is left of each
//! mode falls like (ratio of radii)^(-2 n).

use std::f64::consts::PI;

use super::arc::{packed, packed_count};
use super::pressure_space::PressureSpace;
use super::{NODE_COUNT, PressureCompliance};
use crate::mechanics::body::Side;
use crate::mechanics::material::Idealization;

/// A body between the ring (radius 1) and a concentric circle of radius `fixed_radius` on which it is fixed: above 1
/// for a plate, below 1 for a pin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConcentricBody {
    pub fixed_radius: f64,
    pub poissons_ratio: f64,
    pub idealization: Idealization,
}

/// Modes whose finite-size part is below this share of the mode are left out.
const NEGLIGIBLE: f64 = 1e-17;

impl ConcentricBody {
    fn side(&self) -> Side {
        if self.fixed_radius > 1.0 { Side::Plate } else { Side::Pin }
    }

    /// 2 mu for Young's modulus 1.
    fn twice_shear_modulus(&self) -> f64 {
        1.0 / (1.0 + self.poissons_ratio)
    }

    fn kolosov(&self) -> f64 {
        self.idealization.kolosov(self.poissons_ratio)
    }

    /// c, the amplitude of the logarithmic kernel, for Young's modulus 1: 2/E'.
    pub fn amplitude(&self) -> f64 {
        (self.kolosov() + 1.0) / (2.0 * self.twice_shear_modulus())
    }

    /// lambda_n of the body whose fixed circle is infinitely far (or small), n >= 2.
    fn far_mode(&self, n: usize) -> f64 {
        let (kappa, n) = (self.kolosov(), n as f64);
        let sign = if self.side() == Side::Plate { 1.0 } else { -1.0 };
        ((kappa + 1.0) * n + sign * (kappa - 1.0)) / (2.0 * self.twice_shear_modulus() * (n * n - 1.0))
    }

    /// lambda_n for Young's modulus 1: displacement of the ring away from the other body per unit pressure.
    pub fn mode(&self, n: usize) -> f64 {
        let sign = if self.side() == Side::Plate { 1.0 } else { -1.0 };
        let (ring, fixed) = (self.fields(n, 1.0), self.fields(n, self.fixed_radius));
        // Rows: radial and shear stress on the ring, then the two displacements on the fixed circle.
        let amplitudes =
            solve([ring.radial_stress, ring.shear_stress, fixed.radial, fixed.hoop], [-1.0, 0.0, 0.0, 0.0]);
        let displacement: f64 = amplitudes.iter().zip(&ring.radial).map(|(a, u)| a * u).sum();
        sign * displacement / self.twice_shear_modulus()
    }

    /// The highest mode that the fixed circle still reaches.
    pub fn highest_mode(&self) -> usize {
        let decay = 2.0 * self.fixed_radius.ln().abs();
        // The finite-size part falls like n^2 exp(-decay n); the square costs a few modes more.
        ((-NEGLIGIBLE.ln() + 4.0) / decay).ceil() as usize + 4
    }

    /// 2 mu u and stresses of the four fields of mode n at radius r; those that grow with the radius are scaled to
    /// the larger of the two circles, those that fall to the smaller, so that no power overflows.
    fn fields(&self, n: usize, r: f64) -> Fields {
        let kappa = self.kolosov();
        let (large, small) = (self.fixed_radius.max(1.0), self.fixed_radius.min(1.0));
        if n == 0 {
            // r^2 and ln r; the hoop equations are empty and get two fields that only they see.
            let (g, d) = (r / large, small / r);
            return Fields {
                radial: [(kappa - 1.0) * g, d, 0.0, 0.0],
                hoop: [0.0, 0.0, 1.0, 0.0],
                radial_stress: [2.0 / large, -d / r, 0.0, 0.0],
                shear_stress: [0.0, 0.0, 0.0, 1.0],
            };
        }
        if n == 1 {
            // r^3 cos, the single-valued point force, 1/r, and the translation.
            let (g, d) = (r * r / (large * large), small * small / (r * r));
            let log = 2.0 * kappa * r.ln();
            return Fields {
                radial: [(kappa - 2.0) * g, log - 1.0, d, 1.0],
                hoop: [(kappa + 2.0) * g, -log - 1.0, d, -1.0],
                radial_stress: [2.0 * g / r, (kappa + 3.0) / r, -2.0 * d / r, 0.0],
                shear_stress: [2.0 * g / r, (1.0 - kappa) / r, -2.0 * d / r, 0.0],
            };
        }
        // r^(n+2), r^(2-n), r^n, r^(-n).
        let m = n as f64;
        let (g, d) = ((r / large).powi(n as i32), (small / r).powi(n as i32));
        let [rising, falling, rising_low, falling_low] = [g * r, d * r, g / r, d / r];
        Fields {
            radial: [
                (kappa - m - 1.0) * rising,
                (kappa + m - 1.0) * falling,
                -m * rising_low,
                m * falling_low,
            ],
            hoop: [(kappa + m + 1.0) * rising, -(kappa - m + 1.0) * falling, m * rising_low, m * falling_low],
            radial_stress: [
                -(m + 1.0) * (m - 2.0) * rising / r,
                -(m - 1.0) * (m + 2.0) * falling / r,
                -m * (m - 1.0) * rising_low / r,
                -m * (m + 1.0) * falling_low / r,
            ],
            shear_stress: [
                m * (m + 1.0) * rising / r,
                -m * (m - 1.0) * falling / r,
                m * (m - 1.0) * rising_low / r,
                -m * (m + 1.0) * falling_low / r,
            ],
        }
    }

    /// The exact Galerkin compliance at the nodes of `space`. `moments` are `space.moments(highest)` with `highest`
    /// at least `highest_mode()`.
    pub fn compliance(&self, space: &PressureSpace, moments: &[f64], highest: usize) -> PressureCompliance {
        let terms = space.terms;
        let entries = packed_count(terms);
        let amplitude = self.amplitude();
        let kappa = self.kolosov();
        let beta = (kappa - 1.0) / (kappa + 1.0) * if self.side() == Side::Plate { 1.0 } else { -1.0 };
        let mut values: Vec<f64> = (0..NODE_COUNT * entries)
            .map(|i| amplitude * (space.logarithm[i] + space.cubic[i] + beta * space.quadratic[i]))
            .collect();
        for n in 0..=self.highest_mode().min(highest) {
            let finite = match n {
                0 => 0.5 * self.mode(0),
                1 => self.mode(1) - amplitude,
                _ => self.mode(n) - self.far_mode(n),
            } * (2.0 / PI);
            for node in 0..NODE_COUNT {
                let at = (node * (highest + 1) + n) * terms;
                let moment = &moments[at..at + terms];
                let matrix = &mut values[node * entries..(node + 1) * entries];
                for row in 0..terms {
                    for column in 0..=row {
                        matrix[packed(row, column)] += finite * moment[row] * moment[column];
                    }
                }
            }
        }
        PressureCompliance { terms, amplitude, values }
    }
}

/// 2 mu u_r, 2 mu u_theta, sigma_rr and sigma_r_theta of the four fields of a mode at one radius.
struct Fields {
    radial: [f64; 4],
    hoop: [f64; 4],
    radial_stress: [f64; 4],
    shear_stress: [f64; 4],
}

/// Solves four equations by elimination with full pivoting after scaling every row to one; a unit that a singular
/// system would need is left at zero.
fn solve(mut rows: [[f64; 4]; 4], mut right: [f64; 4]) -> [f64; 4] {
    for (row, right) in rows.iter_mut().zip(&mut right) {
        let scale = row.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        if scale > 0.0 {
            row.iter_mut().for_each(|value| *value /= scale);
            *right /= scale;
        }
    }
    let mut order = [0, 1, 2, 3];
    for step in 0..4 {
        let candidates = (step..4).flat_map(|row| (step..4).map(move |column| (row, column)));
        let pivot = candidates.max_by(|a, b| rows[a.0][a.1].abs().total_cmp(&rows[b.0][b.1].abs()));
        let Some((pivot_row, pivot_column)) = pivot else { continue };
        rows.swap(step, pivot_row);
        right.swap(step, pivot_row);
        rows.iter_mut().for_each(|row| row.swap(step, pivot_column));
        order.swap(step, pivot_column);
        if rows[step][step] == 0.0 {
            continue;
        }
        for row in step + 1..4 {
            let factor = rows[row][step] / rows[step][step];
            for column in step..4 {
                rows[row][column] -= factor * rows[step][column];
            }
            right[row] -= factor * right[step];
        }
    }
    let mut solution = [0.0; 4];
    for step in (0..4).rev() {
        let known: f64 = (step + 1..4).map(|column| rows[step][column] * solution[order[column]]).sum();
        if rows[step][step] != 0.0 {
            solution[order[step]] = (right[step] - known) / rows[step][step];
        }
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: f64 = 0.3;

    fn body(fixed_radius: f64, idealization: Idealization) -> ConcentricBody {
        ConcentricBody { fixed_radius, poissons_ratio: STEEL, idealization }
    }

    /// Lame, plane stress, outer circle fixed: u = (1 - nu^2)(rho^2 - 1)/(rho^2 (1 + nu) + (1 - nu))... from
    /// sigma_rr = A - B/r^2, u = A (1 - nu) r + B (1 + nu)/r, u(rho) = 0, sigma_rr(1) = -1.
    #[test]
    fn mode_zero_is_lame() {
        for ratio in [1.02, 3.0, 1e4] {
            let q = (1.0 - STEEL) * ratio * ratio / (1.0 + STEEL);
            let a = -1.0 / (1.0 + q);
            let exact = a * (1.0 - STEEL) - a * q * (1.0 + STEEL);
            let mode = body(ratio, Idealization::PlaneStress).mode(0);
            assert!((mode / exact - 1.0).abs() < 1e-12, "ratio {ratio}: {mode} {exact}");
        }
    }

    /// High modes do not feel the fixed circle.
    #[test]
    fn high_modes_tend_to_the_far_modes() {
        for fixed_radius in [0.05, 0.95, 1.05, 40.0] {
            for idealization in Idealization::ALL {
                let body = body(fixed_radius, idealization);
                let n = body.highest_mode();
                assert!((body.mode(n) / body.far_mode(n) - 1.0).abs() < 1e-12, "{fixed_radius}, mode {n}");
                assert!(
                    (body.mode(n / 8) / body.far_mode(n / 8) - 1.0).abs() > 1e-9,
                    "{fixed_radius}, mode {}",
                    n / 8
                );
            }
        }
    }
}
