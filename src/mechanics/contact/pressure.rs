//! Contact with a moving edge: the state of a joint as a function of its contact half angle.
//!
//! With the pin's centre e = dR + delta off the hole's, the pressure on |phi| < eps closes the gap,
//!
//! ```text
//!   u_pin[p] + u_plate[p] = e cos(phi) - dR = delta - e (1 - cos phi),
//! ```
//!
//! in the weak sense: integral of p_j times both sides, for every trial pressure. The system is linear in e and delta,
//! so with a_1, a_v the solutions for the right-hand sides 1 and 1 - cos phi the pressure is delta a_1 - e a_v, and
//! the edge is free of singularity where delta sum(a_1) = e sum(a_v). Hence, without iteration, delta/e and F/e as
//! functions of eps. The stiffness is that of a punch that keeps its arc: dF/d delta = integral of (a_1 - a_v) cos phi,
//! because the pressure at a free edge does not change to first order as the edge moves (Barber, Contact Mechanics,
//! section 9.3; Mossakovskii 1963).

use std::f64::consts::FRAC_PI_2;

use pulp::{Arch, Simd, WithSimd};

use super::arc_state::ArcState;

use crate::mechanics::compliance::arc::{ContactArc, MAX_TERMS, TERM_CHOICES, packed, packed_count};
use crate::mechanics::compliance::pressure_space::PressureSpace;
use crate::mechanics::compliance::thin_wall::add_bed;
use crate::mechanics::compliance::{NODE_COUNT, PressureCompliance};
use crate::mechanics::real::{LANES, Lanes, Real};

/// The compliance of both bodies of a joint to the trial pressures of a space.
pub struct JointCompliance<'a> {
    space: &'a PressureSpace,
    amplitude: f64,
    /// As of a `PressureCompliance`.
    bed: f64,
    /// `[node][packed lower triangle]`.
    values: Vec<f64>,
}

impl<'a> JointCompliance<'a> {
    /// Of a pin and a plate with their Young's moduli (one unit). Both compliances belong to `space`.
    pub fn new(
        space: &'a PressureSpace,
        (pin, pin_modulus): (&PressureCompliance, f64),
        (plate, plate_modulus): (&PressureCompliance, f64),
    ) -> JointCompliance<'a> {
        let (pin_share, plate_share) = (1.0 / pin_modulus, 1.0 / plate_modulus);
        let of_both = |(pin, plate): (&f64, &f64)| pin_share * pin + plate_share * plate;
        JointCompliance {
            space,
            amplitude: of_both((&pin.amplitude, &plate.amplitude)),
            bed: of_both((&pin.bed, &plate.bed)),
            values: pin.values.iter().zip(&plate.values).map(of_both).collect(),
        }
    }

    /// The largest contact half angle, rad.
    pub fn limit(&self) -> f64 {
        self.space.limit
    }

    /// States at the space's nodes, by descending half angle. `None` where the compliance is not positive definite,
    /// which says that the discretisation has broken down.
    pub fn at_nodes(&self) -> Vec<Option<ArcState>> {
        let nodes: Vec<usize> = (0..NODE_COUNT).collect();
        let lanes = nodes.chunks(LANES).flat_map(|nodes| {
            let of_lanes = std::array::from_fn(|lane| nodes[lane.min(nodes.len() - 1)]);
            let arcs = of_lanes.map(|node| self.space.arcs[node]);
            let evaluate = Evaluate { joint: self, arcs, nodes: Some(of_lanes) };
            Arch::new().dispatch(evaluate).into_iter().take(nodes.len())
        });
        lanes.collect()
    }

    /// States at contact half angles in (0, limit], side by side.
    pub fn at(&self, half_angles: &[f64; LANES]) -> [Option<ArcState>; LANES] {
        let arcs = half_angles.map(ContactArc::new);
        Arch::new().dispatch(Evaluate { joint: self, arcs, nodes: None })
    }

    /// For each state, the share by which a change of the joint's compliance (times one unit of the moduli) changes the work of
    /// the pressure: since that is stationary in the pressure, to first order the relative change of the energy at a given
    /// indentation, and of the force where it changes evenly with the load. Of a whole body it is the share of the work that
    /// goes into it.
    pub fn relative_changes(&self, states: &[ArcState], change: &PressureCompliance) -> Vec<f64> {
        states
            .chunks(LANES)
            .flat_map(|states| {
                Arch::new().dispatch(Change { joint: self, states, change }).into_iter().take(states.len())
            })
            .collect()
    }
}

/// The matrices of a compliance (`[node][packed]`) at half angles side by side, lower triangle.
#[inline(always)]
fn interpolate<const FUSED: bool, const TERMS: usize>(
    weights: &[Lanes<FUSED>; NODE_COUNT],
    values: &[f64],
) -> [[Lanes<FUSED>; TERMS]; TERMS] {
    let mut matrix = [[Lanes::<FUSED>::zero(); TERMS]; TERMS];
    let negative = weights.map(|weight| -weight);
    let entries = packed_count(TERMS);
    for row in 0..TERMS {
        for column in 0..=row {
            let mut entry = Lanes::<FUSED>::zero();
            let of_entry = values[packed(row, column)..].iter().step_by(entries);
            for (weight, value) in negative.iter().zip(of_entry) {
                entry = entry.minus_product(*weight, Lanes::from_f64(*value));
            }
            matrix[row][column] = entry;
        }
    }
    matrix
}

/// The matrices at one node a lane.
#[inline(always)]
fn gather<const FUSED: bool, const TERMS: usize>(
    nodes: [usize; LANES],
    values: &[f64],
) -> [[Lanes<FUSED>; TERMS]; TERMS] {
    let entries = packed_count(TERMS);
    let of_nodes = nodes.map(|node| &values[node * entries..][..entries]);
    let mut matrix = [[Lanes::<FUSED>::zero(); TERMS]; TERMS];
    for row in 0..TERMS {
        for column in 0..=row {
            for lane in 0..LANES {
                matrix[row][column].0[lane] = of_nodes[lane][packed(row, column)];
            }
        }
    }
    matrix
}

/// One evaluation of `LANES` arcs.
struct Evaluate<'a> {
    joint: &'a JointCompliance<'a>,
    arcs: [ContactArc; LANES],
    /// The nodes that the arcs are at, if they are at any.
    nodes: Option<[usize; LANES]>,
}

impl WithSimd for Evaluate<'_> {
    type Output = [Option<ArcState>; LANES];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        if S::IS_SCALAR { self.run_terms::<false>() } else { self.run_terms::<true>() }
    }
}

impl Evaluate<'_> {
    #[inline(always)]
    fn run_terms<const FUSED: bool>(self) -> [Option<ArcState>; LANES] {
        match self.joint.space.terms {
            3 => self.run::<FUSED, 3>(),
            6 => self.run::<FUSED, 6>(),
            10 => self.run::<FUSED, 10>(),
            16 => self.run::<FUSED, 16>(),
            MAX_TERMS => self.run::<FUSED, MAX_TERMS>(),
            other => unreachable!("no code for {other} trial pressures, only for {TERM_CHOICES:?}"),
        }
    }

    #[inline(always)]
    fn run<const FUSED: bool, const TERMS: usize>(self) -> [Option<ArcState>; LANES] {
        let Evaluate { joint, arcs, nodes } = self;
        let zero = Lanes::<FUSED>::zero();
        let mut matrix = match nodes {
            Some(nodes) => gather::<FUSED, TERMS>(nodes, &joint.values),
            None => {
                let weights = joint.space.interpolation(arcs.map(|arc| arc.half_angle));
                interpolate::<FUSED, TERMS>(&weights, &joint.values)
            }
        };
        matrix[0][0] -= Lanes(arcs.map(|arc| FRAC_PI_2 * joint.amplitude * arc.b.ln()));
        if joint.bed != 0.0 {
            add_bed(&mut matrix, Lanes::from_f64(joint.bed), Lanes(arcs.map(|arc| arc.b)));
        }
        let load_one: [Lanes<FUSED>; TERMS] =
            std::array::from_fn(|k| Lanes::from_f64(ContactArc::resultant(k)));
        let load_versine: [Lanes<FUSED>; TERMS] = ContactArc::versines(Lanes(arcs.map(|arc| arc.b)));
        let (mut one, mut versine) = (load_one, load_versine);
        solve_in_place::<_, TERMS, 0>(&mut matrix, &mut one, &mut versine);
        let (mut sum_one, mut sum_versine) = (zero, zero);
        for k in 0..TERMS {
            sum_one += one[k];
            sum_versine += versine[k];
        }
        let indentation = sum_versine / sum_one;
        let two = Lanes::from_f64(2.0);
        let (mut force, mut stiffness, mut energy) = (zero, zero, zero);
        let mut pressure = [zero; TERMS];
        for k in 0..TERMS {
            let cosine = two * (load_one[k] - load_versine[k]);
            pressure[k] = indentation * one[k] - versine[k];
            force += pressure[k] * cosine;
            stiffness += (one[k] - versine[k]) * cosine;
            energy += pressure[k] * (indentation * load_one[k] - load_versine[k]);
        }
        std::array::from_fn(|lane| {
            let state = ArcState {
                arc: arcs[lane],
                indentation: indentation.0[lane],
                force: force.0[lane],
                tangent_stiffness: stiffness.0[lane],
                energy: energy.0[lane],
                terms: TERMS,
                pressure: std::array::from_fn(|k| if k < TERMS { pressure[k].0[lane] } else { 0.0 }),
            };
            // The square root of a negative pivot makes everything after it NaN.
            let sound = state.indentation.is_finite() && state.force.is_finite() && state.energy.is_finite();
            sound.then_some(state)
        })
    }
}

/// Solves for two right-hand sides by Cholesky, A = L L^T in the lower triangle, of rows and columns from `FIRST` on.
#[inline(always)]
pub(super) fn solve_in_place<T: Real, const TERMS: usize, const FIRST: usize>(
    matrix: &mut [[T; TERMS]; TERMS],
    one: &mut [T; TERMS],
    other: &mut [T; TERMS],
) {
    let mut inverse = [T::zero(); TERMS];
    for row in FIRST..TERMS {
        for column in FIRST..=row {
            let mut value = matrix[row][column];
            for k in FIRST..column {
                value = value.minus_product(matrix[row][k], matrix[column][k]);
            }
            matrix[row][column] = if column < row { value * inverse[column] } else { value };
        }
        inverse[row] = T::from_f64(1.0) / matrix[row][row].sqrt();
        for k in FIRST..row {
            one[row] = one[row].minus_product(matrix[row][k], one[k]);
            other[row] = other[row].minus_product(matrix[row][k], other[k]);
        }
        one[row] = one[row] * inverse[row];
        other[row] = other[row] * inverse[row];
    }
    for row in (FIRST..TERMS).rev() {
        for k in row + 1..TERMS {
            one[row] = one[row].minus_product(matrix[k][row], one[k]);
            other[row] = other[row].minus_product(matrix[k][row], other[k]);
        }
        one[row] = one[row] * inverse[row];
        other[row] = other[row] * inverse[row];
    }
}

/// The quadratic form of a change of compliance with the pressures of up to `LANES` states.
struct Change<'a> {
    joint: &'a JointCompliance<'a>,
    states: &'a [ArcState],
    change: &'a PressureCompliance,
}

impl WithSimd for Change<'_> {
    type Output = [f64; LANES];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        if S::IS_SCALAR { self.run_terms::<false>() } else { self.run_terms::<true>() }
    }
}

impl Change<'_> {
    #[inline(always)]
    fn run_terms<const FUSED: bool>(self) -> [f64; LANES] {
        match self.joint.space.terms {
            3 => self.run::<FUSED, 3>(),
            6 => self.run::<FUSED, 6>(),
            10 => self.run::<FUSED, 10>(),
            16 => self.run::<FUSED, 16>(),
            MAX_TERMS => self.run::<FUSED, MAX_TERMS>(),
            other => unreachable!("no code for {other} trial pressures, only for {TERM_CHOICES:?}"),
        }
    }

    #[inline(always)]
    fn run<const FUSED: bool, const TERMS: usize>(self) -> [f64; LANES] {
        let Change { joint, states, change } = self;
        let state = |lane: usize| &states[lane.min(states.len() - 1)];
        let half_angles = std::array::from_fn(|lane| state(lane).arc.half_angle);
        let weights = joint.space.interpolation(half_angles);
        let mut matrix = interpolate::<FUSED, TERMS>(&weights, &change.values);
        if change.amplitude != 0.0 {
            let log = |lane: usize| -FRAC_PI_2 * change.amplitude * state(lane).arc.b.ln();
            matrix[0][0] += Lanes(std::array::from_fn(log));
        }
        if change.bed != 0.0 {
            let b = |lane: usize| state(lane).arc.b;
            add_bed(&mut matrix, Lanes::from_f64(change.bed), Lanes(std::array::from_fn(b)));
        }
        let pressure: [Lanes<FUSED>; TERMS] =
            std::array::from_fn(|k| Lanes(std::array::from_fn(|lane| state(lane).pressure[k])));
        let mut work = Lanes::<FUSED>::zero();
        for j in 0..TERMS {
            let mut row = Lanes::<FUSED>::zero();
            for k in 0..j {
                row += matrix[j][k] * pressure[k];
            }
            work += pressure[j] * (row + row + matrix[j][j] * pressure[j]);
        }
        std::array::from_fn(|lane| work.0[lane] / state(lane).energy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::compliance::series::ConcentricBody;
    use crate::mechanics::material::Idealization;

    /// Persson's table (Ciavarella & Decuzzi 2001): similar materials, the plate of ratio 1e4, a core of 1e-3.
    #[test]
    fn persson() {
        let space = PressureSpace::new(10, 1.9);
        let highest = 40;
        let moments = space.moments(highest);
        let body = |fixed_radius| ConcentricBody {
            fixed_radius,
            poissons_ratio: 0.3,
            idealization: Idealization::PlaneStress,
        };
        let plate = body(1e4).compliance(&space, &moments, highest);
        let pin = body(1e-3).compliance(&space, &moments, highest);
        let joint = JointCompliance::new(&space, (&pin, 1.0), (&plate, 1.0));
        let table = [
            (5.0, 166.503, 7.30208),
            (10.0, 41.1103, 3.66156),
            (20.0, 9.76763, 1.85239),
            (30.0, 3.97177, 1.26029),
            (45.0, 1.41156, 0.882111),
            (60.0, 0.533601, 0.711721),
            (80.0, 0.0630728, 0.611608),
        ];
        for (degrees, clearance, peak) in table {
            let state = joint.at(&[f64::to_radians(degrees); LANES])[0].unwrap();
            let inverse_force = 0.5 * state.clearance() / state.force;
            let peak_pressure = state.peak_pressure() / state.force;
            // The table has six digits; the largest deviation seen is 3.9e-6, at 80 deg.
            assert!((inverse_force / clearance - 1.0).abs() < 6e-6, "{degrees} deg: {inverse_force}");
            assert!((peak_pressure / peak - 1.0).abs() < 6e-6, "{degrees} deg: {peak_pressure}");
        }
    }
}
