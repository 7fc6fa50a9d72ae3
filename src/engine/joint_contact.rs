//! The contact of designs with one joint, its bodies being solved: their states, how good they are, and what they want.

use std::hash::Hash;
use std::ops::Range;

use foldhash::HashMap;

use crate::engine::accuracy::body_errors::{BodyErrors, JudgedBody, OwnError};
use crate::engine::accuracy::geometry_error::{OutlineError, WIDEST_CLEARANCE};
use crate::engine::accuracy::mesh_change::Trust;
use crate::engine::accuracy::{Estimate, ForceError, Want};
use crate::engine::bodies::BodyLibrary;
use crate::engine::body_request::{BodyRequest, Fidelity, JointBodies};
use crate::engine::hashed::Hashed;
use crate::engine::joint_scale::JointScale;
use crate::engine::known_bodies::SolvedBody;
use crate::engine::outcome::{Answer, BackendKind, Method};
use crate::engine::plan::JointPlan;
use crate::engine::row::Solving;
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::mechanics::compliance::Boundary;
use crate::mechanics::compliance::body_fit::ROUNDED;
use crate::mechanics::contact::curve::{ContactCurve, CurveRoom};
use crate::mechanics::contact::curve_space::{CurveSpace, PartRoom};
use crate::mechanics::contact::load::NoState;
use crate::mechanics::contact::outlines::Outlines;
use crate::mechanics::contact::state::ContactState;
use crate::study::design::{DesignCase, JointDesign, Part};

/// Joints with one of these have a curve in common, their bodies being told by `B`: sizes and loads are left.
pub type JointKey<B> = Hashed<([B; 2], [u64; 3], SpaceKey, Estimate)>;

/// Of a design with its plan and bodies.
pub fn joint_key<B: Hash>(bodies: [B; 2], plan: &JointPlan, case: &DesignCase) -> JointKey<B> {
    let [pin, plate] =
        [&case.joint.pin, &case.joint.plate].map(|part| part.contact_material().youngs_modulus);
    let numbers = [pin, plate, JointScale::of(&case.joint).outlines.radial_clearance].map(f64::to_bits);
    Hashed::new((bodies, numbers, plan.space, plan.estimate))
}

/// Designs of one joint that a thread solves.
const TOGETHER: usize = 64;

/// Which of some designs have a joint in common.
pub struct Alike {
    /// Of the designs, those side by side that have a joint in common, in the order in which these are first met.
    pub places: Vec<u32>,
    /// Of each joint its part of them: no more than `TOGETHER`.
    pub joints: Vec<Range<u32>>,
}

impl Alike {
    /// By the keys of the designs.
    pub fn of<B: Eq + Hash>(keys: Vec<JointKey<B>>) -> Alike {
        let mut numbers: HashMap<JointKey<B>, usize> = HashMap::default();
        let mut counts: Vec<u32> = Vec::with_capacity(keys.len());
        let number_of = |key: JointKey<B>| {
            let number = *numbers.entry(key).or_insert(counts.len());
            if number == counts.len() {
                counts.push(0);
            }
            counts[number] += 1;
            number
        };
        let of_places: Vec<usize> = keys.into_iter().map(number_of).collect();
        let mut joints = Vec::with_capacity(counts.len());
        let mut next = 0;
        // From here on where the next place of each goes.
        for count in &mut counts {
            let end = next + *count;
            joints.extend((next..end).step_by(TOGETHER).map(|start| start..end.min(start + TOGETHER as u32)));
            *count = std::mem::replace(&mut next, end);
        }
        let mut places = vec![0; of_places.len()];
        for (place, number) in (0..).zip(of_places) {
            places[counts[number] as usize] = place;
            counts[number] += 1;
        }
        Alike { places, joints }
    }

    /// The designs of a joint.
    pub fn places(&self, joint: &Range<u32>) -> &[u32] {
        &self.places[joint.start as usize..joint.end as usize]
    }
}

/// A plan with its bodies, which were solved.
#[derive(Clone, Copy)]
pub struct SolvedPlan<'a> {
    pub plan: &'a JointPlan,
    pub bodies: JointBodies,
}

/// The curve of a joint, where it has one. The space of the plan was prepared.
pub fn with_curve<T>(
    library: &BodyLibrary,
    spaces: &Spaces,
    solved: SolvedPlan,
    joint: &JointDesign,
    ask: impl FnOnce(&ContactCurve) -> T,
) -> Option<T> {
    let space = spaces.get(solved.plan.space);
    let outlines = JointScale::of(joint).outlines;
    let mut rooms = Default::default();
    let (bodies, _) = judged_bodies(library, space, solved, joint, &outlines, &mut rooms);
    ContactCurve::new(space, &bodies.each_ref().map(|body| &body.part), outlines).map(|curve| ask(&curve))
}

/// The bodies of a joint, and what has solved them.
fn judged_bodies<'a>(
    library: &'a BodyLibrary,
    space: &CurveSpace,
    SolvedPlan { plan, bodies }: SolvedPlan<'a>,
    joint: &JointDesign,
    outlines: &Outlines,
    rooms: &'a mut [PartRoom; 2],
) -> ([JudgedBody<'a>; 2], BackendKind) {
    let mut backend = BackendKind::Cpu;
    let [of_pin, of_plate] = rooms;
    let parts = [(0, &plan.pin, &joint.pin, of_pin), (1, &plan.plate, &joint.plate, of_plate)];
    let bodies = parts.map(|(place, request, part, room)| {
        let solved = library.body(bodies.own[place]);
        if solved.backend == BackendKind::Gpu {
            backend = BackendKind::Gpu;
        }
        let (compliance, share) = (&solved.compliance, 1.0 / part.contact_material().youngs_modulus);
        let coarser = bodies.coarser[place].map(|coarser| &library.body(coarser).compliance);
        let change = coarser.map(|coarser| [(compliance, share), (coarser, -share)]);
        let own = own_error(request, solved, change.is_none());
        let part = space.part_in(request.body.shape.side, &[(compliance, share)], outlines, room);
        JudgedBody { body: &request.body, own, change, part }
    });
    (bodies, backend)
}

/// What is known of a solved body; of a mesh only where that `is_known`, else what rounding leaves alone.
pub fn own_error<'a>(request: &'a BodyRequest, solved: &SolvedBody, is_known: bool) -> OwnError<'a> {
    let is_bed = matches!(solved.compliance.boundary, Boundary::Nothing);
    match request.fidelity {
        Fidelity::Series if is_bed => OwnError::Bed(&request.body),
        Fidelity::Mesh { level } if is_known => OwnError::of_mesh(&request.body, level, solved.rounding),
        Fidelity::Mesh { .. } if solved.rounding > 0.0 => OwnError::Mesh([solved.rounding; _]),
        _ => OwnError::of_layers(&request.body),
    }
}

/// What the contact of a joint takes, to be taken again by that of another one.
#[derive(Default)]
pub struct ContactRoom {
    /// Of the pin and the plate.
    parts: [PartRoom; 2],
    curve: CurveRoom,
}

/// The answers to designs of one `JointKey`, on one rung, and what each wants of the next. The space of the plan was prepared.
pub fn solve_designs<'a>(
    library: &BodyLibrary,
    spaces: &Spaces,
    solved: SolvedPlan,
    cases: impl Iterator<Item = &'a DesignCase> + Clone,
    accuracy: f64,
    ContactRoom { parts, curve }: &mut ContactRoom,
) -> Vec<(Answer, Want)> {
    let Some(first) = cases.clone().next() else { return Vec::new() };
    let plan = solved.plan;
    let space = spaces.get(plan.space);
    let outlines = JointScale::of(&first.joint).outlines;
    let (members, backend) = judged_bodies(library, space, solved, &first.joint, &outlines, parts);
    let solving = Solving { backend, method: plan.method(), limit_of_pin: space.limit, accuracy };
    let trust = match plan.estimate {
        Estimate::Change(trust) => Some((trust, plan.level)),
        Estimate::Exact | Estimate::Known => None,
    };
    solve_joint(space, &members, outlines, trust, solving, cases, curve)
}

/// Of what rounding leaves of interpolated bodies, where searches of their loads end.
const SEARCH_SHARE: f64 = 0.1;

/// The same of designs whose joint is one of these bodies, with these outlines, in a space; with a trust and a level where their
/// meshes are told by the change since coarser ones.
pub fn solve_joint<'a>(
    space: &CurveSpace,
    bodies: &[JudgedBody; 2],
    outlines: Outlines,
    trust: Option<(Trust, usize)>,
    solving: Solving,
    cases: impl Iterator<Item = &'a DesignCase>,
    room: &mut CurveRoom,
) -> Vec<(Answer, Want)> {
    let parts = bodies.each_ref().map(|body| &body.part);
    let Some(mut curve) = ContactCurve::in_room(space, &parts, outlines, room) else {
        let is_too_wide = outlines.radial_clearance >= WIDEST_CLEARANCE;
        let (reason, want) = if is_too_wide {
            (NoState::ClearanceTooWide, Want::Nothing)
        } else {
            (NoState::BrokenCompliance, Want::FinerMesh)
        };
        return cases.map(|case| (solving.all_failed(case, reason), want)).collect();
    };
    if solving.method == Method::Interpolated {
        curve.tolerance = SEARCH_SHARE * ROUNDED;
    }
    let errors = BodyErrors::new(&curve, bodies, trust);
    let of_curve = curve.errors(solving.method == Method::Series);
    let answer = |case: &DesignCase| {
        let may_peak_aside = case.joint.is_lopsided_fit()
            || [&case.joint.pin, &case.joint.plate].into_iter().any(Part::is_stiff_on_soft);
        let states = curve.states_of_fit(&mut JointScale::of(&case.joint).loads_in_contact(&case.steps));
        let nodes = states.iter().flatten().map(|(_, node)| *node);
        let of_curve = of_curve.up_to(nodes.min().unwrap_or(0));
        let states = states.into_iter().map(|state| {
            let (mut state, node) = state?;
            if may_peak_aside {
                state = curve.peaked(state, node);
            }
            Ok((state, errors.at(state.half_angle, node)))
        });
        judged(case, &outlines, solving, of_curve, states)
    };
    let answers = cases.map(answer).collect();
    *room = curve.into_room();
    answers
}

/// The answer to a design from its states, each with what its bodies leave of its force (`BodyErrors::at`), and from what the curve
/// leaves; and what it wants.
pub fn judged(
    case: &DesignCase,
    outlines: &Outlines,
    solving: Solving,
    of_curve: f64,
    states: impl IntoIterator<Item = Result<(ContactState, [f64; 2]), NoState>>,
) -> (Answer, Want) {
    let of_outlines = OutlineError::of(&case.joint, outlines);
    let states = states.into_iter().map(|state| {
        let (state, of_bodies) = state?;
        Ok((state, ForceError::new(&state, of_curve, of_bodies, of_outlines.at(state.half_angle))))
    });
    solving.respond(case, states)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every place is there once, beside those of its key, and no joint has too many.
    #[test]
    fn places_of_one_joint_come_together() {
        let key = |place: usize| {
            // Of seven keys one has half of the places.
            let number = if place.is_multiple_of(2) { 0 } else { place % 7 };
            let bodies = [number, 0];
            Hashed::new((bodies, [0; 3], SpaceKey::of_press_fits(0.1), Estimate::Exact))
        };
        let count = 5 * TOGETHER;
        let alike = Alike::of((0..count).map(key).collect());
        let Alike { places, joints } = &alike;
        let mut all = places.clone();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..count as u32));
        assert_eq!(joints.iter().map(Range::len).sum::<usize>(), count);
        let mut end = 0;
        for joint in joints {
            let own = alike.places(joint);
            assert!(joint.start == end && !own.is_empty() && own.len() <= TOGETHER, "{joint:?}");
            assert!(own.is_sorted() && own.iter().all(|place| key(*place as usize) == key(own[0] as usize)));
            end = joint.end;
        }
        // Half of the places and a seventh of the others need three joints of `TOGETHER`, six sevenths one each.
        assert_eq!(joints.len(), 3 + 6);
    }
}
