//! How it is computed: meshes, bounds of errors, interpolation and the plan that chooses among them.

#[path = "../common"]
mod common {
    pub mod random;
    pub mod draws;
    pub mod length;
    pub mod lined_bodies;
    pub mod greatest;
    pub mod stepped_ring;
    pub mod nodal_ring;
    pub mod true_outlines;
    pub mod plain_mesh;
    pub mod meshed_body;
    pub mod study_joint;
}
mod batches;
mod bodies;
mod shaders;
mod known_errors;
mod in_common;
mod single_precision;
mod explain;
mod planner;
mod oracle;
mod references;
mod outcomes;
mod interpolation;
mod thin_walls;
mod extremes;
mod properties;
mod question;
mod joint;
mod joint_stresses;
mod layers;
mod material_shares;
mod press_fits;
mod lined_meshes;
mod fitted_meshes;
mod liu2007;
