//! Joints as a device is given them, and the states that it finds.
//!
//! A body's compliance in a space is a sum of rows, and bodies of one kind have the rows in common. What the rows are multiplied by comes up
//! with the joint, or follows on the device from the body's place in its fit.

use std::ops::Range;

use crate::engine::question::Question;
use crate::engine::spaces::SpaceKey;
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::compliance::body_fit::BodyFit;
use crate::mechanics::compliance::near_field::{self, NearField, NearFieldClass};
use crate::mechanics::compliance::pressure_space::Tilt;
use crate::mechanics::compliance::row_sums::Rows;
use crate::mechanics::compliance::second_order::Bands;
use crate::mechanics::contact::compliance_rows::{ModeMembers, NARROW};
use crate::mechanics::contact::curve_error::ROUGH;
use crate::mechanics::contact::curve_space::{CurveSpace, Variable};
use crate::mechanics::contact::load::DimensionlessLoad;
use crate::mechanics::contact::outlines::Outlines;
use crate::mechanics::contact::state::ContactState;

/// Counts of trial pressures that a device has a kernel for.
pub const TERMS: [usize; 2] = [6, 10];

/// The most nodes of a curve, products of polynomials and rows of a body that a workgroup has room for, all its joints together, and coordinates of a fit.
pub const MOST_NODES: usize = 32;
pub const MOST_PRODUCTS: usize = 1024;
pub const MOST_ROWS: usize = 576;
pub const MOST_COORDINATES: usize = 4;

/// In place of where the works of a body begin: it has amplitudes that come with its joint, or the device was to condense it and has not.
pub const ELSEWHERE: u32 = u32::MAX;
pub const MISSING: u32 = u32::MAX - 1;

/// Loads of a joint at most: what more of them come to would not fit the least buffer that devices have.
pub const MOST_LOADS: usize = 4096;

/// Numbers of a joint before those of its loads, and of a state, as `shaders/joints.wgsl` has them.
pub const JOINT_NUMBERS: usize = 19;
pub const STATE_NUMBERS: usize = 11;

/// Nodes of a near field at most, and weights of a body that lies between two of them.
pub const NEAR_NODES: usize = near_field::MOST_NODES;
pub const NEAR_WEIGHTS: usize = 2 * NEAR_NODES;

/// Which joints a device solves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SolvedJoints {
    None,
    /// Those of interpolated bodies, which single precision is good enough for.
    Interpolated,
    All,
}

/// What is the same for many joints: the bodies' rows and the space.
#[derive(Clone, Copy)]
pub struct JointTables<'a> {
    /// Pin and plate.
    pub bodies: [BodyTables<'a>; 2],
    pub space: (SpaceKey, &'a CurveSpace),
}

/// Rows of bodies of one kind.
#[derive(Clone, Copy)]
pub enum BodyTables<'a> {
    /// By its number among fits; with what the members add to compliances in the space.
    Fit(usize, &'a BodyFit, &'a Rows),
    Modes(ModeMembers),
}

/// Joints that one kernel solves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JointKind {
    /// Trial pressures.
    pub terms: usize,
    /// How many a workgroup has side by side: they share its invocations and its memory.
    pub together: usize,
}

/// Equal for equal tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TablesKey {
    Space(SpaceKey),
    Fit(SpaceKey, usize),
    Modes(SpaceKey, ModeMembers),
}

/// Joints on their way to a device, all in one.
#[derive(Default)]
pub struct JointBatch<'a> {
    pub tables: Vec<JointTables<'a>>,
    pub joints: Vec<BatchedJoint>,
    pub numbers: JointNumbers,
    /// Between which the bodies lie that the device condenses for these joints.
    pub near_fields: Vec<(NearFieldClass, &'a NearField)>,
    /// Where its rows are to be counted: no state of them comes back then.
    pub asked: Option<AskedOfJoints<'a>>,
}

/// Numbers of joints one behind another, in the pieces in which they are made.
#[derive(Clone, Debug, Default)]
pub struct JointNumbers {
    pieces: Vec<Vec<f32>>,
    count: usize,
}

/// What is asked of the rows of joints, whose numbers have those for it behind them.
pub struct AskedOfJoints<'a> {
    pub question: &'a Question,
    /// Of the question, then of fits.
    pub tables: Vec<f32>,
    /// Of each quantity what its values lie between, as far as is known.
    pub ranges: Vec<Option<[f64; 2]>>,
}

/// Where a joint's tables are in a batch, where its numbers begin, how many loads it has, and how many numbers behind those of the loads.
#[derive(Clone, Copy, Debug)]
pub struct BatchedJoint {
    pub tables: u32,
    pub numbers_at: u32,
    pub load_count: u32,
    pub amplitude_count: u32,
    /// Of pin and plate, where the device condenses it.
    pub condensed: [Option<CondensedBody>; 2],
}

/// A body that a device condenses for a joint: its place among those that go with the joints, group by group, and those of the near
/// fields that it lies between.
#[derive(Clone, Copy, Debug)]
pub struct CondensedBody {
    pub place: u32,
    pub near_fields: [u32; 2],
}

/// A joint to be solved.
pub struct DeviceJoint<'a> {
    /// Pin and plate.
    pub bodies: [DeviceBody<'a>; 2],
    pub outlines: Outlines,
}

pub struct DeviceBody<'a> {
    /// `even` and `odd` of the infinite body.
    pub infinite: [f64; 2],
    /// 1/E, 1/MPa.
    pub share: f64,
    pub amplitudes: Amplitudes<'a>,
}

/// Where what a body's rows are multiplied by comes from.
pub enum Amplitudes<'a> {
    /// A fit, by the coordinates from -1 to 1 over its box; those there are not are zero.
    Fit([f64; MOST_COORDINATES]),
    Modes(ModeMembers, &'a BodyCompliance),
    /// Of a body that the device condenses: its works, to which near fields come by their weights, and of a pin what is of second order.
    OnDevice(ModeMembers, &'a [Bands], [[f64; NEAR_NODES]; 2]),
}

/// The state under a load, and the share of the work that goes into the pin at the nodes around it.
#[derive(Clone, Copy, Debug)]
pub struct FoundState {
    pub state: ContactState,
    pub of_pin: [f64; 2],
}

impl JointNumbers {
    pub fn push(&mut self, piece: Vec<f32>) {
        self.count += piece.len();
        self.pieces.push(piece);
    }

    pub fn count(&self) -> usize {
        self.count
    }

    /// Those from one to before another, in their order.
    pub fn within(&self, range: Range<usize>) -> impl Iterator<Item = &[f32]> {
        let mut behind = 0;
        self.pieces.iter().map(move |piece| {
            let before = behind;
            behind += piece.len();
            let [start, end] = [range.start, range.end].map(|place| place.clamp(before, behind) - before);
            &piece[start..end]
        })
    }
}

impl BodyTables<'_> {
    pub fn key(&self, space: SpaceKey) -> TablesKey {
        match self {
            BodyTables::Fit(number, ..) => TablesKey::Fit(space, *number),
            BodyTables::Modes(members) => TablesKey::Modes(space, *members),
        }
    }

    /// Rows of the body itself, and how often there are such rows.
    pub fn rows(&self) -> [usize; 2] {
        match self {
            BodyTables::Fit(_, fit, rows) => {
                let of_one = fit.member_count() + 2;
                [of_one, rows.sizes().len() / of_one]
            }
            BodyTables::Modes(members) => [members.count() + 2, members.orders()],
        }
    }

    /// For so many joints of its kind in a workgroup.
    fn has_room(&self, together: usize) -> bool {
        let of_fit = match self {
            BodyTables::Fit(_, fit, _) => {
                together * fit.polynomials.count() <= MOST_PRODUCTS
                    && fit.polynomials.ranges.len() <= MOST_COORDINATES
            }
            BodyTables::Modes(_) => true,
        };
        of_fit && together * self.rows().into_iter().product::<usize>() <= MOST_ROWS
    }
}

/// Whether a device has a kernel for joints in a space.
pub fn is_for_devices(space: SpaceKey) -> bool {
    TERMS.contains(&space.terms) && space.nodes <= MOST_NODES && space.variable == Variable::Root
}

impl JointTables<'_> {
    /// Whether a device has a kernel for joints with these tables and outlines, and room.
    pub fn are_for_devices(&self, outlines: &Outlines) -> bool {
        (0.0..=NARROW).contains(&outlines.radial_clearance)
            && is_for_devices(self.space.0)
            && self.have_room(1)
    }

    /// For so many joints in a workgroup.
    fn have_room(&self, together: usize) -> bool {
        together * self.space.1.arcs().len() <= MOST_NODES
            && self.bodies.iter().all(|body| body.has_room(together))
    }

    /// The kernel that solves joints with these tables.
    pub fn kind(&self) -> JointKind {
        JointKind { terms: self.space.0.terms, together: if self.have_room(2) { 2 } else { 1 } }
    }

    /// Equal for joints with the same tables.
    pub fn key(&self) -> [TablesKey; 2] {
        self.bodies.each_ref().map(|body| body.key(self.space.0))
    }
}

impl BatchedJoint {
    /// Numbers that a device finds of it.
    pub fn found(&self) -> usize {
        1 + STATE_NUMBERS * self.load_count as usize
    }
}

impl DeviceJoint<'_> {
    /// Of the infinite bodies: compliances are told over it, so that single precision bears their squares.
    pub fn even(&self) -> f64 {
        self.bodies.iter().map(|body| body.share * body.infinite[0]).sum()
    }

    /// Of either body: the plate's pressure is along its own normal.
    pub fn tilts(&self) -> [Tilt; 2] {
        [self.outlines.tilt(), Tilt::NONE]
    }

    /// As the kernel has them, under some loads; tells how many these are, and how many numbers are behind theirs. `None` where there are none, or
    /// too many.
    pub fn numbers(
        &self,
        loads: impl Iterator<Item = DimensionlessLoad>,
        to: &mut Vec<f32>,
    ) -> Option<[u32; 2]> {
        let even = self.even();
        for DeviceBody { infinite, share, amplitudes } in &self.bodies {
            let place = match amplitudes {
                Amplitudes::Fit(place) => *place,
                Amplitudes::Modes(..) | Amplitudes::OnDevice(..) => [0.0; MOST_COORDINATES],
            };
            to.extend(place.iter().chain(infinite).map(|number| *number as f32));
            to.push((share / even) as f32);
        }
        let tilts = self.tilts();
        let Outlines { radial_clearance, .. } = self.outlines;
        let of_outlines =
            [tilts[0].first, tilts[0].second, radial_clearance, self.outlines.ratio(), self.outlines.bend()];
        to.extend(of_outlines.iter().map(|number| *number as f32));
        let mut load_count = 0;
        for load in loads.take(MOST_LOADS + 1) {
            let [of_indentation, of_force] = load.target(radial_clearance);
            to.extend_from_slice(&[of_indentation as f32, (of_force / even) as f32]);
            load_count += 1;
        }
        let before = to.len();
        for (DeviceBody { infinite, amplitudes, .. }, tilt) in self.bodies.iter().zip(tilts) {
            match amplitudes {
                Amplitudes::Fit(_) => {}
                Amplitudes::Modes(members, body) => members.amplitudes(body, tilt, to),
                Amplitudes::OnDevice(members, second, weights) => {
                    members.amplitudes_before_ring(*infinite, None, second, tilt, to);
                    to.extend(weights.as_flattened().iter().map(|weight| *weight as f32));
                }
            }
        }
        let are_right = (1..=MOST_LOADS).contains(&load_count);
        are_right.then_some([load_count, to.len() - before].map(|count| count as u32))
    }
}

/// The reverse, from what the kernel has found of a joint with this `even`: a bound of what its curve leaves between nodes
/// (`ContactCurve::error` of compliances that are not exact), and the states in the order of the loads. `None` where a load has none.
pub fn states<'a>(
    found: &'a [f32],
    even: f64,
    outlines: &Outlines,
) -> Option<(f64, impl Iterator<Item = FoundState> + use<'a>)> {
    let (of_curve, found) = found.split_first()?;
    let found = found.as_chunks::<STATE_NUMBERS>().0;
    if !found.iter().all(|numbers| numbers[0] == ENDED) {
        return None;
    }
    let ratio = outlines.ratio();
    let state = move |numbers: &[f32; STATE_NUMBERS]| {
        let [_, b, indentation, force, stiffness, energy, peak, truncation, positive, above, below] =
            numbers.map(f64::from);
        let state = ContactState {
            half_angle: 2.0 * (b / ratio).atan(),
            indentation,
            force: force / even,
            tangent_stiffness: stiffness / even,
            energy: energy / even,
            peak_pressure: peak / even,
            peak_angle: 0.0,
            truncation,
            pressure_is_positive: positive > 0.0,
            on_whole_ring: false,
        };
        FoundState { state, of_pin: [above, below] }
    };
    Some((ROUGH * f64::from(*of_curve), found.iter().map(state)))
}

impl FoundState {
    /// The greatest shares of pin and plate in the work, at the nodes around.
    pub fn shares(&self) -> [f64; 2] {
        let [above, below] = self.of_pin;
        [above.max(below), 1.0 - above.min(below)]
    }
}

/// What the kernel says of a search that came to its end.
pub const ENDED: f32 = 2.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::body::Side;
    use crate::mechanics::compliance::ring_modes::RingModes;

    /// Wherever pieces end.
    #[test]
    fn numbers_come_in_their_order_from_one_to_before_another() {
        let mut numbers = JointNumbers::default();
        for piece in [&[0.0, 1.0, 2.0][..], &[], &[3.0], &[4.0, 5.0]] {
            numbers.push(piece.to_vec());
        }
        assert_eq!(numbers.count(), 6);
        for start in 0..=6 {
            for end in start..=6 {
                let found: Vec<f32> = numbers.within(start..end).flatten().copied().collect();
                let expected: Vec<f32> = (start..end).map(|number| number as f32).collect();
                assert_eq!(found, expected);
            }
        }
    }

    /// Two joints share a workgroup where their nodes and rows have room in half of it.
    #[test]
    fn small_joints_are_two_to_a_workgroup() {
        let together = |nodes: usize, modes: usize| {
            let key = SpaceKey { half_ring: false, terms: 6, nodes, variable: Variable::Root };
            let space = CurveSpace::new(key.variable, key.terms, key.nodes, key.limit());
            let ring = RingModes::whole(5, modes);
            let bodies =
                [Side::Pin, Side::Plate].map(|side| BodyTables::Modes(ModeMembers::of_mesh(side, 8, ring)));
            JointTables { bodies, space: (key, &space) }.kind()
        };
        assert_eq!(together(16, 8), JointKind { terms: 6, together: 2 });
        // Too many nodes, and too many rows.
        assert_eq!(together(24, 8).together, 1);
        assert_eq!(together(16, 12).together, 1);
    }
}
