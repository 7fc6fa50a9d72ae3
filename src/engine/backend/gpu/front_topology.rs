//! What the bodies of a topology share where they are eliminated, on the device, and bodies as they go there.

use super::context::GpuError;
use super::front::{EliminateParameters, Front, FrontLayout};
use super::kernels::Kernels;
use super::layout::{AssembleParameters, MeshLayout};
use super::shared_data::{SharedBuffers, SharedPlace};
use super::system_layout::SystemState;

/// What bodies of a topology share, and where it is on the device. A clone is the same topology.
#[derive(Clone)]
pub struct FrontTopology {
    pub(super) shared: SharedBuffers,
    pub(super) assembly: AssembleParameters,
    pub(super) elimination: EliminateParameters,
    pub front: Front,
    pub(super) tile_products: u64,
    /// Bytes of each body while it is worked on: geometry, values, states, and its front where that is in storage.
    pub(super) scratch: [u64; 4],
    /// And of its numbers and its works.
    pub(super) travelling: [u64; 2],
    bytes: u64,
}

/// Bodies of one topology, by their numbers.
pub struct Job {
    pub topology: FrontTopology,
    /// `MeshLayout::body_numbers`, one body after the other.
    pub numbers: Vec<f64>,
}

impl FrontTopology {
    /// `None` where the device has no room for one body, or an invocation would make too many loop trips.
    pub fn new(
        kernels: &Kernels,
        mesh: &MeshLayout,
        layout: &FrontLayout,
    ) -> Result<Option<FrontTopology>, GpuError> {
        let limits = &kernels.gpu.facts.limits;
        let (wide, invocations) = (kernels.precision.wide_bytes(), u64::from(kernels.invocations));
        let Some(front) = layout.front(wide, invocations, limits) else { return Ok(None) };
        let topology = FrontTopology::with(kernels, mesh, layout, front)?;
        let of_body = topology.body_bytes().into_iter().max().unwrap_or(0);
        Ok((topology.bytes.max(of_body) <= limits.bound_buffer()).then_some(topology))
    }

    /// With a front where one wants it.
    pub fn with(
        kernels: &Kernels,
        mesh: &MeshLayout,
        layout: &FrontLayout,
        front: Front,
    ) -> Result<FrontTopology, GpuError> {
        let wide = kernels.precision.wide_bytes();
        let (lists, mut assembly, mut elimination) = layout.lists(mesh);
        // Pairs, then rows of tiles of four: each begins at a whole one.
        let mut numbers = mesh.shared_numbers.clone();
        numbers.resize(numbers.len().next_multiple_of(4), 0.0);
        let loads_at = numbers.len() as u32 / 4;
        numbers.extend(&layout.loads);
        let SharedPlace { buffers, lists_at, numbers_at } = kernels.share(&lists, &numbers)?;
        let of_assembly = [
            &mut assembly.element_grid_at,
            &mut assembly.pair_starts_at,
            &mut assembly.sources_at,
            &mut assembly.value_places_at,
        ];
        let of_elimination = [&mut elimination.rows_at, &mut elimination.places_at];
        of_assembly.into_iter().chain(of_elimination).for_each(|at| *at += lists_at);
        assembly.shared_numbers_at = numbers_at / 2;
        elimination.loads_at = numbers_at / 4 + loads_at;
        let scratch = [
            4 * mesh.geometry_count() as u64 * wide,
            u64::from(layout.assembly.value_count) * wide,
            size_of::<SystemState>() as u64,
            front.storage_bytes(wide),
        ];
        let travelling = [mesh.body_number_count() as u64, u64::from(layout.parameters.body_size)]
            .map(|count| count * wide);
        Ok(FrontTopology {
            shared: buffers,
            assembly,
            elimination,
            front,
            tile_products: layout.tile_products(),
            scratch,
            travelling,
            bytes: size_of_val(&lists[..]) as u64 + numbers.len() as u64 * wide,
        })
    }

    /// What it takes on the device.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Bytes of one body in each buffer that grows with the bodies.
    pub fn body_bytes(&self) -> [u64; 6] {
        let ([geometry, values, states, fronts], [numbers, works]) = (self.scratch, self.travelling);
        [geometry, values, states, fronts, numbers, works]
    }
}

impl Job {
    /// Of bodies.
    pub(super) fn count(&self) -> usize {
        self.numbers.len() / self.body_size()
    }

    /// Numbers of one body.
    pub(super) fn body_size(&self) -> usize {
        let topology = &self.topology;
        let wide = topology.travelling[1] / u64::from(topology.elimination.body_size);
        (topology.travelling[0] / wide) as usize
    }
}
