//! What is asked of a body: how finely, and what it then shares with others.

use crate::mechanics::body::{Body, Shape};
use crate::mechanics::compliance::concentric_body::ConcentricBody;
use crate::mechanics::element::ElementKind;
use crate::mechanics::grading::{GradingClass, RingDivision};
use crate::mechanics::material::Idealization;
use crate::mechanics::mesh::{Grading, Held};

/// How a body's compliance is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fidelity {
    /// Exact, mode by mode; concentric bodies only.
    Series,
    /// On a mesh of this level.
    Mesh { level: usize },
}

/// A body to solve. Equal ones have the same answer.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct BodyRequest {
    pub body: Body,
    pub fidelity: Fidelity,
}

/// The elements of every mesh: the error of a compliance is of fourth order with Q8, of second with Q4 (tests/mechanics/lame.rs).
pub const ELEMENT: ElementKind = ElementKind::Quad8;

/// The class of a body's mesh at a level.
pub fn mesh_class(body: &Body, level: usize) -> GradingClass {
    GradingClass::of(body, ELEMENT, level)
}

/// How large a body's mesh is.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeshSize {
    pub unknowns: u64,
    pub layers: u64,
}

impl MeshSize {
    /// Unknowns of a layer.
    pub fn width(self) -> f64 {
        self.unknowns as f64 / self.layers as f64
    }
}

/// The size of a body's mesh at a level.
pub fn mesh_size(body: &Body, level: usize) -> MeshSize {
    let class = mesh_class(body, level);
    let columns = class.ring(body.shape.end_angle).corner_angles().len() as u64 - 1;
    let layers = class.layer_count as u64;
    // Two unknowns a node: corner rows of 2 columns + 1 nodes, mid-side rows of columns + 1; supports are few.
    MeshSize { unknowns: 2 * layers * (3 * columns + 2), layers }
}

/// Bodies with one of these share their topology, and can fill one batch.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct TopologyKey {
    shape: &'static Shape,
    /// `None` where each body brings its own.
    idealization: Option<Idealization>,
    /// Only where the far boundary is partly held does the topology depend on the body's own ratios.
    held: Held,
    pub class: GradingClass,
}

/// A body that a library was asked for. Equal requests have the same one, as long as the library keeps it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BodyHandle(u32);

impl BodyHandle {
    pub fn of(place: usize) -> BodyHandle {
        BodyHandle(place as u32)
    }

    pub fn place(self) -> usize {
        self.0 as usize
    }
}

/// The bodies of a joint, the pin first: each on its own mesh, and on the next coarser one where the change since then is what tells its error.
#[derive(Clone, Copy, Debug)]
pub struct JointBodies {
    pub own: [BodyHandle; 2],
    pub coarser: [Option<BodyHandle>; 2],
}

impl JointBodies {
    pub fn all(&self) -> impl Iterator<Item = BodyHandle> {
        self.own.into_iter().chain(self.coarser.into_iter().flatten())
    }
}

/// The two near fields between which that of a body lies, by their places among those of its portion, and how far from the first to the
/// second (0 to 1).
#[derive(Clone, Copy, Debug)]
pub struct Around {
    pub classes: [u32; 2],
    pub between: f64,
}

/// A body to be solved on a mesh.
#[derive(Clone, Debug)]
pub struct Meshed {
    pub handle: BodyHandle,
    pub body: Body,
    /// Of a bare one.
    pub around: Option<Around>,
}

/// Bodies of one topology.
pub type Group = (TopologyKey, Vec<Meshed>);

/// Angles of corner columns, rad, that were made before.
#[derive(Default)]
pub struct RingAngles(Vec<(RingDivision, Vec<f64>)>);

impl RingAngles {
    fn of(&mut self, ring: RingDivision) -> &[f64] {
        // There are few.
        let known = self.0.iter().position(|(known, _)| *known == ring);
        let place = known.unwrap_or_else(|| {
            self.0.push((ring, ring.corner_angles()));
            self.0.len() - 1
        });
        &self.0[place].1
    }
}

impl TopologyKey {
    /// Of a body on a mesh.
    pub fn of(request: &BodyRequest) -> TopologyKey {
        TopologyKey::after(&mut RingAngles::default(), request)
    }

    /// The same after others, whose ring it may have.
    pub fn after(angles: &mut RingAngles, request: &BodyRequest) -> TopologyKey {
        let body = &request.body;
        let level = match request.fidelity {
            Fidelity::Mesh { level } => level,
            Fidelity::Series => unreachable!("an exact body has no mesh"),
        };
        let class = mesh_class(body, level);
        let held = Held::of(body, || angles.of(class.ring(body.shape.end_angle)));
        TopologyKey { shape: body.shape, idealization: Some(body.idealization), held, class }
    }

    /// The topology of bodies that are like these but for plane stress and plane strain.
    pub fn of_either_idealization(self) -> TopologyKey {
        TopologyKey { idealization: None, ..self }
    }

    /// The division of the ring of a body of this topology.
    pub fn grading(&self, body: &Body) -> Grading {
        self.class.grading(body.shape.end_angle)
    }
}

/// An annulus or a disc as `series` takes it.
pub fn concentric(body: &Body) -> ConcentricBody {
    ConcentricBody::of(body).unwrap_or_else(|| unreachable!("a `{}` has no modes", body.shape.name))
}
