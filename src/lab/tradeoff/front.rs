//! The Pareto front: what nothing else beats in both time and error.

/// An error that is less by a smaller share than this is no less.
const TELLING: f64 = 0.01;

/// Which of the points (time, error) no faster one beats, and of equally fast ones the nearest: every point of the front
/// is nearer by more than `TELLING` than all that are faster. A point that is not a number in both, or `None`, is not on
/// the front.
pub fn front(points: &[Option<(f64, f64)>]) -> Vec<bool> {
    let mut order: Vec<(usize, (f64, f64))> = points
        .iter()
        .enumerate()
        .filter_map(|(index, point)| Some((index, (*point)?)))
        .filter(|(_, (time, error))| time.is_finite() && error.is_finite())
        .collect();
    order.sort_by(|(_, a), (_, b)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut on_front = vec![false; points.len()];
    let mut least = f64::INFINITY;
    for (index, (_, error)) in order {
        if error < (1.0 - TELLING) * least {
            least = error;
            on_front[index] = true;
        }
    }
    on_front
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nothing_beats_is_on_the_front() {
        let points = [
            Some((1.0, 1e-1)),
            Some((2.0, 1e-1)), // Slower than the first and no better.
            Some((3.0, 1e-3)),
            Some((3.0, 1e-2)), // As slow as the one before and worse.
            Some((2.5, 5e-2)),
            Some((9.0, 2e-3)),      // Beaten in both.
            Some((9.5, 0.9999e-3)), // No nearer than rounding.
            Some((10.0, 0.0)),
        ];
        assert_eq!(front(&points), [true, false, true, false, true, false, false, true]);
        let backwards: Vec<_> = points.iter().rev().copied().collect();
        assert_eq!(front(&backwards), [true, false, false, true, false, true, false, true]);
    }

    #[test]
    fn of_equal_points_the_first_and_of_no_numbers_none() {
        assert_eq!(front(&[Some((1.0, 1.0)), Some((1.0, 1.0))]), [true, false]);
        assert!(front(&[None, Some((f64::NAN, 0.0)), Some((0.5, f64::NAN)), Some((1.0, 1.0))])[3]);
        assert_eq!(front(&[None, Some((f64::NAN, 0.0)), Some((0.5, f64::INFINITY))]), [false; 3]);
        assert!(front(&[]).is_empty());
    }
}
