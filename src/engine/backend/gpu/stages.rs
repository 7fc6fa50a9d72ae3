//! A batch of bodies on the device: its buffers, and the stages from a few numbers of each body to the compliance of
//! its ring. Nothing is read back between stages.

use super::batch::{ITERATES, OnChip, SOLUTIONS};
use super::context::GpuError;
use super::dispatch::{Argument, Dispatch};
use super::kernels::{AroundIteration, Kernels, Stage};
use super::layout::MeshLayout;
use super::system_layout::{SystemLayout, SystemState};
use crate::mechanics::solve::refine::RefineSettings;

/// Systems of a batch on the device: matrices of one sparsity, their iterates, and the compliances of their rings.
pub struct SystemBatch<'a> {
    kernels: &'a Kernels<'a>,
    pub(crate) around_iteration: &'a AroundIteration,
    pub(crate) layout: &'a SystemLayout,
    body_count: usize,
    on_chip: OnChip,
    slice_starts: wgpu::Buffer,
    columns: wgpu::Buffer,
    diagonal_places: wgpu::Buffer,
    values: wgpu::Buffer,
    /// As the iteration reads them: rounded, or the same buffer.
    narrowed: wgpu::Buffer,
    iterates: wgpu::Buffer,
    solutions: wgpu::Buffer,
    pub(crate) norms: wgpu::Buffer,
    pub(crate) states: wgpu::Buffer,
    pub(crate) compliance: wgpu::Buffer,
}

/// What is known of each system when it has ended, `[body][system]`, with systems beyond the ring's unknowns.
#[derive(Clone, Debug)]
pub struct SystemReports {
    pub states: Vec<SystemState>,
    /// |r| of the recursion over that at the begin of the last round, and |b - K x|/|b| in wide numbers.
    pub recursive_residuals: Vec<f64>,
    pub true_residuals: Vec<f64>,
}

impl<'a> SystemBatch<'a> {
    /// Room for `body_count` bodies; their matrices come from `assemble` or `write_values`.
    pub fn new(
        kernels: &'a Kernels<'a>,
        layout: &'a SystemLayout,
        body_count: usize,
    ) -> Result<SystemBatch<'a>, GpuError> {
        let gpu = kernels.gpu;
        let (real, wide) = (kernels.precision.real_bytes(), kernels.precision.wide_bytes());
        let (bodies, systems) = (body_count as u64, (body_count * layout.system_count()) as u64);
        let (unknowns, value_count) =
            (layout.unknown_count() as u64, bodies * layout.sliced.columns.len() as u64);
        let empty = |label, bytes| gpu.empty(label, bytes);
        let on_chip = OnChip::fitting(unknowns, &kernels.facts(0.0), &kernels.gpu.facts.limits);
        let around_iteration = kernels.around_iteration()?;
        kernels.gpu.checked("room for a batch", || {
            let values = empty("values", value_count * wide);
            SystemBatch {
                kernels,
                around_iteration,
                layout,
                body_count,
                on_chip,
                slice_starts: gpu.filled("slice_starts", &layout.sliced.starts),
                columns: gpu.filled("columns", &layout.sliced.columns),
                diagonal_places: gpu.filled("diagonal_places", &layout.sliced.diagonal_places),
                narrowed: match &around_iteration.narrow {
                    Some(_) => empty("narrowed", value_count * real),
                    None => values.clone(),
                },
                values,
                iterates: empty("iterates", systems * ITERATES * unknowns * real),
                solutions: empty("solutions", systems * SOLUTIONS * unknowns * wide),
                norms: empty("norms", systems * 3 * wide),
                states: empty("states", systems * size_of::<SystemState>() as u64),
                compliance: empty("compliance", systems * layout.ring_count() as u64 * wide),
            }
        })
    }

    pub(crate) fn kernels(&self) -> &'a Kernels<'a> {
        self.kernels
    }

    pub(crate) fn body_count(&self) -> usize {
        self.body_count
    }

    /// What the iteration keeps in the workgroups' own memory: as much as there is room for.
    pub fn on_chip(&self) -> OnChip {
        self.on_chip
    }

    /// Keeps fewer vectors there, which changes no bit.
    pub fn limit_vectors_on_chip(&mut self, vectors: u64) {
        let OnChip { vectors: most, capacity } = self.on_chip;
        self.on_chip = match most.min(vectors) {
            0 => OnChip::NOTHING,
            vectors => OnChip { vectors, capacity },
        };
    }

    /// The matrices of all bodies, `[body][value]`, row after row.
    pub fn write_values(&self, values: &[f64]) -> Result<(), GpuError> {
        let Kernels { gpu, precision, .. } = self.kernels;
        let placed = precision.encode(&self.layout.sliced.place(values));
        gpu.checked("matrix values", || gpu.queue.write_buffer(&self.values, 0, &placed))
    }

    /// Builds the matrices from the numbers of each body (`MeshLayout::body_numbers`, one after the other) and readies
    /// the systems.
    ///
    /// Returns the reach of every grid point and the gradients of every element, for inspection.
    pub fn assemble(&self, mesh: &MeshLayout, body_numbers: &[f64]) -> Result<Geometry, GpuError> {
        // The kernels do not watch their indices.
        assert_eq!(body_numbers.len(), self.body_count * mesh.body_number_count(), "numbers of other bodies");
        assert_eq!(mesh.systems.columns, self.layout.columns, "a mesh of another topology");
        let gpu = self.kernels.gpu;
        gpu.checked("assemble", || {
            let (dispatch, geometry) = self.assembly(mesh, body_numbers);
            gpu.submit([dispatch.pass()]);
            geometry
        })
    }

    pub(crate) fn assembly(&self, mesh: &MeshLayout, body_numbers: &[f64]) -> (Dispatch, Geometry) {
        let Kernels { gpu, precision, assemble, .. } = self.kernels;
        let reals = |label, numbers: &[f64]| gpu.filled(label, &precision.encode(numbers));
        let (grid, size) = (mesh.grid_count(), mesh.geometry_count());
        let bytes = (self.body_count * size) as u64 * 4 * precision.wide_bytes();
        let geometry = gpu.empty("geometry", bytes);
        let (lists, parameters) = mesh.lists();
        let topologies = gpu.filled("topologies", &[parameters]);
        let bodies = reals("bodies", body_numbers);
        let shared_numbers = reals("shared_numbers", &mesh.shared_numbers);
        let lists = gpu.filled("lists", &lists);
        let arguments = [
            Argument::whole("topologies", &topologies),
            Argument::whole("bodies", &bodies),
            Argument::whole("shared_numbers", &shared_numbers),
            Argument::whole("lists", &lists),
            Argument::whole("geometry", &geometry),
            Argument::whole("values", &self.values),
            Argument::whole("states", &self.states),
        ];
        let group = gpu.bind(assemble, &arguments);
        let dispatch = Dispatch::new(assemble, 0, &group, [self.body_count as u32, 1]);
        (dispatch, Geometry { buffer: geometry, grid, size })
    }

    /// Solves for unit forces on the ring's unknowns in rounds of `step_count` steps a dispatch, until all systems must
    /// have stopped: those that have, end at once. `step_count` is that of the `Batch`: with more, Mesa 22 leaves the
    /// iteration early and says nothing.
    pub fn pcg(&self, settings: &RefineSettings, step_count: u32) -> Result<(), GpuError> {
        let gpu = self.kernels.gpu;
        let pcg = &self.kernels.pcg(self.on_chip)?;
        gpu.checked("pcg", || {
            let Rounds { narrow, start, solve, refine, settle } = self.rounds(pcg, settings, step_count);
            gpu.submit(narrow.iter().map(Dispatch::pass));
            gpu.submit([start.pass()]);
            let dispatches = settings.iteration_limit.div_ceil(step_count as usize);
            for round in 0..=settings.round_limit {
                let end = if round == settings.round_limit { &settle } else { &refine };
                let steps = std::iter::repeat_n(solve.pass(), dispatches);
                gpu.submit(steps.chain([end.pass()]));
            }
        })
    }

    pub(crate) fn rounds(&self, pcg: &Stage, settings: &RefineSettings, step_count: u32) -> Rounds {
        let (gpu, AroundIteration { narrow, refine, .. }) = (self.kernels.gpu, self.around_iteration);
        let groups = self.block_groups();
        let parameters = gpu.uniform(&self.layout.parameters(settings, step_count));
        let bind = |stage, values, solutions: Option<Argument>| {
            let arguments = [
                Argument::whole("parameters", &parameters),
                Argument::whole("slice_starts", &self.slice_starts),
                Argument::whole("columns", &self.columns),
                Argument::whole("diagonal_places", &self.diagonal_places),
                Argument::whole("values", values),
                Argument::whole("iterates", &self.iterates),
                Argument::whole("norms", &self.norms),
                Argument::whole("states", &self.states),
            ];
            gpu.bind(stage, &arguments.into_iter().chain(solutions).collect::<Vec<_>>())
        };
        let steps = bind(pcg, &self.narrowed, None);
        let rounds = bind(refine, &self.values, Some(Argument::whole("solutions", &self.solutions)));
        let of_refine = |entry| Dispatch::new(refine, entry, &rounds, groups);
        let narrow = narrow.as_ref().map(|narrow| {
            let arguments = [
                Argument::whole("parameters", &parameters),
                Argument::whole("values", &self.values),
                Argument::whole("narrowed", &self.narrowed),
            ];
            let group = gpu.bind(narrow, &arguments);
            Dispatch::new(narrow, 0, &group, [groups[0], 1])
        });
        let solve = Dispatch::new(pcg, 0, &steps, groups);
        Rounds { narrow, start: of_refine(0), solve, refine: of_refine(1), settle: of_refine(2) }
    }

    /// From the columns as they are, the compliances of the rings.
    pub fn condense(&self) -> Result<(), GpuError> {
        let gpu = self.kernels.gpu;
        gpu.checked("condense", || gpu.submit([self.condensation().pass()]))
    }

    pub(crate) fn condensation(&self) -> Dispatch {
        let (gpu, condense) = (self.kernels.gpu, &self.around_iteration.condense);
        let parameters = gpu.uniform(&self.layout.parameters(&NOTHING_TO_SOLVE, 0));
        let arguments = [
            Argument::whole("parameters", &parameters),
            Argument::whole("solutions", &self.solutions),
            Argument::whole("compliance", &self.compliance),
        ];
        let group = gpu.bind(condense, &arguments);
        Dispatch::new(condense, 0, &group, self.block_groups())
    }

    /// All stages: from the numbers of each body to the compliance of its ring.
    pub fn assemble_and_condense(
        &self,
        mesh: &MeshLayout,
        body_numbers: &[f64],
        settings: &RefineSettings,
        step_count: u32,
    ) -> Result<(), GpuError> {
        self.assemble(mesh, body_numbers)?;
        self.pcg(settings, step_count)?;
        self.condense()
    }

    /// Workgroups of the stages that have one for each body and block of columns.
    fn block_groups(&self) -> [u32; 2] {
        [self.body_count as u32, self.layout.block_count() as u32]
    }

    /// The matrices, `[body][value]`, row after row.
    pub fn read_values(&self) -> Result<Vec<f64>, GpuError> {
        Ok(self.layout.sliced.collect(&self.read_wides(&self.values)?))
    }

    /// The solutions, `[body][system][unknown]`, with systems beyond the ring's unknowns.
    pub fn read_columns(&self) -> Result<Vec<f64>, GpuError> {
        let size = self.layout.unknown_count();
        let solutions = self.read_wides(&self.solutions)?;
        // Of [body][block][x, b - K x][unknown][system in block] the x.
        let blocks = solutions.chunks_exact(8 * size);
        Ok(blocks
            .flat_map(|block| {
                (0..4).flat_map(move |system| block[system..4 * size].iter().step_by(4).copied())
            })
            .collect())
    }

    /// The compliances of the rings, `[body][row][column]`.
    pub fn read_compliance(&self) -> Result<Vec<f64>, GpuError> {
        let padded = self.read_wides(&self.compliance)?;
        let rows = padded.chunks_exact(self.layout.system_count());
        Ok(rows.flat_map(|row| row[..self.layout.ring_count()].iter().copied()).collect())
    }

    pub fn read_reports(&self) -> Result<SystemReports, GpuError> {
        let states = bytemuck::pod_collect_to_vec(&self.kernels.gpu.read(&self.states)?);
        let norms = self.read_wides(&self.norms)?;
        let blocks = || norms.chunks_exact(12);
        Ok(SystemReports {
            states,
            recursive_residuals: blocks().flat_map(|block| [0, 1, 2, 3].map(|i| block[i].sqrt())).collect(),
            true_residuals: blocks().flat_map(|block| [8, 9, 10, 11].map(|i| block[i])).collect(),
        })
    }

    /// Coordinates less those of the ring's point of their line, `[body][row][column]`.
    pub fn read_reaches(&self, geometry: &Geometry) -> Result<Vec<[f64; 2]>, GpuError> {
        let numbers = self.read_wides(&geometry.buffer)?;
        let bodies = numbers.chunks_exact(4 * geometry.size);
        Ok(bodies
            .flat_map(|body| body[..4 * geometry.grid].chunks_exact(4).map(|place| [place[0], place[1]]))
            .collect())
    }

    fn read_wides(&self, buffer: &wgpu::Buffer) -> Result<Vec<f64>, GpuError> {
        Ok(self.kernels.precision.decode(&self.kernels.gpu.read(buffer)?))
    }
}

/// The kernels of conjugate gradients and of the rounds around them.
pub(crate) struct Rounds {
    /// Where the iteration needs matrices of its own.
    pub(crate) narrow: Option<Dispatch>,
    pub(crate) start: Dispatch,
    pub(crate) solve: Dispatch,
    pub(crate) refine: Dispatch,
    pub(crate) settle: Dispatch,
}

/// For kernels that are told sizes only.
const NOTHING_TO_SOLVE: RefineSettings =
    RefineSettings { tolerance: 0.0, goal: 0.0, round_limit: 0, iteration_limit: 0 };

/// Where `assemble` has put its coordinates.
pub struct Geometry {
    buffer: wgpu::Buffer,
    grid: usize,
    size: usize,
}
