//! From a load to the contact half angle: one-dimensional roots on the joint's curve.

use super::arc_state::ArcState;
use super::pressure::JointCompliance;
use crate::mechanics::real::LANES;

/// What a joint is loaded by, dimensionless: lengths over the hole's radius, forces over thickness, hole radius and
/// the unit of the moduli.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DimensionlessLoad {
    Indentation(f64),
    Force(f64),
}

/// Why a load has no state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoState {
    /// The contact would reach beyond the largest half angle the scene allows.
    ContactTooWide,
    /// The compliance is not positive definite, or not finite.
    BrokenCompliance,
}

/// The smallest contact half angle looked at, rad.
const SMALLEST: f64 = 1e-18;

/// Where a search ends: the excess of a load.
const TOLERANCE: f64 = 1e-11;

/// Evaluations of one search at most; bisection alone would need about 60 in ln(eps).
const MOST_EVALUATIONS: usize = 200;

/// A joint's curve, sampled at the nodes of its pressure space.
pub struct JointCurve<'a> {
    joint: JointCompliance<'a>,
    /// States at the smallest half angle and at the nodes, ascending, up to the first beyond a neat fit, and no
    /// further than the contact grows with the load.
    samples: Vec<ArcState>,
}

impl<'a> JointCurve<'a> {
    pub fn new(joint: JointCompliance<'a>) -> Result<JointCurve<'a>, NoState> {
        let nodes: Option<Vec<ArcState>> = joint.at_nodes().into_iter().rev().collect();
        let mut samples: Vec<ArcState> = joint.at(&[SMALLEST; LANES]).into_iter().take(1).flatten().collect();
        samples.extend(nodes.ok_or(NoState::BrokenCompliance)?);
        if let Some(neat) = samples.iter().position(|state| state.indentation >= 1.0) {
            samples.truncate(neat + 1);
        }
        // The pressure is the sum of what punches of all smaller arcs add as the contact grows, each of them positive:
        // where it grows with the load the pressure is positive and the gap beyond it open, and only there.
        let shrinks = |pair: &[ArcState]| pair[1].indentation <= pair[0].indentation;
        if let Some(turn) = samples.windows(2).position(shrinks) {
            samples.truncate(turn + 1);
        }
        Ok(JointCurve { joint, samples })
    }

    pub fn joint(&self) -> &JointCompliance<'a> {
        &self.joint
    }

    /// The states under loads (> 0), for a radial clearance over the hole's radius, >= 0. `LANES` searches go abreast;
    /// where one ends the next load takes its lane.
    pub fn states(&self, clearance: f64, loads: &[DimensionlessLoad]) -> Vec<Result<ArcState, NoState>> {
        let targets: Vec<Target> = loads.iter().map(|load| Target::new(clearance, *load)).collect();
        let mut searches: Vec<Search> = targets.iter().map(|target| self.begin(*target)).collect();
        loop {
            let open = searches.iter().enumerate().filter(|(_, search)| search.found.is_none());
            let lanes: Vec<usize> = open.map(|(index, _)| index).take(LANES).collect();
            if lanes.is_empty() {
                break;
            }
            let mut half_angles = [SMALLEST; LANES];
            for (half_angle, &index) in half_angles.iter_mut().zip(&lanes) {
                *half_angle = searches[index].next.exp();
            }
            for (state, index) in self.joint.at(&half_angles).into_iter().zip(lanes) {
                match state {
                    Some(state) => {
                        let excess = targets[index].excess_of(&state);
                        searches[index].feed(state, excess);
                    }
                    None => searches[index].found = Some(Err(NoState::BrokenCompliance)),
                }
            }
        }
        searches.into_iter().map(|search| search.found.unwrap_or(Err(NoState::BrokenCompliance))).collect()
    }

    /// The bracket of a load among the samples, and a first guess between them.
    fn begin(&self, target: Target) -> Search {
        let Some(above) = self.samples.iter().position(|state| target.excess_of(state) >= 0.0) else {
            return Search::ended(NoState::ContactTooWide);
        };
        let Some(below) = above.checked_sub(1) else { return Search::ended(NoState::BrokenCompliance) };
        let point = |state: &ArcState| (state.arc.half_angle.ln(), target.excess_of(state));
        // Inverse interpolation through the neighbours as well, where it stays inside the bracket.
        let first = below.saturating_sub(1);
        let last = (above + 1).min(self.samples.len() - 1);
        let points: Vec<(f64, f64)> = self.samples[first..=last].iter().map(point).collect();
        let (a, b) = (points[below - first], points[above - first]);
        let guess = inverse_interpolation(&points);
        let next = if guess > a.0 && guess < b.0 { guess } else { 0.5 * (a.0 + b.0) };
        Search { a, b, next, evaluations: 0, found: None }
    }
}

/// A load as what is searched for.
#[derive(Clone, Copy)]
pub(super) enum Target {
    /// delta/e.
    Indentation(f64),
    /// F over the clearance.
    Force(f64),
}

impl Target {
    pub(super) fn new(clearance: f64, load: DimensionlessLoad) -> Target {
        match load {
            DimensionlessLoad::Indentation(delta) => Target::Indentation(delta / (clearance + delta)),
            // A neat fit has one half angle, whatever the load.
            DimensionlessLoad::Force(_) if clearance == 0.0 => Target::Indentation(1.0),
            DimensionlessLoad::Force(force) => Target::Force(force / clearance),
        }
    }

    /// `excess` >= 0, without a logarithm.
    #[inline(always)]
    pub(super) fn is_reached(self, indentation: f64, force: f64) -> bool {
        match self {
            Target::Indentation(target) => indentation >= target,
            Target::Force(target) => force >= target * (1.0 - indentation),
        }
    }

    /// How much a state's load, delta/e and F/e, exceeds the one asked: the logarithm of their ratio, a power law of eps for
    /// small angles. A force grows without bound towards a neat fit, where dR/e ends; so there it is the difference of
    /// dR/e and what it should be, which goes on beyond. The root is searched of this, negative below and positive above.
    #[inline(always)]
    pub(super) fn excess(self, indentation: f64, force: f64) -> f64 {
        match self {
            Target::Indentation(target) => (indentation / target).ln(),
            Target::Force(target) => {
                let (wanted, clearance) = (force / target, 1.0 - indentation);
                if clearance > 0.5 { (wanted / clearance).ln() } else { wanted - clearance }
            }
        }
    }

    fn excess_of(self, state: &ArcState) -> f64 {
        self.excess(state.indentation, state.force)
    }
}

/// The position at which the polynomial through (position, value), taken as position of value, has the value zero.
#[inline(always)]
pub(super) fn inverse_interpolation(points: &[(f64, f64)]) -> f64 {
    let mut sum = 0.0;
    for (i, (position, value)) in points.iter().enumerate() {
        let mut product = *position;
        for (j, (_, other)) in points.iter().enumerate() {
            if j != i {
                product *= other / (other - value);
            }
        }
        sum += product;
    }
    sum
}

/// One search in ln(eps): a bracket with the excess at its ends, the next point, and the state once found.
struct Search {
    a: (f64, f64),
    b: (f64, f64),
    next: f64,
    evaluations: usize,
    found: Option<Result<ArcState, NoState>>,
}

impl Search {
    fn ended(reason: NoState) -> Search {
        Search { a: (0.0, 0.0), b: (0.0, 0.0), next: 0.0, evaluations: 0, found: Some(Err(reason)) }
    }

    /// Takes the excess at `next`: inverse quadratic interpolation through it and the bracket, bisection where that
    /// leaves the bracket.
    fn feed(&mut self, state: ArcState, excess: f64) {
        let latest = (self.next, excess);
        let narrow = (self.b.0 - self.a.0).abs() < 1e-14;
        if excess.abs() < TOLERANCE || (narrow && excess.is_finite()) {
            self.found = Some(Ok(state));
            return;
        }
        self.evaluations += 1;
        if self.evaluations == MOST_EVALUATIONS {
            self.found = Some(Err(NoState::BrokenCompliance));
            return;
        }
        let dropped = if excess < 0.0 {
            std::mem::replace(&mut self.a, latest)
        } else {
            std::mem::replace(&mut self.b, latest)
        };
        let (a, b) = (self.a, self.b);
        let middle = 0.5 * (a.0 + b.0);
        let guess = inverse_interpolation(&[a, b, dropped]);
        // A step into the bracket that the last evaluation has shrunk.
        self.next = if guess > a.0 && guess < b.0 { guess } else { middle };
    }
}
