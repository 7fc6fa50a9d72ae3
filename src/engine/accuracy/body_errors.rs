//! What the bodies of a joint leave of the error of its force: each by its share of the work.

use crate::engine::accuracy::fit_bound::{BodyBound, FitBound};
use crate::engine::accuracy::known_errors::{Known, column, known_errors};
use crate::engine::accuracy::mesh_change::Trust;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::compliance::pressure_space::JointCompliance;
use crate::mechanics::compliance::series::ConcentricBody;
use crate::mechanics::compliance::thin_wall::bed_error;
use crate::mechanics::contact::curve::ContactCurve;

/// A body of a joint, as far as its error goes.
pub struct JudgedBody<'a> {
    pub body: &'a Body,
    pub source: ErrorSource<'a>,
    /// Its part of the joint's compliance.
    pub part: JointCompliance<'a>,
}

/// What tells the error of a body.
#[derive(Clone, Copy)]
pub enum ErrorSource<'a> {
    /// There is none, but of layers that are thinner than the waves of all modes, which bodies on meshes have, too.
    Exact,
    /// A wall that is taken for a bed.
    Bed,
    /// Its mesh, of that level.
    Mesh(usize),
    /// Its mesh, with what the next coarser one would make of the body, and 1/E.
    MeshBeside { fine: &'a BodyCompliance, coarse: &'a BodyCompliance, share: f64 },
    /// It lies between others, inside of their box or near an end of it.
    Fit { bound: &'a FitBound, is_inside: bool },
}

/// The errors of a joint's bodies along its curve.
pub struct BodyErrors<'a> {
    /// Of the meshes that are told by the change since coarser ones, with their level.
    trust: Option<(Trust, usize)>,
    /// That change of the work, relative, summed over the bodies: at each node.
    change: Vec<f64>,
    /// What is known of each body, whatever the change, with its share of the work at each node.
    bodies: [(OwnError<'a>, Vec<f64>); 2],
}

/// What the share of a body in the work is to be multiplied by.
enum OwnError<'a> {
    Nothing,
    CutModes(ConcentricBody),
    Bed(&'a Body),
    Mesh(Known),
    Fit(BodyBound<'a>),
}

impl<'a> BodyErrors<'a> {
    /// With a trust and a level where meshes are told by the change since coarser ones.
    pub fn new(
        curve: &ContactCurve,
        bodies: &'a [JudgedBody<'a>; 2],
        trust: Option<(Trust, usize)>,
    ) -> BodyErrors<'a> {
        let pressures = &curve.space.pressures;
        let own_errors = bodies.each_ref().map(|JudgedBody { body, source, .. }| match source {
            ErrorSource::Exact | ErrorSource::MeshBeside { .. } => {
                let cut = ConcentricBody::with_layers_of(body).filter(ConcentricBody::is_cut);
                cut.map_or(OwnError::Nothing, OwnError::CutModes)
            }
            ErrorSource::Bed => OwnError::Bed(body),
            ErrorSource::Mesh(level) => {
                OwnError::Mesh(known_errors(body, *level).copied().unwrap_or([f64::INFINITY; _]))
            }
            ErrorSource::Fit { bound, is_inside } => OwnError::Fit(bound.of(body, *is_inside)),
        });
        // Where nobody asks for shares there are none.
        let mut of_pin = Vec::new();
        if own_errors.iter().any(|own| !matches!(own, OwnError::Nothing)) {
            of_pin = curve.states.work_shares(pressures, &bodies[0].part);
        }
        let of_plate = of_pin.iter().map(|share| 1.0 - share).collect();
        let [pin, plate] = own_errors;
        let mut change = Vec::new();
        if trust.is_some() {
            change.resize(pressures.arcs.len(), 0.0);
        }
        for body in bodies {
            if let ErrorSource::MeshBeside { fine, coarse, share } = body.source {
                let bodies = [(fine, share), (coarse, -share)];
                let difference = curve.space.part(body.body.shape.side, &bodies, &curve.outlines);
                let changes = curve.states.work_shares(pressures, &difference);
                change.iter_mut().zip(changes).for_each(|(sum, change)| *sum += change.abs());
            }
        }
        if curve.outlines.radial_clearance < 0.0 {
            // The force is the slope of the work: what a press fit is wrong by under one load counts under others.
            let most = change.iter().copied().fold(0.0, f64::max);
            change.fill(most);
        }
        BodyErrors { trust, change, bodies: [(pin, of_pin), (plate, of_plate)] }
    }

    /// The relative errors of the force by meshes and fits, and by beds and thin layers, at a contact half angle, rad, between a node and the next.
    pub fn at(&self, half_angle: f64, node: usize) -> [f64; 2] {
        let of_change =
            |(trust, level): (Trust, usize)| trust.error(level, ContactCurve::around(node, &self.change));
        let mut of_bodies = self.trust.map_or(0.0, of_change);
        let mut of_beds = 0.0;
        for (own, shares) in &self.bodies {
            let share = || ContactCurve::around(node, shares);
            match own {
                OwnError::Nothing => {}
                OwnError::CutModes(body) => of_beds += share() * body.left_out(half_angle),
                OwnError::Bed(body) => of_beds += share() * bed_error(body, half_angle),
                OwnError::Mesh(known) => of_bodies += share() * known[column(half_angle)],
                OwnError::Fit(bound) => of_bodies += share() * bound.at(half_angle),
            }
        }
        [of_bodies, of_beds]
    }
}
