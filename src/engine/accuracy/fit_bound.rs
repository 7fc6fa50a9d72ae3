//! How good a fit across bodies is, told by bodies that were held out.

use crate::engine::accuracy::known_errors::{self, NO_MESH, column};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::compliance::body_fit::ROUNDED;
use crate::mechanics::compliance::pressure_space::Tilt;
use crate::mechanics::contact::curve_space::CurveSpace;
use crate::mechanics::contact::edge::EdgeStates;
use crate::mechanics::contact::outlines::Outlines;

/// A fit is chosen by what this share of all bodies held out does not exceed.
const BOUNDED: f64 = 0.97;

/// The bound of a body is what this share of those held out does not exceed that err alike, inside of the box or near an end of it, and no
/// less than the error of any of these. With `SAFETY`, and because each body counts by its share in a joint, more of the joints are below
/// (`tests/engine/interpolation.rs`).
const BOUNDED_ALIKE: f64 = 0.9;

/// The fit's own error is raised by this: bodies held out are not the worst.
const SAFETY: f64 = 1.5;

/// Walls below this depth, |ln r|, count by themselves, and by the worst of them: what a fit leaves is greatest at the thin end of a
/// box.
pub const THIN_END: f64 = 0.2;

/// Arcs beyond which contact with free edges hardly goes, rad: what a fit does there decides nothing.
const WIDEST: f64 = 1.8;

/// So near to an end of a coordinate's range, over its width, polynomials are at their worst: bodies held out near ends lie nearer.
pub const NEAR_END: f64 = 0.05;

/// Fewer bodies than this say nothing of the worst of them.
const LEAST_ALIKE: usize = 20;

/// Kinds of bodies that have bounds of their own: those inside, others, and thin walls.
pub const KINDS: usize = 3;

/// Bound of the relative error of the force that a fit leaves.
pub struct FitBound {
    /// Contact half angles, descending, rad.
    angles: Vec<f64>,
    /// The greater of the bounds around, squared: wider than the first angle, between it and the next one, and so on. With what the
    /// meshes leave, where these are not of a `known_level`.
    around: Vec<[f64; KINDS]>,
    /// At each angle, of all bodies.
    of_most: Vec<f64>,
    /// Of the meshes the fit was made on, what is known of each body.
    known_level: Option<usize>,
}

impl FitBound {
    /// From the relative change that the fit makes of the work of each of the bodies held out, `[body][arc]`, and the error of its
    /// mesh there, where it is not of a `known_level`; of each body whether it is inside of the fit's box, not near an end.
    pub fn new(
        space: &CurveSpace,
        bodies: &[(Body, bool)],
        of_fit: &[Vec<f64>],
        of_mesh: &[Vec<f64>],
        known_level: Option<usize>,
    ) -> FitBound {
        let with = |safety: f64| -> Vec<Vec<f64>> {
            let own = |of_mesh: &f64| if known_level.is_some() { 0.0 } else { *of_mesh };
            let at_arcs = |(of_fit, of_mesh): (&Vec<f64>, &Vec<f64>)| {
                of_fit.iter().zip(of_mesh).map(|(fit, mesh)| ROUNDED + safety * fit + own(mesh)).collect()
            };
            of_fit.iter().zip(of_mesh).map(at_arcs).collect()
        };
        let (seen, errors) = (with(1.0), with(SAFETY));
        let of_most = quantile(&errors.iter().collect::<Vec<_>>(), BOUNDED);
        let of_alike = |are_inside: bool| {
            let is_alike = |body: &Body, is_inside: bool| is_inside == are_inside && !is_thin(body);
            let alike = of_some(bodies, &errors, is_alike);
            let mut bound =
                if alike.len() < LEAST_ALIKE { of_most.clone() } else { quantile(&alike, BOUNDED_ALIKE) };
            raise(&mut bound, of_some(bodies, &seen, is_alike));
            bound
        };
        let mut of_thin = of_most.clone();
        raise(&mut of_thin, of_some(bodies, &errors, |body, _| is_thin(body)));
        let kinds = [of_alike(true), of_alike(false), of_thin];
        let around = (0..=of_most.len()).map(|below| {
            let arcs = below.saturating_sub(1)..(below + 1).min(of_most.len());
            kinds.each_ref().map(|of_kind| {
                of_kind[arcs.clone()].iter().fold(0.0, |worst: f64, own| worst.max(*own)).powi(2)
            })
        });
        let angles = space.arcs().iter().map(|arc| arc.half_angle).collect();
        FitBound { angles, around: around.collect(), of_most, known_level }
    }

    /// Of a body, inside of the box or near an end of it.
    pub fn of(&self, body: &Body, is_inside: bool) -> BodyBound<'_> {
        let kind = match is_inside {
            _ if is_thin(body) => 2,
            false => 1,
            true => 0,
        };
        let of_mesh = self.known_level.map_or(Some(NO_MESH), |level| known_errors::place(body, level));
        BodyBound { of_fit: self, kind, of_mesh }
    }

    /// Of the meshes the fit was made on, where it is known what they leave.
    pub fn known_level(&self) -> Option<usize> {
        self.known_level
    }

    /// As a device has it: how many angles there are, the angles, then of each width the bounds of all kinds.
    pub fn table(&self) -> impl Iterator<Item = f64> {
        let count = self.angles.len() as f64;
        [count].into_iter().chain(self.angles.iter().copied()).chain(self.around.iter().flatten().copied())
    }

    /// The table where bodies are in no fit, in whatever numbers.
    pub fn of_none<T: Default>() -> [T; 1 + KINDS] {
        std::array::from_fn(|_| T::default())
    }

    /// At the arcs that contact comes to, of all bodies, without what is known of the meshes.
    pub fn near(&self) -> impl Iterator<Item = f64> {
        let near = self.angles.iter().zip(&self.of_most).filter(|(half_angle, _)| **half_angle < WIDEST);
        near.map(|(_, of_most)| *of_most)
    }
}

/// The same of one body.
pub struct BodyBound<'a> {
    of_fit: &'a FitBound,
    kind: usize,
    /// Of the meshes the fit was made on, among `known_errors::all`; `None` of those of which nothing is known.
    of_mesh: Option<usize>,
}

impl BodyBound<'_> {
    /// As a device has it, beside the table of its fit: which of the kinds it is, and where among `known_errors::all` what is known of the
    /// meshes stands.
    pub fn places(&self) -> Option<(usize, usize)> {
        Some((self.kind, self.of_mesh?))
    }

    /// At a contact half angle, rad: of the fit the greater of the bounds around it. What meshes leave of the samples and what the
    /// fit leaves between them have nothing to do with each other.
    pub fn at(&self, half_angle: f64) -> f64 {
        let FitBound { angles, around, .. } = self.of_fit;
        // Few as they are, to count is quicker than to search.
        let below = angles.iter().filter(|angle| **angle > half_angle).count();
        let known = |place: usize| known_errors::all()[place][column(half_angle)];
        let of_mesh = self.of_mesh.map_or(f64::INFINITY, known);
        (around[below][self.kind] + of_mesh * of_mesh).sqrt()
    }
}

fn is_thin(body: &Body) -> bool {
    body.depth_range().0 < THIN_END
}

/// Those of some bodies, each of which lies inside of the box or near an end of it.
fn of_some<'a>(
    bodies: &[(Body, bool)],
    errors: &'a [Vec<f64>],
    is_asked: impl Fn(&Body, bool) -> bool,
) -> Vec<&'a Vec<f64>> {
    let asked = bodies.iter().zip(errors).filter(|((body, is_inside), _)| is_asked(body, *is_inside));
    asked.map(|(_, errors)| errors).collect()
}

/// To no less than these errors at each arc.
fn raise(bound: &mut [f64], errors: Vec<&Vec<f64>>) {
    for of_body in errors {
        bound.iter_mut().zip(of_body).for_each(|(bound, error)| *bound = bound.max(*error));
    }
}

/// What few of the bodies exceed at the worst of the arcs that contact comes to; `[body][arc]`.
pub fn worst_near(space: &CurveSpace, errors: &[Vec<f64>]) -> f64 {
    let near = space
        .arcs()
        .iter()
        .zip(quantile(&errors.iter().collect::<Vec<_>>(), BOUNDED))
        .filter(|(arc, _)| arc.half_angle < WIDEST);
    near.fold(0.0, |worst, (_, bound)| worst.max(bound))
}

/// At each arc what a share of the bodies does not exceed.
fn quantile(errors: &[&Vec<f64>], share: f64) -> Vec<f64> {
    let count = errors.first().map_or(0, |of_body| of_body.len());
    let of_arc = |arc: usize| {
        let mut of_arc: Vec<f64> = errors.iter().map(|of_body| of_body[arc]).collect();
        of_arc.sort_by(f64::total_cmp);
        let place = (share * of_arc.len() as f64) as usize;
        of_arc.get(place.min(of_arc.len().saturating_sub(1))).copied().unwrap_or(f64::INFINITY)
    };
    (0..count).map(of_arc).collect()
}

/// Relative changes of the work of a body alone at each node; infinite where they have no value.
pub fn changes(space: &CurveSpace, expected: &BodyCompliance, found: &BodyCompliance) -> Vec<f64> {
    let alone = space.pressures.joint(&[(expected, 1.0)], Tilt::NONE);
    let change = space.pressures.joint(&[(found, 1.0), (expected, -1.0)], Tilt::NONE);
    let changes =
        EdgeStates::new(&space.pressures, &[&alone], &Outlines::ALIKE).work_shares(&space.pressures, &change);
    changes.into_iter().map(|change| if change.is_finite() { change.abs() } else { f64::INFINITY }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::contact::curve_space::Variable;
    use crate::mechanics::material::Idealization;

    /// One of many bodies inside of a box is far worse than the others: it is not above the bound, which has no safety beyond its error.
    #[test]
    fn no_body_held_out_is_above_its_bound() {
        let space = CurveSpace::new(Variable::Root, 6, 16, 2.4);
        let ring = |ratio: f64| Body::concentric(ratio, 0.3, Idealization::PlaneStress);
        let (usual, worst) = (1e-3, 7e-3);
        let bodies: Vec<(Body, bool)> = (0..100).map(|i| (ring(2.0 + 0.01 * f64::from(i)), i < 50)).collect();
        let of_fit: Vec<Vec<f64>> =
            (0..100).map(|i| vec![if i == 7 { worst } else { usual }; space.arcs().len()]).collect();
        let of_mesh = vec![vec![0.0; space.arcs().len()]; bodies.len()];
        let bound = FitBound::new(&space, &bodies, &of_fit, &of_mesh, None);
        for half_angle in [0.1, 0.8, 1.7] {
            let [inside, near_end] =
                [true, false].map(|is_inside| bound.of(&ring(2.5), is_inside).at(half_angle));
            assert!(inside > worst && inside < 1.01 * worst, "{inside}");
            assert!(near_end >= SAFETY * usual && near_end < 1.02 * SAFETY * usual, "{near_end}");
        }
    }
}
