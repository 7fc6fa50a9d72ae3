//! What must not matter, and what goes wrong: company, resuming, workgroups, bad systems, bad meshes, refusals.

use jointsweep::internals::engine::backend::gpu::works::ModeLoads;
use jointsweep::internals::mechanics::compliance::ring_modes::{Push, RingModes};

use super::*;

/// The works of eight modes of a whole ring on the bodies of a batch that was condensed.
fn works_of_eight(kernels: &Kernels, batch: &SystemBatch, bodies: &Bodies) -> Vec<Option<Vec<f64>>> {
    let pushes = Push::of(bodies.bodies[0].shape.side);
    let loads = ModeLoads::new(kernels, &RingModes::whole(6, 8), pushes, &bodies.meshed[0].topology).unwrap();
    let works = batch.works(&loads).unwrap();
    assert_eq!(works.len(), bodies.count());
    works.into_iter().map(|works| works.map(|works| works.works)).collect()
}

/// How steps are split over dispatches, and who else is in the batch, does not change a bit.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn resuming_and_company_do_not_change_a_bit() {
    let bodies = plates();
    for (precision, _) in precisions() {
        let settings = plain(1e-4, 300);
        let values = bodies.values(precision);
        let solve = |values: &[f64], count: usize, steps: u32| {
            let batch = SystemBatch::new(kernels(precision), &bodies.layout.systems, count).unwrap();
            batch.write_values(values).unwrap();
            batch.pcg(&settings, steps).unwrap();
            (batch.read_columns().unwrap(), batch.read_reports().unwrap().states)
        };
        let (together, states) = solve(&values, bodies.count(), 300);
        for steps in [1, 7, 50] {
            assert!(solve(&values, bodies.count(), steps) == (together.clone(), states.clone()), "{steps}");
        }
        let last = bodies.count() - 1;
        let alone = solve(of_body(&values, &bodies, last), 1, 50);
        assert!(alone.0 == of_body(&together, &bodies, last) && alone.1 == of_body(&states, &bodies, last));
    }
}

/// Few iterations; in mixed precision more than one round of refinement.
pub fn soon_done(precision: Precision) -> RefineSettings {
    let goal = if precision == Precision::Mixed { 1e-3 } else { plain(0.03, 0).goal };
    RefineSettings { tolerance: 0.03, goal, iteration_limit: 1000, ..precision.settings() }
}

/// Nor does it matter where the vectors are during a dispatch.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn vectors_on_the_chip_are_those_in_storage_to_the_bit() {
    let bodies = plates();
    let unknowns = bodies.layout.systems.unknown_count() as u64;
    for (precision, _) in precisions() {
        let settings = soon_done(precision);
        let solve = |vectors: u64, steps: u32| {
            let mut batch = bodies.batch(precision);
            batch.limit_vectors_on_chip(vectors);
            batch.assemble_and_condense(&bodies.layout, &bodies.numbers(), &settings, steps).unwrap();
            (batch.on_chip(), batch.read_compliance().unwrap(), batch.read_reports().unwrap().states)
        };
        let (_, compliance, states) = solve(0, 40);
        let (chosen, own, own_states) = solve(4, 40);
        println!("{precision:?}: {unknowns} unknowns, {chosen:?}");
        // Small bodies: all four, on every device.
        assert!(chosen.vectors == 4 && chosen.capacity >= unknowns);
        assert!(own == compliance && own_states == states);
        for vectors in if precision == Precision::F32 || is_long() { 1..4 } else { 2..3 } {
            let (_, other, other_states) = solve(vectors, 7);
            assert!(other == compliance && other_states == states, "{precision:?} {vectors}");
        }
    }
}

/// Nor do the checks at run time, which all other tests go without; so no index of theirs is out of bounds.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn checks_at_run_time_change_nothing() {
    let coarse = families_at(0, [0, 0], &RATIOS);
    for (precision, _) in precisions() {
        let checked = Kernels::with_tree(device(), precision, INVOCATIONS, Making::Checked).unwrap();
        let settings = soon_done(precision);
        for (name, bodies) in coarse.iter().filter(|(name, _)| *name != "block on its base") {
            let solve = |kernels: &Kernels| {
                let batch = SystemBatch::new(kernels, &bodies.layout.systems, bodies.count()).unwrap();
                batch.assemble_and_condense(&bodies.layout, &bodies.numbers(), &settings, 40).unwrap();
                let works = works_of_eight(kernels, &batch, bodies);
                (batch.read_compliance().unwrap(), batch.read_reports().unwrap().states, works)
            };
            let (expected, found) = (solve(kernels(precision)), solve(&checked));
            assert!(expected.2.iter().all(Option::is_some), "{name} {precision:?}");
            // Compilers may round two kernels otherwise, that of software does not.
            let worst = difference(&found.0, &expected.0);
            println!("{name} {precision:?}: {worst:.1e}");
            assert!(
                worst < 5.0 * settings.goal && found.2.iter().all(Option::is_some),
                "{name} {precision:?} {worst:e}"
            );
            assert!(
                found == expected || device().facts.kind != AdapterKind::Software,
                "{name} {precision:?}"
            );
        }
    }
}

/// Each spoils one body of a batch; the twin says how its systems end, and the others do not notice.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_bad_system_ends_as_the_twin_says_and_spoils_no_other() {
    let bodies = plates();
    let settings = plain(1e-4, 400);
    let middle = bodies.layout.systems.unknown_count() / 2;
    let row_starts = &bodies.layout.systems.row_starts;
    let row = row_starts[middle] as usize..row_starts[middle + 1] as usize;
    let diagonal = bodies.layout.systems.diagonal_places[middle] as usize;
    type Spoil<'a> = (&'a str, Box<dyn Fn(&mut [f64]) + 'a>);
    let spoils: [Spoil; 5] = [
        ("a row of zeros", Box::new(|values| values[row.clone()].fill(0.0))),
        ("a negative matrix", Box::new(|values| values.iter_mut().for_each(|value| *value = -*value))),
        ("an indefinite matrix", Box::new(|values| values[diagonal] *= 1e-3)),
        ("NaN off the diagonal", Box::new(|values| values[row.start] = f64::NAN)),
        ("an infinite entry", Box::new(|values| values[row.start] = f64::INFINITY)),
    ];
    for (precision, _) in precisions() {
        let good = bodies.values(precision);
        let solve = |values: &[f64]| -> (Vec<f64>, SystemReports) {
            let batch = bodies.batch(precision);
            batch.write_values(values).unwrap();
            batch.pcg(&settings, 40).unwrap();
            (batch.read_columns().unwrap(), batch.read_reports().unwrap())
        };
        let (good_columns, good_reports) = solve(&good);
        for (what, spoil) in &spoils {
            let mut values = good.clone();
            let count = bodies.value_count();
            spoil(&mut values[2 * count..3 * count]);
            let (columns, reports) = solve(&values);
            let (_, expected) = twin(&bodies, &values[2 * count..3 * count], precision, &settings);
            let states = of_body(&reports.states, &bodies, 2);
            let ring = bodies.layout.systems.ring_count();
            assert!(states.len() >= ring && expected.len() == ring);
            for (state, report) in states.iter().zip(&expected) {
                assert_eq!(
                    state.outcome(),
                    Some(expected_outcome(report)),
                    "{what} {precision:?} {report:?}"
                );
                assert_ne!(state.outcome(), Some(SystemOutcome::Converged), "{what} {precision:?}");
            }
            for other in [0, 1, 3, 4] {
                assert!(
                    of_body(&columns, &bodies, other) == of_body(&good_columns, &bodies, other),
                    "{what}"
                );
                assert!(
                    of_body(&reports.states, &bodies, other) == of_body(&good_reports.states, &bodies, other)
                );
            }
        }
    }
}

/// A chain of springs that nothing holds, under a load that moves it: there is no solution, and no system says that it
/// has one; the chain beside it, held at one end, does not notice.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn an_unsupported_body_is_not_solved() {
    let size = 70;
    let neighbours = |row: usize| row.saturating_sub(1)..(row + 2).min(size);
    let columns: Vec<u32> = (0..size).flat_map(neighbours).map(|column| column as u32).collect();
    let ends = (0..size).scan(0, |end, row| {
        *end += neighbours(row).len() as u32;
        Some(*end)
    });
    let row_starts: Vec<u32> = std::iter::once(0).chain(ends).collect();
    let chain = SystemLayout::new(&row_starts, &columns, size - 6).unwrap();
    let stiffness = |row: usize, column: usize| {
        if row == column { neighbours(row).len() as f64 - 1.0 } else { -1.0 }
    };
    let free: Vec<f64> =
        (0..size).flat_map(|row| neighbours(row).map(move |column| stiffness(row, column))).collect();
    let mut held = free.clone();
    held[0] += 1.0;
    for (precision, _) in precisions() {
        let settings = RefineSettings { iteration_limit: 2000, ..precision.settings() };
        let solve = |values: &[f64], count: usize| {
            let batch = SystemBatch::new(kernels(precision), &chain, count).unwrap();
            batch.write_values(values).unwrap();
            batch.pcg(&settings, 100).unwrap();
            (batch.read_columns().unwrap(), batch.read_reports().unwrap())
        };
        let (columns, reports) = solve(&[free.clone(), held.clone()].concat(), 2);
        let (alone, alone_reports) = solve(&held, 1);
        for system in 0..6 {
            let (state, residual) = (reports.states[system], reports.true_residuals[system]);
            println!("{precision:?}: {:?} after {}, {residual:.1e}", state.outcome(), state.iterations);
            assert_ne!(state.outcome(), Some(SystemOutcome::Converged), "{precision:?}");
            // What moves the whole chain is left over.
            assert!(residual > 0.05, "{precision:?} {residual}");
            assert_eq!(alone_reports.states[system].outcome(), Some(SystemOutcome::Converged));
            // A unit force on one node of a chain of unit springs moves it by the count of springs to the wall.
            let node = size - 6 + system;
            let found = alone[system * size + node];
            assert!((found - (node + 1) as f64).abs() < 0.1, "{precision:?} {found}");
        }
        assert!(columns[alone.len()..] == alone && reports.states[8..] == alone_reports.states);
    }
}

/// A system that broke down keeps the x of the round before, here the first one, while others of its block go on.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_system_that_breaks_down_is_not_moved() {
    let bodies = plates();
    let unknowns = bodies.layout.systems.unknown_count();
    let diagonal = bodies.layout.systems.diagonal_places[unknowns / 2] as usize;
    for (precision, _) in precisions() {
        let mut values = bodies.values(precision);
        values[diagonal] *= 1e-3;
        let batch = bodies.batch(precision);
        batch.write_values(&values).unwrap();
        let mut company = 0;
        for iteration_limit in [5, 10, 15, 20, 25, 30, 40] {
            batch.pcg(&plain(1e-4, iteration_limit), 40).unwrap();
            let (columns, states) = (batch.read_columns().unwrap(), batch.read_reports().unwrap().states);
            for (columns, states) in columns.chunks_exact(4 * unknowns).zip(states.chunks_exact(4)) {
                let broke_down = |state: &SystemState| state.outcome() == Some(SystemOutcome::Indefinite);
                company += usize::from(states.iter().any(broke_down) && !states.iter().all(broke_down));
                for (column, state) in columns.chunks_exact(unknowns).zip(states) {
                    let is_zero = column.iter().all(|x| *x == 0.0);
                    assert_eq!(
                        is_zero,
                        broke_down(state) || state.iterations == 0,
                        "{precision:?} {state:?}"
                    );
                }
            }
        }
        assert!(company > 0, "{precision:?}");
    }
}

#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn the_iteration_limit_is_kept() {
    let bodies = plates();
    for (precision, _) in precisions() {
        let settings = plain(1e-4, 11);
        let batch = bodies.batch(precision);
        batch.write_values(&bodies.values(precision)).unwrap();
        // More steps in the dispatches than the limit allows.
        batch.pcg(&settings, 4).unwrap();
        let reports = batch.read_reports().unwrap();
        for index in 0..bodies.count() {
            for state in &of_body(&reports.states, &bodies, index)[..bodies.layout.systems.ring_count()] {
                assert_eq!((state.outcome(), state.iterations), (Some(SystemOutcome::IterationLimit), 11));
            }
        }
    }
}

/// Elements turned inside out and numbers that are none refuse their own body before it is solved.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_body_without_a_mesh_is_refused_and_spoils_no_other() {
    // Depth of the boundary; distances of sides, and angle of a corner.
    refuse_spoilt_ones(&plates(), &[(1, f64::NAN), (1, f64::INFINITY), (1, -2.0), (1, 0.0)]);
    let Some(("block held around", blocks)) = iterated_families().last() else {
        unreachable!("the last of them")
    };
    refuse_spoilt_ones(blocks, &[(4, f64::INFINITY), (1, -1.0), (2, 3.0)]);
}

fn refuse_spoilt_ones(bodies: &Bodies, spoilt: &[(usize, f64)]) {
    // Others need not come to their end to be the same.
    let settings = plain(1e-4, 20);
    for (precision, _) in precisions() {
        let solve = |numbers: &[f64]| {
            let batch = bodies.batch(precision);
            batch.assemble(&bodies.layout, numbers).unwrap();
            batch.pcg(&settings, 40).unwrap();
            (batch.read_columns().unwrap(), batch.read_reports().unwrap().states)
        };
        let good = bodies.numbers();
        let (good_columns, good_states) = solve(&good);
        let own = good.len() / bodies.count();
        for &(place, wrong) in spoilt {
            let mut numbers = good.clone();
            numbers[own + place] = wrong;
            let (columns, states) = solve(&numbers);
            for state in of_body(&states, bodies, 1) {
                assert_eq!(
                    (state.outcome(), state.iterations),
                    (Some(SystemOutcome::Inverted), 0),
                    "{place} {wrong}"
                );
            }
            for other in (0..bodies.count()).filter(|&other| other != 1) {
                assert!(of_body(&columns, bodies, other) == of_body(&good_columns, bodies, other), "{wrong}");
                assert!(of_body(&states, bodies, other) == of_body(&good_states, bodies, other), "{wrong}");
            }
        }
    }
}

/// The size of a workgroup changes the order of sums and nothing else.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn any_size_of_workgroup_will_do() {
    let bodies = plates();
    let settings = plain(1e-4, 1000);
    let compliance = |kernels: &Kernels, invocations: u32| {
        let batch = SystemBatch::new(kernels, &bodies.layout.systems, bodies.count()).unwrap();
        batch.assemble(&bodies.layout, &bodies.numbers()).unwrap();
        // Fewer invocations make more trips each: a fixed count of steps would run into Mesa's bound on loops.
        let steps = MOST_TRIPS / bodies.counts().trips(u64::from(invocations));
        batch.pcg(&settings, steps as u32).unwrap();
        batch.condense().unwrap();
        (batch.read_compliance().unwrap(), works_of_eight(kernels, &batch, &bodies))
    };
    let (usual, usual_works) = compliance(kernels(Precision::F32), INVOCATIONS);
    for invocations in [2, 16, 256] {
        let other = Kernels::with_tree(device(), Precision::F32, invocations, Making::Trusted).unwrap();
        let (found, works) = compliance(&other, invocations);
        let worst = difference(&found, &usual);
        let of_works = works.iter().zip(&usual_works).map(|(found, usual)| match (found, usual) {
            (Some(found), Some(usual)) => difference(found, usual),
            other => panic!("{invocations}: {other:?}"),
        });
        let worst_work = greatest(of_works);
        println!("{invocations}: {worst:.1e}, works {worst_work:.1e}");
        // What single precision leaves of compliances, several times.
        assert!(worst < 3e-5 && worst_work < 1e-5, "{invocations}: {worst:e} {worst_work:e}");
    }
}

/// Sums over subgroups, where the device has them, are rounded in another order and nothing else.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn sums_over_subgroups_will_do() {
    let bodies = plates();
    let mut without = device().clone();
    without.facts.features.subgroups = false;
    let mut differ = 0;
    for (precision, _) in precisions() {
        let settings = RefineSettings { iteration_limit: 1000, ..precision.settings() };
        // Fewer than a subgroup has, and many subgroups. Mixed precision has the sums of the others: one size will do.
        let sizes: &[u32] = match precision {
            Precision::F32 => &[4, INVOCATIONS, 256],
            Precision::F64 if is_long() => &[4, INVOCATIONS, 256],
            _ => &[INVOCATIONS],
        };
        for &invocations in sizes {
            let solve = |kernels: &Kernels| {
                let batch = SystemBatch::new(kernels, &bodies.layout.systems, bodies.count()).unwrap();
                let steps = MOST_TRIPS / bodies.counts().trips(u64::from(invocations));
                let numbers = bodies.numbers();
                batch.assemble_and_condense(&bodies.layout, &numbers, &settings, steps as u32).unwrap();
                (batch.read_compliance().unwrap(), batch.read_reports().unwrap().states)
            };
            let by_subgroups = Kernels::new(device(), precision, invocations, Making::Trusted).unwrap();
            let by_tree = Kernels::with_tree(device(), precision, invocations, Making::Trusted).unwrap();
            let ((found, states), (expected, expected_states)) = (solve(&by_subgroups), solve(&by_tree));
            // A device without subgroups takes trees.
            if invocations == INVOCATIONS {
                let others = Kernels::new(&without, precision, invocations, Making::Trusted).unwrap();
                assert!(solve(&others) == (expected.clone(), expected_states.clone()), "{precision:?}");
            }
            differ += usize::from(found != expected);
            let worst = difference(&found, &expected);
            println!("{precision:?} {invocations}: {worst:.1e}");
            // Each of them is so far from the exact one, in f32 where nu = 0.49.
            let tolerance = if precision == Precision::F32 { 3e-5 } else { 2e-9 };
            assert!(worst < tolerance, "{precision:?} {invocations}: {worst:e}");
            assert_eq!(states.len(), expected_states.len());
            for (state, expected) in states.iter().zip(&expected_states) {
                assert_eq!(state.outcome(), expected.outcome());
                let apart = state.iterations.abs_diff(expected.iterations);
                assert!(apart <= 3 + expected.iterations / 8, "{state:?} {expected:?}");
            }
        }
    }
    // Control: these are other sums.
    assert_eq!(differ > 0, device().facts.features.subgroups);
}

/// What the device refuses comes back as an error, and the device is as good as before.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn what_cannot_be_had_is_an_error() {
    for invocations in [0, 48, 1 << 20] {
        let refused = Kernels::new(device(), Precision::F32, invocations, Making::Trusted).err();
        assert!(matches!(refused, Some(GpuError::Lacks { .. })), "{invocations}: {refused:?}");
    }
    // Nor has every device f64.
    let mut narrow = device().clone();
    narrow.facts.features.f64 = false;
    assert!(Kernels::new(&narrow, Precision::F32, INVOCATIONS, Making::Trusted).is_ok());
    for precision in [Precision::F64, Precision::Mixed] {
        let refused = Kernels::new(&narrow, precision, INVOCATIONS, Making::Trusted).err();
        assert!(matches!(refused, Some(GpuError::Lacks { .. })), "{precision:?}: {refused:?}");
    }
    let bodies = plates();
    let too_many = SystemBatch::new(kernels(Precision::F32), &bodies.layout.systems, 1 << 24).err();
    assert!(matches!(too_many, Some(GpuError::Failed { what: "room for a batch", .. })), "{too_many:?}");
    let batch = bodies.batch(Precision::F32);
    let values = bodies.values(Precision::F32);
    let twice = batch.write_values(&[values.clone(), values.clone()].concat()).err();
    assert!(matches!(twice, Some(GpuError::Failed { what: "matrix values", .. })), "{twice:?}");
    batch.write_values(&values).unwrap();
    assert!(batch.read_values().unwrap() == values);
}

/// A planned batch fits the device, and where a buffer ended it, one more body does not.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn the_planner_fills_the_device_and_no_more() {
    let bodies = plates();
    let kernel = kernels(Precision::F32).facts(1e-9);
    let limits = &device().facts.limits;
    // More than any batch holds.
    let counts = vec![bodies.counts(); 100_000];
    let first = batches(&counts, &kernel, limits).unwrap().swap_remove(0).bodies.len();
    println!("{first} bodies of {:?}", counts[0]);
    // Matrices of zeros: every system ends at once.
    let fits = |count: usize| {
        let batch = SystemBatch::new(kernels(Precision::F32), &bodies.layout.systems, count)?;
        batch.pcg(&plain(1e-4, 1), 1)
    };
    fits(first).unwrap();
    let one_more = counts[0].bytes(4, 4).map(|(_, bytes)| bytes * (first as u64 + 1));
    if one_more.iter().any(|bytes| *bytes > limits.bound_buffer()) {
        let refused = fits(first + 1).err();
        assert!(matches!(refused, Some(GpuError::Failed { .. })), "{refused:?}");
    } else {
        // On a large device it is what a batch leaves to others.
        assert!(one_more.iter().sum::<u64>() > MOST_BYTES, "{first}");
    }
}
