//! The contact pressures that are tried: a contact half angle, and on it Chebyshev polynomials over the square-root
//! singularity of a punch.
//!
//! With b = tan(eps/2), s = tan(phi/2)/b = cos(tau), the trial pressures are
//!
//! ```text
//!   p_k d(phi) = cos(2 k tau) d(tau) = T_2k(s)/sqrt(1 - s^2) ds,      k = 0, 1, ... terms - 1.
//! ```
//!
//! Their sum of coefficients is the strength of the edge singularity; contact with a free edge is where it vanishes.
//! In this basis the logarithmic kernel of plane elasticity is diagonal up to rank two, and every other integral is
//! smooth. All quantities are functions of eps alone; they are interpolated between Chebyshev nodes in sqrt(eps).

use std::f64::consts::{FRAC_PI_2, PI};

use crate::mechanics::element::quadrature::gauss_legendre;
use crate::mechanics::real::{LANES, Lanes, Real};

/// The most trial pressures a space may have.
pub const MAX_TERMS: usize = 24;

/// Counts of trial pressures there is compiled code for.
pub const TERM_CHOICES: [usize; 3] = [10, 16, MAX_TERMS];

/// Nodes in eps between which compliances are interpolated.
pub const NODE_COUNT: usize = 32;

/// Geometry of one contact half angle.
#[derive(Clone, Copy, Debug)]
pub struct ContactArc {
    /// Contact half angle, rad.
    pub half_angle: f64,
    /// b = tan(eps/2).
    pub b: f64,
    /// t = tan(atan(b)/2): 1 + b^2 cos^2(tau) = (1 + 2 t^2 cos(2 tau) + t^4)/(1 - t^2)^2.
    t: f64,
}

impl ContactArc {
    pub fn new(half_angle: f64) -> ContactArc {
        let b = (0.5 * half_angle).tan();
        ContactArc { half_angle, b, t: b / (1.0 + (1.0 + b * b).sqrt()) }
    }

    /// phi at tau.
    pub fn angle(&self, tau: f64) -> f64 {
        2.0 * (self.b * tau.cos()).atan()
    }

    /// tau at phi, 0 at and beyond the edge.
    pub fn tau(&self, angle: f64) -> f64 {
        ((0.5 * angle).tan() / self.b).min(1.0).acos()
    }

    /// Integral of p_k over the half arc: pi/2 for k = 0, else 0.
    pub fn resultant(k: usize) -> f64 {
        if k == 0 { FRAC_PI_2 } else { 0.0 }
    }

    /// Integrals of p_k (1 - cos phi) for k = 0, 1, ...: pi [delta_k0 - (-t^2)^k/sqrt(1 + b^2)], free of cancellation.
    #[inline(always)]
    pub fn versines<T: Real, const TERMS: usize>(b: T) -> [T; TERMS] {
        let (one, pi) = (T::from_f64(1.0), T::from_f64(PI));
        let root = (one + b * b).sqrt();
        let t = b / (one + root);
        let ratio = -(t * t);
        let mut next = -(pi / root) * ratio;
        let mut versines = [pi * b * b / (root * (one + root)); TERMS];
        for versine in &mut versines[1..] {
            *versine = next;
            next = next * ratio;
        }
        versines
    }

    /// Galerkin matrix of the kernel sum over n >= 1 of (2/pi) cos(n phi) cos(n phi')/n, less its -pi/2 ln b in (0, 0).
    ///
    /// From ln|2 cos phi - 2 cos phi'| = ln|s^2 - s'^2| + 2 ln b + ln 4 - ln(1 + b^2 s^2) - ln(1 + b^2 s'^2).
    fn logarithm(&self, j: usize, k: usize) -> f64 {
        let fourier = |i: usize| {
            let q = -self.t * self.t;
            if i == 0 {
                -2.0 * FRAC_PI_2 * (1.0 - self.t * self.t).ln()
            } else {
                -FRAC_PI_2 * q.powi(i as i32) / i as f64
            }
        };
        let mut sum = 0.0;
        if j == k {
            sum += if k == 0 {
                PI * FRAC_PI_2 * (0.5_f64).ln() + 4.0_f64.ln() * FRAC_PI_2 * FRAC_PI_2
            } else {
                -PI * PI / (8.0 * k as f64)
            };
        }
        if k == 0 {
            sum -= FRAC_PI_2 * fourier(j);
        }
        if j == 0 {
            sum -= FRAC_PI_2 * fourier(k);
        }
        -sum / PI
    }
}

/// Entries of the lower triangle of a symmetric `terms` x `terms` matrix.
pub const fn packed_count(terms: usize) -> usize {
    terms * (terms + 1) / 2
}

/// Position of (row, column), row >= column, in the packed lower triangle. It does not depend on the count of terms,
/// so a space of fewer terms is a prefix of one of more.
pub const fn packed(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// Trial pressures at the nodes in eps, with all that does not depend on the body.
pub struct PressureSpace {
    pub terms: usize,
    /// The largest contact half angle, rad.
    pub limit: f64,
    /// The arcs at the nodes.
    pub arcs: Vec<ContactArc>,
    /// Galerkin matrices of the kernels sum of (2/pi) cos(n phi) cos(n phi') f(n), packed, one row a node:
    /// f = 1/n over n >= 1 (less its -pi/2 ln b), ...
    pub logarithm: Vec<f64>,
    /// ... f = 1/(n (n^2 - 1)) over n >= 2, ...
    pub cubic: Vec<f64>,
    /// ... f = 1/(n^2 - 1) over n >= 2.
    pub quadratic: Vec<f64>,
    weights: Vec<f64>,
    abscissae: Vec<f64>,
}

/// Points, beyond one for each trial pressure, of the rules for the two kernels: with more of them nothing changes
/// by more than 1e-12.
const SMOOTH_RULE: usize = 22;
const KINK_RULE: usize = 22;

impl PressureSpace {
    /// `terms` trial pressures on arcs up to `limit` (rad, below pi).
    pub fn new(terms: usize, limit: f64) -> PressureSpace {
        let count = NODE_COUNT as f64;
        let angle = |i: usize| PI * (i as f64 + 0.5) / count;
        let abscissae: Vec<f64> = (0..NODE_COUNT).map(|i| 0.5 * (1.0 + angle(i).cos())).collect();
        let weights =
            (0..NODE_COUNT).map(|i| if i % 2 == 0 { angle(i).sin() } else { -angle(i).sin() }).collect();
        let arcs: Vec<ContactArc> = abscissae.iter().map(|x| ContactArc::new(limit * x * x)).collect();
        let entries = packed_count(terms);
        let mut space = PressureSpace {
            terms,
            limit,
            logarithm: Vec::with_capacity(NODE_COUNT * entries),
            cubic: Vec::with_capacity(NODE_COUNT * entries),
            quadratic: Vec::with_capacity(NODE_COUNT * entries),
            arcs,
            weights,
            abscissae,
        };
        let logarithmic = logarithmic_rule(2 * (SMOOTH_RULE + terms));
        let kinked = gauss_legendre(KINK_RULE + terms);
        for arc in space.arcs.clone() {
            for row in 0..terms {
                for column in 0..=row {
                    space.logarithm.push(arc.logarithm(row, column));
                }
            }
            space.cubic.extend(cubic_kernel(&arc, terms, &logarithmic));
            space.quadratic.extend(quadratic_kernel(&arc, terms, &kinked));
        }
        space
    }

    /// Interpolation weights of the nodes at half angles side by side; those of each lane sum to one.
    #[inline(always)]
    pub fn interpolation<const FUSED: bool>(&self, half_angles: [f64; LANES]) -> [Lanes<FUSED>; NODE_COUNT] {
        let x = Lanes(half_angles.map(|half_angle| (half_angle / self.limit).sqrt()));
        let mut weights = [Lanes::zero(); NODE_COUNT];
        let mut sum = Lanes::zero();
        for (i, weight) in weights.iter_mut().enumerate() {
            *weight = Lanes::from_f64(self.weights[i]) / (x - Lanes::from_f64(self.abscissae[i]));
            sum += *weight;
        }
        for weight in &mut weights {
            *weight = *weight / sum;
        }
        for lane in (0..LANES).filter(|lane| sum.0[*lane].is_infinite()) {
            // On a node itself.
            for (weight, abscissa) in weights.iter_mut().zip(&self.abscissae) {
                weight.0[lane] = if *abscissa == x.0[lane] { 1.0 } else { 0.0 };
            }
        }
        weights
    }

    /// Moments m_kn = integral of p_k cos(n phi) at every node for n = 0 ... `highest`: `[node][n][k]`.
    pub fn moments(&self, highest: usize) -> Vec<f64> {
        let mut moments = vec![0.0; NODE_COUNT * (highest + 1) * self.terms];
        for (arc, moments) in self.arcs.iter().zip(moments.chunks_exact_mut((highest + 1) * self.terms)) {
            // Block by block, so that a moment does not depend on how many are asked for.
            for (block, moments) in moments.chunks_mut(MODE_BLOCK * self.terms).enumerate() {
                self.add_moments(arc, block * MODE_BLOCK, moments);
            }
        }
        moments
    }

    /// Adds the moments from mode `first` on, `[n][k]`.
    fn add_moments(&self, arc: &ContactArc, first: usize, moments: &mut [f64]) {
        // The integrand is analytic and has period pi in tau, so the midpoint rule converges exponentially once it
        // resolves the fastest wave, which has n eps/2 periods.
        let fastest = (first + MODE_BLOCK) as f64;
        let points = 24 + self.terms + (0.5 * fastest * arc.half_angle) as usize;
        let weight = FRAC_PI_2 / points as f64;
        for i in 0..points {
            let tau = (i as f64 + 0.5) * weight;
            let trials = cosines((2.0 * tau).cos());
            let angle = arc.angle(tau);
            let turn = 2.0 * angle.cos();
            let mut wave = (first as f64 * angle).cos();
            let mut previous = ((first as f64 - 1.0) * angle).cos();
            for row in moments.chunks_exact_mut(self.terms) {
                let scale = weight * wave;
                row.iter_mut().zip(&trials).for_each(|(moment, trial)| *moment += scale * trial);
                (wave, previous) = (turn * wave - previous, wave);
            }
        }
    }
}

/// Modes whose moments share a quadrature rule.
const MODE_BLOCK: usize = 64;

/// cos(k x) for k = 0 ... `MAX_TERMS` - 1 from cos x.
pub fn cosines(cosine: f64) -> [f64; MAX_TERMS] {
    let (mut value, mut previous) = (1.0, cosine);
    std::array::from_fn(|_| {
        let current = value;
        (value, previous) = (2.0 * cosine * value - previous, value);
        current
    })
}

/// Weights for integrals of ln|cos tau - cos tau'| f(tau') over tau' in (0, pi) by the values of f at the midpoints of
/// `count` equal steps, exact for f = cos(k tau'), k < count (R. Kress, Linear Integral Equations, sect. 12.3):
/// `[node of tau][node of tau']`.
fn logarithmic_rule(count: usize) -> Vec<f64> {
    let step = PI / count as f64;
    let cosine = |i: usize, k: usize| ((i as f64 + 0.5) * step * k as f64).cos();
    let table: Vec<f64> = (0..count * count).map(|i| cosine(i / count, i % count)).collect();
    let wave = |node: usize| &table[node * count..(node + 1) * count];
    let weight = |i: usize, j: usize| {
        let sum: f64 = (1..count).map(|k| wave(i)[k] * wave(j)[k] / k as f64).sum();
        -step * (2.0_f64.ln() + 2.0 * sum)
    };
    (0..count * count).map(|i| weight(i / count, i % count)).collect()
}

/// Galerkin matrix, packed, of the sum over n >= 2 of cos(n theta)/(n (n^2 - 1))
/// = (1 - cos theta) ln(2 sin(theta/2)) - 1/2 + 3/4 cos theta.
///
/// With x = tan(phi/2) = b s and g = 1/(1 + x^2): 1 - cos theta = 2 b^2 (s - s')^2 g g', and
/// ln(2 sin(theta/2)) = ln|s - s'| + ln(2 b) + ln(g)/2 + ln(g')/2, so all but ln|s - s'| is smooth.
fn cubic_kernel(arc: &ContactArc, terms: usize, rule: &[f64]) -> Vec<f64> {
    let count = rule.len().isqrt();
    let step = PI / count as f64;
    let nodes: Vec<(f64, f64, f64)> = (0..count)
        .map(|i| {
            let s = ((i as f64 + 0.5) * step).cos();
            let g = 1.0 / (1.0 + arc.b * arc.b * s * s);
            (s, g, 0.5 * g.ln())
        })
        .collect();
    let trials: Vec<[f64; MAX_TERMS]> = nodes.iter().map(|(s, ..)| cosines(2.0 * s * s - 1.0)).collect();
    let mut matrix = vec![0.0; packed_count(terms)];
    let double = (2.0 * arc.b).ln();
    for (i, (s, g, ln_g)) in nodes.iter().enumerate() {
        let mut potential = [0.0; MAX_TERMS];
        for (j, (other, other_g, other_ln_g)) in nodes.iter().enumerate() {
            let versine = 2.0 * (arc.b * (s - other)).powi(2) * g * other_g;
            let smooth = versine * (double + ln_g + other_ln_g) + 0.25 - 0.75 * versine;
            let weight = versine * rule[i * count + j] + smooth * step;
            potential.iter_mut().zip(&trials[j]).for_each(|(sum, trial)| *sum += weight * trial);
        }
        for row in 0..terms {
            for column in 0..=row {
                // Half of the integral over tau in (0, pi).
                matrix[packed(row, column)] += 0.5 * step / PI * trials[i][row] * potential[column];
            }
        }
    }
    matrix
}

/// Galerkin matrix, packed, of the sum over n >= 2 of cos(n theta)/(n^2 - 1)
/// = 1/2 + 1/4 cos theta - (pi - theta)/2 sin theta, 0 <= theta <= 2 pi, which has a kink on the diagonal.
///
/// For each tau the integral over tau' in (0, pi) is taken on both sides of the kink. sin(theta/2) = |x - x'|/h,
/// cos(theta/2) = (1 + x x')/h, h^2 = (1 + x^2)(1 + x'^2).
fn quadratic_kernel(arc: &ContactArc, terms: usize, rule: &[(f64, f64)]) -> Vec<f64> {
    let mut matrix = vec![0.0; packed_count(terms)];
    for &(point, outer_weight) in rule {
        let tau = 0.5 * FRAC_PI_2 * (1.0 + point);
        let x = arc.b * tau.cos();
        let mut potential = [0.0; MAX_TERMS];
        for (start, end) in [(0.0, tau), (tau, PI)] {
            for &(point, weight) in rule {
                let other = (0.5 * (start + end) + 0.5 * (end - start) * point).cos();
                let y = arc.b * other;
                let scale = 1.0 / ((1.0 + x * x) * (1.0 + y * y)).sqrt();
                let (sine, cosine) = ((x - y).abs() * scale, (1.0 + x * y) * scale);
                let theta = 2.0 * sine.atan2(cosine);
                let kernel = 0.75 - 0.5 * sine * sine - (PI - theta) * sine * cosine;
                let weight = 0.5 * (end - start) * weight * kernel;
                let trials = cosines(2.0 * other * other - 1.0);
                potential.iter_mut().zip(&trials).for_each(|(sum, trial)| *sum += weight * trial);
            }
        }
        let trials = cosines((2.0 * tau).cos());
        for row in 0..terms {
            for column in 0..=row {
                // Symmetric but for the quadrature: take the mean.
                let product = trials[row] * potential[column] + trials[column] * potential[row];
                matrix[packed(row, column)] += 0.25 * FRAC_PI_2 / PI * outer_weight * product;
            }
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kernels against their own series, summed to where the remainder is below the tolerance.
    #[test]
    fn kernels_equal_their_series() {
        let space = PressureSpace::new(4, 2.0);
        let highest = 2000;
        let moments = space.moments(highest);
        let entries = packed_count(4);
        for node in [0, 9, 15] {
            for row in 0..4 {
                for column in 0..=row {
                    let term = |n: usize, k: usize| moments[(node * (highest + 1) + n) * 4 + k];
                    let sum = |weight: &dyn Fn(f64) -> f64, first: usize| -> f64 {
                        (first..=highest)
                            .map(|n| 2.0 / PI * weight(n as f64) * term(n, row) * term(n, column))
                            .sum()
                    };
                    let at = node * entries + packed(row, column);
                    let cubic = sum(&|n| 1.0 / (n * (n * n - 1.0)), 2);
                    let quadratic = sum(&|n| 1.0 / (n * n - 1.0), 2);
                    // What the series leave out beyond the highest mode: their terms fall like n^-4, n^-3.
                    assert!(
                        (space.cubic[at] - cubic).abs() < 1e-8,
                        "cubic {row},{column}: {} {cubic}",
                        space.cubic[at]
                    );
                    assert!(
                        (space.quadratic[at] - quadratic).abs() < 1e-6,
                        "quadratic {row},{column}: {} {quadratic}",
                        space.quadratic[at]
                    );
                    let arc = space.arcs[node];
                    let log = space.logarithm[at] - if row == 0 { FRAC_PI_2 * arc.b.ln() } else { 0.0 };
                    let series = sum(&|n| 1.0 / n, 1);
                    // These fall like n^-2: 2/(pi eps highest) is left.
                    assert!(
                        (log - series).abs() < 1e-3,
                        "log {row},{column} at {}: {log} {series}",
                        arc.half_angle
                    );
                }
            }
        }
    }

    #[test]
    fn versine_equals_its_integral() {
        let arc = ContactArc::new(1.3);
        let versines: [f64; 5] = ContactArc::versines(arc.b);
        for (k, versine) in versines.iter().enumerate() {
            let sum: f64 = gauss_legendre(40)
                .iter()
                .map(|(x, w)| {
                    let tau = 0.5 * FRAC_PI_2 * (1.0 + x);
                    0.5 * FRAC_PI_2 * w * (2.0 * k as f64 * tau).cos() * (1.0 - arc.angle(tau).cos())
                })
                .sum();
            assert!((versine - sum).abs() < 1e-14, "k = {k}");
        }
    }
}
