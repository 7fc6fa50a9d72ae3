//! The curve of a joint from few arcs: contact reduced to functions of the half angle that are smooth.
//!
//! All that is singular in the compliance A of an arc is -pi/2 c ln b in entry (0, 0). With that row eliminated last,
//!
//! ```text
//!   A = | A_00  r^T |    y = B^-1 r,  w = B^-1 v',  S = A_00 - r.y,  V = v_0 - y.v',  Q = w.v',
//!       |  r     B  |    D = 1 - sum(y),  N = sum(w),
//! ```
//!
//! where v = (v_0, v') are the versines, the state with a free edge is
//!
//! ```text
//!   W = N/D,  delta/e = (2/pi) (S W + V),  p_0 = W,  p' = -W y - w,
//!   F/e = 2 [W (pi/2 - V) + Q],  dF/d delta = 2 [(pi/2 - V)^2/S + Q],  U/e^2 = S W^2 + Q,
//! ```
//!
//! and S without its logarithm, D, N/b^2, V/b^2 and Q/b^4 are smooth down to the angle zero. They are found at a few
//! nodes, and between them as polynomials: a load costs no system of equations.

use std::f64::consts::FRAC_PI_2;

use pulp::{Arch, Simd, WithSimd};

use crate::mechanics::compliance::arc::{ContactArc, packed, packed_count};
use crate::mechanics::compliance::pressure_space::PressureSpace;
use crate::mechanics::contact::loading::DimensionlessLoad;
use crate::mechanics::real::{LANES, Lanes, Real};

/// Arcs at which a curve is found.
pub const CURVE_NODES: usize = 16;

/// One register of numbers an entry of a matrix for each of these.
const CHUNKS: usize = CURVE_NODES / LANES;

/// Trial pressures of a curve: what thin bodies would need more for, `CurveState::truncation` tells.
pub const CURVE_TERMS: usize = 10;

/// Numbers of a joint's compliance at the nodes.
pub const ENTRY_COUNT: usize = packed_count(CURVE_TERMS) * CURVE_NODES;

/// Tension that truncation may leave at the edge, over the peak pressure.
const TENSION: f64 = 0.01;

/// Where a search ends: the excess of a load.
const TOLERANCE: f64 = 1e-9;

/// Steps of one search at most; bisection alone would need fewer.
const MOST_STEPS: usize = 100;

/// The arcs of curves up to a limit: Chebyshev nodes in z, tan(eps/4) = tan(limit/4) z^2, which needs no logarithm and no
/// angle to go from z to b.
pub struct CurveNodes {
    /// tan(limit/4).
    steepest: f64,
    /// Descending, like the half angles.
    pub arcs: [ContactArc; CURVE_NODES],
    /// Of the whole Chebyshev transform: `[degree][node]`.
    transform: [[f64; CURVE_NODES]; CURVE_NODES],
    /// Versines over b^2: `[chunk][k]`.
    versines: [[[f64; LANES]; CURVE_TERMS]; CHUNKS],
    ln_b: [f64; CURVE_NODES],
    ln_z: [f64; CURVE_NODES],
    /// 2 cos(pi i/(2 terms)), i = 1, 2, ..., between the zeros of the highest trial pressure.
    turns: [f64; 2 * CURVE_TERMS - 1],
}

impl CurveNodes {
    /// Up to a half angle, rad.
    pub fn new(limit: f64) -> CurveNodes {
        let steepest = (0.25 * limit).tan();
        let angle = |node: usize| std::f64::consts::PI * (node as f64 + 0.5) / CURVE_NODES as f64;
        let z: [f64; CURVE_NODES] = std::array::from_fn(|node| 0.5 * (1.0 + angle(node).cos()));
        let arcs = z.map(|z| ContactArc::new(4.0 * (steepest * z * z).atan()));
        let transform = std::array::from_fn(|degree| {
            let scale = if degree == 0 { 1.0 } else { 2.0 } / CURVE_NODES as f64;
            std::array::from_fn(|node| scale * (degree as f64 * angle(node)).cos())
        });
        let of_node: [[f64; CURVE_TERMS]; CURVE_NODES] = arcs.map(|arc| {
            let versines: [f64; CURVE_TERMS] = ContactArc::versines(arc.b);
            versines.map(|versine| versine / (arc.b * arc.b))
        });
        let versines = std::array::from_fn(|chunk| {
            std::array::from_fn(|k| std::array::from_fn(|lane| of_node[chunk * LANES + lane][k]))
        });
        let ln_b = arcs.map(|arc| arc.b.ln());
        let turn = |i: usize| std::f64::consts::PI * (i + 1) as f64 / (2 * CURVE_TERMS) as f64;
        let turns = std::array::from_fn(|i| 2.0 * turn(i).cos());
        CurveNodes { steepest, arcs, transform, versines, ln_b, ln_z: z.map(f64::ln), turns }
    }

    /// From compliances at the nodes of a pressure space to those at these nodes, `[entry][node]`.
    pub fn resample(&self, space: &PressureSpace, values: &[f64]) -> Vec<f64> {
        let count = space.arcs.len();
        let entries = values.len() / count;
        let mut resampled = vec![0.0; entries * CURVE_NODES];
        for chunk in 0..CHUNKS {
            let half_angles = std::array::from_fn(|lane| self.arcs[chunk * LANES + lane].half_angle);
            let weights = space.interpolation::<false>(half_angles);
            for (weights, of_node) in weights.iter().zip(values.chunks_exact(entries)) {
                for (entry, value) in of_node.iter().enumerate() {
                    let to = &mut resampled[entry * CURVE_NODES + chunk * LANES..][..LANES];
                    to.iter_mut().zip(&weights.0).for_each(|(sum, weight)| *sum += weight * value);
                }
            }
        }
        resampled
    }

    fn b(&self, z: f64) -> f64 {
        let quarter = self.steepest * z * z;
        2.0 * quarter / (1.0 - quarter * quarter)
    }
}

/// The joint under one load; units as in `ArcState`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveState {
    pub half_angle: f64,
    pub indentation: f64,
    pub force: f64,
    pub tangent_stiffness: f64,
    pub energy: f64,
    pub peak_pressure: f64,
    /// As `ArcState::truncation`, of the nodes on both sides the greater.
    pub truncation: f64,
    /// What the highest polynomial has of the functions: of that order is what leaving out further ones costs.
    pub curvature: f64,
    /// At the nodes on both sides.
    pub pressure_is_positive: bool,
    /// The node at or above the state, for what else is known node by node.
    pub node: usize,
}

/// The curve of a joint.
pub struct SmoothCurve<'a> {
    nodes: &'a CurveNodes,
    amplitude: f64,
    /// Chebyshev coefficients of S, D, N/b^2, V/b^2, Q/b^4 and the two parts of the peak pressure: `[degree][function]`.
    coefficients: [[f64; LANES]; CURVE_NODES],
    curvature: f64,
    indentation: [f64; CURVE_NODES],
    force: [f64; CURVE_NODES],
    truncation: [f64; CURVE_NODES],
    positive: [bool; CURVE_NODES],
    /// The widest node that a load can reach, and no node from there on.
    first: usize,
}

impl<'a> SmoothCurve<'a> {
    /// Of a joint's compliance at the nodes, `[entry][node]`, and its amplitude. `None` where it is not positive definite.
    pub fn new(nodes: &'a CurveNodes, amplitude: f64, values: &[f64]) -> Option<SmoothCurve<'a>> {
        if values.len() != ENTRY_COUNT {
            return None;
        }
        let at_nodes = Arch::new().dispatch(AtNodes { nodes, amplitude, values });
        let NodeStates { functions, indentation, force, truncation, positive, .. } = at_nodes;
        if !functions.iter().flatten().all(|value| value.is_finite()) {
            return None;
        }
        let mut coefficients = [[0.0; LANES]; CURVE_NODES];
        for (of_degree, row) in coefficients.iter_mut().zip(&nodes.transform) {
            for (functions, weight) in functions.iter().zip(row) {
                of_degree.iter_mut().zip(functions).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        let share = |function: usize| {
            let most = coefficients.iter().map(|of_degree| of_degree[function].abs()).fold(0.0, f64::max);
            let last =
                coefficients[CURVE_NODES - 2][function].abs() + coefficients[CURVE_NODES - 1][function].abs();
            last / most.max(f64::MIN_POSITIVE)
        };
        let curvature = (0..5).map(share).fold(0.0, f64::max);
        // As `JointCurve`: up to the first beyond a neat fit, and no further than the contact grows with the load.
        let mut first = CURVE_NODES;
        let mut before = 0.0;
        for node in (0..CURVE_NODES).rev() {
            let grown = indentation[node];
            // Not where it is NaN.
            if grown.is_nan() || grown <= before {
                break;
            }
            first = node;
            before = grown;
            if grown >= 1.0 {
                break;
            }
        }
        Some(SmoothCurve {
            nodes,
            amplitude,
            coefficients,
            curvature,
            indentation,
            force,
            truncation,
            positive,
            first,
        })
    }

    /// The states under loads (> 0), for a radial clearance over the hole's radius, >= 0; `None` where there is none on
    /// the curve.
    pub fn states(
        &self,
        clearance: f64,
        loads: impl Iterator<Item = DimensionlessLoad>,
        states: &mut Vec<Option<CurveState>>,
    ) {
        Arch::new().dispatch(Loads { curve: self, clearance, loads, states });
    }
}

/// For each node, the share by which a change of a joint's compliance changes the work of the pressure, as
/// `JointCompliance::relative_changes`; NaN where there is no sound pressure.
pub fn relative_changes(
    nodes: &CurveNodes,
    amplitude: f64,
    values: &[f64],
    changes: &[f64],
) -> [f64; CURVE_NODES] {
    if values.len() != ENTRY_COUNT || changes.len() != ENTRY_COUNT {
        return [f64::NAN; CURVE_NODES];
    }
    let NodeStates { pressure, .. } = Arch::new().dispatch(AtNodes { nodes, amplitude, values });
    std::array::from_fn(|node| {
        let pressure = &pressure[node];
        let work = |values: &[f64]| -> f64 {
            let mut sum = 0.0;
            for row in 0..CURVE_TERMS {
                for column in 0..=row {
                    let twice = if column < row { 2.0 } else { 1.0 };
                    let entry = values[packed(row, column) * CURVE_NODES + node];
                    sum += twice * entry * pressure[row] * pressure[column];
                }
            }
            sum
        };
        let logarithm = FRAC_PI_2 * amplitude * nodes.ln_b[node] * pressure[0] * pressure[0];
        work(changes) / (work(values) - logarithm)
    })
}

struct AtNodes<'a> {
    nodes: &'a CurveNodes,
    amplitude: f64,
    values: &'a [f64],
}

/// What is found at the nodes.
struct NodeStates {
    functions: [[f64; LANES]; CURVE_NODES],
    indentation: [f64; CURVE_NODES],
    force: [f64; CURVE_NODES],
    truncation: [f64; CURVE_NODES],
    positive: [bool; CURVE_NODES],
    /// Coefficients of the trial pressures over e b^2.
    pressure: [[f64; CURVE_TERMS]; CURVE_NODES],
}

impl WithSimd for AtNodes<'_> {
    type Output = NodeStates;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        if S::IS_SCALAR { self.run::<false>() } else { self.run::<true>() }
    }
}

impl AtNodes<'_> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> NodeStates {
        let mut found = NodeStates {
            functions: [[0.0; LANES]; CURVE_NODES],
            indentation: [0.0; CURVE_NODES],
            force: [0.0; CURVE_NODES],
            truncation: [0.0; CURVE_NODES],
            positive: [false; CURVE_NODES],
            pressure: [[0.0; CURVE_TERMS]; CURVE_NODES],
        };
        for chunk in 0..CHUNKS {
            self.run_chunk::<FUSED>(chunk, &mut found);
        }
        found
    }

    #[inline(always)]
    fn run_chunk<const FUSED: bool>(&self, chunk: usize, found: &mut NodeStates) {
        let AtNodes { nodes, amplitude, values, .. } = *self;
        let zero = Lanes::<FUSED>::zero();
        let one = Lanes::<FUSED>::from_f64(1.0);
        let half_pi = Lanes::<FUSED>::from_f64(FRAC_PI_2);
        let load = |row: usize, column: usize| {
            let from = packed(row, column) * CURVE_NODES + chunk * LANES;
            let mut lanes = zero;
            lanes.0.copy_from_slice(&values[from..from + LANES]);
            lanes
        };
        let mut matrix = [[zero; CURVE_TERMS]; CURVE_TERMS];
        for row in 1..CURVE_TERMS {
            for column in 1..=row {
                matrix[row][column] = load(row, column);
            }
        }
        let coupling: [Lanes<FUSED>; CURVE_TERMS] = std::array::from_fn(|row| load(row, 0));
        let versine: [Lanes<FUSED>; CURVE_TERMS] = std::array::from_fn(|k| Lanes(nodes.versines[chunk][k]));
        let (mut y, mut w) = (coupling, versine);
        solve_in_place(&mut matrix, &mut y, &mut w);
        let (mut log_free, mut against, mut work) = (coupling[0], versine[0], zero);
        let (mut edge, mut edge_w, mut peak, mut peak_w) = (one, zero, one, zero);
        for k in 1..CURVE_TERMS {
            log_free = log_free.minus_product(coupling[k], y[k]);
            against = against.minus_product(y[k], versine[k]);
            work = work.minus_product(-w[k], versine[k]);
            edge -= y[k];
            edge_w += w[k];
            if k % 2 == 0 {
                peak -= y[k];
                peak_w += w[k];
            } else {
                peak += y[k];
                peak_w -= w[k];
            }
        }
        let at = chunk * LANES;
        let b2 = Lanes::<FUSED>(std::array::from_fn(|lane| nodes.arcs[at + lane].b.powi(2)));
        let log = Lanes::<FUSED>(std::array::from_fn(|lane| FRAC_PI_2 * amplitude * nodes.ln_b[at + lane]));
        let singular = log_free - log;
        let first = edge_w / edge;
        let scaled_indentation = singular * first + against;
        let indentation = scaled_indentation * b2 / half_pi;
        let force = b2 * (first * (half_pi - b2 * against) + b2 * work);
        // Over b^2.
        let mut pressure = [first; CURVE_TERMS];
        for k in 1..CURVE_TERMS {
            pressure[k] = -(first * y[k] + w[k]);
        }
        let size = |lanes: Lanes<FUSED>| Lanes::<FUSED>(lanes.0.map(f64::abs));
        let mut most = Lanes::<FUSED>::from_f64(f64::MIN_POSITIVE);
        for value in pressure {
            most = -(-most).least(-size(value));
        }
        let tail = (size(pressure[CURVE_TERMS - 2]) + size(pressure[CURVE_TERMS - 1])) / most;
        let least = least_pressure::<FUSED>(&pressure, &nodes.turns);
        // 2 makes the whole joint of both halves.
        let both = force + force;
        for lane in 0..LANES {
            let node = at + lane;
            found.functions[node] = [
                log_free.0[lane],
                edge.0[lane],
                edge_w.0[lane],
                against.0[lane],
                work.0[lane],
                peak.0[lane],
                peak_w.0[lane],
                0.0,
            ];
            // The square root of a negative pivot makes everything after it NaN; S has no pivot of its own.
            let sound = singular.0[lane] > 0.0;
            found.indentation[node] = if sound { indentation.0[lane] } else { f64::NAN };
            found.force[node] = both.0[lane];
            found.truncation[node] = tail.0[lane] * tail.0[lane];
            found.positive[node] = least.0[lane] >= 0.0;
            for k in 0..CURVE_TERMS {
                found.pressure[node][k] = pressure[k].0[lane];
            }
        }
    }
}

/// The least pressure between the zeros of the highest trial pressure, above the tension allowed.
#[inline(always)]
fn least_pressure<const FUSED: bool>(
    pressure: &[Lanes<FUSED>; CURVE_TERMS],
    turns: &[f64; 2 * CURVE_TERMS - 1],
) -> Lanes<FUSED> {
    let mut peak = Lanes::<FUSED>::zero();
    for (k, value) in pressure.iter().enumerate() {
        if k % 2 == 0 { peak += *value } else { peak -= *value }
    }
    let allowed = peak * Lanes::from_f64(-TENSION);
    let mut least = peak - allowed;
    for turn in turns {
        // Clenshaw's sum of c_k cos(k x).
        let turn = Lanes::<FUSED>::from_f64(*turn);
        let (mut current, mut previous) = (Lanes::<FUSED>::zero(), Lanes::<FUSED>::zero());
        for k in (1..CURVE_TERMS).rev() {
            let next = (pressure[k] - previous).minus_product(-turn, current);
            (current, previous) = (next, current);
        }
        let half = Lanes::<FUSED>::from_f64(0.5) * turn;
        let sum = (pressure[0] - previous).minus_product(-half, current);
        least = least.least(sum - allowed);
    }
    least
}

/// Solves for two right-hand sides by Cholesky, rows from 1 on.
#[inline(always)]
fn solve_in_place<T: Real>(
    matrix: &mut [[T; CURVE_TERMS]; CURVE_TERMS],
    one: &mut [T; CURVE_TERMS],
    other: &mut [T; CURVE_TERMS],
) {
    let mut inverse = [T::zero(); CURVE_TERMS];
    for row in 1..CURVE_TERMS {
        for column in 1..=row {
            let mut value = matrix[row][column];
            for k in 1..column {
                value = value.minus_product(matrix[row][k], matrix[column][k]);
            }
            matrix[row][column] = if column < row { value * inverse[column] } else { value };
        }
        inverse[row] = T::from_f64(1.0) / matrix[row][row].sqrt();
        for k in 1..row {
            one[row] = one[row].minus_product(matrix[row][k], one[k]);
            other[row] = other[row].minus_product(matrix[row][k], other[k]);
        }
        one[row] = one[row] * inverse[row];
        other[row] = other[row] * inverse[row];
    }
    for row in (1..CURVE_TERMS).rev() {
        for k in row + 1..CURVE_TERMS {
            one[row] = one[row].minus_product(matrix[k][row], one[k]);
            other[row] = other[row].minus_product(matrix[k][row], other[k]);
        }
        one[row] = one[row] * inverse[row];
        other[row] = other[row] * inverse[row];
    }
}

struct Loads<'a, I> {
    curve: &'a SmoothCurve<'a>,
    clearance: f64,
    loads: I,
    states: &'a mut Vec<Option<CurveState>>,
}

impl<I: Iterator<Item = DimensionlessLoad>> WithSimd for Loads<'_, I> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        if S::IS_SCALAR { self.run::<false>() } else { self.run::<true>() }
    }
}

impl<I: Iterator<Item = DimensionlessLoad>> Loads<'_, I> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        for load in self.loads {
            self.states.push(self.curve.search::<FUSED>(self.clearance, load));
        }
    }
}

impl SmoothCurve<'_> {
    #[inline(always)]
    fn search<const FUSED: bool>(&self, clearance: f64, load: DimensionlessLoad) -> Option<CurveState> {
        let target = Target::new(clearance, load);
        let point = |node: usize| {
            let excess = target.excess(self.indentation[node], self.force[node]);
            (self.nodes.ln_z[node], excess)
        };
        // Nodes go down with the angle: the last one that is not below the load.
        let reached = |node: &usize| target.is_reached(self.indentation[*node], self.force[*node]);
        let above = (self.first..CURVE_NODES).rev().find(reached)?;
        let below = above + 1;
        let last = (below + 1).min(CURVE_NODES - 1);
        let mut points = [(0.0, 0.0); 4];
        let mut count = 0;
        for node in above.saturating_sub(1).max(self.first)..=last {
            points[count] = point(node);
            count += 1;
        }
        let guess = inverse_interpolation(&points[..count]);
        let (mut a, mut b);
        if below < CURVE_NODES {
            (a, b) = (point(below), point(above));
        } else {
            // Below all nodes the load is a power of the angle: more than the fourth, with the logarithm.
            b = point(above);
            a = (b.0 - 0.5 * b.1 - 1.0, f64::NEG_INFINITY);
        }
        let mut next = if guess > a.0 && guess < b.0 {
            guess
        } else if below < CURVE_NODES {
            0.5 * (a.0 + b.0)
        } else {
            (b.0 - 0.25 * b.1).max(a.0)
        };
        for _ in 0..MOST_STEPS {
            let z = next.exp();
            let state = self.state::<FUSED>(z)?;
            let excess = target.excess(state.indentation, state.force);
            if excess.abs() < TOLERANCE || (b.0 - a.0).abs() < 1e-14 {
                let below = below.min(CURVE_NODES - 1);
                return Some(CurveState {
                    truncation: self.truncation[above].max(self.truncation[below]),
                    pressure_is_positive: self.positive[above] && self.positive[below],
                    node: above,
                    ..state
                });
            }
            let latest = (next, excess);
            let dropped = if excess < 0.0 {
                std::mem::replace(&mut a, latest)
            } else {
                std::mem::replace(&mut b, latest)
            };
            let guess = if a.1.is_finite() && dropped.1.is_finite() {
                inverse_interpolation(&[a, b, dropped])
            } else if a.1.is_finite() {
                inverse_interpolation(&[a, b])
            } else {
                b.0 - 0.25 * b.1
            };
            next = if guess > a.0 && guess < b.0 { guess } else { 0.5 * (a.0 + b.0) };
        }
        None
    }

    /// The state at an angle, but for what is known node by node.
    #[inline(always)]
    fn state<const FUSED: bool>(&self, z: f64) -> Option<CurveState> {
        let turn = Lanes::<FUSED>::from_f64(-2.0 * (2.0 * z - 1.0));
        let (mut current, mut previous) = (Lanes::<FUSED>::zero(), Lanes::<FUSED>::zero());
        for of_degree in self.coefficients[1..].iter().rev() {
            let next = (Lanes::<FUSED>(*of_degree) - previous).minus_product(turn, current);
            (current, previous) = (next, current);
        }
        let half = Lanes::<FUSED>::from_f64(0.5) * turn;
        let sum = (Lanes::<FUSED>(self.coefficients[0]) - previous).minus_product(half, current);
        let [log_free, edge, edge_w, against, work, peak, peak_w, _] = sum.0;
        let b = self.nodes.b(z);
        let b2 = b * b;
        let singular = log_free - FRAC_PI_2 * self.amplitude * b.ln();
        let first = b2 * edge_w / edge;
        let (against, work) = (b2 * against, b2 * b2 * work);
        let arm = FRAC_PI_2 - against;
        let state = CurveState {
            half_angle: 2.0 * b.atan(),
            indentation: (singular * first + against) / FRAC_PI_2,
            force: 2.0 * (first * arm + work),
            tangent_stiffness: 2.0 * (arm * arm / singular + work),
            energy: singular * first * first + work,
            peak_pressure: (first * peak - b2 * peak_w) / (2.0 * b),
            truncation: 0.0,
            curvature: self.curvature,
            pressure_is_positive: false,
            node: 0,
        };
        (singular > 0.0 && state.indentation > 0.0 && state.force.is_finite()).then_some(state)
    }
}

/// A load as what is searched for.
#[derive(Clone, Copy)]
enum Target {
    /// delta/e.
    Indentation(f64),
    /// F over the clearance.
    Force(f64),
}

impl Target {
    fn new(clearance: f64, load: DimensionlessLoad) -> Target {
        match load {
            DimensionlessLoad::Indentation(delta) => Target::Indentation(delta / (clearance + delta)),
            // A neat fit has one half angle, whatever the load.
            DimensionlessLoad::Force(_) if clearance == 0.0 => Target::Indentation(1.0),
            DimensionlessLoad::Force(force) => Target::Force(force / clearance),
        }
    }

    #[inline(always)]
    fn is_reached(self, indentation: f64, force: f64) -> bool {
        match self {
            Target::Indentation(target) => indentation >= target,
            Target::Force(target) => force >= target * (1.0 - indentation),
        }
    }

    /// As in `loading`: the logarithm of the ratio of load and target; towards a neat fit, where dR/e ends, the
    /// difference of dR/e and what it should be.
    #[inline(always)]
    fn excess(self, indentation: f64, force: f64) -> f64 {
        match self {
            Target::Indentation(target) => (indentation / target).ln(),
            Target::Force(target) => {
                let (wanted, clearance) = (force / target, 1.0 - indentation);
                if clearance > 0.5 { (wanted / clearance).ln() } else { wanted - clearance }
            }
        }
    }
}

/// The position at which the polynomial through (position, value), taken as position of value, has the value zero.
#[inline(always)]
fn inverse_interpolation(points: &[(f64, f64)]) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::compliance::series::ConcentricBody;
    use crate::mechanics::contact::loading::JointCurve;
    use crate::mechanics::contact::pressure::JointCompliance;
    use crate::mechanics::material::Idealization;

    /// Against the curve that solves a system for every load: narrow and wide contacts, thin and thick bodies, one much
    /// softer than the other, loads by indentation and by force, a neat fit.
    #[test]
    fn the_curve_is_that_of_every_arc() {
        let space = PressureSpace::new(CURVE_TERMS, 2.4);
        let highest = 120;
        let moments = space.moments(highest);
        let nodes = CurveNodes::new(space.limit);
        let mut worst = [0.0_f64; 5];
        for (core, ratio, plate_modulus) in
            [(0.1, 3.0, 1.0), (0.6, 1.4, 1.0), (0.05, 50.0, 0.01), (0.3, 1.5, 100.0)]
        {
            let [pin, plate] = [core, ratio].map(|fixed_radius| {
                let idealization = Idealization::PlaneStrain;
                ConcentricBody { fixed_radius, poissons_ratio: 0.3, idealization }
                    .compliance(&space, &moments, highest)
            });
            let joint = JointCompliance::new(&space, (&pin, 1.0), (&plate, plate_modulus));
            let curve = JointCurve::new(joint).unwrap();
            let [pin_values, plate_values] = [&pin, &plate].map(|body| nodes.resample(&space, &body.values));
            let values: Vec<f64> = pin_values
                .iter()
                .zip(&plate_values)
                .map(|(pin, plate)| pin + plate / plate_modulus)
                .collect();
            let amplitude = pin.amplitude + plate.amplitude / plate_modulus;
            let smooth = SmoothCurve::new(&nodes, amplitude, &values).unwrap();
            for clearance in [0.0, 1e-3] {
                let loads: Vec<DimensionlessLoad> = (0..12)
                    .flat_map(|i| {
                        let load = 1e-7 * 5.0_f64.powi(i);
                        [DimensionlessLoad::Indentation(load), DimensionlessLoad::Force(0.3 * load)]
                    })
                    .collect();
                let expected = curve.states(clearance, &loads);
                let mut found = Vec::new();
                smooth.states(clearance, loads.iter().copied(), &mut found);
                for (found, expected) in found.iter().zip(&expected) {
                    assert_eq!(found.is_some(), expected.is_ok());
                    let (Some(found), Ok(expected)) = (found, expected) else { continue };
                    let errors = [
                        (found.force, expected.force),
                        (found.tangent_stiffness, expected.tangent_stiffness),
                        (found.energy, expected.energy),
                        (found.peak_pressure, expected.peak_pressure()),
                        (found.half_angle, expected.arc.half_angle),
                    ]
                    .map(|(found, expected)| (found / expected - 1.0).abs());
                    // What is said of the curve holds for the force and the energy.
                    assert!(errors[0].max(errors[2]) <= found.curvature + 1e-8, "{found:?} {errors:?}");
                    worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
                }
            }
        }
        println!("force, stiffness, energy, peak, angle: {worst:?}");
        let limits = [1e-4, 3e-4, 1e-4, 3e-4, 3e-4];
        assert!(worst.iter().zip(limits).all(|(worst, limit)| *worst < limit), "{worst:?}");
    }

    /// What is no compliance has no curve, and nothing panics.
    #[test]
    fn broken_compliances_have_no_curve() {
        let nodes = CurveNodes::new(2.4);
        assert!(SmoothCurve::new(&nodes, 1.0, &[]).is_none());
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(SmoothCurve::new(&nodes, 1.0, &[value; ENTRY_COUNT]).is_none(), "{value}");
        }
    }
}
