//! What the parts of a sweep cost, for estimates of what a sweep will take and of what is the cheaper way.

use crate::engine::request::{MeshSize, mesh_size};
use crate::mechanics::body::Body;
use crate::mechanics::real::LANES;

// Core times in seconds, measured on one core at 134 GFLOP/s (AMD EPYC of family 26, AVX-512): those of a lane batch
// fitted to `cargo bench --bench condense` (within 35 % of it at every level), those of a design and a row from
// `cargo bench --bench contact` and `table`, those of set-ups from the stages of quickstart, liu2007 and random.
// Together they are within a factor of 2 of `jointsweep bench` on these, and on sweeps of blocks.

/// Of the pressures of `REFERENCE_TERMS`; it grows with the square of the terms.
pub const SPACE_SECONDS: f64 = 4e-3;
pub const REFERENCE_TERMS: f64 = 10.0;
/// Of what bodies of one topology share, besides the lane batch in which the near field is condensed.
pub const TOPOLOGY_SECONDS: f64 = 0.8e-3;
pub const SERIES_SECONDS: f64 = 10e-6;
pub const DESIGN_SECONDS: f64 = 15e-6;
pub const ROW_SECONDS: f64 = 3e-6;
/// Of designs and rows whose bodies are interpolated, the table included: from hypercube and hypercube-block.
pub const INTERPOLATED_DESIGN_SECONDS: f64 = 4e-6;
pub const INTERPOLATED_ROW_SECONDS: f64 = 0.7e-6;

/// Of one lane batch: a start, the elements and arcs, and the band's factor, as wide as a layer of the mesh.
pub fn batch_seconds(MeshSize { unknowns, layers }: MeshSize) -> f64 {
    let unknowns = unknowns as f64;
    let width = unknowns / layers as f64;
    10e-6 + unknowns * (0.4e-6 + 1e-10 * width * width)
}

/// Of one body on a mesh among many.
pub fn body_seconds(body: &Body, level: usize) -> f64 {
    batch_seconds(mesh_size(body, level)) / LANES as f64
}
