//! Assembly, Cholesky and conjugate gradients: against each other, against their own claims, and when they fail.

use std::f64::consts::PI;

use crate::common::greatest::{self, greatest};
use crate::common::meshes::{ELEMENTS, PlaneMesh, scatter};
use crate::common::ring_loads::ring_displacement;
use crate::common::rings::{MeshedBody, body};
use jointsweep::internals::mechanics::assembly::{Assembly, AssemblyError, Csr};
use jointsweep::internals::mechanics::compliance::RingCompliance;
use jointsweep::internals::mechanics::compliance::condense::variational_compliance;
use jointsweep::internals::mechanics::contact_grading::contact_grading;
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::element::stiffness::Elasticity;
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::mechanics::mesh::SUPPORTED;
use jointsweep::internals::mechanics::real::Real;
use jointsweep::internals::mechanics::solve::cholesky::{CholeskyAnalysis, CholeskyError};
use jointsweep::internals::mechanics::solve::pcg::{ALLOWED_DRIFT, PcgOutcome, PcgReport, PcgSettings, pcg};

/// An annulus of ratio 3, graded for contact from 5 degrees up with `q` ring elements in every angle.
fn plate(element: ElementKind, q: f64, idealization: Idealization, poissons_ratio: f64) -> MeshedBody {
    let body = body("annulus", &[3.0], idealization, poissons_ratio);
    MeshedBody::new(&body, &contact_grading(element, 5f64.to_radians(), q, PI, 2.0))
}

/// The greatest difference over the greatest value.
fn difference(a: &RingCompliance, b: &RingCompliance) -> f64 {
    greatest::difference(&a.values, &b.values)
}

/// The energy of a pressure that falls to zero at 40 degrees, from a compliance.
fn pressure_energy(meshed: &MeshedBody, compliance: &RingCompliance) -> f64 {
    let topology = &meshed.topology;
    let mut load = meshed.unit_pressure();
    for (&node, angle) in topology.ring_nodes.iter().zip(&topology.ring_angles) {
        let pressure = (1.0 - (angle / 40f64.to_radians()).powi(2)).max(0.0).sqrt();
        for component in 0..2 {
            let unknown = topology.unknowns[2 * node as usize + component];
            if unknown != SUPPORTED {
                load[unknown as usize - topology.ring_start] *= pressure;
            }
        }
    }
    0.5 * ring_displacement(compliance, &load).iter().zip(&load).map(|(u, f)| u * f).sum::<f64>()
}

/// Columns of unit forces on the ring's unknowns.
fn ring_loads(meshed: &MeshedBody) -> Vec<f64> {
    let (unknowns, ring_start) = (meshed.topology.unknown_count, meshed.topology.ring_start);
    let mut loads = vec![0.0; unknowns * (unknowns - ring_start)];
    (ring_start..unknowns).for_each(|unknown| loads[(unknown - ring_start) * unknowns + unknown] = 1.0);
    loads
}

/// The ring's compliance by conjugate gradients in the precision `T`, corrected in f64, and how each column was reached: a stagnated one
/// is no error, because the correction uses its true residual.
fn by_pcg<T: Real + PartialOrd + Into<f64>>(
    meshed: &MeshedBody,
    settings: &PcgSettings,
) -> (RingCompliance, Vec<PcgReport>) {
    let exact = meshed.stiffness_values();
    let exact = meshed.assembly.matrix(&exact);
    let values: Vec<T> = meshed.assembly.stiffness_values(&meshed.elasticity, &meshed.coordinates).unwrap();
    let solution = pcg(meshed.assembly.matrix(&values), exact, &ring_loads(meshed), settings);
    let columns: Vec<f64> = solution.columns.into_iter().map(Into::into).collect();
    (variational_compliance(exact, meshed.topology.ring_start, &columns), solution.reports)
}

/// Goal: conjugate gradients in f64 and Cholesky find the same compliance.
#[test]
fn conjugate_gradients_agree_with_cholesky() {
    for element in ELEMENTS {
        let meshed = plate(element, 3.0, Idealization::PlaneStress, 0.3);
        let exact = meshed.condense();
        let settings = PcgSettings { tolerance: 1e-9, iteration_limit: 5000 };
        let (found, reports) = by_pcg::<f64>(&meshed, &settings);
        let error = difference(&found, &exact);
        println!("{element:?}: {error:.0e}");
        // The residual squared, by the correction, is far below rounding: measured 1e-13.
        assert!(error < 1e-11);
        assert_eq!(reports.len(), meshed.topology.ring_unknown_count());
        assert!(reports.iter().all(|report| report.outcome == PcgOutcome::Converged));
    }
}

/// Goal: with the variational correction errors fall as the square of the residual, without it as the residual.
#[test]
fn the_correction_squares_the_error_of_f32_columns() {
    for element in ELEMENTS {
        let meshed = plate(element, 3.0, Idealization::PlaneStress, 0.3);
        let exact = meshed.condense();
        let values = meshed.stiffness_values();
        let values_f32: Vec<f32> =
            meshed.assembly.stiffness_values(&meshed.elasticity, &meshed.coordinates).unwrap();
        let matrix = meshed.assembly.matrix(&values);
        let (unknowns, ring_start) = (meshed.topology.unknown_count, meshed.topology.ring_start);
        let mut errors = Vec::new();
        for tolerance in [1e-2, 1e-3] {
            let settings = PcgSettings { tolerance, iteration_limit: 5000 };
            let solution = pcg(meshed.assembly.matrix(&values_f32), matrix, &ring_loads(&meshed), &settings);
            assert_eq!(solution.reports.len(), unknowns - ring_start);
            assert!(solution.reports.iter().all(|report| report.outcome == PcgOutcome::Converged));
            let columns: Vec<f64> = solution.columns.into_iter().map(f64::from).collect();
            let plain = RingCompliance {
                size: unknowns - ring_start,
                values: columns
                    .chunks_exact(unknowns)
                    .flat_map(|column| &column[ring_start..])
                    .copied()
                    .collect(),
            };
            let corrected = variational_compliance(matrix, ring_start, &columns);
            let energy = |compliance| {
                (pressure_energy(&meshed, compliance) / pressure_energy(&meshed, &exact) - 1.0).abs()
            };
            println!(
                "{element:?} {unknowns} unknowns, residual {tolerance:.0e}: compliance {:.1e} plain, {:.1e} corrected; \
                 energy {:.1e} plain, {:.1e} corrected",
                difference(&plain, &exact),
                difference(&corrected, &exact),
                energy(&plain),
                energy(&corrected)
            );
            // Measured 0.4 to 0.7 times the tolerance, and 1.1 to 4 times its square (energy: up to 5 times).
            assert!(difference(&plain, &exact) > 0.1 * tolerance);
            assert!(difference(&corrected, &exact) < 8.0 * tolerance * tolerance);
            assert!(energy(&corrected) < 10.0 * tolerance * tolerance);
            errors.push([difference(&plain, &exact), difference(&corrected, &exact)]);
        }
        let [by_plain, by_corrected] = [0, 1].map(|i| (errors[0][i] / errors[1][i]).log10());
        println!("{element:?}: order {by_plain:.2} plain, {by_corrected:.2} corrected");
        assert!((by_plain - 1.0).abs() < 0.3 && (by_corrected - 2.0).abs() < 0.4);
    }
}

/// Goal: where f32 cannot reach the tolerance, the report says so although the recursion believes it has; and the
/// correction still makes a good compliance of such columns. Plane strain, nu = 0.49.
#[test]
fn stagnation_in_f32_is_reported() {
    let meshed = plate(ElementKind::Quad4, 4.0, Idealization::PlaneStrain, 0.49);
    let settings = PcgSettings { tolerance: 1e-6, iteration_limit: 5000 };
    let (found, reports) = by_pcg::<f32>(&meshed, &settings);
    for report in &reports {
        assert!(report.recursive_residual <= settings.tolerance * (1.0 + 1e-6), "{report:?}");
        assert!(report.true_residual > ALLOWED_DRIFT * settings.tolerance, "{report:?}");
        assert_eq!(report.outcome, PcgOutcome::Stagnated);
    }
    let worst = greatest(reports.iter().map(|report| report.true_residual));
    let error = difference(&found, &meshed.condense());
    println!("true residual up to {worst:.1e} at tolerance 1e-6; corrected compliance within {error:.0e}");
    assert!(error < 1e-7);
}

/// Goal: the residual reported is |b - K x|/|b|, |v|^2 = sum v^2/diag K; here K x is summed element by element.
#[test]
fn the_reported_residual_is_the_true_one() {
    let meshed = plate(ElementKind::Quad8, 2.0, Idealization::PlaneStress, 0.3);
    let values = meshed.stiffness_values();
    let matrix = meshed.assembly.matrix(&values);
    let values_f32: Vec<f32> =
        meshed.assembly.stiffness_values(&meshed.elasticity, &meshed.coordinates).unwrap();
    let load: Vec<f64> = (0..matrix.row_count()).map(|row| scatter(row as u64)).collect();
    let diagonal = matrix.diagonal();
    let norm = |v: &[f64]| v.iter().zip(&diagonal).map(|(v, d)| v * v / d).sum::<f64>().sqrt();
    let check = |x: Vec<f64>, reported: f64| {
        let displacement: Vec<f64> = meshed
            .topology
            .unknowns
            .iter()
            .map(|&unknown| if unknown == SUPPORTED { 0.0 } else { x[unknown as usize] })
            .collect();
        let force =
            meshed.assembly.internal_force(&meshed.elasticity, &meshed.coordinates, &displacement).unwrap();
        let mut residual = load.clone();
        for (dof, &unknown) in meshed.topology.unknowns.iter().enumerate().filter(|(_, u)| **u != SUPPORTED) {
            residual[unknown as usize] -= force[dof];
        }
        let expected = norm(&residual) / norm(&load);
        // Rounding of K x, 1e-16 |K| |x|, against the residual: measured below 1e-11 of it.
        println!("reported {reported:.3e}, off by {:.0e} of it", reported / expected - 1.0);
        assert!((reported / expected - 1.0).abs() < 1e-6, "{reported:e} {expected:e}");
    };
    let settings = PcgSettings { tolerance: 1e-4, iteration_limit: 5000 };
    let found = pcg(matrix, matrix, &load, &settings);
    check(found.columns, found.reports[0].true_residual);
    let found = pcg(meshed.assembly.matrix(&values_f32), matrix, &load, &settings);
    check(found.columns.into_iter().map(f64::from).collect(), found.reports[0].true_residual);
}

const SMALL_ROWS: [u32; 4] = [0, 2, 4, 5];
const SMALL_COLUMNS: [u32; 5] = [0, 1, 0, 1, 2];

/// [a b 0; b a 0; 0 0 c].
fn small<T>(values: &[T]) -> Csr<'_, T> {
    Csr { row_starts: &SMALL_ROWS, columns: &SMALL_COLUMNS, values }
}

/// Goal: every way to fail has its name.
#[test]
fn failures_are_told_apart() {
    let settings = PcgSettings { tolerance: 1e-10, iteration_limit: 50 };
    let end = |values: [f64; 5], load: [f64; 3], settings: &PcgSettings| {
        let values_f32 = values.map(|value| value as f32);
        let report = pcg(small(&values), small(&values), &load, settings).reports[0];
        let coarse = PcgSettings { tolerance: 1e-5, ..*settings };
        let in_f32 = pcg(small(&values_f32), small(&values), &load, &coarse).reports[0];
        assert_eq!(report.outcome, in_f32.outcome);
        report
    };
    let good = [2.0, 1.0, 1.0, 2.0, 3.0];
    let solved = end(good, [1.0, 2.0, 3.0], &settings);
    assert_eq!(solved.outcome, PcgOutcome::Converged);
    assert!(solved.iterations <= 3 && solved.true_residual < 1e-10);
    let nothing = end(good, [0.0; 3], &settings);
    assert_eq!((nothing.outcome, nothing.iterations, nothing.true_residual), (PcgOutcome::Converged, 0, 0.0));
    assert_eq!(end([1.0, 2.0, 2.0, 1.0, 3.0], [1.0, -1.0, 0.0], &settings).outcome, PcgOutcome::Indefinite);
    assert_eq!(end([2.0, 1.0, 1.0, 2.0, -3.0], [1.0, 2.0, 3.0], &settings).outcome, PcgOutcome::Indefinite);
    assert_eq!(end([2.0, 1.0, 1.0, 2.0, 0.0], [1.0, 2.0, 3.0], &settings).outcome, PcgOutcome::Indefinite);
    assert_eq!(
        end([2.0, f64::NAN, 1.0, 2.0, 3.0], [1.0, 2.0, 3.0], &settings).outcome,
        PcgOutcome::NotFinite
    );
    assert_eq!(
        end([f64::NAN, 1.0, 1.0, 2.0, 3.0], [1.0, 2.0, 3.0], &settings).outcome,
        PcgOutcome::NotFinite
    );
    assert_eq!(end(good, [1.0, f64::NAN, 3.0], &settings).outcome, PcgOutcome::NotFinite);
    let short = PcgSettings { iteration_limit: 1, ..settings };
    let limited = end(good, [1.0, 2.0, 3.0], &short);
    assert_eq!((limited.outcome, limited.iterations), (PcgOutcome::IterationLimit, 1));
    assert!(limited.true_residual > 1e-3);

    let analysis = CholeskyAnalysis::new(small(&good)).unwrap();
    let factorize = |values: [f64; 5]| analysis.factorize(small(&values)).err();
    assert_eq!(factorize(good), None);
    for bad in [[1.0, 2.0, 2.0, 1.0, 3.0], [2.0, f64::NAN, f64::NAN, 2.0, 3.0], [2.0, 1.0, 1.0, 2.0, 0.0]] {
        assert!(matches!(factorize(bad), Some(CholeskyError::NotPositiveDefinite { .. })), "{bad:?}");
    }

    let meshed = plate(ElementKind::Quad4, 2.0, Idealization::PlaneStress, 0.3);
    let (_, stopped) = by_pcg::<f64>(&meshed, &short);
    assert!(stopped.iter().all(|report| report.outcome == PcgOutcome::IterationLimit));
    // A whole body that is not positive definite or not a number, where faer works in blocks of columns.
    let values = meshed.stiffness_values();
    let analysis = CholeskyAnalysis::new(meshed.assembly.matrix(&values)).unwrap();
    for spoil in [|value: f64| -value, |value: f64| value * f64::NAN] {
        let spoilt: Vec<f64> = values.iter().map(|&value| spoil(value)).collect();
        let error = analysis.factorize(meshed.assembly.matrix(&spoilt)).err();
        assert!(matches!(error, Some(CholeskyError::NotPositiveDefinite { .. })));
    }
}

/// Goal: assembly repeats bit for bit, is symmetric bit for bit, and K u is the sum of its elements' forces.
#[test]
fn assembly_gathers_every_element_once() {
    for element in ELEMENTS {
        let meshed = plate(element, 2.0, Idealization::PlaneStrain, 0.3);
        let again = plate(element, 2.0, Idealization::PlaneStrain, 0.3);
        let values = meshed.stiffness_values();
        assert_eq!(values, again.stiffness_values());
        let matrix = meshed.assembly.matrix(&values);
        for row in 0..matrix.row_count() {
            for (column, value) in matrix.row(row) {
                assert_eq!(matrix.row(column).find(|(other, _)| *other == row), Some((row, value)));
            }
        }
        let x: Vec<f64> = (0..matrix.row_count()).map(|row| scatter(row as u64)).collect();
        let mut product = vec![0.0; x.len()];
        matrix.multiply(&x, &mut product);
        let unknowns = &meshed.topology.unknowns;
        let displacement: Vec<f64> =
            unknowns.iter().map(|&u| if u == SUPPORTED { 0.0 } else { x[u as usize] }).collect();
        let force =
            meshed.assembly.internal_force(&meshed.elasticity, &meshed.coordinates, &displacement).unwrap();
        for (dof, &unknown) in unknowns.iter().enumerate().filter(|(_, unknown)| **unknown != SUPPORTED) {
            // Rounding of sums of terms of size one to ten.
            assert!((product[unknown as usize] - force[dof]).abs() < 1e-13);
        }
    }
}

/// Goal: in f32 small elements keep their shape, wherever the body lies. 1 % of f32's digits would be left of
/// coordinates subtracted in f32 here.
#[test]
fn f32_assembly_keeps_small_elements() {
    for element in ELEMENTS {
        let size = 1e-3;
        let near = PlaneMesh::new(element, (3, 3), |x, y| [size * (x + 0.1 * y), size * y]);
        let (unknowns, count) = near.unknowns(|dof| dof < 4);
        let assembly = Assembly::new(element, &near.connectivity, &unknowns, count);
        let elasticity = Elasticity::new(Idealization::PlaneStress, 0.3);
        let far: Vec<[f64; 2]> = near.coordinates.iter().map(|[x, y]| [x + 100.0, y - 100.0]).collect();
        let exact: Vec<f64> = assembly.stiffness_values(&elasticity, &near.coordinates).unwrap();
        let found: Vec<f32> = assembly.stiffness_values(&elasticity, &far).unwrap();
        assert_eq!(found.len(), exact.len());
        let worst = greatest(exact.iter().zip(&found).map(|(a, &b)| a - f64::from(b)));
        println!("{element:?}: f32 values within {worst:.0e}");
        // A few roundings of f32 (6e-8) in entries of size one: measured 7e-7.
        assert!(worst < 2e-6, "{worst:e}");
    }
}

/// Goal: a mesh without a meaning is an error that says where.
#[test]
fn broken_meshes_are_refused() {
    for element in ELEMENTS {
        let mesh = PlaneMesh::new(element, (2, 2), |x, y| [x, y]);
        let (unknowns, count) = mesh.unknowns(|dof| dof < 4);
        let assembly = Assembly::new(element, &mesh.connectivity, &unknowns, count);
        let elasticity = Elasticity::new(Idealization::PlaneStress, 0.3);
        let values = |coordinates: &[[f64; 2]]| assembly.stiffness_values::<f64>(&elasticity, coordinates);
        assert!(values(&mesh.coordinates).is_ok());
        let mirrored: Vec<[f64; 2]> = mesh.coordinates.iter().map(|[x, y]| [-x, *y]).collect();
        assert!(matches!(values(&mirrored), Err(AssemblyError::InvertedElement { element: 0, .. })));
        let flat: Vec<[f64; 2]> = mesh.coordinates.iter().map(|[x, _]| [*x, 0.0]).collect();
        assert!(matches!(values(&flat), Err(AssemblyError::InvertedElement { element: 0 })));
        let mut missing = mesh.coordinates.clone();
        missing[5][1] = f64::NAN;
        assert!(matches!(values(&missing), Err(AssemblyError::CoordinateNotFinite { node: 5, .. })));
        missing[5][1] = f64::INFINITY;
        assert!(matches!(values(&missing), Err(AssemblyError::CoordinateNotFinite { node: 5, .. })));
        assert!(assembly.internal_force(&elasticity, &missing, &vec![0.0; unknowns.len()]).is_err());
    }
}
