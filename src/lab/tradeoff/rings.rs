//! The distinct bodies of some designs, condensed to their rings by sparse Cholesky.

use std::time::{Duration, Instant};

use crate::lab::tradeoff::joints::Joints;
use crate::lab::tradeoff::ring_mesh::{Division, RingMesh, RingSolver, groups};
use crate::mechanics::body::Side;
use crate::mechanics::compliance::RingCompliance;
use crate::mechanics::contact::node_contact::ring_joint::{RingBody, angle_on_hole};
use crate::study::design::{DesignCase, JointDesign};

/// dR/R2.
pub fn clearance_ratio(joint: &JointDesign) -> f64 {
    joint.radial_clearance / joint.hole_radius
}

pub struct Rings {
    meshes: Vec<Option<RingMesh>>,
    /// Of each body the number of its mesh, and its compliance where it has one.
    bodies: Vec<(usize, Option<RingCompliance>)>,
    /// Pin and plate of each design among the bodies.
    of_case: Vec<[usize; 2]>,
    /// Time spent on meshes, which a sweep shares.
    pub shared: Duration,
}

impl Rings {
    pub fn new(cases: &[DesignCase], division: &Division) -> Rings {
        let started = Instant::now();
        // Where the nodes of a plate meet a pin's depends on the clearance.
        let joints = Joints::new(cases, |joint, side| match side {
            Side::Pin => 0,
            Side::Plate => clearance_ratio(joint).to_bits(),
        });
        let groups = groups(&joints.bodies, |body, clearance| {
            let mut grading = division.grading(body);
            let meet = |angle: &mut f64| *angle = angle_on_hole(*angle, f64::from_bits(*clearance));
            grading.angles.iter_mut().for_each(meet);
            grading
        });
        let solver = RingSolver::Cholesky;
        let meshes: Vec<Option<RingMesh>> = groups
            .iter()
            .map(|group| RingMesh::new(&joints.bodies[group.members[0]].0, &group.grading, &solver))
            .collect();
        let shared = started.elapsed();

        let mut bodies: Vec<(usize, Option<RingCompliance>)> = vec![(0, None); joints.bodies.len()];
        for (number, (group, mesh)) in groups.iter().zip(&meshes).enumerate() {
            for &member in &group.members {
                let compliance =
                    mesh.as_ref().and_then(|mesh| mesh.condense(&joints.bodies[member].0, &solver));
                bodies[member] = (number, compliance);
            }
        }
        Rings { meshes, bodies, of_case: joints.of_case, shared }
    }

    /// Pin and plate of a design, by its number; `None` where one could not be condensed.
    pub fn pair(&self, number: usize, design: &JointDesign) -> Option<[RingBody<'_>; 2]> {
        let [pin, plate] = self.of_case[number];
        let ring = |body: usize, youngs_modulus| {
            let (mesh, compliance) = &self.bodies[body];
            let topology = &self.meshes[*mesh].as_ref()?.topology;
            Some(RingBody { topology, compliance: compliance.as_ref()?, youngs_modulus })
        };
        Some([
            ring(pin, design.pin.contact_material().youngs_modulus)?,
            ring(plate, design.plate.contact_material().youngs_modulus)?,
        ])
    }
}
