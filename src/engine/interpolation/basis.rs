//! What the boundaries of a family's bodies are told in, all alike: the numbers that are fitted.

use std::collections::HashMap;

use crate::engine::body_request::{concentric, mesh_class};
use crate::engine::interpolation::family::{Family, body_at};
use crate::mechanics::body::{Body, Side};
use crate::mechanics::compliance::concentric_body::ConcentricBody;
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::compliance::series::NEGLIGIBLE_SECOND;
use crate::mechanics::compliance::{BodyCompliance, Boundary};

/// The finest that any body of a family is told in.
#[derive(Clone, Copy, Debug)]
pub struct Basis {
    first: First,
    /// `BodyCompliance::second` of so many modes.
    second: usize,
}

#[derive(Clone, Copy, Debug)]
enum First {
    /// Of exact bodies, so many modes.
    Modes(usize),
    /// Of bodies on meshes.
    RingModes(RingModes),
}

impl Basis {
    /// Of a family with its bodies on a mesh level, or exact: thin walls ask for most, and the thinnest is in a corner.
    pub fn of(family: &Family, level: usize) -> Basis {
        let corners = family.grid([0.0, 0.5, 1.0]).into_iter();
        let bodies: Vec<Body> = corners.map(|unit| body_at(&family.example, &family.place(&unit))).collect();
        let of_second =
            |body: &Body| ConcentricBody::of(body).map(|body| body.second_order_count(NEGLIGIBLE_SECOND));
        let second = match family.example.shape.side {
            Side::Pin => bodies.iter().filter_map(of_second).max().unwrap_or(0),
            Side::Plate => 0,
        };
        let first = if family.exact {
            First::Modes(bodies.iter().map(|body| concentric(body).highest_mode() + 1).max().unwrap_or(0))
        } else {
            let modes = bodies.iter().map(|body| RingModes::of(&mesh_class(body, level))).max();
            First::RingModes(modes.unwrap_or(RingModes::of(&mesh_class(&family.example, level))))
        };
        Basis { first, second }
    }

    /// What bodies of the family change at their boundary, `[body][number]`.
    pub fn numbers<'a>(&self, bodies: impl Iterator<Item = &'a BodyCompliance>) -> Vec<Vec<f64>> {
        let mut from_others = HashMap::new();
        let mut of_first = |body: &BodyCompliance| match (&self.first, &body.boundary) {
            (First::Modes(count), Boundary::Modes { normal, along }) => {
                let mut numbers = normal.clone();
                numbers.resize(*count, 0.0);
                if !along.is_empty() {
                    numbers.extend(along);
                    numbers.resize(2 * count, 0.0);
                }
                numbers
            }
            (First::RingModes(own), Boundary::RingModes(others, works)) if own != others => {
                from_others.entry(*others).or_insert_with(|| own.works_of_others(others))(works)
            }
            (First::RingModes(_), Boundary::RingModes(_, works)) => works.clone(),
            // No body of a family is a bed, and all are found alike.
            (_, boundary) => unreachable!("{boundary:?} in {self:?}"),
        };
        let of_body = |body: &BodyCompliance| {
            let mut numbers = of_first(body);
            let first = numbers.len();
            numbers.extend(body.second.as_flattened());
            numbers.resize(first + 3 * self.second, 0.0);
            numbers
        };
        bodies.map(of_body).collect()
    }

    /// The reverse of `numbers`, of a body whose infinite part has these amplitudes.
    pub fn compliance(&self, [even, odd]: [f64; 2], numbers: &[f64]) -> BodyCompliance {
        let (first, second) = numbers.split_at(numbers.len() - 3 * self.second);
        let boundary = match self.first {
            First::Modes(count) => {
                let (normal, along) = first.split_at(count);
                Boundary::Modes { normal: normal.to_vec(), along: along.to_vec() }
            }
            First::RingModes(modes) => Boundary::RingModes(modes, first.to_vec()),
        };
        BodyCompliance { even, odd, bed: 0.0, boundary, second: second.as_chunks().0.to_vec() }
    }
}
