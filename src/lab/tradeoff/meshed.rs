//! Designs solved on meshes by contact with a moving edge and the exact near field, as a sweep does, with the parts of
//! that path open to choice: elements, level, trial pressures, and how bodies are condensed.

use std::time::Instant;

use crate::engine::near_fields::NearFieldLibrary;
use crate::engine::ring_loads::RingLoads;
use crate::engine::spaces::Spaces;
use crate::lab::tradeoff::choice::Solution;
use crate::lab::tradeoff::joints::{Joints, Terms};
use crate::lab::tradeoff::moving_edge;
use crate::lab::tradeoff::ring_mesh::{Division, RingMesh, RingSolver, groups};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::near_field::{InCommon, NearFieldClass};
use crate::mechanics::compliance::ring_modes::{Push, RingModes};
use crate::mechanics::compliance::{BodyCompliance, Boundary};
use crate::mechanics::element::ElementKind;
use crate::mechanics::grading::GradingClass;
use crate::study::design::DesignCase;

/// How a body comes from its mesh to its compliance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condenser {
    /// Band Cholesky, several bodies in the lanes of the processor: what a sweep does.
    Lanes,
    /// The whole compliance of the ring, body by body.
    Ring(RingSolver),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshedPath {
    pub element: ElementKind,
    pub level: usize,
    pub terms: Terms,
    pub condenser: Condenser,
}

/// What bodies of one topology share.
enum Shared {
    Lanes(Box<CondensationPlan>),
    Ring(Box<RingMesh>),
    /// No memory for it.
    Nothing,
}

impl MeshedPath {
    pub fn solve(&self, cases: &[DesignCase]) -> Solution {
        let started = Instant::now();
        let joints = Joints::new(cases, |_, _| ());
        let class = |body: &Body| GradingClass::of(body, self.element, self.level);
        let groups = groups(&joints.bodies, |body, _| {
            Division::Ladder { element: self.element, level: self.level }.grading(body)
        });
        let mut near_fields = NearFieldLibrary::default();
        let around = |body: &Body| NearFieldClass::around(body, class(body), &InCommon::default()).0;
        let classes = joints.bodies.iter().flat_map(|(body, ())| around(body));
        near_fields.prepare(classes, &RingLoads::default());
        let shared: Vec<Shared> = groups
            .iter()
            .map(|group| {
                let body = &joints.bodies[group.members[0]].0;
                match &self.condenser {
                    Condenser::Lanes => Shared::Lanes(Box::new(CondensationPlan::new(
                        body,
                        group.grading.clone(),
                        RingModes::of(&class(body)),
                    ))),
                    Condenser::Ring(solver) => RingMesh::new(body, &group.grading, solver)
                        .map_or(Shared::Nothing, |mesh| Shared::Ring(Box::new(mesh))),
                }
            })
            .collect();
        let shared_time = started.elapsed();

        let mut compliances: Vec<Option<BodyCompliance>> = vec![None; joints.bodies.len()];
        for (group, shared) in groups.iter().zip(&shared) {
            let bodies: Vec<Body> =
                group.members.iter().map(|&number| joints.bodies[number].0.clone()).collect();
            let modes = RingModes::of(&class(&bodies[0]));
            let condensed = self.condense(shared, &bodies, &modes);
            for ((&number, body), works) in group.members.iter().zip(&bodies).zip(condensed) {
                compliances[number] = works.map(|mut works| {
                    near_fields.correct(body, class(body), &mut works);
                    BodyCompliance::new(body, Boundary::RingModes(modes, works))
                });
            }
        }
        let mut spaces = Spaces::default();
        let of_case = |case: &DesignCase, [pin, plate]: &[usize; 2]| {
            let (pin, plate) = (compliances[*pin].as_ref()?, compliances[*plate].as_ref()?);
            let key = self.terms.space(&case.joint);
            spaces.prepare([pin, plate].into_iter().map(|body| (key, body)));
            Some(moving_edge::states(case, (key, &spaces), pin, plate))
        };
        let mut of_case = of_case;
        let states = cases
            .iter()
            .zip(&joints.of_case)
            .map(|(case, bodies)| of_case(case, bodies).unwrap_or_else(|| vec![None; case.steps.len()]));
        let states = states.collect();
        Solution { states, shared: shared_time, own: started.elapsed() - shared_time }
    }

    fn condense(&self, shared: &Shared, bodies: &[Body], modes: &RingModes) -> Vec<Option<Vec<f64>>> {
        match (shared, &self.condenser) {
            (Shared::Lanes(plan), _) => plan.condense(bodies).into_iter().map(Some).collect(),
            (Shared::Ring(mesh), Condenser::Ring(solver)) => bodies
                .iter()
                .map(|body| {
                    let ring = mesh.condense(body, solver)?;
                    let works = |push: &Push| modes.works_on_ring(*push, &ring, &mesh.topology);
                    Some(Push::of(body.shape.side).iter().flat_map(works).collect())
                })
                .collect(),
            _ => vec![None; bodies.len()],
        }
    }
}
