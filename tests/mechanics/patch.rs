//! Patch tests: states of constant strain are found exactly on any mesh, also across contact.
//!
//! Irons & Razzaque, in Aziz (ed.), The Mathematical Foundations of the Finite Element Method (1972) 557-587; for
//! contact Taylor & Papadopoulos, in Wriggers & Wagner (eds.), Nonlinear Computational Mechanics (1991) 690-702.

use crate::common::greatest::greatest;
use crate::common::meshes::{ELEMENTS, PlaneMesh, scatter};
use faer::{Mat, Side};
use jointsweep::internals::mechanics::assembly::Assembly;
use jointsweep::internals::mechanics::compliance::condense::by_cholesky;
use jointsweep::internals::mechanics::contact::node_contact::active_set::{
    ActiveSetOutcome, solve_nodal_contact,
};
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::element::quadrature::gauss_legendre;
use jointsweep::internals::mechanics::element::stiffness::Elasticity;
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::mechanics::mesh::SUPPORTED;
use jointsweep::internals::mechanics::solve::cholesky::CholeskyAnalysis;

const POISSONS_RATIOS: [f64; 4] = [-0.5, 0.0, 0.3, 0.499];

/// On 2 x 1, inner corners off their places by up to a fifth of an element, all mid-side nodes off their sides.
fn distorted(element: ElementKind, cells: (usize, usize)) -> PlaneMesh {
    let mut mesh = PlaneMesh::new(element, cells, |x, y| {
        let inside = if x * (1.0 - x) * y * (1.0 - y) > 0.0 { 1.0 } else { 0.0 };
        let seed = (1000.0 * x + 37.0 * y) as u64;
        [2.0 * x + 0.1 * inside * scatter(seed), y + 0.06 * inside * scatter(seed + 7)]
    });
    for (node, place) in mesh.coordinates.iter_mut().enumerate() {
        if mesh.grid[node].0 % 2 + mesh.grid[node].1 % 2 == 1 {
            place.iter_mut().enumerate().for_each(|(i, x)| *x += 0.02 * scatter((2 * node + i) as u64));
        }
    }
    mesh
}

/// Goal: constant strain is exact on a distorted mesh, in its displacements and in its nodal forces.
/// Mesh: 4 x 3 distorted elements on 2 x 1; supports: the boundary is moved by u = G x; no load.
#[test]
fn constant_strain_is_exact() {
    const GRADIENT: [[f64; 2]; 2] = [[0.7, -0.4], [0.9, 0.2]];
    let mut worst: f64 = 0.0;
    for element in ELEMENTS {
        for idealization in Idealization::ALL {
            for poissons_ratio in POISSONS_RATIOS {
                let mesh = distorted(element, (4, 3));
                let elasticity: Elasticity<f64> = Elasticity::new(idealization, poissons_ratio);
                let linear = |[x, y]: &[f64; 2]| GRADIENT.map(|[by_x, by_y]| by_x * x + by_y * y);
                let exact: Vec<f64> = mesh.coordinates.iter().flat_map(linear).collect();
                let supported = |dof: usize| mesh.on_boundary(dof / 2);
                let prescribed: Vec<f64> =
                    (0..exact.len()).map(|dof| if supported(dof) { exact[dof] } else { 0.0 }).collect();
                let load = vec![0.0; exact.len()];
                let (displacement, force) = mesh.solve(&elasticity, supported, &prescribed, &load);
                let error = greatest(displacement.iter().zip(&exact).map(|(a, b)| a - b));
                worst = worst.max(error);
                // Rounding (1e-16) times the condition of K (up to 1e4 at nu = 0.499): measured at most 9e-14.
                assert!(error < 1e-11, "{element:?} {idealization:?} {poissons_ratio}: {error:e}");
                // Virtual work of the displacement x along each axis: sum f x = stress times area, to rounding.
                let mut area = 0.0;
                mesh.integrate(&gauss_legendre(3), |_, _, _, weight| area += weight);
                let [[xx, xy], [yx, yy]] = GRADIENT;
                let stress = [elasticity.direct * xx + elasticity.cross * yy, elasticity.shear * (xy + yx)];
                for (component, stress) in stress.into_iter().enumerate() {
                    let work: f64 = mesh
                        .coordinates
                        .iter()
                        .enumerate()
                        .map(|(i, [x, _])| x * force[2 * i + component])
                        .sum();
                    assert!((work - stress * area).abs() < 1e-12 * elasticity.direct, "{work} {stress}");
                }
            }
        }
    }
    println!("constant strain: displacement within {worst:.0e}");
}

/// The whole stiffness of a mesh, no dof supported.
fn dense_stiffness(mesh: &PlaneMesh, elasticity: &Elasticity<f64>) -> Mat<f64> {
    let (unknowns, count) = mesh.unknowns(|_| false);
    let assembly = Assembly::new(mesh.element, &mesh.connectivity, &unknowns, count);
    let values: Vec<f64> = assembly.stiffness_values(elasticity, &mesh.coordinates).unwrap();
    let mut dense = Mat::zeros(count, count);
    for row in 0..count {
        for (column, value) in assembly.matrix(&values).row(row) {
            dense[(row, column)] = value;
        }
    }
    dense
}

/// Goal: the stiffness is symmetric, resists every motion but the three rigid ones, and none of those.
///
/// Q8 with 2 x 2 points has a fourth mode of no energy on one element alone: its sides bow so that no point sees
/// strain. Two neighbours would have to bow their common side in opposite directions, so any two elements resist it,
/// and every mesh of a body has more than one.
#[test]
fn only_rigid_motions_are_free() {
    for (element, cells, zeros) in [
        (ElementKind::Quad4, (1, 1), 3),
        (ElementKind::Quad8, (1, 1), 4),
        (ElementKind::Quad4, (2, 1), 3),
        (ElementKind::Quad8, (2, 1), 3),
        (ElementKind::Quad4, (3, 3), 3),
        (ElementKind::Quad8, (3, 3), 3),
    ] {
        for idealization in Idealization::ALL {
            for poissons_ratio in POISSONS_RATIOS {
                let mesh = distorted(element, cells);
                let stiffness = dense_stiffness(&mesh, &Elasticity::new(idealization, poissons_ratio));
                assert_eq!(stiffness, stiffness.transpose().to_owned(), "both triangles gather alike");
                let values = stiffness.self_adjoint_eigenvalues(Side::Lower).unwrap();
                let greatest = values[values.len() - 1];
                // Zero to rounding: measured below 1e-15; the least elastic value is above 1e-5 of the greatest.
                let zero = values.iter().filter(|value| value.abs() < 1e-13 * greatest).count();
                assert_eq!(
                    zero, zeros,
                    "{element:?} {cells:?} {idealization:?} {poissons_ratio}: {values:?}"
                );
                assert!(values[zeros] > 1e-6 * greatest, "{}", values[zeros] / greatest);
                for rigid in [|_, _| [1.0, 0.0], |_, _| [0.0, 1.0], |x: f64, y: f64| [-y, x]] {
                    let motion: Vec<f64> = mesh.coordinates.iter().flat_map(|&[x, y]| rigid(x, y)).collect();
                    let motion = Mat::from_fn(motion.len(), 1, |i, _| motion[i]);
                    let force = (&stiffness * motion).norm_max();
                    assert!(force < 1e-13 * greatest, "{force:e}");
                }
            }
        }
    }
}

/// Goal: uniform pressure crosses the interface of two blocks exactly, node by node.
/// Mesh: two distorted blocks, one on the other, nodes of the interface unevenly spaced; supports: rollers under the
/// lower one (height 1) and on the upper one (height 0.7, half as stiff), which comes down by 0.01; sides free.
/// Exact: p = 0.01/(1/E1' + 0.7/E2').
#[test]
fn uniform_pressure_crosses_the_interface() {
    const APPROACH: f64 = 0.01;
    let mut worst: f64 = 0.0;
    for element in ELEMENTS {
        for idealization in Idealization::ALL {
            let mut total = Vec::new();
            let mut initial_gaps = Vec::new();
            let mut spans = Vec::new();
            let mut softness = 0.0;
            for (height, modulus, poissons_ratio) in [(1.0, 1.0, 0.3), (0.7, 0.5, 0.2)] {
                let uneven = |x: f64| x + 0.3 * x * (1.0 - x);
                let mesh = PlaneMesh::new(element, (5, 4), |x, y| {
                    let inside = 4.0 * y * (1.0 - y) * x * (1.0 - x);
                    [uneven(x) + 0.1 * inside * y, height * (y + 0.2 * inside * x)]
                });
                // Row 0 is the interface: its unknowns along the normal (y) come last.
                let top = 2 * mesh.cells.1;
                let mut unknowns = vec![SUPPORTED; 2 * mesh.node_count()];
                let (mut count, mut ring_start) = (0, 0);
                for on_interface in [false, true] {
                    ring_start = count;
                    for (dof, unknown) in unknowns.iter_mut().enumerate() {
                        let (column, row) = mesh.grid[dof / 2];
                        let supported = row == top && (dof % 2 == 1 || column == 0);
                        if !supported && (row == 0 && dof % 2 == 1) == on_interface {
                            *unknown = count as u32;
                            count += 1;
                        }
                    }
                }
                let elasticity: Elasticity<f64> = Elasticity::new(idealization, poissons_ratio);
                let assembly = Assembly::new(element, &mesh.connectivity, &unknowns, count);
                let values: Vec<f64> = assembly.stiffness_values(&elasticity, &mesh.coordinates).unwrap();
                let analysis = CholeskyAnalysis::new(assembly.matrix(&values)).unwrap();
                let compliance =
                    by_cholesky(&assembly, &analysis, ring_start, &elasticity, &mesh.coordinates).unwrap();
                total.resize(compliance.values.len(), 0.0);
                total.iter_mut().zip(&compliance.values).for_each(|(sum, value)| *sum += value / modulus);
                initial_gaps = vec![-APPROACH; compliance.size];
                spans = (0..mesh.node_count())
                    .filter(|&node| mesh.grid[node].1 == 0)
                    .map(|node| mesh.coordinates[node][0])
                    .collect::<Vec<f64>>();
                softness += height / (modulus * idealization.plane_modulus_ratio(poissons_ratio));
            }
            let contact = solve_nodal_contact(&total, &initial_gaps, 10);
            assert_eq!(contact.outcome, ActiveSetOutcome::Settled);
            let pressure = APPROACH / softness;
            let expected = uniform_load(element, &spans);
            assert_eq!(contact.forces.len(), expected.len());
            for (force, expected) in contact.forces.iter().zip(&expected) {
                let error = (force / (pressure * expected) - 1.0).abs();
                worst = worst.max(error);
                // Rounding times the condition of K and of the compliance: measured at most 1e-14.
                assert!(error < 1e-11, "{element:?} {force} {expected}");
            }
            assert!(contact.gaps.iter().all(|gap| gap.abs() < 1e-15), "{:?}", contact.gaps);
        }
    }
    println!("contact patch: nodal forces within {worst:.0e}");
}

/// Nodal forces of unit pressure along a straight line of nodes at `places`.
fn uniform_load(element: ElementKind, places: &[f64]) -> Vec<f64> {
    let shares: &[f64] = match element {
        ElementKind::Quad4 => &[1.0 / 2.0, 1.0 / 2.0],
        ElementKind::Quad8 => &[1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0],
    };
    let mut load = vec![0.0; places.len()];
    for first in (0..places.len() - 1).step_by(shares.len() - 1) {
        let length = places[first + shares.len() - 1] - places[first];
        shares.iter().enumerate().for_each(|(i, share)| load[first + i] += share * length);
    }
    load
}
