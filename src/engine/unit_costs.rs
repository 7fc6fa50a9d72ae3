//! What the parts of a sweep cost, for forecasts of what a sweep will take and of which way is the cheaper one.
//!
//! A cost is a sum: amounts that follow from sizes, each times what one unit of it takes. `unit_costs.csv` is what
//! `cargo run --release --example unit_costs` prints: these times, measured on one core, fitted to bodies of all shapes and to
//! pressure spaces of all sizes. `jointsweep bench` writes the forecast of a whole sweep, at the pace of its machine, beside its time: 0.4 to 1.5
//! of it for every file in configs/ (results/sweep.csv).

use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul};
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::engine::body_request::{BodyRequest, Fidelity, MeshSize, concentric, mesh_class, mesh_size};
use crate::engine::csv_rows::rows;
use crate::engine::plan::JointPlan;
use crate::engine::spaces::SpaceKey;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::arc::packed_count;
use crate::mechanics::compliance::concentric_body::ConcentricBody;
use crate::mechanics::compliance::lane_condensation::few;
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::real::LANES;

macro_rules! units {
    ($($(#[$about:meta])* $unit:ident = $name:literal,)*) => {
        /// What is counted. Each takes a time of its own.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
        pub enum Unit {
            $($(#[$about])* #[serde(rename = $name)] $unit,)*
        }
    };
}

units! {
    /// A run of the program, before and after the sweep.
    Process = "process",
    /// A node of a pressure space.
    SpaceNode = "space node",
    /// A node and pair of trial pressures.
    SpacePair = "space pair",
    /// A step of the integrals over the modes of exact bodies.
    SpaceMode = "space mode",
    /// A step of the integrals over the ring modes of bodies on meshes.
    SpaceRingMode = "space ring mode",
    /// An exact body.
    SeriesBody = "series body",
    /// A mode of it.
    SeriesMode = "series mode",
    /// A lane batch of meshes.
    BatchStart = "batch start",
    /// An unknown of one: coordinates and elements.
    BatchUnknown = "batch unknown",
    /// An unknown and squared width of the band: its factor.
    BatchFactor = "batch factor",
    /// An unknown of a topology: its order of elimination.
    TopologyUnknown = "topology unknown",
    /// A step of the integrals for the ring's loads.
    TopologyLoad = "topology load",
    /// A step of the integrals for the exact works of a near field.
    NearFieldMode = "near field mode",
    /// A number of a body's compliance to the trial pressures.
    SpreadNumber = "spread number",
    /// A product for what the modes of an exact body add to it.
    SpreadMode = "spread mode",
    /// A product for what the ring modes of a body on a mesh add to it.
    SpreadRingMode = "spread ring mode",
    /// A node of a joint's curve.
    CurveNode = "curve node",
    /// A node and pair of trial pressures.
    CurvePair = "curve pair",
    /// A design, besides its bodies and its curve.
    Design = "design",
    /// A row of the table.
    Row = "row",
    /// A row of which answers are all that is kept.
    AnsweredRow = "answered row",
    /// A design whose bodies are interpolated, its curve included.
    InterpolatedDesign = "interpolated design",
    /// The fit of all laws to the states of a design.
    Laws = "laws",
}

impl Unit {
    /// s.
    pub fn seconds(self) -> f64 {
        SECONDS[self as usize]
    }
}

/// In the order of the units, s.
static SECONDS: LazyLock<Vec<f64>> =
    LazyLock::new(|| rows::<Row>(include_str!("unit_costs.csv")).map(|(_, seconds, _)| seconds).collect());

/// A row of the file: what is counted, how long it takes, s.
type Row = (Unit, f64, String);

/// How long something takes by these times, s: the work done in lanes, of bodies, of their compliance to trial pressures and of curves, and all else.
/// What a processor takes for the one beside another machine tells little of the other: it has longer vectors, or other clocks for them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Time {
    pub in_lanes: f64,
    pub others: f64,
}

/// What both are to be multiplied by on a machine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pace {
    pub in_lanes: f64,
    pub others: f64,
}

impl Pace {
    /// Of the machine of the file.
    pub const OF_UNIT_COSTS: Pace = Pace { in_lanes: 1.0, others: 1.0 };

    /// Of two measurements the slower, of either work.
    pub fn or_slower(self, other: Pace) -> Pace {
        Pace { in_lanes: self.in_lanes.max(other.in_lanes), others: self.others.max(other.others) }
    }
}

impl Time {
    pub fn in_lanes(seconds: f64) -> Time {
        Time { in_lanes: seconds, others: 0.0 }
    }

    pub fn of_others(seconds: f64) -> Time {
        Time { in_lanes: 0.0, others: seconds }
    }

    /// On the machine of the file, s.
    pub fn seconds(self) -> f64 {
        self.in_lanes + self.others
    }

    /// On another one, s.
    pub fn at(self, pace: Pace) -> f64 {
        pace.in_lanes * self.in_lanes + pace.others * self.others
    }
}

impl Add for Time {
    type Output = Time;

    fn add(self, other: Time) -> Time {
        Time { in_lanes: self.in_lanes + other.in_lanes, others: self.others + other.others }
    }
}

impl AddAssign for Time {
    fn add_assign(&mut self, more: Time) {
        *self = *self + more;
    }
}

impl Mul<f64> for Time {
    type Output = Time;

    fn mul(self, times: f64) -> Time {
        Time { in_lanes: times * self.in_lanes, others: times * self.others }
    }
}

impl Sum for Time {
    fn sum<I: Iterator<Item = Time>>(times: I) -> Time {
        times.fold(Time::default(), Add::add)
    }
}

/// What something takes: how much of which units.
#[derive(Clone, Copy, Debug)]
pub struct Cost<const UNITS: usize>(pub [(Unit, f64); UNITS]);

impl<const UNITS: usize> Cost<UNITS> {
    pub fn seconds(&self) -> f64 {
        self.0.iter().map(|(unit, amount)| amount * unit.seconds()).sum()
    }
}

/// Of a pressure space.
pub fn space(SpaceKey { terms, nodes, .. }: SpaceKey) -> Cost<2> {
    let nodes = nodes as f64;
    Cost([(Unit::SpaceNode, nodes), (Unit::SpacePair, nodes * packed_count(terms) as f64)])
}

/// Of the integrals of its trial pressures over the modes of exact bodies: the more modes, the more points does each take.
pub fn space_modes(SpaceKey { terms, nodes, .. }: SpaceKey, highest_mode: usize) -> Cost<1> {
    let modes = highest_mode as f64;
    let points = modes + (4 * (24 + terms)) as f64;
    Cost([(Unit::SpaceMode, (nodes * (terms + 12)) as f64 * modes * points)])
}

/// The same over so many ring modes.
pub fn space_ring_modes(SpaceKey { terms, nodes, .. }: SpaceKey, modes: usize) -> Cost<1> {
    let points = 32 + terms + 2 * modes;
    Cost([(Unit::SpaceRingMode, (nodes * points * (modes * terms + 60)) as f64)])
}

/// Of an exact body: its modes.
pub fn series(modes: usize) -> Cost<2> {
    Cost([(Unit::SeriesBody, 1.0), (Unit::SeriesMode, modes as f64)])
}

/// Of the compliance of an exact body to the trial pressures of a space.
pub fn spread_modes(SpaceKey { terms, nodes, .. }: SpaceKey, modes: usize) -> Cost<2> {
    let numbers = (nodes * packed_count(terms)) as f64;
    Cost([(Unit::SpreadNumber, numbers), (Unit::SpreadMode, numbers * modes as f64)])
}

/// The same of a body in so many ring modes.
pub fn spread_ring_modes(SpaceKey { terms, nodes, .. }: SpaceKey, modes: usize) -> Cost<2> {
    let products = nodes * terms * (packed_count(modes) + modes * terms);
    Cost([
        (Unit::SpreadNumber, (nodes * packed_count(terms)) as f64),
        (Unit::SpreadRingMode, products as f64),
    ])
}

/// Of one lane batch: a start, the elements, and the band's factor, which is as wide as a layer of the mesh. The works of the
/// ring modes are little beside.
pub fn batch(size: MeshSize) -> Cost<3> {
    let (unknowns, width) = (size.unknowns as f64, size.width());
    Cost([
        (Unit::BatchStart, 1.0),
        (Unit::BatchUnknown, unknowns),
        (Unit::BatchFactor, unknowns * width * width),
    ])
}

/// So many bodies, condensed one after the other, take as long as a batch.
pub fn few_bodies(size: MeshSize) -> f64 {
    few(size.unknowns as usize * size.width() as usize * LANES * size_of::<f64>()) as f64
}

/// Of what bodies of one topology share: the order of elimination, and the loads of the ring modes.
pub fn topology(size: MeshSize, modes: usize) -> Cost<2> {
    let modes = modes as f64;
    Cost([
        (Unit::TopologyUnknown, size.unknowns as f64),
        (Unit::TopologyLoad, size.width() * modes * (12.0 + modes)),
    ])
}

/// Of the exact works of a near field, from modes of its references to ring modes.
pub fn near_field_works(highest_mode: usize, modes: usize, references: usize) -> Cost<1> {
    let steps = highest_mode * modes * (64 + highest_mode + references * modes / 2);
    Cost([(Unit::NearFieldMode, steps as f64)])
}

/// Of a joint's curve, with the bodies' shares of its work.
pub fn curve(SpaceKey { terms, nodes, .. }: SpaceKey) -> Cost<2> {
    let nodes = nodes as f64;
    Cost([(Unit::CurveNode, nodes), (Unit::CurvePair, nodes * packed_count(terms) as f64)])
}

/// Of a row, in a table or not.
pub fn row(is_written: bool) -> Unit {
    if is_written { Unit::Row } else { Unit::AnsweredRow }
}

/// Of a design with so many rows of a kind, besides its bodies and its curve.
pub fn design(rows: f64, row: Unit) -> Cost<2> {
    Cost([(Unit::Design, 1.0), (row, rows)])
}

/// Of a design with so many rows of a kind whose bodies are interpolated, its curve included.
pub fn interpolated_design(rows: f64, row: Unit) -> Cost<2> {
    Cost([(Unit::InterpolatedDesign, 1.0), (row, rows)])
}

/// Of one body among many of its kind, s; what they share is left out.
pub fn body_seconds(BodyRequest { body, fidelity }: &BodyRequest) -> f64 {
    match *fidelity {
        Fidelity::Series => series(concentric(body).modes_needed()).seconds(),
        Fidelity::Mesh { level } => {
            let condensed = batch(mesh_size(body, level)).seconds() / LANES as f64;
            // The reference of a lined body is condensed like it.
            let meshes = if body.lining.is_empty() { 1.0 } else { 2.0 };
            meshes * condensed + reference_seconds(body)
        }
    }
}

/// Of the exact modes beside which a lined body is told, s; none of a bare one.
pub fn reference_seconds(body: &Body) -> f64 {
    let reference = ConcentricBody::with_layers_of(body);
    reference.map_or(0.0, |reference| series(reference.highest_mode()).seconds())
}

/// Of a body's compliance to the trial pressures of a space, s.
pub fn spread_seconds(BodyRequest { body, fidelity }: &BodyRequest, space: SpaceKey) -> f64 {
    match *fidelity {
        Fidelity::Series => spread_modes(space, concentric(body).modes_needed()).seconds(),
        Fidelity::Mesh { level } => {
            let of_reference = ConcentricBody::with_layers_of(body)
                .map_or(0.0, |reference| spread_modes(space, reference.highest_mode()).seconds());
            of_reference + spread_ring_modes(space, ring_modes(body, level)).seconds()
        }
    }
}

/// Of the contact of a joint whose bodies are solved, s: what designs that differ in clearance, sizes and loads share.
pub fn joint_seconds(plan: &JointPlan) -> f64 {
    let spreads: f64 = plan.requests().map(|request| spread_seconds(&request, plan.space)).sum();
    spreads + curve(plan.space).seconds()
}

/// How many ring modes a body has on a mesh level.
fn ring_modes(body: &Body, level: usize) -> usize {
    RingModes::of(&mesh_class(body, level)).count
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each unit has its row, in order, and no row is of anything else.
    #[test]
    fn the_file_has_every_unit() {
        let rows: Vec<Row> = rows(include_str!("unit_costs.csv")).collect();
        assert_eq!(rows.len(), Unit::Laws as usize + 1);
        for (place, (unit, seconds, of_time)) in rows.into_iter().enumerate() {
            assert_eq!((unit as usize, of_time.as_str()), (place, "s"));
            assert!(unit.seconds() == seconds && seconds > 0.0 && seconds < 1.0, "{unit:?}: {seconds}");
        }
    }
}
