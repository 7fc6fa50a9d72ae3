//! How the bonded layers of a body are divided into rows of elements, whose edges follow the interfaces.
//!
//! ```text
//!   ring |h|  h g  |   h g^2   | interface |  ...  | interface | what is left: divided like a bare body
//!        <----- first layer --------->
//! ```
//!
//! Rows grow as they do without interfaces, h, h g, h g^2, ...; those of a layer are as few as fill it, and are shrunk alike to end at
//! its interface. What is beyond all interfaces is a body of its own, its ring being the outermost one.

use super::body::Body;
use super::body::lining::MOST_LAYERS;
use super::layers::{Layers, layer_thicknesses};

/// Rows of elements in each bonded layer, from the ring on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct LiningRows([u8; MOST_LAYERS]);

/// How bonded layers are divided, and where what is left begins to be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LiningDivision {
    pub rows: LiningRows,
    /// By how much a row exceeds the one before.
    pub growth: f64,
    /// The first row beyond all interfaces is no thicker.
    pub thickest_first: f64,
}

/// The rows of a body: depths below its ring, |ln r|.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyRows {
    /// Where each row of a bonded layer begins; none of a bare body.
    pub starts: Vec<f64>,
    /// How what is left beyond the layers is divided, a body of its own.
    pub rest: Layers,
}

impl LiningRows {
    /// Of all layers together.
    pub fn total(self) -> usize {
        self.0.iter().map(|rows| usize::from(*rows)).sum()
    }

    /// Of each row its material: 0 at the ring, 1 beyond the first interface, and so on.
    pub fn materials(self) -> impl Iterator<Item = usize> {
        (0..).zip(self.0).flat_map(|(layer, rows)| std::iter::repeat_n(layer, usize::from(rows)))
    }
}

impl LiningDivision {
    /// With the fewest rows that fill each layer of a body.
    pub fn of(body: &Body, layers: Layers, growth: f64, thickest_first: f64) -> LiningDivision {
        let mut rows = LiningRows::default();
        let mut numbers = rows.0.iter_mut();
        divide(body, layers, growth, |thickness, first| {
            let mut reached = 0.0;
            let is_short = |row: &f64| {
                reached += row;
                reached < (1.0 - ROUNDING) * thickness
            };
            let natural = layer_thicknesses(first, layers.thickest, growth);
            let before = natural.take_while(is_short).take(usize::from(u8::MAX) - 1).count();
            if let Some(number) = numbers.next() {
                *number = before as u8 + 1;
            }
            before + 1
        });
        LiningDivision { rows, growth, thickest_first }
    }

    /// The rows of a body that is divided so. `layers` are those it has if it is bare; how many there are, and how many of them shrink,
    /// is said of what is beyond all interfaces.
    pub fn divided(&self, body: &Body, layers: Layers) -> BodyRows {
        let mut numbers = self.rows.0.into_iter();
        let (starts, next) = divide(body, layers, self.growth, |_, _| numbers.next().map_or(1, usize::from));
        let first = if starts.is_empty() { layers.first } else { next.min(self.thickest_first) };
        BodyRows { starts, rest: Layers { first, ..layers } }
    }
}

/// Where rows begin and how thick the next one is, each layer divided into as many as `count` says of its thickness and first row.
fn divide(
    body: &Body,
    layers: Layers,
    growth: f64,
    mut count: impl FnMut(f64, f64) -> usize,
) -> (Vec<f64>, f64) {
    let (mut first, mut depth, mut starts) = (layers.first, 0.0, Vec::new());
    for interface in body.lining.list() {
        let end = interface.radius_ratio.ln().abs();
        let rows: Vec<f64> =
            layer_thicknesses(first, layers.thickest, growth).take(count(end - depth, first)).collect();
        let scale = (end - depth) / rows.iter().sum::<f64>();
        for row in &rows {
            starts.push(depth);
            depth += scale * row;
        }
        depth = end;
        let last = rows.last().map_or(first, |last| scale * last);
        first = (growth * last).clamp(layers.first, layers.thickest);
    }
    (starts, first)
}

/// Rows that leave this part of a thickness fill it.
const ROUNDING: f64 = 1e-9;
