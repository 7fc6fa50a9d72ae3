//! What of a study is interpolated: decided from the whole of it, before the first design is solved.
//!
//! A few thousand designs, spread over the study, tell which families of bodies it has, over which ranges, and about how
//! many distinct ones. A pair of families is fitted where that is cheaper than the bodies of their designs.

use foldhash::{HashMap, HashSet};

use crate::engine::accuracy::known_errors::known_level;
use crate::engine::body_request::{BodyRequest, Fidelity};
use crate::engine::distinct::distinct_among;
use crate::engine::interpolation::family::{
    Family, FamilyKey, MOST_COORDINATES, Point, coordinate_count, coordinates,
};
use crate::engine::plan::first_level;
use crate::engine::spaces::SpaceKey;
use crate::engine::unit_costs::{Time, Unit, body_seconds, curve, spread_seconds};
use crate::mechanics::body::Body;
use crate::study::config::{MethodChoice, SolveOptions, Study};
use crate::study::design::{JointDesign, Part};

/// Designs looked at.
pub const LOOKED_AT: u64 = 4096;

/// The least accuracy (relative, of the force) that curves between nodes are good for.
pub const FINEST_ACCURACY: f64 = 1e-3;

/// A fit must save this many times what it costs.
const GAIN: f64 = 2.0;

/// What is fitted for a study, and for which designs.
#[derive(Clone, Debug)]
pub struct InterpolationPlan {
    pub accuracy: f64,
    /// With the time that each fit may take, s.
    pub families: Vec<(Family, f64)>,
    /// Families of pin and plate whose joints are interpolated.
    pub pairs: HashSet<(FamilyKey, FamilyKey)>,
}

/// A body of a joint as its family knows it.
pub struct Member {
    pub key: FamilyKey,
    /// In the plane state that stands for either.
    pub body: Body,
    /// What that is to be multiplied by, 1/MPa.
    pub share: f64,
}

/// The pin and the plate of a joint; none of press fits, which have exact modes.
pub fn pair(joint: &JointDesign) -> Option<[Member; 2]> {
    if joint.is_press_fit() {
        return None;
    }
    let half_ring = joint.body(&joint.pin).shape.end_angle < std::f64::consts::PI;
    let member = |part: &Part| {
        let (body, yields) = joint.body(part).of_either_state();
        let share = yields / part.contact_material().youngs_modulus;
        Some(Member { key: FamilyKey::of(&body, half_ring)?, body, share })
    };
    Some([member(&joint.pin)?, member(&joint.plate)?])
}

/// Bodies of one family among those looked at.
struct Members {
    example: Body,
    low: Point,
    high: Point,
    distinct: HashSet<Body>,
    seen: u64,
}

impl Members {
    fn new(example: Body) -> Members {
        let point = coordinates(&example);
        Members { example, low: point, high: point, distinct: HashSet::default(), seen: 0 }
    }

    fn meet(&mut self, body: &Body) {
        let point = coordinates(body);
        for i in 0..MOST_COORDINATES {
            self.low[i] = self.low[i].min(point[i]);
            self.high[i] = self.high[i].max(point[i]);
        }
        self.distinct.insert(body.clone());
        self.seen += 1;
    }

    /// About how many distinct bodies there are among `all` designs like those seen.
    fn distinct_of(&self, all: f64) -> f64 {
        distinct_among(all, self.seen as f64, self.distinct.len() as f64)
    }
}

impl InterpolationPlan {
    /// For a study, which may do without.
    pub fn of_study(study: &Study) -> Option<InterpolationPlan> {
        if !study.interpolation || !may_interpolate(&study.solve) {
            return None;
        }
        let count = study.design_count();
        // A list that cannot be read is complained of where its designs are drawn.
        let joints = study.cases_at(picks(count, LOOKED_AT)).ok()?.map(|case| Some(case.ok()?.joint));
        InterpolationPlan::new(&study.solve, count, &joints.collect::<Option<Vec<JointDesign>>>()?)
    }

    /// For `count` designs of which `joints` stand for all.
    pub fn new(solve: &SolveOptions, count: u64, joints: &[JointDesign]) -> Option<InterpolationPlan> {
        if !may_interpolate(solve) || joints.is_empty() {
            return None;
        }
        let mut members: HashMap<FamilyKey, Members> = HashMap::default();
        let mut pairs: Vec<((FamilyKey, FamilyKey), [Members; 2])> = Vec::new();
        for joint in joints {
            let Some([pin, plate]) = pair(joint) else { continue };
            let both = (pin.key, plate.key);
            let place = match pairs.iter().position(|(known, _)| *known == both) {
                Some(place) => place,
                None => {
                    pairs.push((both, [&pin, &plate].map(|member| Members::new(member.body.clone()))));
                    pairs.len() - 1
                }
            };
            for (Member { key, body, .. }, of_pair) in [pin, plate].iter().zip(&mut pairs[place].1) {
                of_pair.meet(body);
                members.entry(*key).or_insert_with(|| Members::new(body.clone())).meet(body);
            }
        }
        // What is not looked at may lie a little outside of what is.
        let margin = if joints.len() as u64 == count { 0.0 } else { 2.0 / joints.len() as f64 };
        let family = |key: FamilyKey, members: &Members| {
            let coordinates = coordinate_count(members.example.shape);
            let ranges = (members.low.iter().zip(&members.high).take(coordinates))
                .map(|(low, high)| (low - margin * (high - low), high + margin * (high - low)))
                .collect();
            let exact = members.example.shape.concentric && solve.method != MethodChoice::Fe;
            Family { key, example: members.example.clone(), ranges, exact }
        };
        let families: HashMap<FamilyKey, Family> =
            members.iter().map(|(key, members)| (*key, family(*key, members))).collect();
        let level = first_level(solve.accuracy);
        let mut plan =
            InterpolationPlan { accuracy: solve.accuracy, families: Vec::new(), pairs: HashSet::default() };
        for (both, of_pair) in &pairs {
            let designs = count as f64 * of_pair[0].seen as f64 / joints.len() as f64;
            let [pin, plate] = of_pair.each_ref().map(|members| &members.example);
            let space = SpaceKey::coarsest(pin, plate, solve.accuracy, 0.0);
            let mut saved = designs
                * (curve(space).seconds() + Unit::Design.seconds() - Unit::InterpolatedDesign.seconds());
            let mut cost = 0.0;
            for (key, members) in [both.0, both.1].iter().zip(of_pair) {
                let Some(family) = families.get(key) else { continue };
                let request = |fidelity| BodyRequest { body: members.example.clone(), fidelity };
                let requests = if family.exact {
                    vec![request(Fidelity::Series)]
                } else if let Some(level) = known_level(&members.example, solve.accuracy) {
                    vec![request(Fidelity::Mesh { level })]
                } else {
                    [level, level - 1].map(|level| request(Fidelity::Mesh { level })).to_vec()
                };
                let distinct = members.distinct_of(designs);
                for request in &requests {
                    saved += distinct * body_seconds(request) + designs * spread_seconds(request, space);
                }
                cost += family.least_time(solve.accuracy).seconds();
            }
            if saved < GAIN * cost {
                continue;
            }
            plan.pairs.insert(*both);
            for key in [both.0, both.1] {
                let Some(family) = families.get(&key) else { continue };
                match plan.families.iter_mut().find(|(known, _)| known.key == key) {
                    Some((_, budget)) => *budget += 0.5 * saved,
                    None => plan.families.push((family.clone(), 0.5 * saved)),
                }
            }
        }
        (!plan.pairs.is_empty()).then_some(plan)
    }
}

impl InterpolationPlan {
    /// Whether a joint is in the boxes of a pair of families.
    pub fn covers(&self, joint: &JointDesign) -> bool {
        let Some([pin, plate]) = pair(joint) else { return false };
        let is_inside = |Member { key, body, .. }: &Member| {
            let family = self.families.iter().find(|(family, _)| family.key == *key);
            family.is_some_and(|(family, _)| {
                let point = coordinates(body);
                let mut ranges = family.ranges.iter().zip(&point);
                ranges.all(|((low, high), value)| low <= value && value <= high)
            })
        };
        self.pairs.contains(&(pin.key, plate.key)) && is_inside(&pin) && is_inside(&plate)
    }

    /// Estimated time of the fits.
    pub fn time(&self) -> Time {
        self.families.iter().map(|(family, _)| family.least_time(self.accuracy)).sum()
    }
}

/// Whether the method and the accuracy leave room for it: who asks for `series` wants it exact.
fn may_interpolate(solve: &SolveOptions) -> bool {
    matches!(solve.method, MethodChoice::Auto | MethodChoice::Fe) && solve.accuracy >= FINEST_ACCURACY
}

/// The numbers of designs that stand for all, `most` of them, ascending: one in each of equal shares of the study, at no fixed distance, so
/// that they do not keep step with a grid.
pub fn picks(count: u64, most: u64) -> Vec<u64> {
    if count <= most {
        return (0..count).collect();
    }
    let share = count as f64 / most as f64;
    let golden = 0.618_033_988_749_894_9;
    let pick = |i: u64| (share * (i as f64 + (golden * i as f64).fract())) as u64;
    let mut picks: Vec<u64> = (0..most).map(|i| pick(i).min(count - 1)).collect();
    // Shares of hardly more than one design may have the same one.
    picks.dedup();
    picks
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In the study, each once, ascending, and everywhere.
    #[test]
    fn picks_are_spread_over_the_study() {
        for count in [1, 4096, 4097, 6000, 100_000, 1_000_000_000] {
            let picks = picks(count, LOOKED_AT);
            assert!(picks.windows(2).all(|pair| pair[0] < pair[1]), "{count}");
            assert!(picks[0] <= count / 1000 && picks[picks.len() - 1] < count, "{count}");
            // Of shares of hardly more than one design a quarter have the pick of their neighbour.
            assert!(picks.len() as u64 > 3 * count.min(LOOKED_AT) / 4, "{count}: {}", picks.len());
            let most = 2 * count.div_ceil(LOOKED_AT) + 1;
            assert!(count - picks[picks.len() - 1] <= most, "{count}");
            assert!(picks.windows(2).all(|pair| pair[1] - pair[0] <= most), "{count}");
        }
    }

    /// Not those of every other value of a grid's last axis.
    #[test]
    fn picks_do_not_keep_step_with_a_grid() {
        for axis in [2_u64, 10, 16, 100] {
            let mut counts = vec![0; axis as usize];
            picks(4096 * axis, LOOKED_AT).iter().for_each(|pick| counts[(pick % axis) as usize] += 1);
            let fair = 4096 / axis as i32;
            assert!(counts.iter().all(|count| (count - fair).abs() <= fair / 4 + 2), "{axis}: {counts:?}");
        }
    }
}
