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
//! plus for a hole and minus for a disc, whose sums are known in closed form (`infinite_body`); what is left of each
//! mode falls like (ratio of radii)^(-2 n).

use super::second_order::{Bands, bands};
use super::thin_wall::bed_compliance;
use super::{BodyCompliance, Boundary};
use crate::mechanics::body::{Body, Side, THINNEST_RING};
use crate::mechanics::material::Idealization;

/// A body between the ring (radius 1) and a concentric circle of radius `fixed_radius_ratio` on which it is fixed: above 1
/// for a plate, below 1 for a pin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConcentricBody {
    pub fixed_radius_ratio: f64,
    pub poissons_ratio: f64,
    pub idealization: Idealization,
}

/// Modes whose finite-size part is below this share of the mode are left out.
const NEGLIGIBLE: f64 = 1e-13;

/// The same of what counts by the clearance ratio squared.
const NEGLIGIBLE_SECOND: f64 = 1e-3;

/// Radial and shear stress on the ring: a pressure cos(n phi), and sin(n phi) along the ring.
type Stress = [f64; 2];
const PRESSURE: Stress = [-1.0, 0.0];
const SHEAR: Stress = [0.0, 1.0];

impl ConcentricBody {
    /// `None` where no concentric circle bounds the body.
    pub fn of(body: &Body) -> Option<ConcentricBody> {
        let Body { poissons_ratio, idealization, .. } = *body;
        body.fixed_radius_ratio().map(|fixed_radius_ratio| ConcentricBody {
            fixed_radius_ratio,
            poissons_ratio,
            idealization,
        })
    }

    fn side(&self) -> Side {
        if self.fixed_radius_ratio > 1.0 { Side::Plate } else { Side::Pin }
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

    /// lambda_n, and the amplitude of the displacement along the ring, u_phi = along sin(n phi), or those under shear, each less that of the same body with
    /// its fixed circle infinitely far (or small), n >= 2, free of cancellation.
    ///
    /// With x the amplitudes of the two fields that fall from the ring, y of the two that fall from the fixed circle, and
    /// q = (ratio of radii)^n what is left of them at the other circle,
    ///
    /// ```text
    ///   ring:   N x + q M y = t          fixed circle:   q P x + Q y = 0,
    /// ```
    ///
    /// so x = x0 + q^2 (N - q^2 S)^-1 S x0 with N x0 = t and S = M Q^-1 P.
    fn finite_part(&self, n: usize, stress: Stress) -> [f64; 2] {
        let (kappa, m) = (self.kolosov(), n as f64);
        let is_plate = self.side() == Side::Plate;
        let q = if is_plate { self.fixed_radius_ratio } else { 1.0 / self.fixed_radius_ratio }.powf(-m);
        // Nothing is left, and powers of radii like 1e300 are no numbers.
        if q < 1e-30 {
            return [0.0, 0.0];
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
        let (near_on_fixed, far_on_fixed) = displacements(self.fixed_radius_ratio);
        // y = -q R x.
        let reflection = product(inverse(far_on_fixed), near_on_fixed);
        let back = product(far, reflection);
        let alone = apply(inverse(near), stress);
        let square = q * q;
        let reduced: [[f64; 2]; 2] =
            std::array::from_fn(|i| std::array::from_fn(|j| near[i][j] - square * back[i][j]));
        let more = apply(inverse(reduced), apply(back, alone)).map(|value| square * value);
        let reflected = apply(reflection, [alone[0] + more[0], alone[1] + more[1]]);
        let (near, far) = (apply(near_on_ring, more), apply(far_on_ring, reflected));
        self.normal_and_along([near[0] - square * far[0], near[1] - square * far[1]])
    }

    /// From 2 mu times u_r and u_phi: a pressure pushes a hole outwards and a disc inwards.
    fn normal_and_along(&self, [radial, along]: [f64; 2]) -> [f64; 2] {
        let sign = if self.side() == Side::Plate { 1.0 } else { -1.0 };
        [sign * radial / self.twice_shear_modulus(), along / self.twice_shear_modulus()]
    }

    /// lambda_n of the body whose fixed circle is infinitely far (or small), n >= 2.
    pub fn far_mode(&self, n: usize) -> f64 {
        let (kappa, n) = (self.kolosov(), n as f64);
        let sign = if self.side() == Side::Plate { 1.0 } else { -1.0 };
        ((kappa + 1.0) * n + sign * (kappa - 1.0)) / (2.0 * self.twice_shear_modulus() * (n * n - 1.0))
    }

    /// The amplitude of u_phi of the body whose fixed circle is infinitely far (or small), n >= 2; of a disc.
    pub fn far_mode_along(&self, n: usize) -> f64 {
        let (kappa, n) = (self.kolosov(), n as f64);
        (kappa + 1.0 - (kappa - 1.0) * n) / (2.0 * self.twice_shear_modulus() * (n * n - 1.0))
    }

    /// lambda_1, and the amplitude of u_phi, or those under shear. The fields are r^3, the single-valued point force, 1/r and the translation;
    /// the first three have amplitudes A, L and D, and what the translation adds cancels in u_r + u_phi.
    fn first_mode(&self, stress: Stress) -> [f64; 2] {
        let kappa = self.kolosov();
        // Radial and shear stress on the ring: 2 A + (kappa + 3) L - 2 D and 2 A + (1 - kappa) L - 2 D.
        let point = 0.5 * (stress[0] - stress[1]) / (kappa + 1.0);
        let excess = 0.5 * ((1.0 - kappa) * point - stress[1]);
        // u_r + u_phi = 0 on the fixed circle: kappa A rho^2 - L + D/rho^2 = 0. A and A rho^2, without powers that overflow.
        let square = self.fixed_radius_ratio * self.fixed_radius_ratio;
        let [rising, risen] = match self.side() {
            Side::Plate => {
                let risen = (point - excess / square) / (kappa + 1.0 / square / square);
                [risen / square, risen]
            }
            Side::Pin => {
                let rising = (point * square - excess) / (kappa * square * square + 1.0);
                [rising, rising * square]
            }
        };
        // u_r - u_phi = 0 there: -4 A rho^2 + 4 kappa L ln rho + 2 T = 0.
        let translation = 2.0 * risen - 2.0 * kappa * point * self.fixed_radius_ratio.ln();
        let radial = (kappa - 1.0) * rising + excess - point + translation;
        let along = (kappa + 3.0) * rising + excess - point - translation;
        self.normal_and_along([radial, along])
    }

    /// The mean motion of the ring in the load's direction under a pressure cos(phi), the plate's along the load and the pin's
    /// against it, for Young's modulus 1. Only the first mode moves a ring: u_r = a cos(phi), u_phi = b sin(phi) have the mean
    /// displacement (a - b)/2 along the load line.
    pub fn mean_ring_motion(&self) -> f64 {
        let [normal, along] = self.first_mode(PRESSURE);
        match self.side() {
            Side::Plate => 0.5 * (normal - along),
            // The pressure pushes a disc inwards: u_r = -normal cos(phi).
            Side::Pin => 0.5 * (normal + along),
        }
    }

    /// Whether the body is so thin that it is taken for a Winkler bed, which needs no modes.
    fn is_bed(&self) -> bool {
        self.fixed_radius_ratio.ln().abs() < THINNEST_RING
    }

    /// The highest mode that `compliance` needs.
    pub fn modes_needed(&self) -> usize {
        if self.is_bed() { 0 } else { self.highest_mode() }
    }

    /// The highest mode that the fixed circle still reaches.
    pub fn highest_mode(&self) -> usize {
        let decay = 2.0 * self.fixed_radius_ratio.ln().abs();
        // The finite-size part falls like n^2 exp(-decay n); the square costs a few modes more.
        ((-NEGLIGIBLE.ln() + 4.0) / decay).ceil() as usize + 4
    }

    /// How the ring yields, of a thin wall as that of a bed.
    pub fn compliance(&self) -> BodyCompliance {
        if self.is_bed() {
            let bed = bed_compliance(self.fixed_radius_ratio, self.poissons_ratio, self.idealization);
            return BodyCompliance { even: 0.0, odd: 0.0, boundary: Boundary::Bed(bed), second: Vec::new() };
        }
        let even = self.amplitude();
        let kappa = self.kolosov();
        let sign = if self.side() == Side::Plate { 1.0 } else { -1.0 };
        let odd = sign * even * (kappa - 1.0) / (kappa + 1.0);
        let [normal, mut along] = self.boundary_modes();
        let mut second = Vec::new();
        match self.side() {
            Side::Pin => second = self.bands(&normal, &along),
            Side::Plate => along.clear(),
        }
        BodyCompliance { even, odd, boundary: Boundary::Modes { normal, along }, second }
    }

    /// What the fixed circle changes of each mode, as far as it is felt: of lambda_n, half of it for n = 0, and of the amplitude of
    /// u_phi.
    pub fn boundary_modes(&self) -> [Vec<f64>; 2] {
        self.modes_below(self.highest_mode() + 1)
    }

    /// The first of those.
    fn modes_below(&self, count: usize) -> [Vec<f64>; 2] {
        let mode = |n: usize| match n {
            0 => [0.5 * bed_compliance(self.fixed_radius_ratio, self.poissons_ratio, self.idealization), 0.0],
            1 => {
                let [normal, along] = self.first_mode(PRESSURE);
                [normal - self.amplitude(), along]
            }
            _ => self.finite_part(n, PRESSURE),
        };
        let (normal, along) = (0..count).map(mode).map(|[normal, along]| (normal, along)).unzip();
        [normal, along]
    }

    /// What the fixed circle of a pin adds to second order; nothing of a bed.
    pub fn second_order(&self) -> Vec<Bands> {
        if self.is_bed() {
            return Vec::new();
        }
        let [normal, along] = self.modes_below(self.second_order_count());
        self.bands(&normal, &along)
    }

    /// As many as `second_order` has.
    pub fn second_order_count(&self) -> usize {
        let decay = 2.0 * self.fixed_radius_ratio.ln().abs();
        ((-NEGLIGIBLE_SECOND.ln() + 4.0) / decay).ceil() as usize + 2
    }

    fn bands(&self, normal: &[f64], along: &[f64]) -> Vec<Bands> {
        let count = self.second_order_count();
        let mode = |n: usize| match n {
            0 => 0.0,
            1 => self.first_mode(SHEAR)[1] - self.amplitude(),
            _ => self.finite_part(n, SHEAR)[1],
        };
        let shear: Vec<f64> = (0..count).map(mode).collect();
        bands([normal, along, &shear], count)
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
