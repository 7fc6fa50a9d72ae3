//! Joints of interpolated bodies as a device is given them, and the states that it finds.

use crate::engine::spaces::SpaceKey;
use crate::mechanics::compliance::body_fit::BodyFit;
use crate::mechanics::compliance::pressure_space::Tilt;
use crate::mechanics::compliance::row_sums::Rows;
use crate::mechanics::contact::curve_error::ROUGH;
use crate::mechanics::contact::curve_space::{CurveSpace, Variable};
use crate::mechanics::contact::load::DimensionlessLoad;
use crate::mechanics::contact::outlines::Outlines;
use crate::mechanics::contact::state::ContactState;

/// Counts of trial pressures that a device has a kernel for.
pub const TERMS: [usize; 2] = [6, 10];

/// The most nodes of a curve, products of polynomials, members of a fit and coordinates of a body that it has room for.
pub const MOST_NODES: usize = 32;
pub const MOST_PRODUCTS: usize = 1024;
pub const MOST_MEMBERS: usize = 128;
pub const MOST_COORDINATES: usize = 4;

/// Loads of a joint at most: what more of them come to would not fit the least buffer that devices have.
pub const MOST_LOADS: usize = 4096;

/// How often a fit's members come among its rows at most: of the body itself, and times powers of a number of the joint.
pub const MOST_ORDERS: usize = 4;

/// Numbers of a joint before those of its loads, and of a state, as `shaders/joints.wgsl` has them.
pub const JOINT_NUMBERS: usize = 19;
pub const STATE_NUMBERS: usize = 11;

/// Joints of two fits in one space, each under as many loads.
pub struct JointGroup<'a> {
    /// Of pin, plate and space: what has the same ones has the same tables.
    pub key: JointTablesKey,
    /// Of pin and plate, with what the members add to compliances in the space.
    pub fits: [(&'a BodyFit, &'a Rows); 2],
    pub space: &'a CurveSpace,
    pub load_count: usize,
    pub joints: Vec<InterpolatedJoint>,
}

/// The number of the fit of the pin, that of the plate, and the space.
pub type JointTablesKey = (usize, usize, SpaceKey);

/// One of them.
pub struct InterpolatedJoint {
    /// Pin and plate.
    pub bodies: [InterpolatedBody; 2],
    pub outlines: Outlines,
    pub loads: Vec<DimensionlessLoad>,
}

/// A body in its fit.
pub struct InterpolatedBody {
    /// Coordinates from -1 to 1 over the fit's box; those there are not are zero.
    pub place: [f64; MOST_COORDINATES],
    /// Of the infinite body.
    pub numbers: [f64; 2],
    /// 1/E, 1/MPa.
    pub share: f64,
}

/// What a device has found of a joint.
#[derive(Clone, Debug)]
pub struct JointStates {
    /// As `ContactCurve::error`.
    pub of_curve: f64,
    /// In the order of the loads.
    pub states: Vec<FoundState>,
}

/// The state under a load, and the share of the work that goes into the pin at the nodes around it.
#[derive(Clone, Copy, Debug)]
pub struct FoundState {
    pub state: ContactState,
    pub of_pin: [f64; 2],
}

/// Whether a device has room for joints of two fits in a space.
pub fn has_room(key: SpaceKey, fits: [(&BodyFit, &Rows); 2]) -> bool {
    let fits = fits.iter().all(|(fit, rows)| {
        let (members, of_one) = (fit.member_count(), fit.member_count() + 2);
        let count = rows.sizes().len();
        fit.polynomials.count() <= MOST_PRODUCTS
            && fit.polynomials.ranges.len() <= MOST_COORDINATES
            && members <= MOST_MEMBERS
            && count.is_multiple_of(of_one)
            && count / of_one <= MOST_ORDERS
    });
    fits && TERMS.contains(&key.terms) && key.nodes <= MOST_NODES && key.variable == Variable::Root
}

impl JointGroup<'_> {
    /// Numbers that a joint has here.
    pub fn numbers_of_joint(&self) -> usize {
        JOINT_NUMBERS + 2 * self.load_count
    }

    /// Numbers that are found of it.
    pub fn found_of_joint(&self) -> usize {
        1 + STATE_NUMBERS * self.load_count
    }
}

impl InterpolatedJoint {
    /// Of the infinite bodies: compliances are told over it, so that single precision bears their squares.
    fn even(&self) -> f64 {
        self.bodies.iter().map(|body| body.share * body.numbers[0]).sum()
    }

    /// As the kernel has them.
    pub fn numbers(&self, to: &mut Vec<f32>) {
        let even = self.even();
        for InterpolatedBody { place, numbers, share } in &self.bodies {
            to.extend(place.iter().chain(numbers).chain([&(share / even)]).map(|number| *number as f32));
        }
        let (Tilt { first, second }, outlines) = (self.outlines.tilt(), &self.outlines);
        let radial_clearance = outlines.radial_clearance;
        let of_outlines = [first, second, radial_clearance, outlines.ratio(), outlines.bend()];
        to.extend(of_outlines.map(|number| number as f32));
        for load in &self.loads {
            let [of_indentation, of_force] = load.target(radial_clearance);
            to.extend([of_indentation, of_force / even].map(|number| number as f32));
        }
    }

    /// The reverse: from what the kernel has found; `None` where a load has no state.
    pub fn states(&self, found: &[f32]) -> Option<JointStates> {
        let (of_curve, found) = found.split_first()?;
        let even = self.even();
        let state = |numbers: &[f32]| {
            let numbers: [f32; STATE_NUMBERS] = numbers.try_into().ok()?;
            let [outcome, b, indentation, force, stiffness, energy, peak, truncation, positive, above, below] =
                numbers.map(f64::from);
            let state = ContactState {
                half_angle: 2.0 * (b / self.outlines.ratio()).atan(),
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
            (outcome == ENDED).then_some(FoundState { state, of_pin: [above, below] })
        };
        let states = found.chunks_exact(STATE_NUMBERS).map(state).collect::<Option<Vec<_>>>()?;
        Some(JointStates { of_curve: ROUGH * f64::from(*of_curve), states })
    }
}

/// What the kernel says of a search that came to its end.
const ENDED: f64 = 2.0;
