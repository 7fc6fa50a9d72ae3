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
//! plus for a hole and minus for a disc, whose sums are known in closed form (`kernels`); what is left of each
//! mode falls like (ratio of radii)^(-2 n).

use super::thin_wall::bed_compliance;
use super::{BodyCompliance, Boundary};
use crate::mechanics::body::{Side, THINNEST_RING};
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

    /// lambda_n less that of the same body with its fixed circle infinitely far (or small), n >= 2, free of cancellation.
    ///
    /// With x the amplitudes of the two fields that fall from the ring, y of the two that fall from the fixed circle, and
    /// q = (ratio of radii)^n what is left of them at the other circle,
    ///
    /// ```text
    ///   ring:   N x + q M y = t          fixed circle:   q P x + Q y = 0,
    /// ```
    ///
    /// so x = x0 + q^2 (N - q^2 S)^-1 S x0 with N x0 = t and S = M Q^-1 P.
    fn finite_part(&self, n: usize) -> f64 {
        let (kappa, m) = (self.kolosov(), n as f64);
        let is_plate = self.side() == Side::Plate;
        let q = if is_plate { self.fixed_radius } else { 1.0 / self.fixed_radius }.powf(-m);
        // Nothing is left, and powers of radii like 1e300 are no numbers.
        if q < 1e-30 {
            return 0.0;
        }
        // Radial and hoop displacement of the fields r^(n+2), r^n and of r^(2-n), r^-n, their powers n taken out.
        let displacements = |r: f64| {
            let rising = [[(kappa - m - 1.0) * r, -m / r], [(kappa + m + 1.0) * r, m / r]];
            let falling = [[(kappa + m - 1.0) * r, m / r], [(m - 1.0 - kappa) * r, m / r]];
            if is_plate { (falling, rising) } else { (rising, falling) }
        };
        // Radial and shear stress on the ring.
        let rising = [[-(m + 1.0) * (m - 2.0), -m * (m - 1.0)], [m * (m + 1.0), m * (m - 1.0)]];
        let falling = [[-(m - 1.0) * (m + 2.0), -m * (m + 1.0)], [-m * (m - 1.0), -m * (m + 1.0)]];
        let (near, far) = if is_plate { (falling, rising) } else { (rising, falling) };
        let (near_on_ring, far_on_ring) = displacements(1.0);
        let (near_on_fixed, far_on_fixed) = displacements(self.fixed_radius);
        // y = -q R x.
        let reflection = product(inverse(far_on_fixed), near_on_fixed);
        let back = product(far, reflection);
        let alone = apply(inverse(near), [-1.0, 0.0]);
        let square = q * q;
        let reduced: [[f64; 2]; 2] =
            std::array::from_fn(|i| std::array::from_fn(|j| near[i][j] - square * back[i][j]));
        let more = apply(inverse(reduced), apply(back, alone)).map(|value| square * value);
        let reflected = apply(reflection, [alone[0] + more[0], alone[1] + more[1]]);
        let radial = |rows: [[f64; 2]; 2], x: [f64; 2]| rows[0][0] * x[0] + rows[0][1] * x[1];
        let sign = if is_plate { 1.0 } else { -1.0 };
        sign * (radial(near_on_ring, more) - square * radial(far_on_ring, reflected))
            / self.twice_shear_modulus()
    }

    /// lambda_n of the body whose fixed circle is infinitely far (or small), n >= 2.
    pub fn far_mode(&self, n: usize) -> f64 {
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

    /// Whether the body is so thin that it is taken for a Winkler bed, which needs no modes.
    fn is_bed(&self) -> bool {
        self.fixed_radius.ln().abs() < THINNEST_RING
    }

    /// The highest mode that `compliance` needs.
    pub fn modes_needed(&self) -> usize {
        if self.is_bed() { 0 } else { self.highest_mode() }
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
            let (g, d) = ((r / large).powi(2), (small / r).powi(2));
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

    /// How the ring yields, of a thin wall as that of a bed.
    pub fn compliance(&self) -> BodyCompliance {
        if self.is_bed() {
            let bed = bed_compliance(self.fixed_radius, self.poissons_ratio, self.idealization);
            return BodyCompliance { even: 0.0, odd: 0.0, boundary: Boundary::Bed(bed) };
        }
        let even = self.amplitude();
        let kappa = self.kolosov();
        let sign = if self.side() == Side::Plate { 1.0 } else { -1.0 };
        let odd = sign * even * (kappa - 1.0) / (kappa + 1.0);
        BodyCompliance { even, odd, boundary: Boundary::Modes(self.boundary_modes()) }
    }

    /// What the fixed circle changes of each mode, as far as it is felt; half of it for mode 0.
    pub fn boundary_modes(&self) -> Vec<f64> {
        let mode = |n: usize| match n {
            0 => 0.5 * self.mode(0),
            1 => self.mode(1) - self.amplitude(),
            _ => self.finite_part(n),
        };
        (0..=self.highest_mode()).map(mode).collect()
    }
}

fn product(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

fn apply(a: [[f64; 2]; 2], x: [f64; 2]) -> [f64; 2] {
    a.map(|row| row[0] * x[0] + row[1] * x[1])
}

fn inverse([[a, b], [c, d]]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let determinant = a * d - b * c;
    [[d / determinant, -b / determinant], [-c / determinant, a / determinant]]
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

    /// Against the four equations at once, where their difference still has digits.
    #[test]
    fn finite_parts_are_what_the_fixed_circle_changes() {
        for fixed_radius in [0.01, 0.5, 0.95, 1.02, 3.0, 1e4] {
            for idealization in Idealization::ALL {
                for poissons_ratio in [-0.9, 0.3, 0.4999] {
                    let body = ConcentricBody { fixed_radius, poissons_ratio, idealization };
                    for n in 2..40 {
                        let (mode, far) = (body.mode(n), body.far_mode(n));
                        let error = (body.finite_part(n) - (mode - far)).abs() / far;
                        assert!(error < 1e-11, "{body:?}, mode {n}: {error:e}");
                    }
                }
            }
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
