//! What the boundaries of a family's bodies are told in, all alike: the numbers that are fitted.

use std::collections::HashMap;

use crate::engine::body_request::{concentric, mesh_class};
use crate::engine::interpolation::family::{Family, body_at};
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::compliance::{BodyCompliance, Boundary};

/// The finest that any body of a family is told in.
#[derive(Clone, Copy, Debug)]
pub enum Basis {
    /// Of exact bodies, so many modes.
    Modes(usize),
    /// Of bodies on meshes.
    RingModes(RingModes),
}

impl Basis {
    /// Of a family with its bodies on a mesh level, or exact: thin walls ask for most, and the thinnest is in a corner.
    pub fn of(family: &Family, level: usize) -> Basis {
        let corners = family.grid([0.0, 0.5, 1.0]).into_iter();
        let bodies = corners.map(|unit| body_at(&family.example, &family.place(&unit)));
        if family.exact {
            Basis::Modes(bodies.map(|body| concentric(&body).highest_mode() + 1).max().unwrap_or(0))
        } else {
            let modes = bodies.map(|body| RingModes::of(&mesh_class(&body, level))).max();
            Basis::RingModes(modes.unwrap_or(RingModes::of(&mesh_class(&family.example, level))))
        }
    }

    /// What bodies of the family change at their boundary, `[body][number]`.
    pub fn numbers<'a>(&self, bodies: impl Iterator<Item = &'a BodyCompliance>) -> Vec<Vec<f64>> {
        let mut from_others = HashMap::new();
        let of_body = |body: &BodyCompliance| match (self, &body.boundary) {
            (Basis::Modes(count), Boundary::Modes { normal, along }) => {
                let mut numbers = normal.clone();
                numbers.resize(*count, 0.0);
                if !along.is_empty() {
                    numbers.extend(along);
                    numbers.resize(2 * count, 0.0);
                }
                numbers
            }
            (Basis::RingModes(own), Boundary::RingModes(others, works)) if own != others => {
                from_others.entry(*others).or_insert_with(|| own.works_of_others(others))(works)
            }
            (Basis::RingModes(_), Boundary::RingModes(_, works)) => works.clone(),
            // No body of a family is a bed, and all are found alike.
            (_, boundary) => unreachable!("{boundary:?} in {self:?}"),
        };
        bodies.map(of_body).collect()
    }

    /// The reverse of `numbers`.
    pub fn boundary(&self, numbers: &[f64]) -> Boundary {
        match self {
            Basis::Modes(count) => {
                let (normal, along) = numbers.split_at(*count);
                Boundary::Modes { normal: normal.to_vec(), along: along.to_vec() }
            }
            Basis::RingModes(modes) => Boundary::RingModes(*modes, numbers.to_vec()),
        }
    }
}
