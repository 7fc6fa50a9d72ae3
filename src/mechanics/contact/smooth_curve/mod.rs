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
//! and S without its logarithm (of z, whose square is b but for a smooth factor), D, N/b^2, V/b^2 and Q/b^4 are smooth down to the angle zero. They are found at a few
//! nodes, and between them as polynomials: a load costs no system of equations.

use pulp::Arch;

use self::at_nodes::{AtNodes, NodeStates};
use self::nodes::CurveNodes;
use self::states::Loads;
use crate::mechanics::compliance::arc::packed_count;
use crate::mechanics::contact::loading::DimensionlessLoad;
use crate::mechanics::real::LANES;

pub mod nodes;
pub mod at_nodes;
mod states;

/// Arcs at which a curve is found.
pub const CURVE_NODES: usize = 16;

/// One register of numbers an entry of a matrix for each of these.
const CHUNKS: usize = CURVE_NODES / LANES;

/// Trial pressures of a curve: what thin bodies would need more for, `CurveState::truncation` tells.
pub const CURVE_TERMS: usize = 10;

/// Numbers of a joint's compliance at the nodes.
pub const ENTRY_COUNT: usize = packed_count(CURVE_TERMS) * CURVE_NODES;

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
    /// What the highest polynomials have of the functions.
    pub curvature: f64,
    /// At the nodes on both sides.
    pub pressure_is_positive: bool,
    /// The node at or above the state, for what else is known node by node.
    pub node: usize,
}

/// What leaving out further polynomials costs, over what the highest have, where that is above 1e-5: `tests/interpolation.rs`
/// holds it on 400 joints of discs in rings.
const CURVE_SHARE: f64 = 0.5;

impl CurveState {
    /// Bound of the relative error of force and energy that the polynomials between nodes leave.
    pub fn curve_error(&self) -> f64 {
        CURVE_SHARE * self.curvature
    }
}

/// The curve of a joint.
pub struct SmoothCurve<'a> {
    nodes: &'a CurveNodes,
    amplitude: f64,
    /// Chebyshev coefficients in z of S + pi c ln z, D, N/b^2, V/b^2, Q/b^4 and the two parts of the peak pressure: `[degree][function]`.
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
        let coefficients = Arch::new().dispatch(
            #[inline(always)]
            || nodes.transformed(&functions),
        );
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::compliance::pressure_space::PressureSpace;
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
        let (mut worst, mut count) = ([0.0_f64; 5], 0);
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
                assert_eq!(found.len(), loads.len());
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
                    count += 1;
                    assert!(errors.iter().all(|error| error.is_finite()), "{found:?} {expected:?}");
                    // What is said of the curve holds for the force and the energy.
                    assert!(errors[0].max(errors[2]) <= found.curve_error() + 1e-6, "{found:?} {errors:?}");
                    worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
                }
            }
        }
        println!("{count} states; force, stiffness, energy, peak, angle: {worst:?}");
        assert_eq!(count, 4 * 2 * 24);
        // Seen: 8e-5, 1.5e-4, 8e-5, 6e-5 and 9e-5.
        let limits = [1e-4, 2e-4, 1e-4, 1e-4, 1.3e-4];
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
