//! What the boundary changes of bodies of one family as a function of their ratios and Poisson's ratio: a few members, which are
//! such changes themselves, times polynomials, found from samples by least squares.
//!
//! ```text
//!   D(x) = sum over m of a_m(x) D_m,   a_m(x) = sum over |d| <= degree of a_md T_d1(x_1) T_d2(x_2) ...
//! ```
//!
//! The members are samples made orthogonal, in the order in which they explain most of what is left (a reduced basis by a
//! greedy choice: Quarteroni, Manzoni & Negri, Reduced Basis Methods for Partial Differential Equations, Springer 2016,
//! section 7.1).

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use super::row_sums::{Rows, WeightedSum};

/// Products of Chebyshev polynomials over a box.
#[derive(Clone, Debug)]
pub struct Polynomials {
    /// The box: least and greatest value of each coordinate.
    pub ranges: Vec<(f64, f64)>,
    /// Of each product: another one, the coordinate and degree of the factor that it has more, and all before are of
    /// lower coordinates. The first is 1.
    products: Vec<(usize, usize, usize)>,
    highest: usize,
}

impl Polynomials {
    /// All products whose degrees, each over its coordinate's highest one, sum to at most 1. A coordinate without width
    /// has none.
    pub fn new(ranges: Vec<(f64, f64)>, degrees: &[usize]) -> Polynomials {
        let mut products = vec![(0, 0, 0)];
        let mut shares = vec![0.0];
        for (axis, (range, highest)) in ranges.iter().zip(degrees).enumerate() {
            let known = products.len();
            for parent in (0..known).filter(|_| range.1 > range.0) {
                for degree in 1..=*highest {
                    let share = shares[parent] + degree as f64 / *highest as f64;
                    if share > 1.0 + 1e-9 {
                        break;
                    }
                    products.push((parent, axis, degree));
                    shares.push(share);
                }
            }
        }
        Polynomials { ranges, products, highest: degrees.iter().copied().max().unwrap_or(0) }
    }

    /// How many products there are.
    pub fn count(&self) -> usize {
        self.products.len()
    }

    /// The degrees of each product, of four coordinates; those there are not have degree 0.
    pub fn degrees(&self) -> Vec<[u8; 4]> {
        let mut degrees = vec![[0; 4]];
        for (parent, axis, degree) in &self.products[1..] {
            let mut own = degrees[*parent];
            own[*axis] = *degree as u8;
            degrees.push(own);
        }
        degrees
    }

    /// A point from -1 to 1 over the box; zero where it has no width.
    pub fn place<'a>(&'a self, point: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let place = |((low, high), value): (&(f64, f64), &f64)| {
            if high > low { (2.0 * value - low - high) / (high - low) } else { 0.0 }
        };
        self.ranges.iter().zip(point).map(place)
    }

    /// Whether a point is in the box.
    pub fn contains(&self, point: &[f64]) -> bool {
        self.ranges.iter().zip(point).all(|((low, high), value)| low <= value && value <= high)
    }

    /// Whether a point of the box is farther than this share of its width from each end.
    pub fn is_inside(&self, point: &[f64], share: f64) -> bool {
        let is_far = |((low, high), value): (&(f64, f64), &f64)| {
            low == high || (value - low).min(high - value) > share * (high - low)
        };
        self.ranges.iter().zip(point).all(is_far)
    }

    /// The products at a point; `work` is overwritten.
    pub fn values(&self, point: &[f64], work: &mut Vec<f64>, values: &mut Vec<f64>) {
        let row = self.highest + 1;
        work.clear();
        for x in self.place(point) {
            let (mut current, mut previous) = (1.0, x);
            for _ in 0..row {
                work.push(current);
                (current, previous) = (2.0 * x * current - previous, current);
            }
        }
        values.clear();
        values.push(1.0);
        for (parent, axis, degree) in &self.products[1..] {
            values.push(values[*parent] * work[axis * row + degree]);
        }
    }
}

impl FitScratch {
    /// A sum of rows that is yet to be made and left in `values`: each of these shares in turn times the numbers given and then the
    /// amplitudes of the members, which were found before; times a scale.
    pub fn weigh(&mut self, shares: &[f64], numbers: &[f64], scale: f64) -> WeightedSum<'_> {
        let FitScratch { weights, amplitudes, values, .. } = self;
        weights.clear();
        for share in shares {
            weights.extend(numbers.iter().map(|number| (share * number) as f32));
            weights.extend(amplitudes.iter().map(|amplitude| (share * amplitude) as f32));
        }
        WeightedSum { weights, scale, sum: values }
    }
}

/// A fitted family.
#[derive(Clone, Debug)]
pub struct BodyFit {
    pub polynomials: Polynomials,
    /// Of the members, a row for each product.
    coefficients: Rows,
    /// D_m: `[member][number]`, each as long as a sample.
    members: Vec<f64>,
    length: usize,
}

/// Numbers that a fit works with, kept from body to body.
#[derive(Default)]
pub struct FitScratch {
    work: Vec<f64>,
    products: Vec<f64>,
    weights: Vec<f32>,
    amplitudes: Vec<f64>,
    /// What is made of the sum.
    pub values: Vec<f64>,
    pub moved: Vec<f64>,
}

impl BodyFit {
    /// From points and the samples there (all of one length), each weighted by the size of its body's compliance, `scales`.
    /// Members are added until what is left of each sample is below `tolerance` of that. `None` where the points do not
    /// determine the polynomials.
    pub fn new(
        polynomials: Polynomials,
        points: &[Vec<f64>],
        samples: &[Vec<f64>],
        scales: &[f64],
        tolerance: f64,
    ) -> Option<BodyFit> {
        let (count, rows) = (polynomials.count(), points.len());
        if rows < count || samples.len() != rows || samples.is_empty() {
            return None;
        }
        let is_sound = samples.iter().flatten().all(|value| value.is_finite());
        if !is_sound || !scales.iter().all(|scale| scale.is_finite() && *scale > 0.0) {
            return None;
        }
        let members = members(samples, scales, tolerance);
        let (mut work, mut values) = (Vec::new(), Vec::new());
        let mut design = Mat::<f64>::zeros(rows, count);
        let mut amplitudes = Mat::<f64>::zeros(rows, members.len());
        for (row, ((point, sample), scale)) in points.iter().zip(samples).zip(scales).enumerate() {
            polynomials.values(point, &mut work, &mut values);
            for (column, value) in values.iter().enumerate() {
                design[(row, column)] = value / scale;
            }
            for (column, member) in members.iter().enumerate() {
                amplitudes[(row, column)] = dot(sample, member) / scale;
            }
        }
        // The points are dense at the ends like Chebyshev's, so the products are nearly orthogonal and the normal
        // equations well conditioned.
        let gram = design.transpose() * &design;
        let factor = gram.llt(Side::Lower).ok()?;
        let solution = factor.solve(design.transpose() * &amplitudes);
        let row = |product: usize| (0..members.len()).map(|member| solution[(product, member)]).collect();
        let coefficients: Vec<Vec<f64>> = (0..count).map(row).collect();
        let sound = coefficients.iter().flatten().all(|value| value.is_finite());
        sound.then_some(BodyFit {
            polynomials,
            coefficients: Rows::new(&coefficients),
            members: members.concat(),
            length: samples[0].len(),
        })
    }

    /// What is fitted at a point of the box, as the samples are.
    pub fn at(&self, point: &[f64], scratch: &mut FitScratch) -> Vec<f64> {
        let mut sum = vec![0.0; self.length];
        self.find(point, scratch);
        for (member, amplitude) in self.members().zip(&scratch.amplitudes) {
            sum.iter_mut().zip(member).for_each(|(sum, value)| *sum += amplitude * value);
        }
        sum
    }

    /// The amplitudes of the members at a point of the box, left in `scratch`.
    fn find(&self, point: &[f64], scratch: &mut FitScratch) {
        self.coefficients.sums(0.0, &mut [self.begin(point, scratch)]);
    }

    /// The amplitudes of the members at a point of the box, yet to be summed from the rows of `coefficients`.
    pub fn begin<'a>(&self, point: &[f64], scratch: &'a mut FitScratch) -> WeightedSum<'a> {
        let FitScratch { work, products, weights, amplitudes, .. } = scratch;
        self.polynomials.values(point, work, products);
        weights.clear();
        weights.extend(products.iter().map(|product| *product as f32));
        WeightedSum { weights, scale: 1.0, sum: amplitudes }
    }

    /// Of the amplitudes of its members, a row for each product.
    pub fn coefficients(&self) -> &Rows {
        &self.coefficients
    }

    pub fn member_count(&self) -> usize {
        self.members.len() / self.length
    }

    /// Its members, each as the samples are.
    pub fn members(&self) -> impl Iterator<Item = &[f64]> {
        self.members.chunks_exact(self.length)
    }
}

/// Rows that add less than this of the first to a sum are left out.
pub const NEGLIGIBLE: f32 = 1e-6;

/// What that and sums in f32 leave of a compliance, relative, on the safe side.
pub const ROUNDED: f64 = 1e-5;

/// Orthonormal members of samples, the most needed first.
fn members(samples: &[Vec<f64>], scales: &[f64], tolerance: f64) -> Vec<Vec<f64>> {
    let mut left: Vec<Vec<f64>> = samples
        .iter()
        .zip(scales)
        .map(|(sample, scale)| sample.iter().map(|value| value / scale).collect())
        .collect();
    let mut members: Vec<Vec<f64>> = Vec::new();
    for _ in 0..samples.len() {
        let sizes: Vec<f64> = left.iter().map(|sample| dot(sample, sample).sqrt()).collect();
        let Some((most, size)) = sizes.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)) else { break };
        if *size <= tolerance {
            break;
        }
        let member: Vec<f64> = left[most].iter().map(|value| value / size).collect();
        for sample in &mut left {
            let share = dot(sample, &member);
            sample.iter_mut().zip(&member).for_each(|(value, member)| *value -= share * member);
        }
        members.push(member);
    }
    members
}

/// In eight sums, which the compiler keeps in registers.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a_blocks, b_blocks) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a_blocks.remainder().iter().zip(b_blocks.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_blocks.zip(b_blocks) {
        for i in 0..8 {
            sums[i] += a[i] * b[i];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two members times polynomials of the basis are found exactly; a coordinate without width is no obstacle.
    #[test]
    fn what_is_in_the_space_is_found() {
        let ranges = vec![(-1.0, 3.0), (0.2, 0.2), (5.0, 6.0)];
        let polynomials = || Polynomials::new(ranges.clone(), &[4, 4, 2]);
        // 1 to x^4, z, x z, x^2 z and z^2.
        assert_eq!(polynomials().count(), 9);
        let length = 37;
        let member = |k: usize| move |i: usize| ((k + 1) as f64 * i as f64).sin();
        let sample = |point: &[f64]| -> Vec<f64> {
            let (x, z) = (point[0], point[2]);
            let (a, b) = (3.0 + x - 0.2 * x.powi(4) + x * z, 0.1 * z * z - 2.0 * x * x);
            (0..length).map(|i| a * member(0)(i) + b * member(1)(i)).collect()
        };
        let points: Vec<Vec<f64>> = (0..40)
            .map(|i| vec![-1.0 + 0.1 * f64::from(i), 0.2, 5.0 + (0.618 * f64::from(i)).fract()])
            .collect();
        let samples: Vec<Vec<f64>> = points.iter().map(|point| sample(point)).collect();
        let fit = BodyFit::new(polynomials(), &points, &samples, &vec![10.0; 40], 1e-10).unwrap();
        assert_eq!(fit.members().count(), 2);
        for point in [[0.33, 0.2, 5.5], [2.9, 0.2, 6.0]] {
            assert!(fit.polynomials.contains(&point));
            let found = fit.at(&point, &mut FitScratch::default());
            assert_eq!(found.len(), length);
            for (found, expected) in found.iter().zip(sample(&point)) {
                assert!((found - expected).abs() < 3e-6, "{found} {expected}");
            }
        }
        assert!(!fit.polynomials.contains(&[3.1, 0.2, 5.5]) && !fit.polynomials.contains(&[0.0, 0.3, 5.5]));
        assert!(!fit.polynomials.contains(&[f64::NAN, 0.2, 5.5]));
    }

    /// Points that say nothing of a direction, and samples that are no numbers, give no fit.
    #[test]
    fn what_is_not_determined_is_refused() {
        let polynomials = || Polynomials::new(vec![(0.0, 1.0)], &[2]);
        let samples = vec![vec![1.0; 8]; 5];
        let fit = |points: &[Vec<f64>], samples: &[Vec<f64>]| {
            BodyFit::new(polynomials(), points, samples, &[3.0; 5][..points.len()], 1e-6)
        };
        assert!(fit(&vec![vec![0.5]; 5], &samples).is_none());
        let points: Vec<Vec<f64>> = (0..5).map(|i| vec![0.2 * f64::from(i)]).collect();
        assert!(fit(&points[..2], &samples[..2]).is_none());
        let mut broken = samples.clone();
        broken[3][2] = f64::NAN;
        assert!(fit(&points, &broken).is_none());
        assert!(fit(&points, &samples).is_some());
    }
}
