//! What is true: elements, bodies, compliance, contact and laws, against closed forms and against solvers of the tests' own.

#[path = "../common"]
mod common {
    pub mod random;
    pub mod length;
    pub mod greatest;
    pub mod meshes;
    pub mod meshed_body;
    pub mod rings;
    pub mod ring_loads;
    pub mod stepped_ring;
    pub mod ring_design;
    pub mod nodal_ring;
    pub mod true_outlines;
    pub mod finite_displacement;
    pub mod law_joints;
}
mod greatest;
mod operations;
mod ring_meshes;
mod patch;
mod convergence;
mod lame;
mod solvers;
mod condensation;
mod series;
mod layered_rings;
mod lined_joints;
mod press_fits;
mod stresses;
mod active_set;
mod contact_formulations;
mod curves;
mod geometry;
mod linearity;
mod laws;
mod calibrated_laws;
