//! Where a family is sampled, and where its fit is checked.

use crate::engine::interpolation::family::{Family, MOST_COORDINATES};
use crate::mechanics::compliance::body_fit::Polynomials;

/// Degrees tried, by how many coordinates vary: of the ratios and of Poisson's ratio.
pub(super) const DEGREES: [&[(usize, usize)]; MOST_COORDINATES + 1] = [
    &[(0, 0)],
    &[(6, 6), (10, 8), (16, 10)],
    &[(8, 5), (12, 6), (16, 8)],
    &[(6, 5), (8, 6), (10, 6)],
    &[(6, 6), (8, 6), (10, 6)],
];

/// Samples for each product of polynomials.
const OVERSAMPLING: usize = 2;

/// Shapes for each product of the ratios alone, where every shape comes with several of Poisson's ratios.
const OVERSAMPLING_SHAPES: f64 = 1.2;

/// Poisson's ratios of each shape sampled.
const REPEATS: [usize; MOST_COORDINATES + 1] = [1, 1, 1, 4, 4];

/// Where samples lie along a side of the unit box, besides those within.
const SAMPLED_SIDES: [f64; 3] = [0.0, 0.5, 1.0];

/// Bodies held out, besides those near corners, edges and sides.
const HELD_OUT: usize = 60;

impl Family {
    pub(super) fn polynomials(&self, (of_ratios, of_poisson): (usize, usize)) -> Polynomials {
        let mut degrees = vec![of_ratios; self.ranges.len()];
        if let Some(last) = degrees.last_mut() {
            *last = of_poisson;
        }
        Polynomials::new(self.ranges.clone(), &degrees)
    }

    /// Samples, besides those of the grid, that determine polynomials of these degrees.
    pub(super) fn sample_count(&self, degrees: (usize, usize)) -> usize {
        let count = self.polynomials(degrees).count();
        let repeats = self.repeats();
        if repeats == 1 {
            return OVERSAMPLING * count;
        }
        let of_shape = vec![degrees.0; self.ranges.len() - 1];
        let shapes = Polynomials::new(self.ranges[..of_shape.len()].to_vec(), &of_shape).count();
        (OVERSAMPLING_SHAPES * shapes as f64) as usize * repeats
    }

    /// Poisson's ratios sampled of each shape: where shapes have meshes of their own they fill the lanes of one batch.
    fn repeats(&self) -> usize {
        if self.exact { 1 } else { REPEATS[self.free()] }
    }

    pub(super) fn place(&self, unit: &[f64]) -> Vec<f64> {
        unit.iter().zip(&self.ranges).map(|(unit, (low, high))| low + unit * (high - low)).collect()
    }

    /// How many points there are with so many besides the grid.
    pub(super) fn sample_points_with(&self, count: usize) -> usize {
        self.grid(SAMPLED_SIDES).len() + count
    }

    /// Where the samples are: on corners, edges and sides, where nothing holds polynomials, then points that are dense at the ends like Chebyshev's, and often on them.
    pub(super) fn sample_points(&self, count: usize) -> Vec<Vec<f64>> {
        let dense = |unit: f64| to_ends(0.5 - 0.5 * (std::f64::consts::PI * unit).cos(), 0.03, 0.0);
        let inner = self.spread(count, 0.5).map(|unit| unit.into_iter().map(dense).collect::<Vec<f64>>());
        self.grid(SAMPLED_SIDES).into_iter().chain(inner).map(|unit| self.place(&unit)).collect()
    }

    /// Where the fit is checked: near the corners, edges and sides, where it is at its worst, and everywhere else.
    pub(super) fn held_out_points(&self) -> Vec<Vec<f64>> {
        let near_ends = |unit: f64| to_ends(unit, 0.12, 0.01);
        let inner =
            self.spread(HELD_OUT, 0.21).map(|unit| unit.into_iter().map(near_ends).collect::<Vec<f64>>());
        self.grid([0.01, 0.3, 0.99]).into_iter().chain(inner).map(|unit| self.place(&unit)).collect()
    }

    /// Points of an evenly spread sequence in the unit box.
    fn spread(&self, count: usize, offset: f64) -> impl Iterator<Item = Vec<f64>> {
        let repeats = self.repeats();
        let of_shapes = if repeats == 1 { self.ranges.len() } else { self.ranges.len() - 1 };
        let shapes = Sequence::new(of_shapes, offset);
        let repeated = Sequence::new(self.ranges.len() - of_shapes, offset);
        (0..count).map(move |index| shapes.at(index / repeats).chain(repeated.at(index)).collect())
    }

    /// Corners, edges and sides of the unit box: all points with these on each coordinate; one without width has one.
    pub(super) fn grid(&self, along: [f64; 3]) -> Vec<Vec<f64>> {
        let mut points = vec![Vec::new()];
        for (low, high) in &self.ranges {
            let along = if high > low { &along[..] } else { &along[..1] };
            let extended = points.iter().flat_map(|point: &Vec<f64>| {
                along.iter().map(move |unit| point.iter().copied().chain([*unit]).collect())
            });
            points = extended.collect();
        }
        points
    }
}

/// What is close to an end of the unit interval goes to a margin from it.
fn to_ends(unit: f64, close: f64, margin: f64) -> f64 {
    match unit {
        low if low < close => margin,
        high if high > 1.0 - close => 1.0 - margin,
        between => between,
    }
}

/// An evenly spread sequence in the unit box: multiples of the powers of the root of x^(d+1) = x + 1
/// (M. Roberts, The unreasonable effectiveness of quasirandom sequences, 2018).
struct Sequence {
    steps: Vec<f64>,
    offset: f64,
}

impl Sequence {
    fn new(dimensions: usize, offset: f64) -> Sequence {
        let mut root: f64 = 2.0;
        for _ in 0..64 {
            let next = (1.0 + root).powf(1.0 / (dimensions as f64 + 1.0));
            if std::mem::replace(&mut root, next) == next {
                break;
            }
        }
        let steps = (0..dimensions).map(|dimension| root.powi(-(dimension as i32 + 1))).collect();
        Sequence { steps, offset }
    }

    fn at(&self, index: usize) -> impl Iterator<Item = f64> {
        self.steps.iter().map(move |step| (self.offset + step * (index as f64 + 1.0)).fract())
    }
}
