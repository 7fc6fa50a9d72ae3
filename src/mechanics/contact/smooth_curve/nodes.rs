//! The arcs at which a curve is found, and what depends on them alone.

use super::{CHUNKS, CURVE_NODES, CURVE_TERMS};
use crate::mechanics::compliance::arc::ContactArc;
use crate::mechanics::compliance::pressure_space::PressureSpace;
use crate::mechanics::real::{LANES, Lanes, Real};

/// Where a pressure is looked at.
pub(super) const TURNS: usize = 2 * CURVE_TERMS;

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
    pub(super) versines: [[[f64; LANES]; CURVE_TERMS]; CHUNKS],
    pub(super) ln_b: [f64; CURVE_NODES],
    pub(super) ln_z: [f64; CURVE_NODES],
    /// 2 cos(pi i/(2 terms)), i = 1, 2, ..., between the zeros of the highest trial pressure, the last where they all peak.
    pub(super) turns: [f64; TURNS],
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

    /// From values at the nodes, `[node][function]`, to Chebyshev coefficients, `[degree][function]`.
    #[inline(always)]
    pub(super) fn transformed(&self, values: &[[f64; LANES]; CURVE_NODES]) -> [[f64; LANES]; CURVE_NODES] {
        let mut coefficients = [[0.0; LANES]; CURVE_NODES];
        for (of_degree, row) in coefficients.iter_mut().zip(&self.transform) {
            for (values, weight) in values.iter().zip(row) {
                for (sum, value) in of_degree.iter_mut().zip(values) {
                    *sum += weight * value;
                }
            }
        }
        coefficients
    }

    #[inline(always)]
    pub(super) fn b<const FUSED: bool>(&self, z: Lanes<FUSED>) -> Lanes<FUSED> {
        let quarter = Lanes::from_f64(self.steepest) * z * z;
        (quarter + quarter) / Lanes::from_f64(1.0).minus_product(quarter, quarter)
    }
}
