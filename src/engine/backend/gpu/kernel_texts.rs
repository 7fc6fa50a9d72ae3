//! The kernels as text: their files, and what is put before them in each precision.

use super::batch::{OnChip, works_tile};
use super::front::{AMPLIFIED, Front, ROUGHEST, WORKS_HEADER};
use super::gather::NO_PLACE;
use super::system_layout::{SLICE, SystemOutcome};
use crate::engine::accuracy::LEAST;
use crate::engine::accuracy::fit_bound::{KINDS, NEAR_END, THIN_END};
use crate::engine::accuracy::geometry_error::{
    LARGE_DISPLACEMENT, OF_CUBE, OF_HELD, OF_SHEAR, OF_SINE, OF_STRAIN, STIFFEST, WALL,
};
use crate::engine::accuracy::known_errors::{COLUMNS, DEPTHS};
use crate::engine::backend::drawn::{DrawnShape, FIT_WORDS, LoadKind, MOST_KINDS, NOWHERE, SIDE_WORDS};
use crate::engine::backend::joints::{
    ELSEWHERE, ENDED, JOINT_NUMBERS, JointKind, MISSING, MOST_COORDINATES, MOST_PRODUCTS, MOST_ROWS,
    NEAR_NODES, STATE_NUMBERS, TERMS,
};
use crate::engine::backend::precision::Precision;
use crate::engine::question::counted::{
    EXPONENTS, FIRST_EXPONENT, LEADING, PARTS, SUM_WORDS, Total, Verdict,
};
use crate::engine::question::tables::{BOUND_NUMBERS, DESIGN_NUMBERS, Field, SCENE_NUMBERS};
use crate::engine::question::{CALCULATED, FOUND, NOISE, OF_ERRORS, ROUNDED, TRUSTED};
use crate::engine::spaces::{DEEP, THIN, WIDE_COSINE, WIDE_TANGENT};
use crate::mechanics::body::DEEPEST_MESHED;
use crate::mechanics::compliance::ring_modes::MOST_MODES;
use crate::mechanics::contact::compliance_rows;
use crate::mechanics::contact::curve_error::ROUGH;
use crate::mechanics::contact::edge::{SLOWEST, TENSION};
use crate::mechanics::contact::reduced::{DECISIVE, FUNCTIONS, OF_LOAD};
use crate::mechanics::contact::search::MOST_OF_POLYNOMIALS;
use crate::mechanics::layers::{MOST_STEPS, SHRINK, SINGLE_TOLERANCE, STEEPEST, TOLERANCE};
use crate::mechanics::lines::{CROWDING, LEEWAY, THICK_WALL};
use crate::study::draw_tables::{
    ENTRY_WORDS, Kind as ValuesKind, POISSONS_RATIO, SUPPORT, Slot, YOUNGS_MODULUS,
};
use crate::study::sampling::{SOBOL_BITS, Source};
use crate::study::values::ROOTS;

/// How a kernel uses what it is bound to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    Uniform,
    Read,
    Written,
}

use Access::{Read, Uniform, Written};

/// A number that stands in a twin.
#[derive(Clone, Copy, Debug)]
pub enum Constant {
    /// u32.
    Count(usize),
    /// In the numbers of the kernel.
    Wide(f64),
    /// f32 in any precision.
    Single(f64),
}

impl Constant {
    fn text(self, name: &str) -> String {
        match self {
            Constant::Count(count) => format!("const {name} = {count}u;\n"),
            Constant::Single(number) => format!("const {name} = f32({number:?});\n"),
            Constant::Wide(number) => format!("const {name} = wide({number:?});\n"),
        }
    }
}

/// One file of kernels: its text, its entry points, and its bindings by name, in their order.
pub struct KernelFile {
    pub name: &'static str,
    pub text: &'static str,
    pub entry_points: &'static [&'static str],
    pub bindings: &'static [(&'static str, Access)],
    /// What it has from its twin, by name.
    pub constants: &'static [(&'static str, Constant)],
    /// What it takes sums of over a workgroup.
    pub summand: Option<&'static str>,
}

const COMMON: &str = include_str!("../../../../shaders/common.wgsl");
const SUM_TREE: &str = include_str!("../../../../shaders/sum_tree.wgsl");
const SUM_SUBGROUPS: &str = include_str!("../../../../shaders/sum_subgroups.wgsl");

pub const ASSEMBLE: KernelFile = KernelFile {
    name: "assemble",
    text: concat!(
        include_str!("../../../../shaders/functions.wgsl"),
        include_str!("../../../../shaders/topologies.wgsl"),
        include_str!("../../../../shaders/assemble.wgsl")
    ),
    entry_points: &["assemble"],
    bindings: &[
        ("topologies", Read),
        ("bodies", Read),
        ("shared_numbers", Read),
        ("lists", Read),
        ("geometry", Written),
        ("values", Written),
        ("states", Written),
    ],
    constants: &[
        ("LEEWAY", Constant::Wide(LEEWAY)),
        ("CROWDING", Constant::Wide(CROWDING)),
        ("THICK_WALL", Constant::Wide(THICK_WALL)),
        ("SHRINK", Constant::Wide(SHRINK)),
        ("TOLERANCE", Constant::Wide(TOLERANCE)),
        ("SINGLE_TOLERANCE", Constant::Wide(SINGLE_TOLERANCE)),
        ("STEEPEST", Constant::Wide(STEEPEST)),
        ("MOST_STEPS", Constant::Count(MOST_STEPS)),
        ("NO_PLACE", Constant::Count(NO_PLACE as usize)),
    ],
    summand: None,
};

pub const PCG: KernelFile = KernelFile {
    name: "pcg",
    text: include_str!("../../../../shaders/pcg.wgsl"),
    entry_points: &["solve"],
    bindings: &[
        ("parameters", Uniform),
        ("slice_starts", Read),
        ("columns", Read),
        ("diagonal_places", Read),
        ("values", Read),
        ("iterates", Written),
        ("norms", Written),
        ("states", Written),
    ],
    constants: &[],
    summand: Some("real4"),
};

pub const NARROW: KernelFile = KernelFile {
    name: "narrow",
    text: include_str!("../../../../shaders/narrow.wgsl"),
    entry_points: &["narrow"],
    bindings: &[("parameters", Uniform), ("values", Read), ("narrowed", Written)],
    constants: &[],
    summand: None,
};

pub const REFINE: KernelFile = KernelFile {
    name: "refine",
    text: include_str!("../../../../shaders/refine.wgsl"),
    entry_points: &["start", "refine", "settle"],
    bindings: &[
        ("parameters", Uniform),
        ("slice_starts", Read),
        ("columns", Read),
        ("diagonal_places", Read),
        ("values", Read),
        ("iterates", Written),
        ("norms", Written),
        ("states", Written),
        ("solutions", Written),
    ],
    constants: &[],
    summand: Some("wide4"),
};

pub const CONDENSE: KernelFile = KernelFile {
    name: "condense",
    text: include_str!("../../../../shaders/condense.wgsl"),
    entry_points: &["condense"],
    bindings: &[("parameters", Uniform), ("solutions", Read), ("compliance", Written)],
    constants: &[],
    summand: None,
};

pub const WORKS: KernelFile = KernelFile {
    name: "works",
    text: include_str!("../../../../shaders/works.wgsl"),
    entry_points: &["sum_works"],
    bindings: &[
        ("parameters", Uniform),
        ("compliance", Read),
        ("loads", Read),
        ("states", Read),
        ("norms", Read),
        ("works", Written),
    ],
    constants: &[],
    summand: None,
};

pub const ELIMINATE: KernelFile = KernelFile {
    name: "eliminate",
    text: concat!(
        include_str!("../../../../shaders/topologies.wgsl"),
        include_str!("../../../../shaders/eliminate.wgsl")
    ),
    entry_points: &["eliminate"],
    bindings: &[
        ("topologies", Read),
        ("lists", Read),
        ("loads", Read),
        ("values", Read),
        ("states", Read),
        ("works", Written),
        ("fronts", Written),
    ],
    constants: &[],
    summand: None,
};

// `joints.wgsl` takes them four at a time.
const _: () = assert!(FUNCTIONS == 12 && OF_LOAD == 8);

/// From bodies, as they lie in fits or are condensed, and loads to states of contact.
pub const JOINTS: KernelFile = KernelFile {
    name: "joints",
    text: concat!(
        include_str!("../../../../shaders/joint_place.wgsl"),
        include_str!("../../../../shaders/joints.wgsl")
    ),
    entry_points: &["solve_joints"],
    bindings: &[
        ("parameters", Read),
        ("tables", Read),
        ("table_fours", Read),
        ("places", Read),
        ("joints", Read),
        ("works", Read),
        ("near_fields", Read),
        ("found", Written),
    ],
    constants: &[
        ("MOST_PRODUCTS", Constant::Count(MOST_PRODUCTS)),
        ("MOST_ROWS", Constant::Count(MOST_ROWS)),
        ("JOINT_NUMBERS", Constant::Count(JOINT_NUMBERS)),
        ("STATE_NUMBERS", Constant::Count(STATE_NUMBERS)),
        ("NEAR_NODES", Constant::Count(NEAR_NODES)),
        ("ELSEWHERE", Constant::Count(ELSEWHERE as usize)),
        ("MISSING", Constant::Count(MISSING as usize)),
        ("ROUGHEST_LOSS", Constant::Single(ROUGHEST / (AMPLIFIED * f32::EPSILON as f64))),
        ("DECISIVE", Constant::Count(DECISIVE)),
        ("MOST_STEPS", Constant::Count(MOST_SEARCH_STEPS)),
        ("MOST_OF_POLYNOMIALS", Constant::Count(MOST_OF_POLYNOMIALS)),
        ("SEARCH_TOLERANCE", Constant::Single(SEARCH_TOLERANCE)),
        ("NARROWEST", Constant::Single(NARROWEST)),
        ("SLOWEST", Constant::Single(SLOWEST)),
        ("TENSION", Constant::Single(TENSION)),
    ],
    summand: None,
};

/// From numbers of designs to what the two others are given of them; each question adds its own functions.
pub const DRAW: KernelFile = KernelFile {
    name: "draw",
    text: concat!(
        include_str!("../../../../shaders/joint_place.wgsl"),
        include_str!("../../../../shaders/draw.wgsl")
    ),
    entry_points: &["draw"],
    bindings: &[
        ("settings", Uniform),
        ("words", Read),
        ("numbers", Read),
        ("joints", Written),
        ("places", Written),
        ("designs", Written),
    ],
    constants: &[
        ("SLOT_COUNT", Constant::Count(Slot::Count as usize)),
        ("HOLE_RADIUS", Constant::Count(Slot::HoleRadius as usize)),
        ("RADIAL_CLEARANCE", Constant::Count(Slot::RadialClearance as usize)),
        ("THICKNESS", Constant::Count(Slot::Thickness as usize)),
        ("IDEALIZATION", Constant::Count(Slot::Idealization as usize)),
        ("PIN", Constant::Count(Slot::Pin as usize)),
        ("PLATE", Constant::Count(Slot::Plate as usize)),
        ("SUPPORT", Constant::Count(SUPPORT)),
        ("YOUNGS_MODULUS", Constant::Count(YOUNGS_MODULUS)),
        ("POISSONS_RATIO", Constant::Count(POISSONS_RATIO)),
        ("ENTRY_WORDS", Constant::Count(ENTRY_WORDS)),
        ("GRID", Constant::Count(Source::Grid as usize)),
        ("ZIP", Constant::Count(Source::Zip as usize)),
        ("SLICES", Constant::Count(Source::Slices as usize)),
        ("SOBOL", Constant::Count(Source::Sobol as usize)),
        ("SOBOL_BITS", Constant::Count(SOBOL_BITS as usize)),
        ("LIST", Constant::Count(ValuesKind::List as usize)),
        ("LOGARITHMIC", Constant::Count(ValuesKind::Logarithmic as usize)),
        ("ROOTS", Constant::Count(ROOTS)),
        ("SIDE_WORDS", Constant::Count(SIDE_WORDS)),
        ("FIT_WORDS", Constant::Count(FIT_WORDS)),
        ("MOST_KINDS", Constant::Count(MOST_KINDS)),
        ("CONCENTRIC", Constant::Count(DrawnShape::Concentric as usize)),
        ("BLOCK", Constant::Count(DrawnShape::Block as usize)),
        ("OFFSET", Constant::Count(LoadKind::Offset as usize)),
        ("FORCE", Constant::Count(LoadKind::Force as usize)),
        ("NOWHERE", Constant::Count(NOWHERE as usize)),
        ("ELSEWHERE", Constant::Count(ELSEWHERE as usize)),
        ("JOINT_NUMBERS", Constant::Count(JOINT_NUMBERS)),
        ("BODY_NUMBERS", Constant::Count(MOST_COORDINATES + 3)),
        ("MOST_COORDINATES", Constant::Count(MOST_COORDINATES)),
        ("SCENE_NUMBERS", Constant::Count(SCENE_NUMBERS)),
        ("BODY_BOUND_NUMBERS", Constant::Count(BOUND_NUMBERS)),
        ("DEPTH_COUNT", Constant::Count(DEPTHS.len())),
        ("THIN", Constant::Wide(THIN)),
        ("THIN_END", Constant::Wide(THIN_END)),
        ("DEEP", Constant::Wide(DEEP)),
        ("DEEPEST_MESHED", Constant::Wide(DEEPEST_MESHED)),
        ("NEAR_END", Constant::Wide(NEAR_END)),
        ("NARROW", Constant::Wide(compliance_rows::NARROW)),
        ("PI", Constant::Wide(std::f64::consts::PI)),
        ("OF_CUBE", Constant::Wide(OF_CUBE)),
        ("OF_SHEAR", Constant::Wide(OF_SHEAR)),
        ("OF_HELD", Constant::Wide(OF_HELD)),
        ("WALL", Constant::Wide(WALL)),
        ("STIFFEST", Constant::Wide(STIFFEST)),
        ("WIDE_COSINE", Constant::Wide(WIDE_COSINE)),
        ("WIDE_TANGENT", Constant::Wide(WIDE_TANGENT)),
    ],
    summand: None,
};

/// Designs that a workgroup of `answers` has, and its invocations, which take the rows of all of these in turn.
pub const ANSWERED_TOGETHER: usize = 64;
pub const ANSWERING: u32 = 128;

/// From states of joints to what is asked of all rows together; each question adds its own functions.
pub const ANSWERS: KernelFile = KernelFile {
    name: "answers",
    text: include_str!("../../../../shaders/answers.wgsl"),
    entry_points: &["answer"],
    bindings: &[("found", Read), ("joints", Read), ("asked", Read), ("designs", Read), ("told", Written)],
    constants: &[
        ("TOGETHER", Constant::Count(ANSWERED_TOGETHER)),
        ("JOINT_NUMBERS", Constant::Count(JOINT_NUMBERS)),
        ("STATE_NUMBERS", Constant::Count(STATE_NUMBERS)),
        ("ACCURACY", Constant::Count(Field::Accuracy as usize)),
        ("QUANTITY_COUNT", Constant::Count(Field::QuantityCount as usize)),
        ("QUANTITIES_AT", Constant::Count(Field::QuantitiesAt as usize)),
        ("WATCH_COUNT", Constant::Count(Field::WatchCount as usize)),
        ("WATCHES_AT", Constant::Count(Field::WatchesAt as usize)),
        ("AXIS_COUNT", Constant::Count(Field::AxisCount as usize)),
        ("POINT_COUNT", Constant::Count(Field::PointCount as usize)),
        ("AXES_AT", Constant::Count(Field::AxesAt as usize)),
        ("HISTOGRAM_COUNT", Constant::Count(Field::HistogramCount as usize)),
        ("HISTOGRAMS_AT", Constant::Count(Field::HistogramsAt as usize)),
        ("GIVEN_OF_DESIGN", Constant::Count(Field::GivenOfDesign as usize)),
        ("GIVEN_OF_ROW", Constant::Count(Field::GivenOfRow as usize)),
        ("VERDICTS_AT", Constant::Count(Field::VerdictsAt as usize)),
        ("COLUMN_BEGINS_AT", Constant::Count(Field::ColumnBeginsAt as usize)),
        ("MESH_ERRORS_AT", Constant::Count(Field::MeshErrorsAt as usize)),
        ("ON_MESHES", Constant::Count(Field::OnMeshes as usize)),
        ("COUNTED_DESIGNS", Constant::Count(Total::CountedDesigns as usize)),
        ("COUNTED_ROWS", Constant::Count(Total::CountedRows as usize)),
        ("KEPT_ROWS", Constant::Count(Total::KeptRows as usize)),
        ("LARGE_ROWS", Constant::Count(Total::LargeRows as usize)),
        ("GREATEST_ERROR", Constant::Count(Total::GreatestError as usize)),
        ("GREATEST_LINEARITY", Constant::Count(Total::GreatestLinearity as usize)),
        ("GREATEST_FORCE", Constant::Count(Total::GreatestForce as usize)),
        ("LEAST_FORCE", Constant::Count(Total::LeastForce as usize)),
        ("OF_ALL", Constant::Count(Total::Count as usize)),
        ("OPEN", Constant::Count(Verdict::Open as usize)),
        ("COUNTED", Constant::Count(Verdict::Counted as usize)),
        ("CANDIDATE", Constant::Count(Verdict::Candidate as usize)),
        ("MORE_NODES", Constant::Count(Verdict::MoreNodes as usize)),
        ("MORE_TERMS", Constant::Count(Verdict::MoreTerms as usize)),
        ("FINER_MESH", Constant::Count(Verdict::FinerMesh as usize)),
        ("SCENE_NUMBERS", Constant::Count(SCENE_NUMBERS)),
        ("BODY_BOUND_NUMBERS", Constant::Count(BOUND_NUMBERS)),
        ("DESIGN_NUMBERS", Constant::Count(DESIGN_NUMBERS)),
        ("KINDS", Constant::Count(KINDS)),
        ("COLUMNS", Constant::Count(COLUMNS.len() + 1)),
        ("LEAST_EXPONENT", Constant::Count((127 + FIRST_EXPONENT) as usize)),
        ("EXPONENTS", Constant::Count(EXPONENTS)),
        ("LEADING", Constant::Count(LEADING)),
        ("PARTS", Constant::Count(PARTS)),
        ("SUM_WORDS", Constant::Count(SUM_WORDS)),
        ("ENDED", Constant::Single(ENDED as f64)),
        ("ROUGH", Constant::Single(ROUGH)),
        ("LEAST_ERROR", Constant::Single(LEAST)),
        ("OF_SINE", Constant::Single(OF_SINE)),
        ("OF_STRAIN", Constant::Single(OF_STRAIN)),
        ("LARGE_DISPLACEMENT", Constant::Single(LARGE_DISPLACEMENT)),
        ("FOUND", Constant::Single(FOUND)),
        ("CALCULATED", Constant::Single(CALCULATED)),
        ("ROUNDED", Constant::Single(ROUNDED)),
        ("TRUSTED", Constant::Single(TRUSTED)),
        ("OF_ERRORS", Constant::Single(OF_ERRORS)),
        ("NOISE", Constant::Single(NOISE)),
    ],
    summand: None,
};

/// Where a search in single precision ends: what its load is off by, or how narrow its bracket is, relative, or after so many steps.
const SEARCH_TOLERANCE: f64 = 1e-6;
const NARROWEST: f64 = 3e-7;
const MOST_SEARCH_STEPS: usize = 40;

/// Vectors of a workgroup's own memory that `roofline` reads: 16 KiB of f64, which every device has.
const ROOFLINE_SHARED: usize = 512;

/// What a device can do at most.
pub const ROOFLINE: KernelFile = KernelFile {
    name: "roofline",
    text: include_str!("../../../../shaders/roofline.wgsl"),
    entry_points: &["copy", "multiply_add", "read_cached", "read_shared"],
    bindings: &[("parameters", Uniform), ("source", Read), ("copied", Written)],
    constants: &[("SHARED", Constant::Count(ROOFLINE_SHARED)), ("STRIDE", Constant::Count(16))],
    summand: None,
};

/// The files of kernels that turn bodies into works of their rings' modes.
pub const KERNEL_FILES: [&KernelFile; 7] = [&ASSEMBLE, &NARROW, &PCG, &REFINE, &CONDENSE, &WORKS, &ELIMINATE];

/// How the invocations of a workgroup add their parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sums {
    /// In the order of the twins.
    Tree,
    /// In the order of the device, where it has subgroups.
    Subgroups,
}

/// What the text of a kernel depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    pub precision: Precision,
    /// Of a workgroup, a power of two.
    pub invocations: u32,
    /// Of `pcg`.
    pub on_chip: OnChip,
    /// Of `eliminate`.
    pub front: Front,
    /// Of `joints`.
    pub joints: JointKind,
    pub sums: Sums,
}

impl Variant {
    /// With all vectors in storage, the smallest front, one joint of the fewest trial pressures, and sums as a tree.
    pub fn plain(precision: Precision, invocations: u32) -> Variant {
        let front = Front::SMALLEST;
        let joints = JointKind { terms: TERMS[0], together: 1 };
        Variant { precision, invocations, on_chip: OnChip::NOTHING, front, joints, sums: Sums::Tree }
    }
}

impl KernelFile {
    /// The whole text in one precision and for one size of workgroup, with all vectors in storage and sums as a tree.
    pub fn source(&self, precision: Precision, invocations: u32) -> String {
        self.variant(&Variant::plain(precision, invocations))
    }

    /// How many of its bindings are storage.
    pub fn storage_buffers(&self) -> usize {
        self.bindings.iter().filter(|(_, access)| *access != Uniform).count()
    }

    /// Its entry points, which do nothing.
    pub fn empty(&self, invocations: u32) -> String {
        let empty = |name: &&str| format!("@compute @workgroup_size({invocations})\nfn {name}() {{}}\n");
        self.entry_points.iter().map(empty).collect()
    }

    pub fn variant(&self, variant: &Variant) -> String {
        let Variant {
            precision,
            invocations,
            on_chip: OnChip { vectors, capacity },
            front: Front { rows, is_on_chip },
            joints: JointKind { terms, together },
            sums,
        } = variant;
        let name = |bytes: u64| if bytes == 4 { "f32" } else { "f64" };
        let (real, wide) = (name(precision.real_bytes()), name(precision.wide_bytes()));
        // WGSL wants `enable subgroups;` first, which naga does not read (gfx-rs/wgpu#5555).
        let sums = match (self.summand, sums) {
            (None, _) => String::new(),
            (Some(summand), Sums::Tree) => format!("alias summand = {summand};\n{SUM_TREE}"),
            (Some(summand), Sums::Subgroups) => format!("alias summand = {summand};\n{SUM_SUBGROUPS}"),
        };
        let outcomes = SystemOutcome::ALL.map(|(name, outcome)| (name, Constant::Count(outcome as usize)));
        let tile_rows = works_tile(u64::from(*invocations)) as usize;
        let sizes = [
            ("SLICE", SLICE),
            ("MOST_MODES", MOST_MODES),
            ("WORKS_HEADER", WORKS_HEADER),
            ("TILE_ROWS", tile_rows),
            ("TERMS", *terms),
            ("JOINTS", *together),
        ];
        let sizes = sizes.map(|(name, size)| (name, Constant::Count(size)));
        let constants = outcomes.iter().chain(&sizes).chain(self.constants);
        let constants: String = constants.map(|(name, constant)| constant.text(name)).collect();
        let text = self.text;
        let double = precision.wide_bytes() == 8;
        format!(
            "alias real = {real};\nalias wide = {wide};\nconst IS_WIDE_DOUBLE = {double};\nconst INVOCATIONS = {invocations}u;\n\
             const ON_CHIP = {vectors}u;\nconst CAPACITY = {capacity}u;\nconst FRONT = {rows}u;\nconst IS_FRONT_ON_CHIP = {is_on_chip};\n\
             {constants}{COMMON}\n{sums}\n{text}"
        )
    }
}
