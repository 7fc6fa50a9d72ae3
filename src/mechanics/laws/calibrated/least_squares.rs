//! Small weighted least squares, by Gram and Schmidt.

use smallvec::SmallVec;

/// Room for one problem after the other.
pub struct LeastSquares<const UNKNOWNS: usize> {
    columns: [Row; UNKNOWNS],
    left: Row,
    own_weights: Row,
}

/// As long as laws are fitted to states, without room from the system.
type Row = SmallVec<[f64; 16]>;

impl<const UNKNOWNS: usize> LeastSquares<UNKNOWNS> {
    pub fn new() -> LeastSquares<UNKNOWNS> {
        LeastSquares {
            columns: std::array::from_fn(|_| Row::new()),
            left: Row::new(),
            own_weights: Row::new(),
        }
    }

    /// The numbers that minimise the sum of the squares of weight * (value - row . numbers), and that sum; `None` where rows do not
    /// determine them.
    pub fn solve(
        &mut self,
        rows: &[[f64; UNKNOWNS]],
        values: &[f64],
        weights: &[f64],
    ) -> Option<([f64; UNKNOWNS], f64)> {
        let LeastSquares { columns, left, .. } = self;
        for (j, column) in columns.iter_mut().enumerate() {
            column.clear();
            column.extend(rows.iter().zip(weights).map(|(row, weight)| weight * row[j]));
        }
        left.clear();
        left.extend(values.iter().zip(weights).map(|(value, weight)| weight * value));
        let mut upper = [[0.0; UNKNOWNS]; UNKNOWNS];
        let mut right = [0.0; UNKNOWNS];
        for j in 0..UNKNOWNS {
            let (done, rest) = columns.split_at_mut(j);
            let own = &mut rest[0];
            let before = dot(own, own).sqrt();
            for (k, column) in done.iter().enumerate() {
                upper[k][j] = dot(column, own);
                subtract(own, upper[k][j], column);
            }
            let size = dot(own, own).sqrt();
            // Nothing new in this column, or no number.
            if size.is_nan() || size <= 1e-10 * before {
                return None;
            }
            upper[j][j] = size;
            own.iter_mut().for_each(|value| *value /= size);
            right[j] = dot(own, left);
            subtract(left, right[j], own);
        }
        for j in (0..UNKNOWNS).rev() {
            let known: f64 = (j + 1..UNKNOWNS).map(|k| upper[j][k] * right[k]).sum();
            right[j] = (right[j] - known) / upper[j][j];
        }
        right.iter().all(|value| value.is_finite()).then(|| (right, dot(left, left)))
    }

    /// The same with the greatest weighted residual lessened, and that residual: so many steps of Lawson's way.
    pub fn even(
        &mut self,
        steps: usize,
        rows: &[[f64; UNKNOWNS]],
        values: &[f64],
        weights: &[f64],
    ) -> Option<([f64; UNKNOWNS], f64)> {
        let mut own = std::mem::take(&mut self.own_weights);
        own.clear();
        own.extend_from_slice(weights);
        let residual = |numbers: &[f64; UNKNOWNS], i: usize| {
            let sum: f64 = rows[i].iter().zip(numbers).map(|(row, number)| row * number).sum();
            (weights[i] * (values[i] - sum)).abs()
        };
        let mut best: Option<([f64; UNKNOWNS], f64)> = None;
        for step in 1..=steps {
            let (numbers, _) = self.solve(rows, values, &own)?;
            let worst = (0..rows.len()).map(|i| residual(&numbers, i)).fold(0.0, f64::max);
            if best.is_none_or(|(_, least)| worst < least) {
                best = Some((numbers, worst));
            }
            if worst == 0.0 || step == steps {
                break;
            }
            // The square root of Lawson's factor, since squares are summed; never nothing.
            for (i, own) in own.iter_mut().enumerate() {
                *own *= (residual(&numbers, i) / worst).sqrt().max(0.1);
            }
        }
        self.own_weights = own;
        best
    }
}

/// In four sums, which do not wait for each other.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    for (a, b) in a.iter().zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    rest + sums[0] + sums[1] + sums[2] + sums[3]
}

fn subtract(from: &mut [f64], factor: f64, column: &[f64]) {
    from.iter_mut().zip(column).for_each(|(own, other)| *own -= factor * other);
}

/// Of Lawson's way: more gain little.
const STEPS: usize = 3;

/// One fit with about the least worst residual.
pub fn even_fit<const UNKNOWNS: usize>(
    rows: &[[f64; UNKNOWNS]],
    values: &[f64],
    weights: &[f64],
) -> Option<([f64; UNKNOWNS], f64)> {
    LeastSquares::new().even(STEPS, rows, values, weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_data_are_found_and_dependent_columns_refused() {
        let rows: Vec<[f64; 3]> = (1..9).map(f64::from).map(|x| [1.0, x, 1.0 / x]).collect();
        let values: Vec<f64> = rows.iter().map(|row| 2.0 * row[0] - 0.5 * row[1] + 3.0 * row[2]).collect();
        let (found, _) = LeastSquares::new().solve(&rows, &values, &[0.7; 8]).unwrap();
        for (found, expected) in found.into_iter().zip([2.0, -0.5, 3.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        let dependent: Vec<[f64; 2]> = rows.iter().map(|row| [row[1], 2.0 * row[1]]).collect();
        assert!(LeastSquares::new().solve(&dependent, &values, &[1.0; 8]).is_none());
        assert!(LeastSquares::new().solve(&rows, &[f64::NAN; 8], &[1.0; 8]).is_none());
    }

    /// The best line to sqrt(x) on [0, 1] errs by 1/8 at both ends and in the middle.
    #[test]
    fn an_even_fit_has_less_of_the_worst() {
        let places: Vec<f64> = (0..=40).map(|i| f64::from(i) / 40.0).collect();
        let rows: Vec<[f64; 2]> = places.iter().map(|x| [1.0, *x]).collect();
        let values: Vec<f64> = places.iter().map(|x| x.sqrt()).collect();
        let (_, worst) = even_fit(&rows, &values, &[1.0; 41]).unwrap();
        assert!((0.125..0.15).contains(&worst), "{worst}");
    }
}
