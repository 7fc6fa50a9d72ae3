//! Galerkin matrices of the infinitely extended bodies: the kernels sum of (2/pi) cos(n phi) cos(n phi') f(n) in the
//! trial pressures, in closed form, one arc a lane; and what the tilt of a pin's pressure adds, to first and second order.
//!
//! Half the range suffices: pressures are even, so that for tau in (0, pi/2) the other point goes over (0, pi).

mod product_rule;

use std::f64::consts::{FRAC_PI_2, PI};

use product_rule::ProductRule;

use super::arc::{ContactArc, MAX_TERMS, packed, packed_count};
use super::arc_lanes::{ArcLanes, ForEach, numbers_of};
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::real::{LANES, Lanes, Real};

/// Points over (0, pi/2), beyond one for each trial pressure, by asinh(1/b) of the widest arc: how far functions of tan(phi/2) = b cos(tau) are
/// analytic in tau. With more of them nothing changes by more than 1e-12.
const RULE: f64 = 13.0;
/// No more than these, which is as true up to the widest arc of any space.
const MOST_OF_RULE: usize = 32;

/// Kernels that are integrated together, in the order of `InfiniteKernels`.
const KERNELS: usize = 6;

/// Trial pressures whose sums are taken side by side: each waits for itself alone.
const ABREAST: usize = 6;

/// `[packed entry][arc]` each.
#[derive(Clone, Default)]
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
    pub fn new(arcs: &[ContactArc], terms: usize, for_each: ForEach) -> InfiniteKernels {
        InfiniteKernels::with_more_points(arcs, terms, for_each, 0)
    }

    fn with_more_points(
        arcs: &[ContactArc],
        terms: usize,
        for_each: ForEach,
        more: usize,
    ) -> InfiniteKernels {
        let of_arcs = |(arcs, matrices): ArcLanes| {
            let widest = arcs.iter().fold(0.0_f64, |widest, arc| widest.max(arc.b));
            let points = (RULE / widest.recip().asinh()).ceil() as usize;
            let rule = ProductRule::new(points.min(MOST_OF_RULE) + terms + more, terms);
            in_lanes(Regular { arcs, terms, rule: &rule, matrices });
            for (lane, arc) in arcs.iter().enumerate() {
                add_logarithm(arc, terms, &mut |row, column, value| {
                    matrices[packed(row, column)][lane] += value;
                });
            }
        };
        let entries = packed_count(terms);
        let matrices = numbers_of(arcs, KERNELS * entries, for_each, &of_arcs);
        let [even, odd, tilted_even, tilted_odd, second_even, second_odd] = by_entries(&matrices, entries);
        InfiniteKernels { even, odd, tilted_even, tilted_odd, second_even, second_odd }
    }
}

/// Kernels `[packed entry][arc]` from those `[chunk of arcs][kernel][packed entry][lane]`.
pub fn by_entries<const KERNELS: usize>(matrices: &[[f64; LANES]], entries: usize) -> [Vec<f64>; KERNELS] {
    let count = matrices.len() / KERNELS / entries;
    let mut kernels = std::array::from_fn(|_| vec![0.0; entries * count * LANES]);
    for (chunk, matrices) in matrices.chunks_exact(KERNELS * entries).enumerate() {
        for (kernel, matrix) in kernels.iter_mut().zip(matrices.chunks_exact(entries)) {
            for (row, values) in kernel.chunks_exact_mut(count * LANES).zip(matrix) {
                row[chunk * LANES..][..LANES].copy_from_slice(values);
            }
        }
    }
    kernels
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

/// Galerkin matrices of `InfiniteKernels`, `even` and `second_even` without the logarithm.
///
/// Of the sum over n >= 2 of cos(n theta)/(n (n^2 - 1)) = (1 - cos theta) ln(2 sin(theta/2)) - 1/2 + 3/4 cos theta,
/// and of (sin phi - sin phi') times that of sin(n theta)/(n^2 - 1) = sin theta [1/4 - ln(2 sin(theta/2))]; and of what comes of both to
/// second order,
///
/// ```text
///   -(sin phi - sin phi')^2/2 [3/4 cos theta - 1/2 - cos theta ln(2 sin(theta/2))] - (cos phi + cos phi')/4
///   + cos(phi + phi') {(1 + cos theta)/4 - sin^2(theta)/2 [1/4 - ln(2 sin(theta/2))]}.
/// ```
///
/// Of the sum over n >= 2 of cos(n theta)/(n^2 - 1) = 1/2 + 1/4 cos theta - (pi - theta)/2 sin theta, 0 <= theta <= 2 pi,
/// and of (sin phi - sin phi') times that of n sin(n theta)/(n^2 - 1) = (pi - theta)/2 cos theta - 1/4 sin theta; both have a
/// kink on the diagonal. And of what comes of both to second order, -(sin phi - sin phi')^2/2 times the first and
/// -(sin 2 phi - sin 2 phi')/4 times the other sum.
///
/// With x = tan(phi/2) = b s and g = 1/(1 + x^2): 1 - cos theta = 2 b^2 (s - s')^2 g g',
/// (sin phi - sin phi') sin theta = 2 (1 - cos theta) (1 - x^2 x'^2) g g', and
/// ln(2 sin(theta/2)) = ln|s - s'| + ln(2 b) + ln(g)/2 + ln(g')/2, so all but ln|s - s'| is smooth; and where theta = |phi - phi'|
/// all but the sign.
struct Regular<'a> {
    arcs: &'a [ContactArc; LANES],
    terms: usize,
    rule: &'a ProductRule,
    /// To which they are added, `[kernel][packed entry]`.
    matrices: &'a mut [[f64; LANES]],
}

/// A point of the rule on the arcs.
#[derive(Clone, Copy)]
struct Point<const WIDTH: usize> {
    /// x.
    x: Lanes<WIDTH>,
    g: Lanes<WIDTH>,
    /// ln(g)/2.
    ln_g: Lanes<WIDTH>,
    angle: Lanes<WIDTH>,
}

impl<const WIDTH: usize> Point<WIDTH> {
    #[inline(always)]
    fn new(x: Lanes<WIDTH>) -> Point<WIDTH> {
        let one = Lanes::from_f64(1.0);
        let g = one / (one + x * x);
        Point { x, g, ln_g: Lanes(g.0.map(|g| 0.5 * g.ln())), angle: Lanes(x.0.map(|x| 2.0 * x.atan())) }
    }

    #[inline(always)]
    fn mirrored(self) -> Point<WIDTH> {
        Point { x: -self.x, angle: -self.angle, ..self }
    }

    /// The kernels between two points, in the order of `InfiniteKernels`, times the weights: the step, and by ln(2 b) those of `ProductRule`.
    #[inline(always)]
    fn kernels(
        self,
        other: Point<WIDTH>,
        (step, double): (f64, Lanes<WIDTH>),
        weights: [f64; 2],
    ) -> [Lanes<WIDTH>; KERNELS] {
        let number = Lanes::<WIDTH>::from_f64;
        let difference = self.x - other.x;
        let products = self.g * other.g;
        let versine = number(2.0) * difference * difference * products;
        let logarithm = (double + self.ln_g + other.ln_g) * number(step) + number(weights[0]);
        // g (1 - x^2 x'^2) g' = g + g' - 1, free of squares; cos phi = 2 g - 1.
        let sum = self.g + other.g - number(1.0);
        let (own, others) = (number(2.0) * self.g - number(1.0), number(2.0) * other.g - number(1.0));
        // cos theta, (1 + cos theta)/2 and cos(phi + phi').
        let (cosine, near) = (number(1.0) - versine, number(1.0) - number(0.5) * versine);
        let of_sum = number(2.0) * own * others - cosine;
        // Half of (sin phi - sin phi')^2, and half of cos(phi + phi') sin^2(theta).
        let square = number(0.5) * (number(1.0) + of_sum) * versine;
        let product = of_sum * versine * near;
        let rest = square * (number(0.5) - number(0.75) * cosine) - number(0.25) * product
            + number(0.5) * of_sum * near
            - number(0.5) * sum;
        let even = versine * logarithm + number(step) * (number(0.25) - number(0.75) * versine);
        let tilted_even = (versine + versine) * sum * (number(0.25 * step) - logarithm);
        let second_even = (square * cosine + product) * logarithm + number(step) * rest;
        // sin(phi - phi'), sin phi - sin phi', and (theta - pi)/2 with the sign of phi - phi'.
        let sine = number(2.0) * difference * (number(1.0) + self.x * other.x) * products;
        let arm = number(2.0) * difference * (number(1.0) - self.x * other.x) * products;
        let turn = number(0.5 * step) * (self.angle - other.angle) - number(FRAC_PI_2 * weights[1]);
        let odd = number(step) * (number(0.75) - number(0.25) * versine) + turn * sine;
        let of_sines = turn * cosine + number(0.25 * step) * sine;
        let tilted_odd = -arm * of_sines;
        let second_odd = number(0.5) * of_sum * sine * of_sines - square * odd;
        [even, odd, tilted_even, tilted_odd, second_even, second_odd]
    }
}

impl LaneWork for Regular<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const WIDTH: usize>(self) {
        let Regular { arcs, terms, rule: ProductRule { half, nodes, trials, weights }, matrices } = self;
        let number = Lanes::<WIDTH>::from_f64;
        let step = FRAC_PI_2 / *half as f64;
        let b = Lanes::<WIDTH>(arcs.map(|arc| arc.b));
        let double = Lanes::<WIDTH>(arcs.map(|arc| (2.0 * arc.b).ln()));
        let mut points: Vec<Point<WIDTH>> = Vec::with_capacity(nodes.len());
        for s in nodes {
            points.push(Point::new(b * number(*s)));
        }
        let mut of_point = vec![[Lanes::<WIDTH>::zero(); KERNELS]; *half];
        for (i, point) in points.iter().enumerate() {
            // Kernels are the same with the points exchanged: the sums over those up to this one are added both ways.
            for (j, other) in points[..=i].iter().enumerate() {
                // The trial pressures are the same at both.
                let [own, mirrored] = weights[i * half + j];
                let own = point.kernels(*other, (step, double), own);
                let mirrored = point.kernels(other.mirrored(), (step, double), mirrored);
                let share = number(if i == j { -0.5 } else { -1.0 });
                for kernel in 0..KERNELS {
                    of_point[j][kernel] = share * (own[kernel] + mirrored[kernel]);
                }
            }
            for (kernel, matrix) in matrices.chunks_exact_mut(packed_count(terms)).enumerate() {
                let mut potential = [Lanes::<WIDTH>::zero(); MAX_TERMS];
                for (block, sums) in potential.as_chunks_mut::<ABREAST>().0.iter_mut().enumerate() {
                    if block * ABREAST < terms {
                        for (weights, trials) in of_point[..=i].iter().zip(trials) {
                            for k in 0..ABREAST {
                                let trial = number(trials[block * ABREAST + k]);
                                sums[k] = sums[k].minus_product(weights[kernel], trial);
                            }
                        }
                    }
                }
                for row in 0..terms {
                    let of_row = number(-step / PI * trials[i][row]);
                    for column in 0..=row {
                        let of_column = number(-step / PI * trials[i][column]);
                        let entry = &mut matrix[packed(row, column)];
                        let sum = Lanes::<WIDTH>(*entry).minus_product(of_row, potential[column]);
                        *entry = sum.minus_product(of_column, potential[row]).0;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::compliance::arc::cosines;
    use crate::mechanics::compliance::arc_lanes::one_by_one;
    use crate::mechanics::element::quadrature::gauss_legendre;

    /// The kernels against their own series, summed to where the remainder is below the tolerance.
    #[test]
    fn kernels_equal_their_series() {
        let arcs: Vec<ContactArc> = (1..=LANES).map(|i| ContactArc::new(0.25 * i as f64)).collect();
        let InfiniteKernels { even, odd, tilted_even, tilted_odd, second_even, second_odd } =
            InfiniteKernels::new(&arcs, 4, &one_by_one);
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

    /// Those with a kink against many points of Gauss on either side of it, up to the widest arc of any space.
    #[test]
    fn kernels_with_a_kink_equal_their_integrals() {
        let arcs: Vec<ContactArc> = (1..=LANES).map(|i| ContactArc::new(0.3 * i as f64)).collect();
        let kernels = InfiniteKernels::new(&arcs, 6, &one_by_one);
        let rule = gauss_legendre(120);
        let points = |start: f64, end: f64| {
            let half = 0.5 * (end - start);
            rule.iter().map(move |(x, weight)| (start + half * (1.0 + x), half * weight))
        };
        let mut compared = 0;
        for (place, arc) in arcs.iter().enumerate() {
            let mut sums = [[[0.0; 6]; 6]; 3];
            for (tau, weight) in points(0.0, FRAC_PI_2) {
                let phi = arc.angle(tau);
                for (other_tau, other_weight) in points(0.0, tau).chain(points(tau, PI)) {
                    let other = arc.angle(other_tau);
                    let (theta, sign) = ((phi - other).abs(), (phi - other).signum());
                    let of_cosines = 0.5 + 0.25 * theta.cos() - 0.5 * (PI - theta) * theta.sin();
                    let of_sines = sign * (0.5 * (PI - theta) * theta.cos() - 0.25 * theta.sin());
                    let arm = phi.sin() - other.sin();
                    let twice = (2.0 * phi).sin() - (2.0 * other).sin();
                    let of_kernels =
                        [of_cosines, arm * of_sines, -0.5 * arm * arm * of_cosines - 0.25 * twice * of_sines];
                    let [trials, others] = [tau, other_tau].map(|tau| cosines((2.0 * tau).cos(), 6));
                    for (sums, kernel) in sums.iter_mut().zip(of_kernels) {
                        for row in 0..6 {
                            for column in 0..=row {
                                sums[row][column] +=
                                    weight * other_weight / PI * kernel * trials[row] * others[column];
                            }
                        }
                    }
                }
            }
            for row in 0..6 {
                for column in 0..=row {
                    let at = packed(row, column) * arcs.len() + place;
                    let found = [kernels.odd[at], kernels.tilted_odd[at], kernels.second_odd[at]];
                    for (found, sums) in found.iter().zip(&sums) {
                        let integral = sums[row][column];
                        assert!((found - integral).abs() < 2e-12, "{row},{column}: {found} {integral}");
                        compared += 1;
                    }
                }
            }
        }
        assert_eq!(compared, 3 * 21 * LANES);
    }

    #[test]
    fn more_points_change_nothing() {
        for widest in [0.01, 0.1, 0.3, 0.7, 1.0, 1.5, 2.0, 2.4] {
            let arcs: Vec<ContactArc> =
                (1..=LANES).map(|i| ContactArc::new(widest * i as f64 / LANES as f64)).collect();
            for terms in [3, 6, MAX_TERMS] {
                let by = |more: usize| {
                    let InfiniteKernels { even, odd, tilted_even, tilted_odd, second_even, second_odd } =
                        InfiniteKernels::with_more_points(&arcs, terms, &one_by_one, more);
                    [even, odd, tilted_even, tilted_odd, second_even, second_odd].concat()
                };
                let changes: Vec<f64> =
                    by(0).iter().zip(by(20)).map(|(few, many)| (few - many).abs()).collect();
                assert_eq!(changes.len(), KERNELS * LANES * packed_count(terms));
                let worst = changes.iter().fold(0.0_f64, |worst, change| worst.max(*change));
                println!("{widest} {terms}: {worst:e}");
                assert!(changes.iter().all(|change| *change < 1e-12), "{widest}, {terms}: {worst:e}");
            }
        }
    }
}
