//! The pressure spaces of joints: how many trial pressures, at how many nodes of a curve. Each is made once and kept.

use std::f64::consts::PI;

use foldhash::{HashMap, HashSet};
use rayon::prelude::*;

use crate::mechanics::body::{Body, THINNEST_RING};
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::compliance::arc::TERM_CHOICES;
use crate::mechanics::compliance::arc_lanes::ArcLanes;
use crate::mechanics::compliance::ring_modes::{LARGEST_HELD, RingModes};
use crate::mechanics::contact::curve_space::{CurveSpace, MOST_NODES, Variable};

/// Which pressure space a joint is solved in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SpaceKey {
    /// Whether the pin's ring ends at pi/2.
    pub half_ring: bool,
    /// Trial pressures.
    pub terms: usize,
    /// Nodes of a curve, and what it is a polynomial of.
    pub nodes: usize,
    pub variable: Variable,
}

/// Counts of nodes.
pub const NODE_CHOICES: [usize; 6] = [16, 24, 32, 48, 64, MOST_NODES];

/// With fewer the force beside thin layers is good to 1e-5, but its slope off by 0.2 %: exports want both.
const TERMS_OF_THIN_LAYERS: usize = 10;

/// Beside beds.
const NODES_OF_BEDS: usize = 64;

/// Accuracies of the force, relative: down to the first the fewest trial pressures and nodes are enough, below the second it takes many.
const COARSE: f64 = 1e-2;
const FINE: f64 = 1e-4;

/// Beyond any free contact of a whole ring, rad.
const WIDEST: f64 = 2.4;

impl SpaceKey {
    /// The largest contact half angle, rad: just short of a half ring's end, where its face is held.
    pub fn limit(self) -> f64 {
        match self {
            SpaceKey { variable: Variable::Gap, .. } => PI,
            SpaceKey { half_ring: true, .. } => LARGEST_HELD,
            _ => WIDEST,
        }
    }

    /// The coarsest of press fits for an accuracy of the force (`tests/mechanics/press_fits.rs`).
    pub fn of_press_fits(accuracy: f64) -> SpaceKey {
        let (terms, nodes) = if accuracy >= FINE { (10, 24) } else { (16, 48) };
        SpaceKey { half_ring: false, terms, nodes, variable: Variable::Gap }
    }

    /// The coarsest for an accuracy of the force and contacts up to a half angle, rad, beside a thinnest wall (|ln r|).
    ///
    /// The layer between contact and far boundary must be resolved, too. What few trial pressures leave of contacts up to a
    /// half angle is measured in `tests/mechanics/series.rs`, what few nodes leave in `tests/mechanics/curves.rs`.
    pub fn coarsest(pin: &Body, plate: &Body, accuracy: f64, half_angle: f64) -> SpaceKey {
        let depths = [pin, plate].map(|body| {
            let nearest = body.nearest_depth();
            // Layers give way at their far side: no more is needed for thin ones than for walls that are just not thin.
            let thinnest = match body.lining.is_empty() {
                true => nearest,
                false => body.depth_range().0.min(nearest.max(1.01 * THIN)),
            };
            [nearest, thinnest]
        });
        let [nearest, thinnest] = [0, 1].map(|of| depths[0][of].min(depths[1][of]));
        let mut space = SpaceKey::beside(thinnest, pin.shape.end_angle < PI, accuracy, half_angle);
        if nearest < THINNEST_RING {
            space = SpaceKey { nodes: NODES_OF_BEDS, variable: Variable::Logarithm, ..space };
            if [pin, plate].into_iter().any(|body| !body.lining.is_empty()) {
                space.terms = space.terms.max(TERMS_OF_THIN_LAYERS);
            }
        }
        space
    }

    /// The same for a depth of the thinnest wall, no beds.
    fn beside(thinnest: f64, half_ring: bool, accuracy: f64, half_angle: f64) -> SpaceKey {
        // For deep, middling and thin walls terms and nodes.
        let of_depth = match accuracy {
            _ if accuracy >= COARSE => [(6, 24), (6, 32), (10, 48)],
            _ if accuracy >= FINE && half_angle < WIDE => [(6, 24), (6, 32), (16, 48)],
            _ if accuracy >= FINE => [(10, 24), (10, 32), (16, 48)],
            _ => [(10, 48), (16, 48), (24, 64)],
        };
        let (terms, nodes) = match thinnest {
            depth if depth > DEEP => of_depth[0],
            depth if depth > THIN => of_depth[1],
            _ => of_depth[2],
        };
        SpaceKey { half_ring, terms, nodes, variable: Variable::Root }
    }

    /// The same for interpolated bodies. Where a percent is asked and the pin's ring is whole, fewer nodes leave less than the fits.
    pub fn of_fits(pin: &Body, plate: &Body, accuracy: f64, half_angle: f64) -> SpaceKey {
        SpaceKey::coarsest(pin, plate, accuracy, half_angle).with_nodes_of_fits(accuracy)
    }

    fn with_nodes_of_fits(self, accuracy: f64) -> SpaceKey {
        match self.nodes {
            24 if accuracy >= COARSE && !self.half_ring => SpaceKey { nodes: 16, ..self },
            32 if accuracy >= COARSE && !self.half_ring => SpaceKey { nodes: 24, ..self },
            _ => self,
        }
    }

    /// Those `of_fits` of all contacts between walls no thinner than `THIN`.
    pub fn of_fits_of_thick_walls(half_ring: bool, accuracy: f64) -> impl Iterator<Item = SpaceKey> {
        let of_angle = move |half_angle| {
            [2.0 * DEEP, DEEP].map(|depth| {
                SpaceKey::beside(depth, half_ring, accuracy, half_angle).with_nodes_of_fits(accuracy)
            })
        };
        [0.0, WIDE].into_iter().flat_map(of_angle)
    }

    /// The next one with more trial pressures, `None` where there is none.
    pub fn with_more_terms(self) -> Option<SpaceKey> {
        next(&TERM_CHOICES, self.terms).map(|terms| SpaceKey { terms, ..self })
    }

    /// The next one with more nodes of the curve.
    pub fn with_more_nodes(self) -> Option<SpaceKey> {
        next(&NODE_CHOICES, self.nodes).map(|nodes| SpaceKey { nodes, ..self })
    }
}

fn next(choices: &[usize], now: usize) -> Option<usize> {
    choices.iter().copied().find(|choice| *choice > now)
}

/// From this contact half angle on, rad, few trial pressures leave something of the half angle and the peak pressure.
pub const WIDE: f64 = 1.4;

/// Its cosine, and the tangent of half of it.
pub const WIDE_COSINE: f64 = 0.169_967_142_900_240_94;
pub const WIDE_TANGENT: f64 = 0.842_288_380_463_079_3;

/// |ln r| from which on walls ask for more.
pub const DEEP: f64 = 0.35;
pub const THIN: f64 = 0.15;

/// The spaces met so far.
#[derive(Clone, Default)]
pub struct Spaces {
    spaces: HashMap<SpaceKey, CurveSpace>,
}

/// What bodies need of spaces: modes so many, and these ring modes.
#[derive(Default)]
pub struct Needs(HashMap<SpaceKey, (usize, HashSet<RingModes>)>);

impl Needs {
    /// And a body.
    pub fn with(self, (key, body): (SpaceKey, &BodyCompliance)) -> Needs {
        self.with_modes(key, body.mode_count(), body.boundary.ring_modes().map(|(modes, _)| modes))
    }

    /// And a body that has so many modes of concentric bodies, and these ring modes.
    pub fn with_modes(mut self, key: SpaceKey, count: usize, of_ring: Option<&RingModes>) -> Needs {
        let (mode_count, ring_modes) = self.0.entry(key).or_default();
        *mode_count = count.max(*mode_count);
        ring_modes.extend(of_ring);
        self
    }

    /// And others.
    pub fn and(mut self, others: Needs) -> Needs {
        for (key, (more_modes, more_ring_modes)) in others.0 {
            let (mode_count, ring_modes) = self.0.entry(key).or_default();
            *mode_count = more_modes.max(*mode_count);
            ring_modes.extend(more_ring_modes);
        }
        self
    }
}

impl Spaces {
    /// A space that was prepared.
    pub fn get(&self, key: SpaceKey) -> &CurveSpace {
        &self.spaces[&key]
    }

    /// Makes spaces, as far as they are not there yet, without what bodies need in them.
    pub fn make(&mut self, keys: impl Iterator<Item = SpaceKey>) {
        let new: HashSet<SpaceKey> = keys.filter(|key| !self.spaces.contains_key(key)).collect();
        let make = |key: SpaceKey| {
            (key, CurveSpace::made(key.variable, key.terms, key.nodes, key.limit(), &on_all_threads))
        };
        let made: Vec<(SpaceKey, CurveSpace)> = new.into_par_iter().map(make).collect();
        self.spaces.extend(made);
    }

    /// Makes spaces with what these bodies need in them, as far as it is not there yet.
    pub fn prepare<'a>(&mut self, bodies: impl Iterator<Item = (SpaceKey, &'a BodyCompliance)>) {
        self.meet(bodies.fold(Needs::default(), Needs::with));
    }

    /// The same by what bodies need.
    pub fn meet(&mut self, Needs(mut needs): Needs) {
        self.make(needs.keys().copied());
        let open = self.spaces.iter_mut().filter_map(|(key, space)| Some((space, needs.remove(key)?)));
        open.collect::<Vec<_>>().into_par_iter().for_each(|(space, (mode_count, ring_modes))| {
            space.pressures.prepare_modes(mode_count, &on_all_threads);
            for modes in &ring_modes {
                space.pressures.prepare_ring_modes(modes, &on_all_threads);
            }
        });
    }
}

/// `ForEach`, of which many studies have a single space to make.
fn on_all_threads(all: Vec<ArcLanes>, each: &(dyn Fn(ArcLanes) + Sync)) {
    all.into_par_iter().for_each(each);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_contacts_are_told_by_sides_too() {
        let differences = [WIDE_COSINE / WIDE.cos() - 1.0, WIDE_TANGENT / (0.5 * WIDE).tan() - 1.0];
        assert!(differences.iter().all(|difference| difference.abs() < 1e-15), "{differences:?}");
    }
}
