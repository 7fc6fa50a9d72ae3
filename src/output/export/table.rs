//! The points of a table: chosen from the joint's own curve so that the simulator's own rule between them stays
//! within an error.

use crate::error::Error;
use crate::output::export::breakpoints::{Choice, PLACES, STRIDE, deviations};
use crate::output::export::interpolation::{Interpolant, Interpolation, cubic_weights};
use crate::output::export::numbers::rounded;
use crate::output::export::samples::{Samples, Solver, openings, reached_force};
use crate::output::export::source::{Source, refuse};
use crate::study::design::JointDesign;

/// Force and stiffness over indentation, for one clearance or several.
#[derive(Clone, Debug)]
pub struct Table {
    /// mm, ascending; below zero of press fits, of a single one 0.
    pub clearances: Vec<f64>,
    /// mm, ascending, from 0 on; of press fits the offset.
    pub indentations: Vec<f64>,
    /// N, for each clearance.
    pub forces: Vec<Vec<f64>>,
    /// dF/d delta, N/mm, for each clearance: zero at 0, where the slope falls like 1/ln; of a press fit not.
    pub stiffnesses: Vec<Vec<f64>>,
}

/// What is true of a table, measured against the curve where the table has no points.
#[derive(Clone, Debug)]
pub struct Quality {
    /// Relative to the force, from the first point above 0 on: the worst of the rules.
    pub of_force: f64,
    /// Relative to the stiffness, of Hermite's rule; `None` without it.
    pub of_stiffness: Option<f64>,
    /// Below the first point, relative to the force there.
    pub of_first: f64,
    /// Relative to the force half way between neighbouring clearances; `None` for one clearance.
    pub between: Option<f64>,
    /// Places where it was measured.
    pub places: usize,
    /// Largest of the curve.
    pub force_error: f64,
    /// At the largest indentation.
    pub linearity_error: Option<f64>,
    pub methods: Vec<&'static str>,
}

/// How a format goes from one clearance to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    Linear,
    /// The cubic through four neighbours, over ln(clearance) where none is zero.
    Cubic,
}

impl Table {
    /// Of each clearance.
    pub fn interpolants(&self, rule: Interpolation) -> Vec<Interpolant<'_>> {
        let of = |i: usize| Interpolant::new(rule, &self.indentations, &self.forces[i], &self.stiffnesses[i]);
        (0..self.clearances.len()).map(of).collect()
    }

    /// The variable of `Between::Cubic`.
    pub fn over_logarithm(&self) -> bool {
        self.clearances[0] > 0.0
    }

    /// Force at a clearance between the table's, given those at its own.
    fn across(&self, between: Between, clearance: f64, force: impl Fn(usize) -> f64) -> f64 {
        let (first, weights) = match between {
            Between::Linear => {
                let above = self.clearances.partition_point(|own| *own <= clearance);
                let left = above.saturating_sub(1).min(self.clearances.len() - 2);
                let [low, high] = [self.clearances[left], self.clearances[left + 1]];
                let share = (clearance - low) / (high - low);
                (left, vec![1.0 - share, share])
            }
            Between::Cubic if self.over_logarithm() => {
                let nodes: Vec<f64> = self.clearances.iter().map(|clearance| clearance.ln()).collect();
                cubic_weights(&nodes, clearance.ln())
            }
            Between::Cubic => cubic_weights(&self.clearances, clearance),
        };
        weights.iter().enumerate().map(|(i, weight)| weight * force(first + i)).sum()
    }
}

/// The first point above zero, over the last.
const FIRST: f64 = 1e-6;

/// Shares of the first point where the table is measured below it.
const BELOW: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

/// What a table is to be good for.
#[derive(Clone, Copy, Debug)]
pub struct Wish<'a> {
    pub rules: &'a [Interpolation],
    pub between: Between,
    /// Between points, mm.
    pub least_step: f64,
    /// Relative to the force.
    pub error: f64,
}

/// The first point above zero has at least so many least steps below it, so that the next ones may be that close.
const LEAST_STEPS: f64 = 12.0;

/// A table of some designs, good for every one of the rules to a relative error.
pub fn tabulate(
    source: &Source,
    Wish { rules, between, least_step, error }: Wish,
    allow_warned: bool,
) -> Result<(Table, Quality), Error> {
    let end = up(source.end - source.ring_compliance * reached_force(source)?);
    let first = FIRST.max(LEAST_STEPS * least_step / end);
    if first > 0.25 {
        let problem = format!(
            "{} mm is too short a range for this format, whose points are at least {least_step} mm apart",
            rounded(end, 6)
        );
        return refuse("range", problem);
    }
    let is_loose = source.members.iter().any(|member| !member.joint.is_press_fit());
    let (places, bends) = spread(end, first, openings(source)?, is_loose);
    let mut solver = Solver::new(source, allow_warned);
    let (mut curves, mut below) = (Vec::new(), Vec::new());
    // Below the first place, in front of the others.
    let asked: Vec<f64> = BELOW.iter().map(|share| share * places[0]).chain(places.iter().copied()).collect();
    for member in &source.members {
        let mut curve = solver.sample(&member.joint, Some(member), &asked)?;
        below.push(curve.force.drain(..BELOW.len()).collect::<Vec<f64>>());
        curve.stiffness.drain(..BELOW.len());
        curves.push(curve);
    }
    let choice = Choice { places: &places, bends: &bends, curves: &curves, rules, least_step };
    let points = choice.points(error)?;
    // From where a press fit is concentric the way is the whole distance: alone it is a law without clearance.
    let least = if source.is_family() { f64::NEG_INFINITY } else { 0.0 };
    let clearances = source.members.iter().map(|member| member.joint.radial_clearance.max(least)).collect();
    let (mut table, mut quality) = measured(clearances, &places, &curves, &points, rules);
    for (own, member) in table.stiffnesses.iter_mut().zip(&source.members) {
        if member.joint.is_press_fit() {
            // Linear from the first on.
            own[0] = own[1];
        }
    }
    for rule in rules {
        for (interpolant, truth) in table.interpolants(*rule).iter().zip(&below) {
            for (place, force) in asked.iter().zip(truth) {
                let off = (interpolant.at(*place).0 - force).abs() / interpolant.at(places[0]).0;
                quality.of_first = quality.of_first.max(off);
            }
        }
    }
    if table.clearances.len() > 1 {
        let mut worst = 0.0_f64;
        for pair in source.members.windows(2) {
            let [low, high] = [pair[0].joint.radial_clearance, pair[1].joint.radial_clearance];
            let middle = if low > 0.0 { (low * high).sqrt() } else { 0.5 * (low + high) };
            let joint = JointDesign { radial_clearance: middle, ..pair[0].joint.clone() };
            // A third of the places, the first of them odd.
            let some: Vec<usize> = (1..PLACES).step_by(9).collect();
            let asked: Vec<f64> = some.iter().map(|i| places[*i]).collect();
            let truth = solver.sample(&joint, None, &asked)?;
            for rule in rules {
                let interpolants = table.interpolants(*rule);
                for (place, force) in asked.iter().zip(&truth.force) {
                    let found = table.across(between, middle, |i| interpolants[i].at(*place).0);
                    worst = worst.max((found / force - 1.0).abs());
                }
            }
        }
        quality.between = Some(worst);
    }
    quality.force_error = solver.worst.force_error;
    quality.linearity_error = solver.worst.linearity_error;
    quality.methods = solver.worst.methods;
    Ok((table, quality))
}

/// Places of press fits up to where the first of them opens: they are linear there.
const BEFORE_OPENING: usize = PLACES / 8;

/// A point lies this share before an opening: at it the slope is that of one side or the other.
const JUST_BEFORE: f64 = 1e-6;

/// With more openings than these, some share a piece: each still has some places.
const MOST_PIECES: usize = 64;

/// Places up to an end, evenly by their logarithms from a share of it on. From where a press fit opens by those of the distances from
/// there on, because its stiffness falls like a root of them; `is_loose` where there are joints with clearance beside them. With the
/// indices of these bends.
fn spread(end: f64, first: f64, mut openings: Vec<f64>, is_loose: bool) -> (Vec<f64>, Vec<usize>) {
    openings.sort_by(f64::total_cmp);
    // Where pieces begin; too close to the next, an opening has no room of its own.
    let mut starts: Vec<f64> = Vec::new();
    for opening in openings {
        if opening > first * end && starts.last().is_none_or(|last| *last < 0.999 * opening) {
            starts.push(opening);
        }
    }
    starts.retain(|start| *start < 0.999 * end);
    let starts: Vec<f64> =
        starts.iter().step_by(starts.len().div_ceil(MOST_PIECES).max(1)).copied().collect();
    let by_logarithm =
        |length: f64, place: usize, last: usize| length * first.powf(1.0 - place as f64 / last as f64);
    let before = match starts.len() {
        0 => PLACES,
        _ if !is_loose => BEFORE_OPENING,
        count => (PLACES / (count + 1) / STRIDE * STRIDE).max(STRIDE),
    };
    let end_of_piece = |next: usize| starts.get(next).map_or(end, |start| start * (1.0 - JUST_BEFORE));
    let reach = end_of_piece(0);
    let mut places: Vec<f64> =
        (0..=before).map(|place| rounded(by_logarithm(reach, place, before), 6)).collect();
    // What follows it may be as near as that.
    places[before] = rounded(reach, 12);
    let mut bends = Vec::new();
    for (i, start) in starts.iter().enumerate() {
        bends.push(places.len() - 1);
        let left = starts.len() - i;
        let count = match left {
            1 => PLACES + 1 - places.len(),
            _ => (PLACES + 1 - places.len()) / left / STRIDE * STRIDE,
        };
        let length = end_of_piece(i + 1) - start;
        places.extend((1..=count).map(|place| rounded(start + by_logarithm(length, place, count), 12)));
    }
    places[PLACES] = end;
    (places, bends)
}

/// With nine digits, not below the value.
fn up(value: f64) -> f64 {
    let near = rounded(value, 9);
    if near >= value { near } else { rounded(value * (1.0 + 1e-8), 9) }
}

fn measured(
    clearances: Vec<f64>,
    places: &[f64],
    curves: &[Samples],
    points: &[usize],
    rules: &[Interpolation],
) -> (Table, Quality) {
    let (mut of_force, mut of_stiffness, mut count) = (0.0_f64, 0.0_f64, 0);
    deviations(places, curves, rules, points, |i, force, slope| {
        if i % 2 == 1 {
            of_force = of_force.max(force);
            of_stiffness = of_stiffness.max(slope);
            count += 1;
        }
    });
    let rows = |values: fn(&Samples) -> &[f64]| -> Vec<Vec<f64>> {
        let row = |curve: &Samples| {
            let own = points.iter().map(|i| rounded(values(curve)[*i], 9));
            std::iter::once(0.0).chain(own).collect()
        };
        curves.iter().map(row).collect()
    };
    let table = Table {
        clearances,
        indentations: std::iter::once(0.0).chain(points.iter().map(|i| places[*i])).collect(),
        forces: rows(|curve| &curve.force),
        stiffnesses: rows(|curve| &curve.stiffness),
    };
    let quality = Quality {
        of_force,
        of_stiffness: rules.contains(&Interpolation::Hermite).then_some(of_stiffness),
        of_first: 0.0,
        between: None,
        places: count,
        force_error: 0.0,
        linearity_error: None,
        methods: Vec::new(),
    };
    (table, quality)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever there is to bend, places ascend from above zero to the end, and bends are among those that may become points.
    #[test]
    fn places_ascend_and_bends_may_become_points() {
        let near = [0.3, 0.3002, 0.301, 0.9995];
        let many: Vec<f64> = (1..=1000).map(|i| 1e-3 * f64::from(i)).collect();
        for openings in [&[][..], &[0.3], &near, &many] {
            for is_loose in [false, true] {
                let (places, bends) = spread(1.0, 1e-6, openings.to_vec(), is_loose);
                assert_eq!((places.len(), places[PLACES]), (PLACES + 1, 1.0));
                assert!(places[0] > 0.0 && places.windows(2).all(|pair| pair[0] < pair[1]), "{openings:?}");
                assert!(bends.iter().all(|bend| bend % STRIDE == 0), "{bends:?}");
                for bend in bends {
                    let place = places[bend];
                    let is_just_before = |opening: &f64| (1e-7..2e-6).contains(&(1.0 - place / opening));
                    assert!(openings.iter().any(is_just_before), "{place}");
                }
            }
        }
        assert_eq!(spread(1.0, 1e-6, near.to_vec(), true).1.len(), 2);
    }
}
