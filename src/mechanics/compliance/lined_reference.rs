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

use super::concentric_body::ConcentricBody;
use super::near_field::{DEEPEST_REFERENCE, ReferenceMesh};
use super::ring_modes::RingModes;
use super::series::Infinite;
use super::{BodyCompliance, Boundary};
use crate::mechanics::body::{Body, Side};
use crate::mechanics::grading::GradingClass;

/// A reference, on a mesh of its class.
#[derive(Clone, Debug)]
pub struct LinedReference {
    pub body: Body,
    pub mesh: ReferenceMesh,
}

impl LinedReference {
    /// Of a lined body on a mesh of a class.
    pub fn of(body: &Body, class: GradingClass) -> LinedReference {
        let (rest, radius_ratio) = body.beyond_lining();
        let to_boundary = (rest.shape.depth)(&rest.parameters, 0.0);
        let growth = class.layers_of(body).growth(to_boundary, 1.0);
        let enough = DEEPEST_REFERENCE - radius_ratio.ln().abs();
        let (layers, depth) = class.beside(body, enough, growth);
        let side = body.shape.side;
        let fixed_radius_ratio = radius_ratio * (side.outward() * depth).exp();
        let reference = Body {
            lining: body.lining.clone(),
            all_around: body.all_around,
            ..Body::concentric(fixed_radius_ratio, body.poissons_ratio, body.idealization)
        };
        let half_ring = body.shape.end_angle < std::f64::consts::PI;
        LinedReference { body: reference, mesh: ReferenceMesh { side, half_ring, layers } }
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
        let boundary =
            Boundary::BesideModes { normal, along, modes: RingModes::of(&self.mesh.layers), works };
        let Infinite { even, odd, bed } = reference.infinite();
        BodyCompliance { even, odd, bed, ..BodyCompliance::new(body, boundary) }
    }
}
