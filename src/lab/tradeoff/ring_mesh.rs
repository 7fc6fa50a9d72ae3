//! Bodies of one topology on a mesh, condensed to the unknowns of their ring one by one: by sparse Cholesky or by
//! conjugate gradients.

use crate::mechanics::assembly::Assembly;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::RingCompliance;
use crate::mechanics::compliance::condense::{
    by_cholesky, plain_compliance, ring_unit_loads, variational_compliance,
};
use crate::mechanics::contact_grading::contact_grading;
use crate::mechanics::element::ElementKind;
use crate::mechanics::element::stiffness::Elasticity;
use crate::mechanics::grading::GradingClass;
use crate::mechanics::lines::coordinates;
use crate::mechanics::mesh::{Grading, RingTopology, held_columns};
use crate::mechanics::solve::cholesky::CholeskyAnalysis;
use crate::mechanics::solve::pcg::{PcgOutcome, PcgReport, PcgSettings, pcg};
use crate::mechanics::solve::refine::{RefineSettings, refined};

/// How finely bodies are divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Division {
    /// A level of the ladder that a sweep climbs.
    Ladder { element: ElementKind, level: usize },
    /// As fine at every contact angle from the least one up: `contact_grading`.
    Contact { element: ElementKind, fineness: f64, least_angle: f64 },
}

impl Division {
    pub fn grading(&self, body: &Body) -> Grading {
        match *self {
            Division::Ladder { element, level } => {
                GradingClass::of(body, element, level).grading(body.shape.end_angle)
            }
            Division::Contact { element, fineness, least_angle } => {
                let depth = body.depth_range().1;
                contact_grading(element, least_angle, fineness, body.shape.end_angle, depth)
            }
        }
    }
}

/// Bodies, by their number, that share a topology and `key`.
pub struct Group<K> {
    pub grading: Grading,
    pub key: K,
    pub members: Vec<usize>,
    held: Vec<bool>,
}

/// The bodies by topology, as they are divided, in the order of each group's first.
pub fn groups<K: Copy + PartialEq>(
    bodies: &[(Body, K)],
    division: impl Fn(&Body, &K) -> Grading,
) -> Vec<Group<K>> {
    let mut groups: Vec<Group<K>> = Vec::new();
    for (number, (body, key)) in bodies.iter().enumerate() {
        let grading = division(body, key);
        let held = held_columns(body, &grading.angles);
        let is_own = |group: &&mut Group<K>| {
            let first = &bodies[group.members[0]].0;
            group.key == *key
                && first.shape.name == body.shape.name
                && first.idealization == body.idealization
                && group.held == held
                && group.grading == grading
        };
        match groups.iter_mut().find(is_own) {
            Some(group) => group.members.push(number),
            None => groups.push(Group { grading, key: *key, members: vec![number], held }),
        }
    }
    groups
}

/// The numbers that conjugate gradients compute in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    F64,
    F32,
    /// Rounds in f32 around a residual in f64.
    Mixed,
}

/// How the stiffness of a body is solved for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RingSolver {
    Cholesky,
    /// To a relative residual; with the variational correction or without it.
    Pcg {
        numbers: Numbers,
        tolerance: f64,
        corrected: bool,
    },
}

/// What bodies of one topology share.
pub struct RingMesh {
    grading: Grading,
    pub topology: RingTopology,
    assembly: Assembly,
    /// Where the solver asks for it.
    analysis: Option<CholeskyAnalysis>,
}

/// Products with K that a column is given: far more than any converging one needs.
const ITERATION_LIMIT: usize = 20_000;

/// Rounds of refinement after the first.
const ROUND_LIMIT: u32 = 12;

/// Residual that a round in f32 has to reach: what f32 can do on any mesh here.
const ROUND_TOLERANCE: f64 = 1e-3;

impl RingMesh {
    /// For bodies like `body`; `None` where the factor finds no memory.
    pub fn new(body: &Body, grading: &Grading, solver: &RingSolver) -> Option<RingMesh> {
        let topology = RingTopology::new(body, grading);
        let assembly = Assembly::of_ring(&topology);
        let analysis = match solver {
            RingSolver::Cholesky => {
                // Only the pattern is read.
                let values = vec![0.0; assembly.value_count()];
                Some(CholeskyAnalysis::new(assembly.matrix(&values)).ok()?)
            }
            RingSolver::Pcg { .. } => None,
        };
        Some(RingMesh { grading: grading.clone(), topology, assembly, analysis })
    }

    /// The ring's compliance; `None` where the mesh is inside out, or the solver gives up.
    pub fn condense(&self, body: &Body, solver: &RingSolver) -> Option<RingCompliance> {
        let RingMesh { grading, topology, assembly, analysis } = self;
        let places = coordinates(body, grading, topology);
        let elasticity = Elasticity::new(body.idealization, body.poissons_ratio);
        let ring_start = topology.ring_start;
        let RingSolver::Pcg { numbers, tolerance, corrected } = *solver else {
            return by_cholesky(assembly, analysis.as_ref()?, ring_start, &elasticity, &places).ok();
        };
        let values: Vec<f64> = assembly.stiffness_values(&elasticity, &places).ok()?;
        let exact = assembly.matrix(&values);
        let loads = ring_unit_loads(topology.unknown_count, ring_start);
        let settings = PcgSettings { tolerance, iteration_limit: ITERATION_LIMIT };
        let (columns, reports): (Vec<f64>, Vec<PcgReport>) = match numbers {
            Numbers::F64 => {
                let solution = pcg::<f64>(exact, exact, &loads, &settings);
                (solution.columns, solution.reports)
            }
            Numbers::F32 | Numbers::Mixed => {
                let rounded: Vec<f32> = assembly.stiffness_values(&elasticity, &places).ok()?;
                let rounded = assembly.matrix(&rounded);
                if numbers == Numbers::F32 {
                    let solution = pcg(rounded, exact, &loads, &settings);
                    (solution.columns.into_iter().map(f64::from).collect(), solution.reports)
                } else {
                    let settings = RefineSettings {
                        tolerance: tolerance.max(ROUND_TOLERANCE),
                        goal: tolerance,
                        round_limit: ROUND_LIMIT,
                        iteration_limit: ITERATION_LIMIT,
                    };
                    let solution = refined(rounded, exact, &loads, &settings);
                    (solution.columns, solution.reports)
                }
            }
        };
        // A stagnated column is as good as its numbers let it be.
        let reached =
            |report: &PcgReport| matches!(report.outcome, PcgOutcome::Converged | PcgOutcome::Stagnated);
        if !reports.iter().all(reached) {
            return None;
        }
        Some(if corrected {
            variational_compliance(exact, ring_start, &columns)
        } else {
            plain_compliance(topology.unknown_count, ring_start, &columns)
        })
    }
}
