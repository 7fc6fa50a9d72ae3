//! A cubic between logarithms through every fourth state with its slope: C1 and monotone, a power law at both ends.

use std::fmt::Write;

use super::{CalibratedLaw, Number, Sample, Samples};

pub static LAW: CalibratedLaw = CalibratedLaw {
    name: "spline",
    outside: "goes on as the power of its first and last slope",
    constants: &[],
    range: Samples::range,
    fit,
    value,
    formula: |constants, sizes| {
        let mut text = String::from("cubic Hermite in ln d and ln F through (d, F, d ln F/d ln d) =");
        for point in constants.chunks_exact(3) {
            let indentation = point[0].exp() * sizes.radial_clearance;
            let force = point[1].exp() * sizes.stiffness * sizes.radial_clearance;
            // A String takes every write.
            let _ = write!(text, " ({}, {}, {})", Number(indentation), Number(force), Number(point[2]));
        }
        text
    },
};

/// ln x, ln y and d ln y/d ln x of each knot, in their order.
fn fit(samples: &[Sample]) -> Option<Vec<f64>> {
    let last = samples.len().checked_sub(1)?;
    let knots = (0..=last).filter(|place| place.is_multiple_of(2) || *place == last);
    let constants: Vec<f64> = knots
        .flat_map(|place| {
            let Sample { x, y, exponent } = samples[place];
            [x.ln(), y.ln(), exponent]
        })
        .collect();
    // Fritsch and Carlson: no slope at a knot above three times that of a piece beside it.
    let is_monotone = |pair: (&[f64], &[f64])| {
        let secant = (pair.1[1] - pair.0[1]) / (pair.1[0] - pair.0[0]);
        [pair.0[2], pair.1[2]].iter().all(|slope| (0.0..=3.0 * secant).contains(slope))
    };
    let pieces = constants.chunks_exact(3).zip(constants.chunks_exact(3).skip(1));
    pieces.into_iter().all(is_monotone).then_some(constants)
}

fn value(constants: &[f64], x: f64, _: f64) -> [f64; 2] {
    let at = x.ln();
    let (knots, _) = constants.as_chunks::<3>();
    let above = knots.partition_point(|knot| knot[0] < at);
    let [logarithm, slope] = if above == 0 || above == knots.len() {
        let knot = knots[above.saturating_sub(1)];
        [knot[1] + knot[2] * (at - knot[0]), knot[2]]
    } else {
        let [a, b] = [knots[above - 1], knots[above]];
        let width = b[0] - a[0];
        let t = (at - a[0]) / width;
        let (rise, of_a, of_b) = (b[1] - a[1], width * a[2], width * b[2]);
        let cubic = [of_a + of_b - 2.0 * rise, 3.0 * rise - 2.0 * of_a - of_b];
        [
            a[1] + t * (of_a + t * (cubic[1] + t * cubic[0])),
            (of_a + t * (2.0 * cubic[1] + t * 3.0 * cubic[0])) / width,
        ]
    };
    let y = logarithm.exp();
    [y, slope * y / x]
}
