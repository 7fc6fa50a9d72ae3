//! The kernels on a device against their twins on the processor, stage by stage and all together.
//!
//! Any Vulkan adapter will do, software too. Without a driver these tests are ignored; with JOINTSWEEP_REQUIRE_GPU
//! set, a missing adapter or a missing f64 is a failure.

#[path = "../common"]
mod common {
    pub mod random;
    pub mod draws;
    pub mod greatest;
    pub mod length;
    pub mod meshed_body;
    pub mod rings;
}
mod answers;
mod drawn;
mod elimination;
mod joints;
mod limits;
mod stages;
mod sweeps;
mod watched;
mod whole_joints;
mod works;

use std::collections::HashSet;
use std::sync::OnceLock;

use crate::common::greatest::{difference, greatest};
use crate::common::length::{count, is_long};
use crate::common::rings::{MeshedBody, body};
use jointsweep::internals::engine::backend::gpu::batch::{
    AssembleCounts, BodyCounts, MOST_BYTES, MOST_TRIPS, batches,
};
use jointsweep::internals::engine::backend::gpu::context::{
    AdapterChoice, AdapterKind, Adapters, GpuDevice, GpuError,
};
use jointsweep::internals::engine::backend::gpu::kernels::{Kernels, Making, Precision};
use jointsweep::internals::engine::backend::gpu::layout::MeshLayout;
use jointsweep::internals::engine::backend::gpu::stages::{SystemBatch, SystemReports};
use jointsweep::internals::engine::backend::gpu::system_layout::{SystemLayout, SystemOutcome, SystemState};
use jointsweep::internals::mechanics::body::Body;
use jointsweep::internals::mechanics::compliance::condense::variational_compliance;
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::grading::GradingClass;
use jointsweep::internals::mechanics::layers::{Layers, SHRINK};
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::mechanics::mesh::{Grading, RingTopology, corner_columns, ring_points};
use jointsweep::internals::mechanics::solve::pcg::{PcgOutcome, PcgReport, PcgSettings, pcg};
use jointsweep::internals::mechanics::solve::refine::{RefineSettings, refined};

/// As many invocations as the twin has partial sums.
const INVOCATIONS: u32 = 64;

fn device() -> &'static GpuDevice {
    static DEVICE: OnceLock<GpuDevice> = OnceLock::new();
    DEVICE.get_or_init(|| {
        // Every name holds the empty one: the best adapter, be it software.
        let gpu =
            Adapters::enumerate().open(AdapterChoice::Named("")).unwrap_or_else(|error| panic!("{error}"));
        println!("{} with {}", gpu.facts.name, gpu.facts.driver);
        gpu
    })
}

fn kernels(precision: Precision) -> &'static Kernels<'static> {
    static KERNELS: [OnceLock<Kernels<'static>>; 3] = [const { OnceLock::new() }; 3];
    // Sums as the twin takes them.
    KERNELS[precision as usize]
        .get_or_init(|| Kernels::with_tree(device(), precision, INVOCATIONS, Making::Trusted).unwrap())
}

/// f32, and those with f64 where the adapter has it, with the rounding of wide numbers.
fn precisions() -> Vec<(Precision, f64)> {
    let mut precisions = vec![(Precision::F32, f64::from(f32::EPSILON))];
    if device().facts.features.f64 {
        precisions.extend([(Precision::F64, f64::EPSILON), (Precision::Mixed, f64::EPSILON)]);
    } else {
        assert!(std::env::var_os("JOINTSWEEP_REQUIRE_GPU").is_none(), "no f64 on {}", device().facts.name);
    }
    precisions
}

/// Bodies of one topology, their meshes, and what the device is told of them.
struct Bodies {
    level: usize,
    bodies: Vec<Body>,
    grading: Grading,
    meshed: Vec<MeshedBody>,
    layout: MeshLayout,
}

impl Bodies {
    fn new(bodies: Vec<Body>, level: usize) -> Bodies {
        let class = GradingClass::of(&bodies[0], ElementKind::Quad8, level);
        assert!(bodies.iter().all(|body| GradingClass::of(body, ElementKind::Quad8, level) == class));
        let grading = class.grading(bodies[0].shape.end_angle);
        let meshed: Vec<MeshedBody> = bodies.iter().map(|body| MeshedBody::new(body, &grading)).collect();
        assert!(meshed.iter().all(|body| body.topology == meshed[0].topology));
        let layout = MeshLayout::new(&bodies[0], &grading).unwrap();
        // Nothing is to come out even.
        assert_ne!(layout.systems.unknown_count() % INVOCATIONS as usize, 0);
        Bodies { level, bodies, grading, meshed, layout }
    }

    fn count(&self) -> usize {
        self.bodies.len()
    }

    fn batch(&self, precision: Precision) -> SystemBatch<'_> {
        SystemBatch::new(kernels(precision), &self.layout.systems, self.count()).unwrap()
    }

    fn numbers(&self) -> Vec<f64> {
        self.bodies.iter().flat_map(|body| self.layout.body_numbers(body)).collect()
    }

    /// The twin's matrices, rounded to what the device holds.
    fn values(&self, precision: Precision) -> Vec<f64> {
        let values = self.meshed.iter().flat_map(MeshedBody::stiffness_values);
        match precision {
            Precision::F32 => values.map(|value| f64::from(value as f32)).collect(),
            Precision::F64 | Precision::Mixed => values.collect(),
        }
    }

    fn counts(&self) -> BodyCounts {
        self.layout.counts()
    }

    /// Values of one body's matrix.
    fn value_count(&self) -> usize {
        self.layout.systems.columns.len()
    }
}

/// Of every shape, support and boundary, Poisson's ratios from ordinary to nearly incompressible.
fn families() -> &'static [(&'static str, Bodies)] {
    static FAMILIES: OnceLock<Vec<(&'static str, Bodies)>> = OnceLock::new();
    FAMILIES.get_or_init(|| families_at(1, [1, 1], &RATIOS))
}

const RATIOS: [f64; 3] = [0.3, 0.1, 0.45];
const FAMILY_COUNT: usize = 5;
const ON_BASE: usize = 3;

/// The same for conjugate gradients, to which blocks are more work than all others together: those on their base have a coarser mesh, in the
/// short form those held around too, and of the first there is one then.
fn iterated_families() -> &'static [(&'static str, Bodies)] {
    static FAMILIES: OnceLock<Vec<(&'static str, Bodies)>> = OnceLock::new();
    FAMILIES.get_or_init(|| {
        let mut families = families_at(1, [0, usize::from(is_long())], &RATIOS);
        if !is_long() {
            families[ON_BASE] = families_at(0, [0, 0], &RATIOS[..1]).swap_remove(ON_BASE);
        }
        families
    })
}

/// What has gone through all stages, as in a sweep.
struct Condensed<'a> {
    batch: SystemBatch<'a>,
    compliance: Vec<f64>,
    columns: Vec<f64>,
    reports: SystemReports,
}

impl<'a> Condensed<'a> {
    fn new(bodies: &'a Bodies, precision: Precision, settings: &RefineSettings) -> Condensed<'a> {
        let batch = bodies.batch(precision);
        let steps = MOST_TRIPS / bodies.counts().trips(u64::from(INVOCATIONS));
        batch.assemble_and_condense(&bodies.layout, &bodies.numbers(), settings, steps as u32).unwrap();
        let (compliance, columns) = (batch.read_compliance().unwrap(), batch.read_columns().unwrap());
        let reports = batch.read_reports().unwrap();
        Condensed { batch, compliance, columns, reports }
    }
}

/// Each of `iterated_families` in each precision, solved once for all tests: software takes seconds for one.
fn condensed_family(family: usize, precision: Precision) -> &'static Condensed<'static> {
    static CONDENSED: [[OnceLock<Condensed<'static>>; 3]; FAMILY_COUNT] =
        [const { [const { OnceLock::new() }; 3] }; FAMILY_COUNT];
    let bodies = &iterated_families()[family].1;
    CONDENSED[family][precision as usize]
        .get_or_init(|| Condensed::new(bodies, precision, &precision.settings()))
}

/// With at most three Poisson's ratios, on meshes of a level, blocks of either support on one of their own.
fn families_at(
    level: usize,
    [on_base, held_around]: [usize; 2],
    poissons_ratios: &[f64],
) -> Vec<(&'static str, Bodies)> {
    let at = |level: usize, name: &str, ratios: &[&[f64]], support: usize| {
        let bodies = ratios.iter().zip(poissons_ratios).map(|(ratios, &poissons_ratio)| Body {
            support,
            ..body(name, ratios, Idealization::PlaneStrain, poissons_ratio)
        });
        Bodies::new(bodies.collect(), level)
    };
    let of = |name: &str, ratios: &[&[f64]]| at(level, name, ratios, 0);
    let blocks: [&[f64]; 3] = [&[2.0, 3.0, 1.6], &[2.02, 3.0, 1.62], &[2.0, 3.05, 1.6]];
    vec![
        ("annulus", of("annulus", &[&[2.8], &[3.0], &[3.1]])),
        ("rigid-core", of("rigid-core", &[&[0.3], &[0.28], &[0.29]])),
        ("rigid-midplane", of("rigid-midplane", &[&[], &[], &[]])),
        ("block on its base", at(on_base, "block", &blocks, 0)),
        ("block held around", at(held_around, "block", &blocks, 1)),
    ]
}

/// Blocks of one topology whose corners lie on other columns each: lopsided ones, some with a thin wall below, beside or
/// above the hole, and one that is long.
fn blocks() -> Vec<(&'static str, Bodies)> {
    let of = |ratios: [[f64; 3]; 3], level: usize| {
        let plate =
            |ratios: [f64; 3]| Body { support: 1, ..body("block", &ratios, Idealization::PlaneStress, 0.3) };
        let bodies = Bodies::new(ratios.map(plate).to_vec(), level);
        let columns = bodies
            .bodies
            .iter()
            .map(|body| corner_columns(&(body.shape.corners)(&body.parameters), &bodies.grading.angles));
        assert_eq!(columns.collect::<HashSet<_>>().len(), 3, "{ratios:?}");
        bodies
    };
    vec![
        ("lopsided block", of([[2.0, 3.0, 1.6], [3.0, 1.6, 2.0], [1.6, 2.0, 3.2]], 2)),
        ("thin-walled block", of([[1.06, 3.2, 1.5], [3.0, 1.06, 1.5], [1.5, 3.0, 1.06]], 1)),
        ("long block", of([[20.0, 1.5, 1.6], [1.6, 20.0, 1.5], [1.5, 1.6, 20.0]], 1)),
    ]
}

fn plates() -> Bodies {
    let bodies = [(2.8, 0.3), (3.0, 0.1), (3.1, 0.49), (2.9, -0.5), (2.85, 0.2)];
    let plate = |(ratio, nu)| body("annulus", &[ratio], Idealization::PlaneStrain, nu);
    Bodies::new(bodies.map(plate).to_vec(), 1)
}

/// The twin's solution of one body in the precision of the device: columns, reports.
fn twin(
    bodies: &Bodies,
    values: &[f64],
    precision: Precision,
    settings: &RefineSettings,
) -> (Vec<f64>, Vec<PcgReport>) {
    let assembly = &bodies.meshed[0].assembly;
    let unknowns = assembly.unknown_count();
    let ring_start = bodies.meshed[0].topology.ring_start;
    let mut loads = vec![0.0; unknowns * (unknowns - ring_start)];
    (ring_start..unknowns).for_each(|unknown| loads[(unknown - ring_start) * unknowns + unknown] = 1.0);
    let exact = assembly.matrix(values);
    let rounded: Vec<f32> = values.iter().map(|&value| value as f32).collect();
    let solution = match precision {
        Precision::F32 => {
            // Rounds of this one would have a residual in f64, which the kernels have not.
            assert_eq!(settings.round_limit, 0);
            let RefineSettings { tolerance, iteration_limit, .. } = *settings;
            let solution =
                pcg(assembly.matrix(&rounded), exact, &loads, &PcgSettings { tolerance, iteration_limit });
            return (solution.columns.into_iter().map(f64::from).collect(), solution.reports);
        }
        Precision::F64 => refined(exact, exact, &loads, settings),
        Precision::Mixed => refined(assembly.matrix(&rounded), exact, &loads, settings),
    };
    (solution.columns, solution.reports)
}

/// One round and no more.
fn plain(tolerance: f64, iteration_limit: usize) -> RefineSettings {
    PcgSettings { tolerance, iteration_limit }.into()
}

fn expected_outcome(report: &PcgReport) -> SystemOutcome {
    match report.outcome {
        PcgOutcome::Converged => SystemOutcome::Converged,
        PcgOutcome::Stagnated => SystemOutcome::Stagnated,
        PcgOutcome::IterationLimit => SystemOutcome::IterationLimit,
        PcgOutcome::Indefinite => SystemOutcome::Indefinite,
        PcgOutcome::NotFinite => SystemOutcome::NotFinite,
    }
}

/// Of what a batch has, as much for each body and something, the part of one body.
fn of_body<'a, T>(all: &'a [T], bodies: &Bodies, index: usize) -> &'a [T] {
    let count = all.len() / bodies.count();
    assert!(count > 0 && all.len() == count * bodies.count(), "{} for {} bodies", all.len(), bodies.count());
    &all[index * count..(index + 1) * count]
}
