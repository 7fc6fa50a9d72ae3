//! The concentric body beside which a lined body on a mesh is told.
//!
//! Layers make the ring yield in waves as short as they are thin, which no few ring modes carry. So a lined body has a reference of its
//! own: a concentric body with the same layers, whose exact modes are all taken, and the mesh only carries what the body differs from
//! it:
//!
//! ```text
//!   C(body) = C_series(reference) + [C_mesh(body) - C_mesh(reference)].
//! ```
//!
//! Both meshes are the same from the ring through the layers and beyond them along the load line, so that what the mesh leaves near
//! the ring is in both and cancels, however thin a layer is beside its elements. The reference ends where its far circle is
//! hardly felt, or has a layer of elements more than that line: a concentric body is not its own reference, and its mesh can be judged
//! by `series`.

use super::lane_condensation::CondensationPlan;
use super::near_field::{DEEPEST_REFERENCE, LoadedRing, end_angle, whole_ring};
use super::ring_modes::RingModes;
use super::series::{ConcentricBody, Infinite};
use super::{BodyCompliance, Boundary};
use crate::mechanics::body::{Body, MAX_PARAMETERS, Side, annulus, cored_disc};
use crate::mechanics::grading::GradingClass;

/// A reference, on a mesh of its class.
#[derive(Clone, Debug)]
pub struct LinedReference {
    pub body: Body,
    pub class: GradingClass,
    half_ring: bool,
}

impl LinedReference {
    /// Of a lined body on a mesh of a class.
    pub fn of(body: &Body, class: GradingClass) -> LinedReference {
        let (rest, radius_ratio) = body.beyond_lining();
        let to_boundary = (rest.shape.depth)(&rest.parameters, 0.0);
        let growth = class.layers_of(body).growth(to_boundary, 1.0);
        let enough = DEEPEST_REFERENCE - radius_ratio.ln().abs();
        let (class, depth) = class.beside(body, enough, growth);
        let mut parameters = [0.0; MAX_PARAMETERS];
        let (shape, from_interface) = match body.shape.side {
            Side::Plate => (&annulus::SHAPE, depth.exp()),
            Side::Pin => (&cored_disc::SHAPE, (-depth).exp()),
        };
        parameters[0] = radius_ratio * from_interface;
        let half_ring = body.shape.end_angle < std::f64::consts::PI;
        LinedReference { body: Body { shape, parameters, support: 0, ..body.clone() }, class, half_ring }
    }

    /// Its ring.
    pub fn ring(&self) -> LoadedRing {
        LoadedRing::of_reference(self.body.shape.side, self.half_ring, self.class)
    }

    /// For references of one class, with the loads of the modes on their ring.
    pub fn plan(&self, loads: &[Vec<f64>]) -> CondensationPlan {
        let grading = whole_ring(&self.class, end_angle(self.half_ring));
        CondensationPlan::with_loads(&self.body, grading, RingModes::of(&self.class), loads)
    }

    /// The compliance of the body by its condensed works and those of this reference.
    pub fn compliance(&self, body: &Body, mut works: Vec<f64>, own_works: &[f64]) -> BodyCompliance {
        works.iter_mut().zip(own_works).for_each(|(work, own)| *work -= own);
        let Some(reference) = ConcentricBody::of(&self.body) else {
            unreachable!("a reference is concentric")
        };
        let [normal, mut along] = reference.boundary_modes();
        if body.shape.side == Side::Plate {
            along.clear();
        }
        let boundary = Boundary::BesideModes { normal, along, modes: RingModes::of(&self.class), works };
        let Infinite { even, odd, bed } = reference.infinite();
        BodyCompliance { even, odd, bed, ..BodyCompliance::new(body, boundary) }
    }
}
