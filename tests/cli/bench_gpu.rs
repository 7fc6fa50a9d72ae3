//! `jointsweep bench-gpu` as a user runs it, and that it refuses a GPU that is wrong.

use crate::common::workdir::{Rows, Workdir};
use jointsweep::internals::engine::agreement::{Disagreement, worst_difference};
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::DesignOutcome;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::design::DesignCase;

const FILES: [&str; 6] =
    ["answers.csv", "kernels.csv", "manifest.json", "peaks.csv", "precisions.csv", "scaling.csv"];

/// The numbers of a column; all of them positive, and none empty.
#[track_caller]
fn positive(table: &Rows, name: &str) -> Vec<f64> {
    let numbers: Vec<f64> = table.column(name).iter().map(|cell| cell.parse().expect(name)).collect();
    assert!(!numbers.is_empty() && numbers.iter().all(|n| n.is_finite() && *n > 0.0), "{name}: {numbers:?}");
    numbers
}

/// On any adapter, be it software: every name holds the empty one. One precision, for the sake of time.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn every_file_is_there_and_its_figures_are_sane() {
    let work = Workdir::new("bench-gpu");
    let arguments = ["bench-gpu", "--adapter", "", "--precision", "f32", "--most", "100", "--out", "figures"];
    let told = work.run(&arguments).expect(0);
    assert_eq!(work.files(), FILES.map(|name| format!("figures/{name}")));

    let manifest = work.json("figures/manifest.json");
    assert_eq!((&manifest["state"], &manifest["asked"]["most"]), (&"complete".into(), &100.into()));
    assert_eq!(manifest["asked"]["precisions"], serde_json::json!(["f32"]));
    let adapter = manifest["adapter"]["name"].as_str().unwrap();
    assert!(told.stdout.contains(adapter) && told.stdout.contains("works"), "{}", told.stdout);
    let is_software = manifest["adapter"]["kind"] == "software";
    assert_eq!(manifest["asked"]["remark"].is_string(), is_software);
    assert!(manifest["adapter"]["limits"]["workgroup_bytes"].as_u64().unwrap() >= 16 << 10);

    let peaks = work.table("figures/peaks.csv");
    assert_eq!(peaks.column("numbers")[0], "f32");
    positive(&peaks, "multiply_add_gflop_per_s");
    for name in ["copy_gb_per_s", "cached_gb_per_s", "workgroup_gb_per_s"] {
        positive(&peaks, name);
    }
    assert!(peaks.column("cached_region_bytes").iter().all(|bytes| *bytes == "2097152"));

    let precisions = work.table("figures/precisions.csv");
    assert_eq!(precisions.column("precision"), ["f32"]);
    for name in ["wall_s", "designs_per_s", "condensation_on_the_gpu_s"] {
        positive(&precisions, name);
    }
    // Bodies are eliminated.
    assert_eq!(precisions.column("solves"), ["0"]);
    let difference = positive(&precisions, "worst_difference")[0];
    assert!(difference < 1e-4, "{difference:e}");

    let scaling = work.table("figures/scaling.csv");
    assert_eq!(scaling.column("scene"), ["concentric", "concentric", "blocks", "blocks", "concentric"]);
    assert_eq!(scaling.column("accuracy"), ["1 %", "0.1 %", "1 %", "0.1 %", "1 %"]);
    assert_eq!(scaling.column("solver"), ["auto", "auto", "auto", "auto", "pcg"]);
    let others = if is_software { "10" } else { "100" };
    assert_eq!(scaling.column("designs"), ["100", others, others, others, others]);
    positive(&scaling, "cpu_interpolated_wall_s");
    // Conjugate gradients solve systems, elimination none.
    let solves: Vec<u64> = scaling.column("solves").iter().map(|cell| cell.parse().unwrap()).collect();
    assert!(solves[4] > 0 && solves[0] == 0, "{solves:?}");
    let of = |name: &str| positive(&scaling, name)[0];
    assert!((of("designs_per_s") * of("wall_s") - 100.0).abs() < 0.1);
    assert!((of("gpu_over_cpu") * of("wall_s") / of("cpu_wall_s") - 1.0).abs() < 1e-3);
    assert!(of("with_table_s") > 0.0 && of("table_bytes") > 100.0 * 10.0 * 100.0);
    // Elimination asks once for a batch; conjugate gradients are not counted.
    for name in ["dispatches", "submits", "waits", "bytes_up", "bytes_down"] {
        let counts: Vec<u64> = scaling.column(name).iter().map(|cell| cell.parse().unwrap()).collect();
        assert!(counts[..4].iter().all(|count| *count > 0) && counts[4] == 0, "{name}: {counts:?}");
    }
    let first = |name: &str| scaling.column(name)[0].parse::<u64>().unwrap();
    assert!(first("waits") <= first("submits") && first("submits") <= first("dispatches"));
    // A sweep makes the kernels that none before it has made.
    let kernels: Vec<f64> = scaling.column("kernels_s").iter().map(|cell| cell.parse().unwrap()).collect();
    assert!(kernels.iter().sum::<f64>() > 0.0, "{kernels:?}");
    assert!(kernels.iter().zip(positive(&scaling, "wall_s")).all(|(a, b)| *a < b), "{kernels:?}");
    let has_clock = manifest["adapter"]["features"]["timestamps"].as_bool().unwrap();
    let busy = &scaling.column("busy_share")[..4];
    if has_clock {
        let shares: Vec<f64> = busy.iter().map(|cell| cell.parse().unwrap()).collect();
        assert!(shares.iter().all(|share| *share > 0.0 && *share < 1.0), "{shares:?}");
    } else {
        assert_eq!(busy, [""; 4]);
    }

    let answers = work.table("figures/answers.csv");
    assert_eq!(answers.column("bodies"), ["condensed", "interpolated"]);
    assert_eq!(answers.column("designs"), ["100"; 2]);
    for name in ["gpu_wall_s", "gpu_designs_per_s", "cpu_wall_s", "cpu_designs_per_s"] {
        positive(&answers, name);
    }

    let kernels = work.table("figures/kernels.csv");
    let expected = ["elimination", "assemble", "pcg", "refine", "condense", "works", "joints"];
    assert_eq!(kernels.column("kernel"), expected);
    for name in ["seconds", "operations", "bytes", "gflop_per_s", "gb_per_s", "arithmetic_floor_s"] {
        positive(&kernels, name);
    }
    // Software has its peaks from a processor that others use meanwhile.
    let most = if is_software { 10.0 } else { 1.0 };
    let bounds = kernels.column("bound");
    let known = ["arithmetic", "memory", "cache", "workgroup", "issue"];
    assert!(bounds.iter().all(|bound| known.contains(bound)), "{bounds:?}");
    // Of assembly and of those that solve it is counted what stays on the chip.
    let counted =
        |name: &str| kernels.column(name).iter().map(|cell| !cell.is_empty()).collect::<Vec<bool>>();
    for name in ["cached_bytes", "instructions", "issue_share"] {
        assert_eq!(counted(name), [true, true, true, false, false, false, true], "{name}");
    }
    for name in ["workgroup_bytes", "workgroup_share"] {
        assert_eq!(counted(name), [true, false, true, false, false, false, false], "{name}");
    }
    for name in ["arithmetic_share", "memory_share", "bound_share"] {
        let shares = positive(&kernels, name);
        assert!(shares.iter().all(|share| *share <= most), "{name}: {shares:?}");
    }
    let iterations = kernels.column("iterations");
    // A system takes tens of steps, and only `pcg` counts them.
    assert!(iterations[2].parse::<f64>().unwrap() > 100.0, "{iterations:?}");
    assert_eq!(iterations.iter().filter(|cell| cell.is_empty()).count(), expected.len() - 1);
}

/// A run's result is not lost to a benchmark, nor are the figures of one to another of other sizes.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_benchmark_destroys_nothing() {
    let work = Workdir::new("bench-gpu-folder");
    let bench = |most: &'static str, folder: &'static str| {
        let short = ["bench-gpu", "--adapter", "", "--precision", "f32", "--budget", "0.01 s"];
        [&short[..], &["--most", most, "--out", folder]].concat()
    };
    work.write("small.toml", &crate::SMALL);
    work.run(&["run", "small.toml", "--out", "result"]).expect(0);
    let before = (work.files(), work.read("result/manifest.json"));
    let refused = work.run(&bench("10", "result")).expect(1);
    assert!(refused.stderr.contains("result holds the result of `jointsweep run`"), "{}", refused.stderr);
    assert_eq!((work.files(), work.read("result/manifest.json")), before);

    work.run(&bench("10", "figures")).expect(0);
    let manifest = work.read("figures/manifest.json");
    let refused = work.run(&bench("20", "figures")).expect(1);
    assert!(refused.stderr.contains("--force"), "{}", refused.stderr);
    assert_eq!(work.read("figures/manifest.json"), manifest);
    // The same benchmark takes the place of the one before, files that it has no time for included.
    work.write("figures/scaling.csv", "of the one before");
    work.run(&bench("10", "figures")).expect(0);
    assert_ne!(work.read("figures/manifest.json"), manifest);
    assert!(!work.path("figures/scaling.csv").exists());
}

/// What there is no time for is left out and named; the check never is.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_benchmark_ends_in_time() {
    let work = Workdir::new("bench-gpu-budget");
    let arguments =
        ["bench-gpu", "--adapter", "", "--precision", "f32", "--budget", "0.01 s", "--out", "figures"];
    let told = work.run(&arguments).expect(0);
    let manifest = work.json("figures/manifest.json");
    assert_eq!(
        (&manifest["state"], &manifest["asked"]["budget_seconds"]),
        (&"complete".into(), &0.01.into())
    );
    assert!(manifest["asked"]["checked_designs"].as_u64().unwrap() >= 10);
    let remarks: Vec<&str> =
        manifest["remarks"].as_array().unwrap().iter().map(|remark| remark.as_str().unwrap()).collect();
    // Five sweeps, the answers, the precisions, and each mesh of the kernels.
    assert!(
        remarks.len() >= 8 && remarks.iter().all(|remark| remark.starts_with("no time for ")),
        "{remarks:?}"
    );
    assert!(remarks.iter().all(|remark| told.stderr.contains(remark)), "{}", told.stderr);
    assert!(!work.files().contains(&"figures/scaling.csv".to_string()));
    assert!(work.table("figures/precisions.csv").column("precision").is_empty());
    assert!(work.table("figures/kernels.csv").column("kernel").is_empty());
    // What is told ends with the adapter: no header stands alone.
    assert_eq!(told.stdout.trim_end().lines().count(), 1, "{}", told.stdout);
    for wrong in ["8", "0s", "1 day", "min", "nan s"] {
        let refused = work.run(&["bench-gpu", "--budget", wrong]).expect(1);
        assert!(
            refused.stderr.contains("a time is needed, like 90s, 8min or 1h"),
            "{wrong}: {}",
            refused.stderr
        );
    }
}

#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn an_adapter_that_is_not_there_leaves_nothing() {
    let work = Workdir::new("bench-gpu-nothing");
    let refused = work.run(&["bench-gpu", "--adapter", "no such thing"]).expect(1);
    assert!(refused.stderr.contains("no adapter is called `no such thing`"), "{}", refused.stderr);
    assert!(work.files().is_empty());
}

/// The first designs of the sweep that is measured.
fn outcomes() -> Vec<DesignOutcome> {
    let study =
        Study::load(std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/configs/random.toml")));
    let study = study.unwrap();
    let cases: Vec<DesignCase> = study.cases().unwrap().take(3).map(Result::unwrap).collect();
    Ladder::new(study.solve).sharing(study.in_common()).solve(&cases)
}

/// Negative control of the check: what a wrong GPU could answer.
#[test]
fn wrong_answers_are_refused() {
    let expected = outcomes();
    assert_eq!(worst_difference(&expected, &expected, 0.0), Ok(0.0));
    let with_force = |change: &dyn Fn(f64) -> f64| {
        let mut found = expected.clone();
        let response = found[1].steps[2].response.as_mut().unwrap();
        response.force = change(response.force);
        worst_difference(&found, &expected, 1e-4)
    };
    let worst = with_force(&|force| force * (1.0 - 0.9e-4)).unwrap();
    assert!((worst - 0.9e-4).abs() < 1e-9, "{worst:e}");
    for wrong in
        [with_force(&|force| 1.1e-4 * force + force), with_force(&|_| f64::NAN), with_force(&|_| 0.0)]
    {
        assert!(matches!(wrong, Err(Disagreement::Force { design: 1, step: 2, .. })), "{wrong:?}");
    }

    let mut without_answer = expected.clone();
    without_answer[2].steps[0].response = None;
    let refused = worst_difference(&without_answer, &expected, 1e-4);
    assert!(matches!(refused, Err(Disagreement::Answer { design: 2, step: 0, .. })), "{refused:?}");
    assert!(matches!(worst_difference(&expected, &without_answer, 1e-4), Err(Disagreement::Answer { .. })));
    let refused = worst_difference(&expected[..2], &expected, 1e-4);
    assert_eq!(refused, Err(Disagreement::Count { found: 2, expected: 3 }));
}

/// A GPU that answers nothing has no force that could be off.
#[test]
fn no_forces_are_no_agreement() {
    let mut silent = outcomes();
    silent.iter_mut().flat_map(|outcome| &mut outcome.steps).for_each(|step| step.response = None);
    assert_eq!(worst_difference(&silent, &silent, 1e-4), Err(Disagreement::Nothing));
    assert_eq!(worst_difference(&[], &[], 1e-4), Err(Disagreement::Nothing));
}
