//! What the bodies of a joint leave of the error of its force: each by its share of the work.

use crate::engine::accuracy::fit_bound::FitBound;
use crate::engine::accuracy::known_errors::known_error;
use crate::engine::accuracy::mesh_change::Trust;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::compliance::pressure_space::JointCompliance;
use crate::mechanics::compliance::thin_wall::bed_error;
use crate::mechanics::contact::curve::ContactCurve;

/// A body of a joint, as far as its error goes.
pub struct JudgedBody<'a> {
    pub body: &'a Body,
    pub source: ErrorSource<'a>,
    /// Its part of the joint's compliance.
    pub part: JointCompliance<'static>,
}

/// What tells the error of a body.
#[derive(Clone, Copy)]
pub enum ErrorSource<'a> {
    /// There is none.
    Exact,
    /// A wall that is taken for a bed.
    Bed,
    /// Its mesh, of that level.
    Mesh(usize),
    /// Its mesh, with what the next coarser one would make of the body, and 1/E.
    MeshBeside { fine: &'a BodyCompliance, coarse: &'a BodyCompliance, share: f64 },
    /// It lies between others.
    Fit(&'a FitBound),
}

/// The errors of a joint's bodies along its curve.
pub struct BodyErrors<'a> {
    /// Of the meshes that are told by the change since coarser ones, with their level.
    trust: Option<(Trust, usize)>,
    /// That change of the work, relative, summed over the bodies: at each node.
    change: Vec<f64>,
    bodies: &'a [JudgedBody<'a>; 2],
    /// Of the work, the share of each body: at each node. Empty where nobody asks for it.
    shares: [Vec<f64>; 2],
}

impl<'a> BodyErrors<'a> {
    /// With a trust and a level where meshes are told by the change since coarser ones.
    pub fn new(
        curve: &ContactCurve,
        bodies: &'a [JudgedBody<'a>; 2],
        trust: Option<(Trust, usize)>,
    ) -> BodyErrors<'a> {
        let pressures = &curve.space.pressures;
        let counts = |body: &JudgedBody| {
            matches!(body.source, ErrorSource::Bed | ErrorSource::Mesh(_) | ErrorSource::Fit(_))
        };
        let mut shares = [Vec::new(), Vec::new()];
        if bodies.iter().any(counts) {
            let of_pin = curve.states.work_shares(pressures, &bodies[0].part);
            shares = [of_pin.clone(), of_pin.iter().map(|share| 1.0 - share).collect()];
        }
        let mut change = vec![0.0; pressures.arcs.len()];
        for body in bodies {
            if let ErrorSource::MeshBeside { fine, coarse, share } = body.source {
                let bodies = [(fine, share), (coarse, -share)];
                let difference = curve.space.part(body.body.shape.side, &bodies, &curve.outlines);
                let changes = curve.states.work_shares(pressures, &difference);
                change.iter_mut().zip(changes).for_each(|(sum, change)| *sum += change.abs());
            }
        }
        BodyErrors { trust, change, bodies, shares }
    }

    /// The relative errors of the force by meshes and fits, and by beds, at a contact half angle, rad, between a node and the next.
    pub fn at(&self, half_angle: f64, node: usize) -> [f64; 2] {
        let of_change =
            |(trust, level): (Trust, usize)| trust.error(level, ContactCurve::around(node, &self.change));
        let mut of_bodies = self.trust.map_or(0.0, of_change);
        let mut of_beds = 0.0;
        for (JudgedBody { body, source, .. }, shares) in self.bodies.iter().zip(&self.shares) {
            let share = || ContactCurve::around(node, shares);
            match source {
                ErrorSource::Exact | ErrorSource::MeshBeside { .. } => {}
                ErrorSource::Bed => of_beds += share() * bed_error(body, half_angle),
                ErrorSource::Mesh(level) => {
                    of_bodies += share() * known_error(body, *level, half_angle).unwrap_or(f64::INFINITY);
                }
                ErrorSource::Fit(bound) => of_bodies += share() * bound.at(body, half_angle),
            }
        }
        [of_bodies, of_beds]
    }
}
