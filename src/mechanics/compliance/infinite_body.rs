//! Galerkin matrices of the infinitely extended bodies: the kernels sum of (2/pi) cos(n phi) cos(n phi') f(n) in the
//! trial pressures, in closed form, one arc a lane; and what the tilt of a pin's pressure adds, to first and second order.
//!
//! Half the range suffices: pressures are even, so that for tau in (0, pi/2) the other point goes over (0, pi).

use std::f64::consts::{FRAC_PI_2, PI};

use super::arc::{ContactArc, MAX_TERMS, cosines, packed, packed_count};
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::element::quadrature::gauss_legendre;
use crate::mechanics::real::{LANES, Lanes, Real};

/// Points, beyond one for each trial pressure, of the rules for the two kernels: with more of them nothing changes
/// by more than 1e-12.
const SMOOTH_RULE: usize = 22;
const KINK_RULE: usize = 22;

/// `[packed entry][arc]` each.
pub struct InfiniteKernels {
    /// f(n) = n/(n^2 - 1) over n >= 2 and 1/n for n = 1, less its -pi/2 ln b in (0, 0).
    pub even: Vec<f64>,
    /// f(n) = 1/(n^2 - 1) over n >= 2.
    pub odd: Vec<f64>,
    /// What unit tilt adds, with the displacement along the ring of a disc: (sin phi sin(n phi) cos(n phi') and the reverse) times
    /// f(n) = 1/(n^2 - 1) and n/(n^2 - 1) over n >= 2.
    pub tilted_even: Vec<f64>,
    pub tilted_odd: Vec<f64>,
    /// What the clearance ratio squared adds (`second_order`), of a disc: lambda_n = sigma_n = n/(n^2 - 1) with
    /// tau_n = 1/(n^2 - 1), and these two exchanged; lambda_1 = sigma_1 = 1 of the first.
    pub second_even: Vec<f64>,
    pub second_odd: Vec<f64>,
}

impl InfiniteKernels {
    /// For arcs, as many as a multiple of `LANES`.
    pub fn new(arcs: &[ContactArc], terms: usize) -> InfiniteKernels {
        let entries = packed_count(terms);
        let mut kernels: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; entries * arcs.len()]);
        let (logarithmic, kinked) = (LogarithmicRule::new(terms), KinkedRule::new(terms));
        for (chunk, of_chunk) in arcs.chunks_exact(LANES).enumerate() {
            let lanes: [ContactArc; LANES] = std::array::from_fn(|lane| of_chunk[lane]);
            let [even, tilted_even, second_even] =
                in_lanes(Cubic { arcs: &lanes, terms, rule: &logarithmic });
            let [odd, tilted_odd, second_odd] = in_lanes(Quadratic { arcs: &lanes, terms, rule: &kinked });
            let own = [even, odd, tilted_even, tilted_odd, second_even, second_odd];
            for (kernel, own) in kernels.iter_mut().zip(own) {
                for (entry, values) in own.iter().enumerate() {
                    kernel[entry * arcs.len() + chunk * LANES..][..LANES].copy_from_slice(values);
                }
            }
            for (lane, arc) in of_chunk.iter().enumerate() {
                let mut add = |row: usize, column: usize, value: f64| {
                    kernels[0][packed(row, column) * arcs.len() + chunk * LANES + lane] += value;
                };
                add_logarithm(arc, terms, &mut add);
            }
        }
        let [even, odd, tilted_even, tilted_odd, second_even, second_odd] = kernels;
        InfiniteKernels { even, odd, tilted_even, tilted_odd, second_even, second_odd }
    }
}

/// The Galerkin matrix of f(n) = 1/n over n >= 1, less its -pi/2 ln b in (0, 0).
///
/// From ln|2 cos phi - 2 cos phi'| = ln|s^2 - s'^2| + 2 ln b + ln 4 - ln(1 + b^2 s^2) - ln(1 + b^2 s'^2), of which the
/// first is diagonal in T_2k and the last two have the Fourier series of ln(1 + 2 q cos(2 tau) + q^2), q = t^2.
fn add_logarithm(arc: &ContactArc, terms: usize, add: &mut impl FnMut(usize, usize, f64)) {
    let q = arc.t * arc.t;
    // -[pi pi/2 ln(1/2) + (pi/2)^2 ln 4 + ...]/pi: the logarithms of 2 cancel.
    add(0, 0, -PI * (1.0 - q).ln());
    for k in 1..terms {
        add(k, k, PI / (8.0 * k as f64));
        add(k, 0, -0.25 * PI * (-q).powi(k as i32) / k as f64);
    }
}

/// Weights for integrals of ln|cos tau - cos tau'| f(tau') over tau' in (0, pi) by the values of f at the midpoints of `count`
/// equal steps, exact for f = cos(k tau'), k < count (R. Kress, Linear Integral Equations, sect. 12.3).
struct LogarithmicRule {
    count: usize,
    /// `[node of tau][node of tau']`.
    weights: Vec<f64>,
    /// cos(tau).
    nodes: Vec<f64>,
    trials: Vec<[f64; MAX_TERMS]>,
}

impl LogarithmicRule {
    fn new(terms: usize) -> LogarithmicRule {
        let count = 2 * (SMOOTH_RULE + terms);
        let step = PI / count as f64;
        // cos((i + 1/2) k step) is one of 4 count cosines.
        let table: Vec<f64> = (0..4 * count).map(|i| (0.5 * i as f64 * step).cos()).collect();
        let cosine = |i: usize, k: usize| table[(2 * i + 1) * k % (4 * count)];
        // cos(a) cos(b) = [cos(a + b) + cos(a - b)]/2: sums of two numbers of one table.
        let sums: Vec<f64> = (0..=2 * count)
            .map(|turn| (1..count).map(|k| table[2 * turn * k % (4 * count)] / k as f64).sum())
            .collect();
        let weight = |i: usize, j: usize| -step * (2.0_f64.ln() + sums[i + j + 1] + sums[i.abs_diff(j)]);
        let nodes: Vec<f64> = (0..count).map(|i| cosine(i, 1)).collect();
        LogarithmicRule {
            count,
            weights: (0..count * count).map(|at| weight(at / count, at % count)).collect(),
            trials: nodes.iter().map(|s| cosines(2.0 * s * s - 1.0)).collect(),
            nodes,
        }
    }
}

/// Galerkin matrices of the sum over n >= 2 of cos(n theta)/(n (n^2 - 1))
/// = (1 - cos theta) ln(2 sin(theta/2)) - 1/2 + 3/4 cos theta,
/// and of (sin phi - sin phi') times that of sin(n theta)/(n^2 - 1) = sin theta [1/4 - ln(2 sin(theta/2))]; and of what comes of both to
/// second order,
///
/// ```text
///   -(sin phi - sin phi')^2/2 [3/4 cos theta - 1/2 - cos theta ln(2 sin(theta/2))] - (cos phi + cos phi')/4
///   + cos(phi + phi') {(1 + cos theta)/4 - sin^2(theta)/2 [1/4 - ln(2 sin(theta/2))]}.
/// ```
///
/// With x = tan(phi/2) = b s and g = 1/(1 + x^2): 1 - cos theta = 2 b^2 (s - s')^2 g g',
/// (sin phi - sin phi') sin theta = 2 (1 - cos theta) (1 - x^2 x'^2) g g', and
/// ln(2 sin(theta/2)) = ln|s - s'| + ln(2 b) + ln(g)/2 + ln(g')/2, so all but ln|s - s'| is smooth.
struct Cubic<'a> {
    arcs: &'a [ContactArc; LANES],
    terms: usize,
    rule: &'a LogarithmicRule,
}

impl LaneWork for Cubic<'_> {
    type Output = [Vec<[f64; LANES]>; 3];

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> [Vec<[f64; LANES]>; 3] {
        let Cubic { arcs, terms, rule: LogarithmicRule { count, weights, nodes, trials } } = self;
        let number = Lanes::<FUSED>::from_f64;
        let step = PI / *count as f64;
        let b = Lanes::<FUSED>(arcs.map(|arc| arc.b));
        let double = Lanes::<FUSED>(arcs.map(|arc| (2.0 * arc.b).ln()));
        let at_nodes: Vec<[Lanes<FUSED>; 2]> = nodes
            .iter()
            .map(|s| {
                let x = b * number(*s);
                let g = number(1.0) / (number(1.0) + x * x);
                [g, Lanes(g.0.map(|g| 0.5 * g.ln()))]
            })
            .collect();
        let mut matrices = [(); 3].map(|()| vec![[0.0; LANES]; packed_count(terms)]);
        for (i, (s, [g, ln_g])) in nodes.iter().zip(&at_nodes).enumerate() {
            let mut potentials = [[Lanes::<FUSED>::zero(); MAX_TERMS]; 3];
            for (j, (other, [other_g, other_ln_g])) in nodes.iter().zip(&at_nodes).enumerate() {
                let arm = b * number(s - other);
                let versine = number(2.0) * arm * arm * *g * *other_g;
                let logarithm =
                    (double + *ln_g + *other_ln_g) * number(step) + number(weights[i * count + j]);
                let smooth = number(step) * (number(0.25) - number(0.75) * versine);
                // g (1 - x^2 x'^2) g' = g + g' - 1, free of squares.
                let tilt = (versine + versine) * (*g + *other_g - number(1.0));
                // cos theta, (1 + cos theta)/2, cos phi + cos phi', and cos(phi + phi').
                let (cosine, near) = (number(1.0) - versine, number(1.0) - number(0.5) * versine);
                let cosines = number(2.0) * (*g + *other_g - number(1.0));
                let [own, other] = [*g, *other_g].map(|g| number(2.0) * g - number(1.0));
                let of_sum = number(2.0) * own * other - cosine;
                // Half of (sin phi - sin phi')^2, and half of cos(phi + phi') sin^2(theta).
                let square = number(0.5) * (number(1.0) + of_sum) * versine;
                let product = of_sum * versine * near;
                let of_logarithm = square * cosine + product;
                let rest = square * (number(0.5) - number(0.75) * cosine) - number(0.25) * product
                    + number(0.5) * of_sum * near
                    - number(0.25) * cosines;
                let second = of_logarithm * logarithm + number(step) * rest;
                let of_kernels =
                    [versine * logarithm + smooth, tilt * (number(0.25 * step) - logarithm), second]
                        .map(|weight| -weight);
                for (potential, weight) in potentials.iter_mut().zip(of_kernels) {
                    for (sum, trial) in potential[..terms].iter_mut().zip(&trials[j]) {
                        *sum = sum.minus_product(weight, number(*trial));
                    }
                }
            }
            for (matrix, potential) in matrices.iter_mut().zip(&potentials) {
                for row in 0..terms {
                    for column in 0..=row {
                        // Half of the integral over tau in (0, pi).
                        let factor = 0.5 * step / PI * trials[i][row];
                        let entry = &mut matrix[packed(row, column)];
                        entry
                            .iter_mut()
                            .zip(potential[column].0)
                            .for_each(|(sum, value)| *sum += factor * value);
                    }
                }
            }
        }
        matrices
    }
}

/// Points and weights over tau in (0, pi/2), and over tau' on both sides of each.
struct KinkedRule {
    outer: Vec<(f64, f64)>,
    /// cos(tau') and weight, `[tau]`.
    inner: Vec<Vec<(f64, f64)>>,
}

impl KinkedRule {
    fn new(terms: usize) -> KinkedRule {
        let rule = gauss_legendre(KINK_RULE + terms);
        let outer: Vec<(f64, f64)> =
            rule.iter().map(|(x, weight)| (0.5 * FRAC_PI_2 * (1.0 + x), 0.5 * FRAC_PI_2 * weight)).collect();
        let both_sides = |(tau, _): &(f64, f64)| {
            let sides = [(0.0, *tau), (*tau, PI)].into_iter();
            let points = sides.flat_map(|(start, end)| {
                let point = move |(x, weight): &(f64, f64)| {
                    let half = 0.5 * (end - start);
                    ((0.5 * (start + end) + half * x).cos(), half * weight)
                };
                rule.iter().map(point)
            });
            points.collect()
        };
        KinkedRule { inner: outer.iter().map(both_sides).collect(), outer }
    }
}

/// Galerkin matrices of the sum over n >= 2 of cos(n theta)/(n^2 - 1)
/// = 1/2 + 1/4 cos theta - (pi - theta)/2 sin theta, 0 <= theta <= 2 pi,
/// and of (sin phi - sin phi') times that of n sin(n theta)/(n^2 - 1) = (pi - theta)/2 cos theta - 1/4 sin theta; both have a
/// kink on the diagonal. And of what comes of both to second order, -(sin phi - sin phi')^2/2 times the first and
/// -(sin 2 phi - sin 2 phi')/4 times the other sum.
///
/// For each tau the integral over tau' in (0, pi) is taken on both sides of the kink. sin(theta/2) = |x - x'|/h,
/// cos(theta/2) = (1 + x x')/h, h^2 = (1 + x^2)(1 + x'^2), sin phi - sin phi' = 2 (x - x') (1 - x x')/h^2.
struct Quadratic<'a> {
    arcs: &'a [ContactArc; LANES],
    terms: usize,
    rule: &'a KinkedRule,
}

impl LaneWork for Quadratic<'_> {
    type Output = [Vec<[f64; LANES]>; 3];

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> [Vec<[f64; LANES]>; 3] {
        let Quadratic { arcs, terms, rule } = self;
        let number = Lanes::<FUSED>::from_f64;
        let b = Lanes::<FUSED>(arcs.map(|arc| arc.b));
        let angle = |x: Lanes<FUSED>| Lanes::<FUSED>(x.0.map(|x| 2.0 * x.atan()));
        let mut matrices = [(); 3].map(|()| vec![[0.0; LANES]; packed_count(terms)]);
        for (&(tau, outer_weight), inner) in rule.outer.iter().zip(&rule.inner) {
            let x = b * number(tau.cos());
            let own_angle = angle(x);
            let mut potentials = [[Lanes::<FUSED>::zero(); MAX_TERMS]; 3];
            for &(cosine, weight) in inner {
                let y = b * number(cosine);
                let theta = own_angle - angle(y);
                let theta = Lanes::<FUSED>(theta.0.map(f64::abs));
                let squares = (number(1.0) + x * x) * (number(1.0) + y * y);
                let (difference, along) = (x - y, number(1.0) + x * y);
                // sin^2(theta/2), and half of sin(theta).
                let sine_square = difference * difference / squares;
                let product = Lanes::<FUSED>(difference.0.map(f64::abs)) * along / squares;
                let rest = number(PI) - theta;
                let kernel = number(0.75) - number(0.5) * sine_square - rest * product;
                // |sin phi - sin phi'|, or the negative beyond pi/2.
                let arm =
                    (number(1.0) - x * y) * Lanes(difference.0.map(|value| 2.0 * value.abs())) / squares;
                let cosine_of = number(1.0) - number(2.0) * sine_square;
                let of_sines = rest * cosine_of - product;
                let tilted = arm * number(0.5) * of_sines;
                // cos(phi + phi').
                let (inward, sum) = (number(1.0) - x * y, x + y);
                let of_sum = (inward * inward - sum * sum) / squares;
                let second = -((number(1.0) + of_sum) * sine_square * kernel)
                    - number(0.5) * of_sum * product * of_sines;
                let trials = cosines(2.0 * cosine * cosine - 1.0);
                for (potential, kernel) in potentials.iter_mut().zip([kernel, tilted, second]) {
                    let kernel = number(-weight) * kernel;
                    for (sum, trial) in potential[..terms].iter_mut().zip(&trials) {
                        *sum = sum.minus_product(kernel, number(*trial));
                    }
                }
            }
            let trials = cosines((2.0 * tau).cos());
            for (matrix, potential) in matrices.iter_mut().zip(&potentials) {
                for row in 0..terms {
                    for column in 0..=row {
                        // Symmetric but for the quadrature: take the mean.
                        let product =
                            number(trials[row]) * potential[column] + number(trials[column]) * potential[row];
                        let factor = 0.5 * outer_weight / PI;
                        let entry = &mut matrix[packed(row, column)];
                        entry.iter_mut().zip(product.0).for_each(|(sum, value)| *sum += factor * value);
                    }
                }
            }
        }
        matrices
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::element::quadrature::gauss_legendre;

    /// The kernels against their own series, summed to where the remainder is below the tolerance.
    #[test]
    fn kernels_equal_their_series() {
        let arcs: Vec<ContactArc> = (1..=LANES).map(|i| ContactArc::new(0.25 * i as f64)).collect();
        let InfiniteKernels { even, odd, tilted_even, tilted_odd, second_even, second_odd } =
            InfiniteKernels::new(&arcs, 4);
        let highest = 2000;
        let rule = gauss_legendre(60);
        let mut compared = 0;
        for (place, arc) in arcs.iter().enumerate() {
            // Integrals of p_k cos(n phi), on 40 pieces for the waves.
            let moment = |n: usize, k: usize| -> f64 {
                let piece = FRAC_PI_2 / 40.0;
                let of_piece = |i: usize| {
                    rule.iter().map(move |(x, weight)| {
                        let tau = piece * (i as f64 + 0.5 + 0.5 * x);
                        0.5 * piece
                            * weight
                            * (2.0 * k as f64 * tau).cos()
                            * (n as f64 * arc.angle(tau)).cos()
                    })
                };
                (0..40).flat_map(of_piece).sum()
            };
            let moments: Vec<[f64; 4]> =
                (0..=highest).map(|n| std::array::from_fn(|k| moment(n, k))).collect();
            for row in 0..4 {
                for column in 0..=row {
                    let sum = |weight: &dyn Fn(f64) -> f64, first: usize| -> f64 {
                        let modes = (first..=highest).zip(&moments[first..]);
                        modes.map(|(n, m)| 2.0 / PI * weight(n as f64) * m[row] * m[column]).sum()
                    };
                    let at = packed(row, column) * arcs.len() + place;
                    // What the series leave out beyond the highest mode falls like n^-3, and n^-2: 2/(pi eps highest).
                    let quadratic = sum(&|n| 1.0 / (n * n - 1.0), 2);
                    assert!((odd[at] - quadratic).abs() < 1e-6, "{row},{column}: {} {quadratic}", odd[at]);
                    let log = even[at] - if row == 0 { FRAC_PI_2 * arc.ln_b } else { 0.0 };
                    let series =
                        moments[1][row] * moments[1][column] * 2.0 / PI + sum(&|n| n / (n * n - 1.0), 2);
                    assert!((log - series).abs() < 1.5e-3, "{row},{column}: {log} {series}");
                    // sin phi sin(n phi) by the cosines before and behind; these fall like n^-4 and n^-3.
                    let tilted = |weight: &dyn Fn(f64) -> f64| -> f64 {
                        let of_mode = |n: usize, k: usize| 0.5 * (moments[n - 1][k] - moments[n + 1][k]);
                        let both = |n: usize| {
                            of_mode(n, row) * moments[n][column] + of_mode(n, column) * moments[n][row]
                        };
                        (2..highest).map(|n| 2.0 / PI * weight(n as f64) * both(n)).sum()
                    };
                    let [of_even, of_odd] =
                        [tilted(&|n| 1.0 / (n * n - 1.0)), tilted(&|n| n / (n * n - 1.0))];
                    assert!(
                        (tilted_even[at] - of_even).abs() < 1e-6,
                        "{row},{column}: {} {of_even}",
                        tilted_even[at]
                    );
                    assert!(
                        (tilted_odd[at] - of_odd).abs() < 2e-3,
                        "{row},{column}: {} {of_odd}",
                        tilted_odd[at]
                    );
                    // Of lambda_n = sigma_n and tau_n: by the sums that `second_order` names.
                    let second = |of: &dyn Fn(f64) -> [f64; 2], first: usize| -> f64 {
                        let of_modes = first..highest - 2;
                        let changed = |n: usize, k: usize| {
                            let (m, at) =
                                (n as f64, |away: isize| moments[(n as isize + away).unsigned_abs()][k]);
                            let twice = [at(-1) - at(1), at(-2) - at(2)];
                            let place = 0.125 * (at(2) + at(-2)) - 0.25 * at(0) - 0.25 * m * twice[0]
                                + 0.125 * m * twice[1];
                            (at(0), place, 0.25 * (twice[0] - twice[1]), 0.5 * twice[0])
                        };
                        of_modes.fold(0.0, |sum, n| {
                            let [(p, dp, dt, t), (q, dq, du, u)] = [row, column].map(|k| changed(n, k));
                            let [normal, along] = of(n as f64);
                            sum + 2.0 / PI * (normal * (p * dq + q * dp + t * u) + along * (p * du + q * dt))
                        })
                    };
                    let of_first = |n: f64| {
                        if n == 1.0 { [1.0, 0.0] } else { [n / (n * n - 1.0), 1.0 / (n * n - 1.0)] }
                    };
                    let of_even = second(&of_first, 1);
                    let of_odd = second(&|n| [1.0 / (n * n - 1.0), n / (n * n - 1.0)], 2);
                    for (found, series) in [(second_even[at], of_even), (second_odd[at], of_odd)] {
                        assert!((found - series).abs() < 5e-4, "{row},{column}: {found} {series}");
                    }
                    // Their difference falls like n^-4.
                    let sum = |f: &dyn Fn(f64) -> f64| sum(f, 2);
                    let cubic = sum(&|n| 1.0 / (n * (n * n - 1.0)));
                    let own = {
                        let mut logarithm = 0.0;
                        add_logarithm(arc, 4, &mut |i, j, value| {
                            logarithm += if (i, j) == (row, column) { value } else { 0.0 };
                        });
                        even[at] - logarithm
                    };
                    assert!((own - cubic).abs() < 1e-8, "{row},{column}: {own} {cubic}");
                    compared += 1;
                }
            }
        }
        assert_eq!(compared, 10 * LANES);
    }
}
