//! What the bodies of a joint leave of the error of its force: each by its share of the work.

use crate::engine::accuracy::fit_bound::BodyBound;
use crate::engine::accuracy::known_errors::{Known, column, known_errors};
use crate::engine::accuracy::mesh_change::Trust;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::compliance::concentric_body::ConcentricBody;
use crate::mechanics::compliance::pressure_space::JointCompliance;
use crate::mechanics::compliance::thin_wall::bed_error;
use crate::mechanics::contact::curve::ContactCurve;

/// A body of a joint, as far as its error goes.
pub struct JudgedBody<'a> {
    pub body: &'a Body,
    /// What is known of it, whatever the change since a coarser mesh.
    pub own: OwnError<'a>,
    /// Where that change tells the error: what it is on its mesh, with 1/E, and on the next coarser one, with -1/E.
    pub change: Option<[(&'a BodyCompliance, f64); 2]>,
    /// Its part of the joint's compliance.
    pub part: JointCompliance<'a>,
}

/// What the share of a body in the work is to be multiplied by.
pub enum OwnError<'a> {
    Nothing,
    /// Layers are thinner than the waves of all modes.
    CutModes(ConcentricBody),
    /// A wall is taken for a bed.
    Bed(&'a Body),
    /// By the level of its mesh.
    Mesh(Known),
    /// It lies between others.
    Fit(BodyBound<'a>),
}

impl OwnError<'_> {
    /// Of exact modes; bodies on meshes have them, too.
    pub fn of_layers(body: &Body) -> OwnError<'static> {
        let cut = ConcentricBody::with_layers_of(body).filter(ConcentricBody::is_cut);
        cut.map_or(OwnError::Nothing, OwnError::CutModes)
    }

    /// What a share of the work is to be multiplied by at a contact half angle, rad: of meshes and fits, and of beds and thin layers.
    pub fn at(&self, half_angle: f64) -> [f64; 2] {
        match self {
            OwnError::Nothing => [0.0, 0.0],
            OwnError::CutModes(body) => [0.0, body.left_out(half_angle)],
            OwnError::Bed(body) => [0.0, bed_error(body, half_angle)],
            OwnError::Mesh(known) => [known[column(half_angle)], 0.0],
            OwnError::Fit(bound) => [bound.at(half_angle), 0.0],
        }
    }

    /// Of a mesh of a level, and what rounding leaves.
    pub fn of_mesh(body: &Body, level: usize, rounding: f64) -> OwnError<'static> {
        let known = known_errors(body, level).copied().unwrap_or([f64::INFINITY; _]);
        OwnError::Mesh(known.map(|known| known + rounding))
    }
}

/// The errors of a joint's bodies along its curve.
pub struct BodyErrors<'a> {
    /// Of the meshes that are told by the change since coarser ones, with their level.
    trust: Option<(Trust, usize)>,
    /// That change of the work, relative, summed over the bodies: at each node.
    change: Vec<f64>,
    /// The own error of each body with its share of the work at each node.
    bodies: [(&'a OwnError<'a>, Vec<f64>); 2],
}

impl<'a> BodyErrors<'a> {
    /// With a trust and a level where meshes are told by the change since coarser ones.
    pub fn new(
        curve: &ContactCurve,
        bodies: &'a [JudgedBody<'a>; 2],
        trust: Option<(Trust, usize)>,
    ) -> BodyErrors<'a> {
        let pressures = &curve.space.pressures;
        // Where nobody asks for shares there are none.
        let mut of_pin = Vec::new();
        if bodies.iter().any(|body| !matches!(body.own, OwnError::Nothing)) {
            of_pin = curve.states.work_shares(pressures, &bodies[0].part);
        }
        let of_plate = of_pin.iter().map(|share| 1.0 - share).collect();
        let mut change = Vec::new();
        if trust.is_some() {
            change.resize(pressures.arcs.len(), 0.0);
        }
        for body in bodies {
            if let Some(bodies) = &body.change {
                let difference = curve.space.part(body.body.shape.side, bodies, &curve.outlines);
                let changes = curve.states.work_shares(pressures, &difference);
                change.iter_mut().zip(changes).for_each(|(sum, change)| *sum += change.abs());
            }
        }
        if curve.outlines.radial_clearance < 0.0 {
            // The force is the slope of the work: what a press fit is wrong by under one load counts under others.
            let most = change.iter().copied().fold(0.0, f64::max);
            change.fill(most);
        }
        BodyErrors { trust, change, bodies: [(&bodies[0].own, of_pin), (&bodies[1].own, of_plate)] }
    }

    /// The relative errors of the force by meshes and fits, and by beds and thin layers, at a contact half angle, rad, between a node and the next.
    pub fn at(&self, half_angle: f64, node: usize) -> [f64; 2] {
        let of_change =
            |(trust, level): (Trust, usize)| trust.error(level, ContactCurve::around(node, &self.change));
        let mut of_bodies = self.trust.map_or(0.0, of_change);
        let mut of_beds = 0.0;
        for (own, shares) in &self.bodies {
            // Where nobody asks for shares there are none.
            if !matches!(own, OwnError::Nothing) {
                let share = ContactCurve::around(node, shares);
                let [of_body, of_bed] = own.at(half_angle);
                of_bodies += share * of_body;
                of_beds += share * of_bed;
            }
        }
        [of_bodies, of_beds]
    }
}
