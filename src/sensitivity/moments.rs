//! Sums over the rows of Saltelli's design, of which every index is made: memory does not grow with the rows.

/// Groups of neighbouring rows at most; there are more than half as many where there are enough rows. The bootstrap draws
/// whole groups: points of a Sobol sequence that follow each other are spread evenly, and groups scatter as little as that,
/// where single rows would scatter like random ones and make the intervals several times too wide.
pub const MOST_GROUPS: u64 = 64;

/// Sums over rows of values less a value near them, which keeps their digits. A and B are the outputs of a row's two
/// points, C_i that of A with factor i of B.
#[derive(Clone, Debug)]
pub struct Sums {
    pub rows: f64,
    /// Of A + B.
    pub values: f64,
    /// Of A^2 + B^2.
    pub squares: f64,
    /// Of C_i - A.
    pub change: Vec<f64>,
    /// Of B (C_i - A).
    pub change_with_b: Vec<f64>,
    /// Of (C_i - A)^2.
    pub change_squared: Vec<f64>,
}

impl Sums {
    pub fn new(factors: usize) -> Sums {
        let zeros = vec![0.0; factors];
        Sums {
            rows: 0.0,
            values: 0.0,
            squares: 0.0,
            change: zeros.clone(),
            change_with_b: zeros.clone(),
            change_squared: zeros,
        }
    }

    /// A row's A, B, C_1, C_2 ...
    fn add_row(&mut self, row: impl Fn(usize) -> f64) {
        let (a, b) = (row(0), row(1));
        self.rows += 1.0;
        self.values += a + b;
        self.squares += a * a + b * b;
        for factor in 0..self.change.len() {
            let change = row(factor + 2) - a;
            self.change[factor] += change;
            self.change_with_b[factor] += b * change;
            self.change_squared[factor] += change * change;
        }
    }

    pub fn add(&mut self, other: &Sums) {
        self.rows += other.rows;
        self.values += other.values;
        self.squares += other.squares;
        for (own, others) in [
            (&mut self.change, &other.change),
            (&mut self.change_with_b, &other.change_with_b),
            (&mut self.change_squared, &other.change_squared),
        ] {
            own.iter_mut().zip(others).for_each(|(own, other)| *own += other);
        }
    }
}

/// The rows of one output, in groups of neighbours.
#[derive(Clone, Debug)]
pub struct Moments {
    factors: usize,
    /// Rows of a group: a power of two, as blocks of a Sobol sequence are.
    group_length: u64,
    next_row: u64,
    left_out: u64,
    /// Subtracted from all values.
    origin: Option<f64>,
    groups: Vec<Sums>,
}

impl Moments {
    /// For as many rows as will come.
    pub fn new(factors: usize, rows: u64) -> Moments {
        let group_length = rows.div_ceil(MOST_GROUPS).max(1).next_power_of_two();
        Moments { factors, group_length, next_row: 0, left_out: 0, origin: None, groups: Vec::new() }
    }

    /// Takes the next row: A, B, C_1, C_2 ... A row in which a value is missing is left out and counted.
    pub fn add_row(&mut self, row: &[Option<f64>]) {
        if self.next_row.is_multiple_of(self.group_length) {
            self.groups.push(Sums::new(self.factors));
        }
        self.next_row += 1;
        let is_whole = row.iter().all(|value| value.is_some_and(f64::is_finite));
        if let (true, Some(group)) = (is_whole, self.groups.last_mut()) {
            let value = |place: usize| row[place].unwrap_or_default();
            let origin = *self.origin.get_or_insert(value(0));
            group.add_row(|place| value(place) - origin);
        } else {
            self.left_out += 1;
        }
    }

    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// What all sums are relative to.
    pub fn origin(&self) -> f64 {
        self.origin.unwrap_or(0.0)
    }

    pub fn factors(&self) -> usize {
        self.factors
    }

    /// The groups that have rows.
    pub fn groups(&self) -> impl Iterator<Item = &Sums> {
        self.groups.iter().filter(|group| group.rows > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_few_and_none_for_a_handful() {
        for (rows, groups, longest) in
            [(5, 5, 1), (64, 64, 1), (65, 33, 2), (1000, 63, 16), (3000, 47, 64), (1 << 20, 64, 1 << 14)]
        {
            let mut moments = Moments::new(1, rows);
            (0..rows).for_each(|row| moments.add_row(&[Some(row as f64), Some(1.0), Some(2.0)]));
            let lengths: Vec<f64> = moments.groups().map(|group| group.rows).collect();
            assert_eq!((lengths.len(), lengths[0]), (groups, f64::from(longest)), "{rows}");
            assert_eq!(lengths.iter().sum::<f64>(), rows as f64);
        }
    }

    #[test]
    fn a_row_with_a_hole_is_left_out_whole() {
        let mut moments = Moments::new(1, 3);
        for row in [
            [Some(1.0), Some(2.0), None],
            [Some(4.0), Some(6.0), Some(5.0)],
            [Some(f64::NAN), Some(0.0), Some(0.0)],
        ] {
            moments.add_row(&row);
        }
        assert_eq!((moments.left_out(), moments.origin()), (2, 4.0));
        let sums: Vec<&Sums> = moments.groups().collect();
        assert_eq!(sums.len(), 1);
        assert_eq!((sums[0].values, sums[0].squares), (2.0, 4.0));
        assert_eq!((sums[0].change[0], sums[0].change_with_b[0], sums[0].change_squared[0]), (1.0, 2.0, 1.0));
    }
}
