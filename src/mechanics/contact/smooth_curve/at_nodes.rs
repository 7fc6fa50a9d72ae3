//! A joint at the nodes of its curve: one system of equations each, in the lanes of one register.

use std::f64::consts::FRAC_PI_2;

use pulp::{Arch, Simd, WithSimd};

use super::nodes::{CurveNodes, TURNS};
use super::{CHUNKS, CURVE_NODES, CURVE_TERMS, ENTRY_COUNT};
use crate::mechanics::compliance::arc::packed;
use crate::mechanics::contact::pressure::solve_in_place;
use crate::mechanics::real::{LANES, Lanes, Real};

/// Tension that truncation may leave at the edge, over the peak pressure.
const TENSION: f64 = 0.01;

/// A joint's compliance at the nodes, `[entry][node]`, with its amplitude.
pub(super) struct AtNodes<'a> {
    pub(super) nodes: &'a CurveNodes,
    pub(super) amplitude: f64,
    pub(super) values: &'a [f64],
}

/// What is found at the nodes.
pub(super) struct NodeStates {
    pub(super) functions: [[f64; LANES]; CURVE_NODES],
    pub(super) indentation: [f64; CURVE_NODES],
    pub(super) force: [f64; CURVE_NODES],
    pub(super) truncation: [f64; CURVE_NODES],
    pub(super) positive: [bool; CURVE_NODES],
    /// Coefficients of the trial pressures over e b^2.
    pub(super) pressure: [[f64; CURVE_TERMS]; CURVE_NODES],
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
        solve_in_place::<_, CURVE_TERMS, 1>(&mut matrix, &mut y, &mut w);
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
        let logarithm = |ln: &[f64; CURVE_NODES]| {
            Lanes::<FUSED>(std::array::from_fn(|lane| FRAC_PI_2 * amplitude * ln[at + lane]))
        };
        let singular = log_free - logarithm(&nodes.ln_b);
        // b is z^2 times what is smooth.
        let ln_z = logarithm(&nodes.ln_z);
        let smooth = singular + ln_z + ln_z;
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
                smooth.0[lane],
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

/// Places that a pressure is looked at side by side, so that no sum waits for the one before.
const ABREAST: usize = 4;

/// The least pressure between the zeros of the highest trial pressure, above the tension allowed.
#[inline(always)]
fn least_pressure<const FUSED: bool>(
    pressure: &[Lanes<FUSED>; CURVE_TERMS],
    turns: &[f64; TURNS],
) -> Lanes<FUSED> {
    let mut peak = Lanes::<FUSED>::zero();
    for (k, value) in pressure.iter().enumerate() {
        if k % 2 == 0 { peak += *value } else { peak -= *value }
    }
    let mut least = peak;
    for turns in turns.chunks_exact(ABREAST) {
        // Clenshaw's sums of c_k cos(k x).
        let mut current = [Lanes::<FUSED>::zero(); ABREAST];
        let mut previous = current;
        for value in pressure[1..].iter().rev() {
            for place in 0..ABREAST {
                let turn = Lanes::from_f64(-turns[place]);
                let next = (*value - previous[place]).minus_product(turn, current[place]);
                (current[place], previous[place]) = (next, current[place]);
            }
        }
        for place in 0..ABREAST {
            let half = Lanes::from_f64(-0.5 * turns[place]);
            least = least.least((pressure[0] - previous[place]).minus_product(half, current[place]));
        }
    }
    least - peak * Lanes::from_f64(-TENSION)
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
