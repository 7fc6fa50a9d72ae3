//! Smooth functions around the ring, in which the compliance of a body on a mesh is told from that of an infinite one.
//!
//! Their difference is a smooth kernel, so a few cosines carry it, in an angle u that is stretched where contact is:
//!
//! ```text
//!   whole ring:             tan(u/2) = a tan(phi/2),     psi_m = cos(m u),     0 <= u <= pi,
//!   ring that ends held:    cos u = tan(phi/2)/b,        psi_m = cos(2 m u),   0 <= u <= pi/2.
//! ```
//!
//! The first is a map of the disc onto itself, so the cosines stay those of harmonic functions; a ring with a wall near by
//! wants a larger a. The second are the trial pressures of the largest arc. With the works D_mn of the difference under the
//! pressures psi_n du on psi_m du, and the integrals of the trial pressures of any arc,
//!
//! ```text
//!   A_jk = (infinite body)_jk + sum over m, n of M_mj D_mn M_nk,    M_mk = integral of p_k psi_m over that of psi_m^2.
//! ```

mod boundary_works;

use std::f64::consts::{FRAC_PI_2, PI};

use boundary_works::WorksOfModes;

use super::RingCompliance;
use super::arc::{ArcMap, ContactArc, packed, packed_count};
use super::arc_lanes::{POINTS, points_from, subtract_products};
use super::lane_work::{TermWork, in_lanes, in_lanes_with_terms};
use crate::mechanics::body::Side;
use crate::mechanics::element::quadrature::gauss_legendre;
use crate::mechanics::element::{ElementKind, side_functions};
use crate::mechanics::grading::GradingClass;
use crate::mechanics::mesh::{RingTopology, SUPPORTED};
use crate::mechanics::real::{LANES, Lanes, Real};

/// Functions on a ring, ordered by how finely they resolve a ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RingModes {
    pub count: usize,
    ring: Ring,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Ring {
    /// Stretched at the load line by so many quarters.
    Whole(u32),
    EndsHeld,
}

/// The largest arc on a ring that ends held, rad.
pub const LARGEST_HELD: f64 = 1.54;

/// Functions on a ring that ends held, for levels 0 and 1, 2 and 3, and finer ones.
const COUNT_HELD: [usize; 3] = [8, 12, 16];

/// Quarters of stretch and count of a whole ring by its class of depth, for levels 0 and 1, 2 and 3, and finer ones: the fewest
/// that leave the errors of the mesh as they are (docs/theory.md, section 6).
#[rustfmt::skip]
const WHOLE: [[(u32, usize); 12]; 3] = [
    [(5, 8), (5, 8), (5, 8), (5, 12), (5, 16), (6, 16), (8, 16), (10, 16), (12, 16), (16, 24), (20, 24), (20, 32)],
    [(5, 8), (5, 12), (5, 12), (5, 16), (5, 24), (6, 24), (6, 24), (8, 24), (8, 32), (8, 48), (12, 48), (16, 48)],
    [(4, 8), (4, 12), (4, 16), (5, 24), (5, 32), (5, 32), (5, 48), (5, 48), (6, 48), (8, 48), (12, 48), (16, 48)],
];

/// Functions of a ring that may be pressed all around, which nothing stretches.
const ALL_AROUND: [[usize; 12]; 3] = [
    [8, 8, 12, 16, 24, 32, 48, 48, 48, 48, 48, 48],
    [12, 12, 16, 24, 32, 48, 48, 48, 48, 48, 48, 48],
    [12, 16, 24, 32, 48, 48, 48, 48, 48, 48, 48, 48],
];

/// The greatest count.
pub const MOST_MODES: usize = 48;

/// How a pressure pushes a ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Push {
    /// Along its normal.
    Normal,
    /// What a tilt of that by sin(phi) against the ring's sense adds, twice: the works are quadratic.
    Tilt,
}

impl Push {
    /// Of the bodies of one side: the hole's normal is not that of the pin.
    pub fn of(side: Side) -> &'static [Push] {
        match side {
            Side::Pin => &[Push::Normal, Push::Tilt],
            Side::Plate => &[Push::Normal],
        }
    }

    fn direction(self, (sine, cosine): (f64, f64)) -> [f64; 2] {
        match self {
            Push::Normal => [sine, -cosine],
            Push::Tilt => [-2.0 * sine * cosine, -2.0 * sine * sine],
        }
    }
}

impl RingModes {
    /// Of the meshes of a class.
    pub fn of(class: &GradingClass) -> RingModes {
        let fineness = (class.level / 2).min(WHOLE.len() - 1);
        if class.ends_held {
            return RingModes { ring: Ring::EndsHeld, count: COUNT_HELD[fineness] };
        }
        let depth = (class.depth_class as usize).min(WHOLE[fineness].len() - 1);
        let (quarters, count) =
            if class.all_around { (4, ALL_AROUND[fineness][depth]) } else { WHOLE[fineness][depth] };
        RingModes::whole(quarters, count)
    }

    /// cos(m u) of a whole ring, stretched by so many quarters.
    pub fn whole(quarters: u32, count: usize) -> RingModes {
        RingModes { ring: Ring::Whole(quarters), count }
    }

    /// u at an angle phi.
    fn stretched(&self, angle: f64) -> f64 {
        match self.ring {
            Ring::Whole(_) if angle >= PI => PI,
            Ring::Whole(quarters) => 2.0 * (0.25 * f64::from(quarters) * (0.5 * angle).tan()).atan(),
            Ring::EndsHeld => ContactArc::new(LARGEST_HELD).tau(angle),
        }
    }

    /// phi at u.
    fn angle(&self, stretched: f64) -> f64 {
        match self.ring {
            Ring::Whole(quarters) => 2.0 * ((0.5 * stretched).tan() / (0.25 * f64::from(quarters))).atan(),
            Ring::EndsHeld => ContactArc::new(LARGEST_HELD).angle(stretched),
        }
    }

    /// The range of u, from 0.
    fn end(&self) -> f64 {
        match self.ring {
            Ring::Whole(_) => PI,
            Ring::EndsHeld => FRAC_PI_2,
        }
    }

    /// psi_m at u, m = 0 ... count - 1.
    fn values(&self, stretched: f64, values: &mut [f64]) {
        self.values_of((PI / self.end() * stretched).cos(), values);
    }

    /// The same from psi_1.
    fn values_of(&self, first: f64, values: &mut [f64]) {
        let turn = 2.0 * first;
        let (mut value, mut previous) = (1.0, first);
        for psi in values {
            *psi = value;
            (value, previous) = (turn * value - previous, value);
        }
    }

    /// Nodal loads of the pressures psi_m du as they push, for ring nodes at these angles: `[push][node][component][m]`.
    pub fn loads(&self, pushes: &[Push], element: ElementKind, ring_angles: &[f64]) -> Vec<Vec<f64>> {
        let count = self.count;
        let side = element.side_node_count() - 1;
        let rule = gauss_legendre(12 + count);
        let mut psi = vec![0.0; count];
        let mut loads = vec![vec![0.0; ring_angles.len() * 2 * count]; pushes.len()];
        for first in (0..ring_angles.len() - 1).step_by(side) {
            let (start, end) = (ring_angles[first], ring_angles[first + side]);
            let (from, to) = (self.stretched(start), self.stretched(end));
            for &(x, weight) in &rule {
                let stretched = 0.5 * (from + to) + 0.5 * (to - from) * x;
                let weight = 0.5 * (to - from).abs() * weight;
                let angle = self.angle(stretched);
                let turn = angle.sin_cos();
                self.values(stretched, &mut psi);
                let (functions, nodes) = side_functions(element, (2.0 * angle - start - end) / (end - start));
                for (push, loads) in pushes.iter().zip(&mut loads) {
                    for (node, function) in functions.iter().enumerate().take(nodes) {
                        for (component, along) in push.direction(turn).into_iter().enumerate() {
                            let at = ((first + node) * 2 + component) * count;
                            let scale = weight * function * along;
                            let own = &mut loads[at..at + count];
                            own.iter_mut().zip(&psi).for_each(|(load, psi)| *load += scale * psi);
                        }
                    }
                }
            }
        }
        loads
    }

    /// The loads on the ring's unknowns as they push, of those that move: unknown, from the ring's first on, and `[m]`.
    pub fn unknown_loads(&self, pushes: &[Push], topology: &RingTopology) -> Vec<Vec<(usize, Vec<f64>)>> {
        self.placed(&self.loads(pushes, topology.element, &topology.ring_angles), topology)
    }

    /// The same from the `loads` of the ring.
    pub fn placed(&self, loads: &[Vec<f64>], topology: &RingTopology) -> Vec<Vec<(usize, Vec<f64>)>> {
        let placed = |loads: &Vec<f64>| {
            let placed = loads.chunks_exact(self.count).enumerate().filter_map(|(place, load)| {
                let unknown = topology.unknowns[2 * topology.ring_nodes[place / 2] as usize + place % 2];
                (unknown != SUPPORTED).then(|| (unknown as usize - topology.ring_start, load.to_vec()))
            });
            placed.collect()
        };
        loads.iter().map(placed).collect()
    }

    /// The works of the modes as they push, packed, on a ring whose whole compliance is known.
    pub fn works_on_ring(&self, push: Push, ring: &RingCompliance, topology: &RingTopology) -> Vec<f64> {
        let loads = self.unknown_loads(&[Push::Normal, push], topology);
        let mut works = vec![0.0; packed_count(self.count)];
        let mut displacement = vec![0.0; self.count];
        for (row, of_row) in &loads[1] {
            displacement.fill(0.0);
            for (column, of_column) in &loads[0] {
                let compliance = ring.values[row * ring.size + column];
                displacement.iter_mut().zip(of_column).for_each(|(u, load)| *u += compliance * load);
            }
            for m in 0..self.count {
                for n in 0..=m {
                    let both = of_row[m] * displacement[n] + of_row[n] * displacement[m];
                    works[packed(m, n)] += 0.5 * both;
                }
            }
        }
        works
    }

    /// What the boundary of concentric bodies of one side changes of the works, packed, one way to push after the other; the
    /// bodies by `ConcentricBody::boundary_modes`.
    pub fn works_of_modes(&self, side: Side, bodies: &[[Vec<f64>; 2]]) -> Vec<Vec<f64>> {
        in_lanes(WorksOfModes { modes: self, side, bodies })
    }

    /// Integrals of these functions, du, with those of other modes over that of the square of the latter: `[other][own]`.
    fn moments_of(&self, other: &RingModes) -> Vec<f64> {
        let (mut own, mut of_other) = (vec![0.0; self.count], vec![0.0; other.count]);
        let mut moments = vec![0.0; self.count * other.count];
        let points = 64 + 2 * (self.count + other.count);
        let weight = self.end() / points as f64;
        for i in 0..points {
            let stretched = (i as f64 + 0.5) * weight;
            self.values(stretched, &mut own);
            other.values(other.stretched(self.angle(stretched)), &mut of_other);
            for (m, (psi, moments)) in of_other.iter().zip(moments.chunks_exact_mut(self.count)).enumerate() {
                let scale = weight * psi / other.norm(m);
                moments.iter_mut().zip(&own).for_each(|(moment, own)| *moment += scale * own);
            }
        }
        moments
    }

    /// The works of these modes, packed, one way to push after the other, of bodies that are told in other ones.
    pub fn works_of_others(&self, other: &RingModes) -> impl Fn(&[f64]) -> Vec<f64> + use<> {
        let (count, moments) = (self.count, self.moments_of(other));
        let others = other.count;
        let of_push = move |works: &[f64]| {
            let mut sum = vec![0.0; packed_count(count)];
            let mut row = vec![0.0; count];
            for (m, of_m) in moments.chunks_exact(count).enumerate() {
                row.fill(0.0);
                for (n, of_n) in moments.chunks_exact(count).enumerate().take(others) {
                    let work = works[packed(m.max(n), m.min(n))];
                    row.iter_mut().zip(of_n).for_each(|(sum, moment)| *sum += work * moment);
                }
                for (k, moment) in of_m.iter().enumerate() {
                    let sum = &mut sum[packed(k, 0)..=packed(k, k)];
                    sum.iter_mut().zip(&row).for_each(|(sum, value)| *sum += moment * value);
                }
            }
            sum
        };
        move |works| works.chunks_exact(packed_count(others)).flat_map(&of_push).collect()
    }

    /// The integral of psi_m^2 du.
    fn norm(&self, m: usize) -> f64 {
        if m == 0 { self.end() } else { 0.5 * self.end() }
    }

    /// Adds M_mk of the trial pressures of arcs of one map, an arc a lane: `[m][k]`.
    pub fn add_moments(&self, arcs: &[ContactArc; LANES], terms: usize, moments: &mut [[f64; LANES]]) {
        in_lanes_with_terms(terms, AddMoments { modes: self, arcs, moments });
    }
}

/// Those of `RingModes::add_moments`.
struct AddMoments<'a> {
    modes: &'a RingModes,
    arcs: &'a [ContactArc; LANES],
    moments: &'a mut [[f64; LANES]],
}

impl TermWork for AddMoments<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const WIDTH: usize, const TERMS: usize>(self) {
        let AddMoments { modes, arcs, moments } = self;
        let number = Lanes::<WIDTH>::from_f64;
        let (moments, _) = moments.as_chunks_mut::<TERMS>();
        let points = (32 + TERMS + 2 * modes.count).next_multiple_of(POINTS);
        let weight = FRAC_PI_2 / points as f64;
        let held = ContactArc::new(LARGEST_HELD).b;
        let mut squares = Lanes::<WIDTH>::zero();
        for (square, arc) in squares.0.iter_mut().zip(arcs) {
            *square = arc.b * arc.b;
        }
        for begin in (0..points).step_by(POINTS) {
            let (at, trials) = points_from::<TERMS>(begin, weight);
            // Twice psi_1.
            let mut firsts = [Lanes::<WIDTH>::zero(); POINTS];
            for (first, cosine) in firsts.iter_mut().zip(at) {
                // tan(phi/2) squared is a quotient.
                let above = squares * number(cosine * cosine);
                let below = match arcs[0].map {
                    ArcMap::Tangent => number(1.0),
                    ArcMap::Sine => number(1.0) - above,
                };
                *first = number(2.0)
                    * match modes.ring {
                        Ring::Whole(quarters) => {
                            let above = number((0.25 * f64::from(quarters)).powi(2)) * above;
                            (below - above) / (below + above)
                        }
                        Ring::EndsHeld => {
                            let of_held = number(2.0) * above / (below * number(held * held));
                            (of_held - number(1.0)).least(number(1.0))
                        }
                    };
            }
            let mut psi = [number(1.0); POINTS];
            let mut previous = firsts;
            for previous in &mut previous {
                *previous = number(0.5) * *previous;
            }
            for (m, moments) in moments.iter_mut().enumerate().take(modes.count) {
                let share = number(1.0 / modes.norm(m));
                let mut values = psi;
                for value in &mut values {
                    *value = share * *value;
                }
                subtract_products(moments, &values, &trials);
                for point in 0..POINTS {
                    let next = firsts[point] * psi[point] - previous[point];
                    (psi[point], previous[point]) = (next, psi[point]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::compliance::concentric_body::ConcentricBody;
    use crate::mechanics::compliance::pressure_space::{PressureSpace, Tilt};
    use crate::mechanics::compliance::{BodyCompliance, Boundary};
    use crate::mechanics::material::Idealization;
    use crate::mechanics::real::LANES;

    /// What the wall of an annulus changes, by its own modes and by stretched ones.
    #[test]
    fn stretched_modes_carry_a_wall() {
        let arcs = (1..=2 * LANES).map(|i| ContactArc::new(0.15 * i as f64)).collect();
        let mut space = PressureSpace::new(6, arcs);
        let body = ConcentricBody::bare(2.0, 0.3, Idealization::PlaneStrain);
        let exact = body.compliance();
        space.prepare(&exact);
        for (quarters, count, limit) in [(4, 8, 5.7e-4), (4, 16, 1.5e-8), (5, 16, 5.8e-8), (8, 24, 1.8e-7)] {
            let modes = RingModes::whole(quarters, count);
            let works = modes.works_of_modes(Side::Plate, &[body.boundary_modes()]).remove(0);
            let found = BodyCompliance { boundary: Boundary::RingModes(modes, works), ..exact.clone() };
            space.prepare(&found);
            let left = space.joint(&[(&exact, 1.0), (&found, -1.0)], Tilt::NONE);
            let worst = left.values.iter().fold(0.0, |worst: f64, value| worst.max(value.abs())) / exact.even;
            println!("stretched by {quarters}/4, {count} modes: {worst:e}");
            assert!(worst < limit && worst > 0.1 * limit, "{quarters} {count}: {worst:e}");
        }
    }

    /// A body that is told in some modes is the same in finer ones.
    #[test]
    fn a_body_is_the_same_in_other_modes() {
        let arcs = (1..=LANES).map(|i| ContactArc::new(0.28 * i as f64)).collect();
        let mut space = PressureSpace::new(6, arcs);
        let body = ConcentricBody::bare(2.0, 0.3, Idealization::PlaneStrain);
        let (coarse, fine) = (RingModes::whole(4, 8), RingModes::whole(6, 32));
        let works = coarse.works_of_modes(Side::Plate, &[body.boundary_modes()]).remove(0);
        let told_again = fine.works_of_others(&coarse)(&works);
        let told = [(coarse, works), (fine, told_again)].map(|(modes, works)| {
            let told = BodyCompliance { boundary: Boundary::RingModes(modes, works), ..body.compliance() };
            space.prepare(&told);
            told
        });
        let left = space.joint(&[(&told[0], 1.0), (&told[1], -1.0)], Tilt::NONE);
        let worst = left.values.iter().fold(0.0, |worst: f64, value| worst.max(value.abs())) / told[0].even;
        println!("{worst:e}");
        assert!(worst < 1e-13, "{worst:e}");
    }

    /// A rigid translation along y does the work of the pressures.
    #[test]
    fn translation_does_the_work_of_the_modes() {
        let angles: Vec<f64> = (0..=24).map(|i| PI * (i as f64 / 24.0).powf(1.3)).collect();
        for modes in [RingModes::whole(6, 8), RingModes { ring: Ring::EndsHeld, count: 8 }] {
            let loads = modes.loads(&[Push::Normal], ElementKind::Quad8, &angles).remove(0);
            let points = 4000;
            let weight = modes.end() / points as f64;
            for m in 0..8 {
                let work: f64 = (0..angles.len()).map(|node| loads[(node * 2 + 1) * 8 + m]).sum();
                let mut psi = [0.0; 8];
                let mut expected = 0.0;
                for i in 0..points {
                    let u = (i as f64 + 0.5) * weight;
                    modes.values(u, &mut psi);
                    expected -= weight * psi[m] * modes.angle(u).cos();
                }
                assert!((work - expected).abs() < 1e-6, "{modes:?} {m}: {work} {expected}");
            }
        }
    }
}
