//! Designs solved on meshes by contact with a moving edge and the exact near field, as a sweep does, with the parts of
//! that path open to choice: elements, level, trial pressures, and how bodies are condensed.

use std::collections::{HashMap, HashSet};
use std::time::Instant;

use crate::engine::request::SpaceKey;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::PressureCompliance;
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::near_field::{NearField, NearFieldClass};
use crate::mechanics::compliance::pressure_space::PressureSpace;
use crate::mechanics::compliance::ring_loads::{ArcLoads, RingLoads, galerkin_compliance, ring_loads};
use crate::mechanics::element::ElementKind;
use crate::mechanics::grading::GradingClass;
use crate::study::design::DesignCase;
use crate::tradeoff::choice::Solution;
use crate::tradeoff::joints::{Joints, Terms};
use crate::tradeoff::moving_edge;
use crate::tradeoff::ring_mesh::{Division, RingMesh, RingSolver, groups};

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
    Ring(Box<RingMesh>, Vec<ArcLoads>),
    /// No memory for it.
    Nothing,
}

/// A space with the near fields of its classes.
struct Space {
    space: PressureSpace,
    rings: RingLoads,
    near_fields: HashMap<NearFieldClass, NearField>,
}

impl MeshedPath {
    pub fn solve(&self, cases: &[DesignCase]) -> Solution {
        let started = Instant::now();
        let joints = Joints::new(cases, |joint| self.terms.space(joint));
        let groups = groups(&joints.bodies, &Division::Ladder { element: self.element, level: self.level });
        let spaces = self.spaces(&joints.bodies);
        let shared: Vec<Shared> = groups
            .iter()
            .map(|group| {
                let body = &joints.bodies[group.members[0]].0;
                let Space { space, rings, .. } = &spaces[&group.key];
                match &self.condenser {
                    Condenser::Lanes => Shared::Lanes(Box::new(CondensationPlan::new(
                        body,
                        group.grading.clone(),
                        space,
                        rings,
                    ))),
                    Condenser::Ring(solver) => {
                        RingMesh::new(body, &group.grading, solver).map_or(Shared::Nothing, |mesh| {
                            let angles = &mesh.topology.ring_angles;
                            let loads = ring_loads(space, mesh.topology.element, angles);
                            Shared::Ring(Box::new(mesh), loads)
                        })
                    }
                }
            })
            .collect();
        let shared_time = started.elapsed();

        let mut compliances: Vec<Option<PressureCompliance>> = vec![None; joints.bodies.len()];
        for (group, shared) in groups.iter().zip(&shared) {
            let bodies: Vec<Body> = group.members.iter().map(|&number| joints.bodies[number].0).collect();
            let space = &spaces[&group.key];
            for ((&number, body), compliance) in
                group.members.iter().zip(&bodies).zip(self.condense(shared, &bodies, &space.space))
            {
                let (around, between) = self.near_field_classes(body);
                let around = around.each_ref().map(|class| &space.near_fields[class]);
                compliances[number] = compliance.map(|mut compliance| {
                    NearField::correct(around, between, body.poissons_ratio, &mut compliance);
                    compliance
                });
            }
        }
        let states = cases.iter().zip(&joints.of_case).map(|(case, [pin, plate])| {
            let space = &spaces[&joints.bodies[*pin].1].space;
            match (&compliances[*pin], &compliances[*plate]) {
                (Some(pin), Some(plate)) => moving_edge::states(case, space, pin, plate),
                _ => vec![None; case.steps.len()],
            }
        });
        let states = states.collect();
        Solution { states, shared: shared_time, own: started.elapsed() - shared_time }
    }

    fn condense(
        &self,
        shared: &Shared,
        bodies: &[Body],
        space: &PressureSpace,
    ) -> Vec<Option<PressureCompliance>> {
        match (shared, &self.condenser) {
            (Shared::Lanes(plan), _) => plan.condense(bodies).into_iter().map(Some).collect(),
            (Shared::Ring(mesh, loads), Condenser::Ring(solver)) => bodies
                .iter()
                .map(|body| {
                    let ring = mesh.condense(body, solver)?;
                    let amplitude = 2.0 / body.idealization.plane_modulus_ratio(body.poissons_ratio);
                    Some(galerkin_compliance(&ring, &mesh.topology, loads, space.terms, amplitude))
                })
                .collect(),
            _ => vec![None; bodies.len()],
        }
    }

    fn near_field_classes(&self, body: &Body) -> ([NearFieldClass; 2], f64) {
        NearFieldClass::around(body, GradingClass::of(body, self.element, self.level))
    }

    /// The spaces of the bodies, with their near fields.
    fn spaces(&self, bodies: &[(Body, SpaceKey)]) -> HashMap<SpaceKey, Space> {
        let mut classes: HashMap<SpaceKey, HashSet<NearFieldClass>> = HashMap::new();
        for (body, key) in bodies {
            classes.entry(*key).or_default().extend(self.near_field_classes(body).0);
        }
        let made = classes.into_iter().map(|(key, classes)| {
            let space = PressureSpace::new(key.terms, key.limit());
            let highest = classes.iter().map(NearFieldClass::highest_mode).max().unwrap_or(0);
            let moments = space.moments(highest);
            let rings = RingLoads::default();
            let near_fields = classes
                .into_iter()
                .map(|class| (class, NearField::new(&class, &space, &moments, highest, &rings)))
                .collect();
            (key, Space { space, rings, near_fields })
        });
        made.collect()
    }
}
