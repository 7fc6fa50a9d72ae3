//! Stage by stage, and all together.

use super::*;

#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn coordinates_are_those_of_the_twin() {
    for (name, bodies) in families().iter().chain(&blocks()) {
        for (precision, rounding) in precisions() {
            let batch = bodies.batch(precision);
            let geometry = batch.assemble(&bodies.layout, &bodies.numbers()).unwrap();
            let reaches = batch.read_reaches(&geometry).unwrap();
            let ring = ring_points(&bodies.grading);
            let grid = reaches.len() / bodies.count();
            assert_eq!(grid, (2 * bodies.meshed[0].topology.layer_count + 1) * ring.len());
            for (meshed, reaches) in bodies.meshed.iter().zip(reaches.chunks_exact(grid)) {
                let topology = &meshed.topology;
                assert_eq!(meshed.coordinates.len(), topology.grid.len());
                let mut errors = Vec::new();
                for (place, &(row, column)) in meshed.coordinates.iter().zip(&topology.grid) {
                    let reach = reaches[row * ring.len() + column];
                    let far = reaches[reaches.len() - ring.len() + column];
                    for axis in 0..2 {
                        let expected = place[axis] - ring[column][axis];
                        errors.push((reach[axis] - expected) / far[0].hypot(far[1]));
                    }
                }
                let worst = greatest(errors);
                println!("{name} {precision:?}: {worst:.1e}");
                // Some ten operations a number, over the length of its line.
                assert!(worst < 40.0 * rounding, "{name} {precision:?}: {worst:e}");
            }
        }
    }
}

#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn matrices_are_those_of_the_twin() {
    for (name, bodies) in families().iter().chain(&blocks()) {
        for (precision, rounding) in precisions() {
            let batch = bodies.batch(precision);
            batch.assemble(&bodies.layout, &bodies.numbers()).unwrap();
            let found = batch.read_values().unwrap();
            let expected: Vec<Vec<f64>> = bodies.meshed.iter().map(MeshedBody::stiffness_values).collect();
            assert_eq!(found.len(), bodies.value_count() * expected.len());
            for (found, expected) in found.chunks_exact(bodies.value_count()).zip(&expected) {
                let worst = difference(found, expected);
                println!("{name} {precision:?}: {worst:.1e}");
                // Some thirty operations a value, and coordinates of an element that are good to ten roundings; and the
                // twin subtracts coordinates of about 1 in elements as thin as the thinnest layer.
                let Layers { first, shrinking, .. } = bodies.grading.layers;
                let thinnest = first * SHRINK.powi(shrinking as i32);
                let allowed = 40.0 * rounding + 2.0 * f64::EPSILON / thinnest;
                assert!(worst < allowed, "{name} {precision:?}: {worst:e}");
            }
            // Control: what is compared differs from body to body by far more.
            assert!(difference(&expected[0], &expected[1]) > 1e-2, "{name}");
        }
    }
}

#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn conjugate_gradients_are_those_of_the_twin() {
    let pins = [0.3, 0.1, 0.49].map(|nu| body("rigid-midplane", &[], Idealization::PlaneStrain, nu));
    let pins = Bodies::new(pins.to_vec(), 1);
    // The last block has a system without a load.
    assert_ne!(pins.layout.systems.ring_count() % 4, 0);
    for bodies in [plates(), pins] {
        as_the_twin(&bodies);
    }
}

fn as_the_twin(bodies: &Bodies) {
    let unknowns = bodies.layout.systems.unknown_count();
    let ring = bodies.layout.systems.ring_count();
    for (precision, rounding) in precisions() {
        let settings = match precision {
            Precision::F32 => plain(1e-4, 1000),
            Precision::F64 => plain(1e-9, 1000),
            // Three rounds.
            Precision::Mixed => {
                RefineSettings { tolerance: 1e-3, goal: 2e-9, round_limit: 4, iteration_limit: 1000 }
            }
        };
        let values = bodies.values(precision);
        let batch = bodies.batch(precision);
        batch.write_values(&values).unwrap();
        batch.pcg(&settings, 40).unwrap();
        batch.condense().unwrap();
        let (columns, reports) = (batch.read_columns().unwrap(), batch.read_reports().unwrap());
        let mut counts = Vec::new();
        for index in 0..bodies.count() {
            let own_values = of_body(&values, bodies, index);
            let (expected, expected_reports) = twin(bodies, own_values, precision, &settings);
            let found = of_body(&columns, bodies, index);
            let states = of_body(&reports.states, bodies, index);
            let true_residuals = of_body(&reports.true_residuals, bodies, index);
            assert_eq!(expected_reports.len(), ring);
            for (system, report) in expected_reports.iter().enumerate() {
                let state = states[system];
                assert_eq!(state.outcome(), Some(expected_outcome(report)), "{precision:?} {index} {system}");
                // A sum rounded otherwise may tip a step over the tolerance, and a second round begins with a residual
                // rounded otherwise: where f32 is at its end (nu = 0.49) that was seen to change 8 % of the steps, in one round 8 of 155.
                let iterations = state.iterations as usize;
                let allowed = report.iterations / if settings.round_limit == 0 { 15 } else { 10 };
                assert!(iterations.abs_diff(report.iterations) <= 3 + allowed, "{iterations} {report:?}");
                counts.push(iterations);
                // The kernel takes the residual of a rounded x in its own precision. What a last round of refinement leaves
                // below the goal is a matter of rounding: a factor of two was seen, and so is the last step of a round.
                let norm = true_residuals[system];
                let is_alike = if settings.round_limit == 0 {
                    (norm - report.true_residual).abs() < 2.0 * report.true_residual + 1e3 * rounding
                } else {
                    norm.max(report.true_residual) <= settings.goal
                };
                assert!(is_alike, "{norm} {report:?}");
            }
            // Beyond the ring's unknowns there is nothing to solve.
            for (system, state) in states.iter().enumerate().skip(ring) {
                assert_eq!((state.outcome(), state.iterations), (Some(SystemOutcome::Converged), 0));
                assert!(found[system * unknowns..(system + 1) * unknowns].iter().all(|x| *x == 0.0));
            }
            let worst = difference(&found[..ring * unknowns], &expected);
            println!("{precision:?} body {index}: {worst:.1e}, {} steps", states[0].iterations);
            // Both are within the tolerance of the same solution, in a norm that bounds the greatest entry.
            assert!(worst < 5.0 * settings.goal, "{precision:?} {index}: {worst:e}");
        }
        let (least, most) = (counts.iter().min().unwrap(), counts.iter().max().unwrap());
        println!("{precision:?}: {least} to {most} steps");
        assert!(*most as f64 > 1.5 * *least as f64, "all systems stop at once: {least} {most}");
    }
}

/// The condensation alone: the same columns on both sides.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn compliances_are_those_of_the_twin() {
    let bodies = plates();
    let systems = &bodies.layout.systems;
    for (precision, rounding) in precisions() {
        // With a rest large enough to see the correction.
        let settings = plain(1e-2, 1000);
        let values = bodies.values(precision);
        let batch = bodies.batch(precision);
        batch.write_values(&values).unwrap();
        batch.pcg(&settings, 40).unwrap();
        batch.condense().unwrap();
        let (columns, found) = (batch.read_columns().unwrap(), batch.read_compliance().unwrap());
        for index in 0..bodies.count() {
            let exact = bodies.meshed[0].assembly.matrix(of_body(&values, &bodies, index));
            let columns =
                &of_body(&columns, &bodies, index)[..systems.ring_count() * systems.unknown_count()];
            let expected = variational_compliance(exact, systems.ring_start as usize, columns).values;
            let found = of_body(&found, &bodies, index);
            let worst = difference(found, &expected);
            println!("{precision:?} body {index}: {worst:.1e}");
            // K x cancels: |K||x| is some hundred times |b|, rounded once an entry.
            assert!(worst < 100.0 * rounding, "{precision:?} {index}: {worst:e}");
            for i in 0..systems.ring_count() {
                for j in 0..i {
                    let (a, b) = (found[i * systems.ring_count() + j], found[j * systems.ring_count() + i]);
                    assert!((a - b).abs() <= 4.0 * rounding * greatest(expected.iter().copied()));
                }
            }
        }
        // Control: without the correction the columns themselves are off by far more.
        let plain: Vec<f64> = (0..systems.ring_count())
            .flat_map(|j| {
                let column = &columns[j * systems.unknown_count()..(j + 1) * systems.unknown_count()];
                column[systems.ring_start as usize..].to_vec()
            })
            .collect();
        assert!(difference(of_body(&found, &bodies, 0), &plain) > 1e-4);
    }
}

/// From a few numbers a body to the compliance of its ring, as far as the settings promise, against sparse Cholesky in
/// f64.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn the_whole_chain_gives_the_compliance_of_cholesky() {
    // The workgroup's memory does not suffice for all vectors on finer meshes.
    let levels = if is_long() { 3..5 } else { 3..4 };
    let fine = levels.map(|level| {
        let plate = body("annulus", &[2.9], Idealization::PlaneStrain, 0.3);
        ("fine annulus", Bodies::new(vec![plate], level))
    });
    let fine: Vec<(&str, Bodies)> = fine.collect();
    let mut on_chip = HashSet::new();
    for (number, (name, bodies)) in iterated_families().iter().chain(&fine).enumerate() {
        for (precision, rounding) in precisions() {
            let promised = match precision {
                // Its stiffness is far larger than what its ring feels of it.
                Precision::F32 if *name == "block on its base" => 1e-3,
                Precision::F32 => 2e-4,
                Precision::Mixed => 1e-8,
                Precision::F64 => 1e-10,
            };
            let of_its_own;
            let Condensed { batch, compliance: found, columns, reports } = if number < FAMILY_COUNT {
                condensed_family(number, precision)
            } else {
                of_its_own = Condensed::new(bodies, precision, &precision.settings());
                &of_its_own
            };
            on_chip.insert(batch.on_chip().vectors);
            for (index, meshed) in bodies.meshed.iter().enumerate() {
                let expected = meshed.condense().values;
                let worst = difference(of_body(found, bodies, index), &expected);
                assert!(worst < promised, "{name} {precision:?} {index}: {worst:e}");
                // The values of K alone, good to some roundings, change C by that part of |U|^T |K| |U|; and the error
                // of the columns counts by its square, in a norm of which ten were measured.
                let energy = absolute_energy(meshed, of_body(columns, bodies, index));
                let share = energy / greatest(expected.iter().copied());
                let residual = greatest(of_body(&reports.true_residuals, bodies, index).iter().copied());
                let allowed = 4.0 * rounding * share + 10.0 * residual * residual;
                println!("{name} {precision:?} body {index}: {worst:.1e} of {allowed:.1e}");
                assert!(worst < allowed, "{name} {precision:?} {index}: {worst:e}");
                let ring = bodies.layout.systems.ring_count();
                for state in &of_body(&reports.states, bodies, index)[..ring] {
                    assert_eq!(state.outcome(), Some(SystemOutcome::Converged), "{name} {precision:?}");
                }
            }
        }
    }
    println!("{on_chip:?} vectors on chip");
    assert!(on_chip.len() > 1, "{on_chip:?}");
}

/// Nearly incompressible plane strain, where f32 is unusable: mixed precision gets there by its rounds, and what does
/// not get there says so.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn mixed_precision_reaches_the_nearly_incompressible() {
    // Without f64 there is no mixed precision: a device is refused it (`what_cannot_be_had_is_an_error`).
    if precisions().len() == 1 {
        return;
    }
    let ratios = [0.499, 0.4999];
    let concentric =
        families_at(0, [0, 0], &ratios).into_iter().filter(|(name, _)| !name.starts_with("block"));
    for (name, bodies) in concentric {
        let settings = Precision::Mixed.settings();
        let few = RefineSettings { round_limit: 0, ..settings };
        let refined = Condensed::new(&bodies, Precision::Mixed, &settings);
        let unrefined = Condensed::new(&bodies, Precision::Mixed, &few);
        let narrow = Condensed::new(&bodies, Precision::F32, &Precision::F32.settings());
        for (index, nu) in ratios.iter().enumerate() {
            let expected = bodies.meshed[index].condense().values;
            let [error, without, in_f32] = [&refined, &unrefined, &narrow]
                .map(|found| difference(of_body(&found.compliance, &bodies, index), &expected));
            println!("{name} nu {nu}: {error:.1e}, {without:.1e} in one round, {in_f32:.1e} in f32");
            assert!(error < 1e-8, "{name} {nu}: {error:e}");
            // Control: the rounds are what does it.
            assert!(without > 5.0 * error && in_f32 > 1e-5, "{name} {nu}: {without:e} {in_f32:e}");
            let ring = bodies.layout.systems.ring_count();
            for system in 0..ring {
                let outcome = |reports: &SystemReports| {
                    let state = of_body(&reports.states, &bodies, index)[system];
                    (state.outcome().unwrap(), of_body(&reports.true_residuals, &bodies, index)[system])
                };
                let (ended, residual) = outcome(&refined.reports);
                assert!(
                    ended == SystemOutcome::Converged && residual <= settings.goal,
                    "{ended:?} {residual}"
                );
                for (reports, goal) in
                    [(&unrefined.reports, settings.goal), (&narrow.reports, Precision::F32.settings().goal)]
                {
                    let (ended, residual) = outcome(reports);
                    let expected =
                        if residual <= goal { SystemOutcome::Converged } else { SystemOutcome::Stagnated };
                    assert_eq!(ended, expected, "{name} {nu} {residual}");
                }
            }
            let stagnated = of_body(&unrefined.reports.states, &bodies, index)[..ring]
                .iter()
                .filter(|state| state.outcome() == Some(SystemOutcome::Stagnated));
            assert!(stagnated.count() > ring / 2, "{name} {nu}");
        }
    }
}

/// The greatest |u|^T |K| |u| of any column u.
fn absolute_energy(meshed: &MeshedBody, columns: &[f64]) -> f64 {
    let values: Vec<f64> = meshed.stiffness_values().iter().map(|value| value.abs()).collect();
    let matrix = meshed.assembly.matrix(&values);
    let mut product = vec![0.0; matrix.row_count()];
    let energies = columns.chunks_exact(matrix.row_count()).map(|column| {
        let sizes: Vec<f64> = column.iter().map(|u| u.abs()).collect();
        matrix.multiply(&sizes, &mut product);
        sizes.iter().zip(&product).map(|(u, force)| u * force).sum()
    });
    greatest(energies)
}
