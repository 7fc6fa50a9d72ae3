//! What the parts of a sweep cost, for estimates of what a sweep will take and of what is the cheaper way.
//!
//! Core times in seconds on one core at 134 GFLOP/s (AMD EPYC of family 26, AVX-512). Those of meshes and of what they share
//! are fitted to bodies of all shapes on every level with 6, 10 and 24 trial pressures, walls from 0.02 to 1e6 in |ln r|,
//! within 40 %; those of a design and a row come from `cargo bench --bench contact` and `table`. `jointsweep bench` writes the
//! forecast of a whole sweep beside its time: within a factor of 3 for every file in configs/ (results/sweep.csv).

use crate::engine::request::{BodyRequest, Fidelity, MeshSize, concentric, mesh_class, mesh_size};
use crate::engine::spaces::SpaceKey;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::arc::packed_count;
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::real::LANES;

/// Of the process, before and after the sweep.
pub const START_SECONDS: f64 = 2e-3;
/// Of bodies that share a topology, besides their near fields.
pub const TOPOLOGY_SECONDS: f64 = 0.2e-3;
pub const DESIGN_SECONDS: f64 = 10e-6;
pub const ROW_SECONDS: f64 = 1.5e-6;
/// Of designs and rows whose bodies are interpolated, the table included: from hypercube and hypercube-block.
pub const INTERPOLATED_DESIGN_SECONDS: f64 = 4e-6;
pub const INTERPOLATED_ROW_SECONDS: f64 = 0.7e-6;

/// Of a pressure space, with the moments of modes up to one: each mode takes as many points as it has waves.
pub fn space_seconds(space: SpaceKey, highest_mode: usize) -> f64 {
    let (terms, modes) = (space.terms as f64, highest_mode as f64);
    let of_arc = 28e-6 * (terms / 6.0).powf(1.7) + 7e-10 * (1.0 + terms / 12.0) * modes * modes;
    space.nodes as f64 * of_arc
}

/// Of an exact body: its modes.
pub fn series_seconds(modes: usize) -> f64 {
    1e-6 + 0.15e-6 * modes as f64
}

/// Of what an exact body, by its modes, is to the trial pressures of a space.
pub fn spread_seconds(modes: usize, space: SpaceKey) -> f64 {
    0.12e-9 * (modes * packed_count(space.terms) * space.nodes) as f64
}

/// Of one lane batch: a start, the elements, the band's factor, which is as wide as a layer of the mesh, and the ring's modes.
pub fn batch_seconds(MeshSize { unknowns, layers }: MeshSize, modes: usize) -> f64 {
    let (unknowns, modes) = (unknowns as f64, modes as f64);
    let width = unknowns / layers as f64;
    let of_modes = 4e-10 * width * modes * (width + modes);
    10e-6 + unknowns * (0.35e-6 + 1.8e-10 * width * width) + of_modes
}

/// Of one body among many of its kind; what they share is left out.
pub fn body_seconds(body: &Body, fidelity: Fidelity) -> f64 {
    match fidelity {
        Fidelity::Series => series_seconds(concentric(body).modes_needed()),
        Fidelity::Mesh { level } => {
            let modes = RingModes::of(&mesh_class(body, level)).count;
            batch_seconds(mesh_size(body, level), modes) / LANES as f64
        }
    }
}

/// `body_seconds` of a request.
pub fn request_seconds(request: &BodyRequest) -> f64 {
    body_seconds(&request.body, request.fidelity)
}
