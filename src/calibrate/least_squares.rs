//! Nonlinear least squares by Levenberg's and Marquardt's method (Marquardt 1963; Nocedal & Wright 2006, section 10.3): each step
//! solves (J^T J + damping * D^2) step = -J^T r with D the norms of J's columns, from one singular value decomposition of J D^-1.

use faer::Mat;

/// Residuals at some values of the unknowns, and their derivatives where they are asked.
pub trait Problem {
    /// `None` where there are none. The sum of their squares must be a number to go on from.
    fn residuals(&mut self, unknowns: &[f64]) -> Option<Vec<f64>>;

    /// Columns d residuals/d unknown, at values that have residuals.
    fn derivatives(&mut self, unknowns: &[f64]) -> Option<Vec<Vec<f64>>>;
}

/// The least sum of squares, and how sharp it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    pub unknowns: Vec<f64>,
    pub residuals: Vec<f64>,
    /// (J^T J)^-1; infinite on the diagonal for unknowns that the residuals do not decide.
    pub inverse: Vec<Vec<f64>>,
    /// (J^T J)^-1 J^T J of one unknown alone: how much wider its variance is for the others being unknown; 1 where it does not matter.
    pub inflation: Vec<f64>,
    /// Largest over smallest singular value of J with columns of norm 1.
    pub condition: f64,
    pub iterations: usize,
}

/// Why there is none.
#[derive(Clone, Debug, PartialEq)]
pub enum NoMinimum {
    /// No residuals at the start.
    BadStart,
    /// Residuals there whose squares no number holds.
    TooFar,
    /// Still falling, or stuck, after so many iterations; with the inflation of each variance where it ended, as far as known.
    NotSettled { iterations: usize, inflation: Vec<f64> },
}

const MOST_ITERATIONS: usize = 200;
/// Of a step that changes nothing any more, in the unknowns' own scale of 1.
const SMALLEST_STEP: f64 = 1e-11;
/// A step is at most this long, in the unknowns' own scale of 1: a factor of e^1.5 for logarithms.
const LARGEST_STEP: f64 = 1.5;
/// What is left to go, over the standard error, at a minimum that rounding keeps from being met.
const WITHIN_ERROR: f64 = 1e-3;
/// The same in the unknowns' own scale of 1, for points without scatter.
const NOTHING_LEFT: f64 = 1e-7;
/// Beyond this damping no step is worth trying.
const MOST_DAMPING: f64 = 1e16;
/// Singular values below this share of the largest one are rounding.
const SMALLEST_SHARE: f64 = 1e-10;

pub fn minimum(problem: &mut impl Problem, start: &[f64]) -> Result<Minimum, NoMinimum> {
    let mut unknowns = start.to_vec();
    let mut residuals = problem.residuals(&unknowns).ok_or(NoMinimum::BadStart)?;
    if !norm_squared(&residuals).is_finite() {
        return Err(NoMinimum::TooFar);
    }
    let mut damping: f64 = 1e-3;
    // Whether the last step has changed the sum by no more than rounding does.
    let mut is_settled = false;
    for iteration in 1..=MOST_ITERATIONS {
        let stuck = |inflation: Vec<f64>| NoMinimum::NotSettled { iterations: iteration, inflation };
        let columns = problem.derivatives(&unknowns).ok_or_else(|| stuck(Vec::new()))?;
        let slope = Slope::new(&columns, &residuals).ok_or_else(|| stuck(Vec::new()))?;
        let sum = norm_squared(&residuals);
        let mut moved = None;
        let is_over = slope.is_minimum(sum, 1e-5) || (is_settled && slope.is_minimum(sum, 1.0));
        while !is_over && damping <= MOST_DAMPING {
            let step = slope.step(damping);
            let longest = step.iter().fold(0.0_f64, |most, step| most.max(step.abs()));
            if longest <= SMALLEST_STEP {
                break;
            }
            let shrink = (LARGEST_STEP / longest).min(1.0);
            let trial: Vec<f64> = unknowns.iter().zip(&step).map(|(own, step)| own + shrink * step).collect();
            match problem.residuals(&trial).filter(|residuals| norm_squared(residuals) < sum) {
                Some(less) => {
                    damping = (0.1 * damping).max(1e-12);
                    moved = Some((trial, less));
                    break;
                }
                None => damping *= 8.0,
            }
        }
        match moved {
            Some((trial, less)) => {
                is_settled = norm_squared(&less) > (1.0 - 1e-12) * sum;
                (unknowns, residuals) = (trial, less);
            }
            None if slope.is_minimum(sum, 1.0) => {
                let (inverse, inflation, condition) = slope.inverse();
                return Ok(Minimum {
                    unknowns,
                    residuals,
                    inverse,
                    inflation,
                    condition,
                    iterations: iteration,
                });
            }
            None => return Err(stuck(slope.inverse().1)),
        }
        if iteration == MOST_ITERATIONS {
            return Err(stuck(slope.inverse().1));
        }
    }
    unreachable!("the last iteration has returned")
}

fn norm_squared(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// The singular value decomposition U S V^T of J D^-1, with the residuals in U's frame.
struct Slope {
    norms: Vec<f64>,
    singular: Vec<f64>,
    /// V by rows.
    frame: Vec<Vec<f64>>,
    /// U^T r.
    residuals: Vec<f64>,
    rows: usize,
}

impl Slope {
    fn new(columns: &[Vec<f64>], residuals: &[f64]) -> Option<Slope> {
        let norms = columns.iter().map(|column| norm_squared(column).sqrt());
        // Of others the decomposition would not end.
        if !norms.clone().all(f64::is_finite) {
            return None;
        }
        let norms: Vec<f64> = norms.map(|norm| if norm > 0.0 { norm } else { 1.0 }).collect();
        let (rows, count) = (residuals.len(), columns.len());
        let scaled = Mat::from_fn(rows, count, |row, column| columns[column][row] / norms[column]);
        let svd = scaled.thin_svd().ok()?;
        let (left, right) = (svd.U(), svd.V());
        let singular = (0..count).map(|k| svd.S().column_vector()[k]).collect();
        let turned = |k: usize| (0..rows).map(|row| left[(row, k)] * residuals[row]).sum();
        Some(Slope {
            norms,
            singular,
            frame: (0..count).map(|row| (0..count).map(|k| right[(row, k)]).collect()).collect(),
            residuals: (0..count).map(turned).collect(),
            rows,
        })
    }

    fn step(&self, damping: f64) -> Vec<f64> {
        let share = |k: usize| {
            let s = self.singular[k];
            if s * s + damping > 0.0 { s / (s * s + damping) } else { 0.0 }
        };
        let of = |row: &Vec<f64>| -> f64 {
            (0..row.len()).map(|k| -row[k] * share(k) * self.residuals[k]).sum::<f64>()
        };
        self.frame.iter().zip(&self.norms).map(|(row, norm)| of(row) / norm).collect()
    }

    /// Whether the whole way that is left, along directions the residuals decide, is nothing, or nothing beside the standard
    /// error; both `stricter` times.
    fn is_minimum(&self, sum: f64, stricter: f64) -> bool {
        let spare = self.rows.saturating_sub(self.norms.len()).max(1);
        let deviation = (sum / spare as f64).sqrt();
        let least_norm = self.norms.iter().copied().fold(f64::INFINITY, f64::min);
        (0..self.singular.len()).filter(|k| self.is_decided(*k)).all(|k| {
            let left = self.residuals[k].abs();
            left <= stricter * WITHIN_ERROR * deviation
                || left / self.singular[k] <= stricter * NOTHING_LEFT * least_norm
        })
    }

    fn is_decided(&self, direction: usize) -> bool {
        let greatest = self.singular.iter().copied().fold(0.0, f64::max);
        self.singular[direction] > SMALLEST_SHARE * greatest
    }

    /// (J^T J)^-1, the inflation of each variance, and the condition.
    fn inverse(&self) -> (Vec<Vec<f64>>, Vec<f64>, f64) {
        let count = self.norms.len();
        let scaled = |i: usize, j: usize| -> f64 {
            (0..count)
                .filter(|k| self.is_decided(*k))
                .map(|k| self.frame[i][k] * self.frame[j][k] / self.singular[k].powi(2))
                .sum()
        };
        // Any part in a direction that is not decided: beyond rounding of the frame.
        let is_open = |i: usize| (0..count).any(|k| !self.is_decided(k) && self.frame[i][k].abs() > 1e-6);
        let entry = |i: usize, j: usize| match i == j && is_open(i) {
            true => f64::INFINITY,
            false => scaled(i, j) / (self.norms[i] * self.norms[j]),
        };
        let inverse = (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect();
        let inflation = (0..count).map(|i| if is_open(i) { f64::INFINITY } else { scaled(i, i) }).collect();
        let greatest = self.singular.iter().copied().fold(0.0, f64::max);
        let least = self.singular.iter().copied().fold(f64::INFINITY, f64::min);
        (inverse, inflation, greatest / least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = a exp(b x), whose residuals have no value for a below zero.
    struct Exponential {
        points: Vec<(f64, f64)>,
    }

    impl Problem for Exponential {
        fn residuals(&mut self, unknowns: &[f64]) -> Option<Vec<f64>> {
            let (a, b) = (unknowns[0], unknowns[1]);
            (a > 0.0).then(|| self.points.iter().map(|(x, y)| a * (b * x).exp() - y).collect())
        }

        fn derivatives(&mut self, unknowns: &[f64]) -> Option<Vec<Vec<f64>>> {
            let (a, b) = (unknowns[0], unknowns[1]);
            let column = |of: &dyn Fn(f64) -> f64| self.points.iter().map(|(x, _)| of(*x)).collect();
            Some(vec![column(&|x| (b * x).exp()), column(&|x| a * x * (b * x).exp())])
        }
    }

    #[test]
    fn exact_points_give_the_values_they_come_from() {
        let points = (0..20).map(|i| 0.1 * f64::from(i)).map(|x| (x, 2.0 * (-1.3 * x).exp())).collect();
        let minimum = minimum(&mut Exponential { points }, &[0.1, 3.0]).unwrap();
        assert!((minimum.unknowns[0] - 2.0).abs() < 1e-9 && (minimum.unknowns[1] + 1.3).abs() < 1e-9);
    }

    /// Against the normal equations of a straight line: (J^T J)^-1 by hand.
    struct Line(Vec<(f64, f64)>, bool);

    impl Problem for Line {
        fn residuals(&mut self, unknowns: &[f64]) -> Option<Vec<f64>> {
            Some(self.0.iter().map(|(x, y)| unknowns[0] + unknowns[1] * x - y).collect())
        }

        fn derivatives(&mut self, _: &[f64]) -> Option<Vec<Vec<f64>>> {
            let slope = self.0.iter().map(|(x, _)| if self.1 { 1.0 } else { *x }).collect();
            Some(vec![vec![1.0; self.0.len()], slope])
        }
    }

    #[test]
    fn the_inverse_is_that_of_the_normal_equations() {
        let points = vec![(0.0, 1.0), (1.0, 2.5), (2.0, 2.0), (3.0, 4.5)];
        let minimum = minimum(&mut Line(points.clone(), false), &[0.0, 0.0]).unwrap();
        // n = 4, sum x = 6, sum x^2 = 14, determinant 20; sum y = 10, sum xy = 20.
        let expected = [[14.0 / 20.0, -6.0 / 20.0], [-6.0 / 20.0, 4.0 / 20.0]];
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            assert!((minimum.inverse[i][j] - expected[i][j]).abs() < 1e-12, "{:?}", minimum.inverse);
        }
        assert!((minimum.unknowns[0] - 1.0).abs() < 1e-9 && (minimum.unknowns[1] - 1.0).abs() < 1e-9);
        assert!((minimum.inflation[0] - 14.0 / 5.0).abs() < 1e-12, "{:?}", minimum.inflation);
        // Columns of norm 1 with the cosine c = 6/sqrt(4 * 14): singular values sqrt(1 +- c).
        let cosine = 6.0 / 56f64.sqrt();
        assert!((minimum.condition - ((1.0 + cosine) / (1.0 - cosine)).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn what_is_not_decided_is_infinite() {
        let points = vec![(0.0, 1.0), (1.0, 2.5), (2.0, 2.0)];
        // Both derivatives are alike, and so are both residuals where x is 1.
        struct Twice(Vec<(f64, f64)>);
        impl Problem for Twice {
            fn residuals(&mut self, unknowns: &[f64]) -> Option<Vec<f64>> {
                Some(self.0.iter().map(|(_, y)| unknowns[0] + unknowns[1] - y).collect())
            }
            fn derivatives(&mut self, _: &[f64]) -> Option<Vec<Vec<f64>>> {
                Some(vec![vec![1.0; self.0.len()]; 2])
            }
        }
        let minimum = minimum(&mut Twice(points), &[0.0, 0.0]).unwrap();
        assert!(minimum.inverse[0][0].is_infinite() && minimum.inverse[1][1].is_infinite());
        assert!((minimum.unknowns[0] + minimum.unknowns[1] - 5.5 / 3.0).abs() < 1e-9);
        assert!(minimum.condition > 1e10);
    }

    /// Squares that no number holds, of residuals and of derivatives.
    #[test]
    fn numbers_that_are_too_large_come_to_an_end() {
        let far = (0..5).map(|i| (f64::from(i), 4e160)).collect();
        assert_eq!(minimum(&mut Line(far, false), &[0.0, 0.0]), Err(NoMinimum::TooFar));
        let steep = (0..5).map(|i| (1e160 * f64::from(i), 1.0)).collect();
        let error = minimum(&mut Line(steep, false), &[0.0, 0.0]).unwrap_err();
        assert!(matches!(error, NoMinimum::NotSettled { .. }), "{error:?}");
    }

    #[test]
    fn a_start_without_residuals_is_told() {
        let error = minimum(&mut Exponential { points: vec![(0.0, 1.0); 3] }, &[-1.0, 0.0]).unwrap_err();
        assert_eq!(error, NoMinimum::BadStart);
    }
}
