//! The program on a GPU, be it software: the same config gives the same table as on the processor.
//!
//! Without a Vulkan driver these tests are ignored.

use jointsweep::internals::engine::backend::choice::GpuChoice;
use jointsweep::internals::engine::backend::gpu::context::{AdapterChoice, Adapters};
use jointsweep::internals::engine::backend::precision::Precision;
use jointsweep::internals::engine::unit_costs::Pace;
use jointsweep::internals::output::kept_rates::{RATES, rates};

use crate::common::greatest::greatest;
use crate::common::workdir::{Ended, Rows, Workdir};

/// A drawn sweep of cored pins in blocks, in steel and softer.
fn config(varied: &Varied) -> String {
    let Varied { idealization, half_width_ratio, poissons_ratio, indentation, count, solve } = varied;
    format!(
        r#"
[joint]
idealization = "{idealization}"
hole_radius = {{ from = "5 mm", to = "50 mm", spacing = "log" }}
radial_clearance = {{ from = "0.01 mm", to = "0.2 mm", spacing = "log" }}
thickness = "5 mm"
[joint.pin]
model = "rigid-core"
core_radius_ratio = {{ from = 0.1, to = 0.4 }}
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[joint.plate]
model = "block"
half_width_ratio = {half_width_ratio}
depth_ratio = 3.0
height_ratio = 2.0
support = "outer"
youngs_modulus = {{ from = "10 GPa", to = "210 GPa" }}
poissons_ratio = {poissons_ratio}
[load]
indentation = {indentation}
[sampling]
method = "latin-hypercube"
count = {count}
[solve]
accuracy = "1 %"
{solve}
"#
    )
}

struct Varied {
    idealization: &'static str,
    half_width_ratio: &'static str,
    poissons_ratio: &'static str,
    indentation: &'static str,
    count: usize,
    solve: &'static str,
}

/// Meshes on both sides, two loads a design, one of them without contact.
const SWEEP: Varied = Varied {
    idealization: "plane-strain",
    half_width_ratio: "{ from = 2.0, to = 4.0 }",
    poissons_ratio: "{ from = 0.1, to = 0.45 }",
    indentation: r#"["0 mm", "0.002 mm", "0.02 mm"]"#,
    count: 6,
    solve: r#"method = "fe""#,
};

/// Pins that are all different in plates of a few kinds, about as many as make it worth the while to interpolate them.
const LARGE: Varied = Varied {
    idealization: "plane-stress",
    half_width_ratio: "[2.0, 2.2, 2.4, 2.6, 2.8, 3.0]",
    poissons_ratio: "0.3",
    indentation: r#""0.02 mm""#,
    count: 2500,
    solve: "",
};

/// Any adapter: every name holds the empty one.
const ANY: [&str; 2] = ["--adapter", ""];

#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_config_gives_the_same_table_on_both_backends() {
    let work = Workdir::new("backends");
    // From 1 % on the processor condenses in single precision.
    work.write("sweep.toml", &config(&SWEEP).replace("\"1 %\"", "\"0.9 %\""));
    work.run(&["run", "sweep.toml", "--out", "cpu", "--backend", "cpu"]).expect(0);
    // The last digit of the table is 1e-9 at most.
    for (precision, solver, allowed) in
        [("f32", "auto", 3e-5), ("f64", "eliminate", 1e-9), ("mixed", "pcg", 4.3e-9)]
    {
        let arguments =
            ["run", "sweep.toml", "--out", precision, "--precision", precision, "--solver", solver];
        let ended = work.run(&[&arguments[..], &ANY].concat()).expect(0);
        assert!(!ended.stderr.contains("warning") && !ended.stderr.contains("XDG"), "{}", ended.stderr);
        let summary = ended.stdout;
        let manifest = work.json(&format!("{precision}/manifest.json"));
        assert_eq!((&manifest["backend"], &manifest["precision"]), (&"gpu".into(), &precision.into()));
        let adapter = manifest["adapter"]["name"].as_str().unwrap();
        assert!(!adapter.is_empty() && summary.contains(adapter), "{summary}");
        assert!(manifest["adapter"]["driver"].is_string() && manifest["fallback"].is_null());
        assert_eq!(manifest["counts"]["designs_on_cpu"], 0);
        assert_eq!(manifest["adapter"]["solver"], solver);
        let residual = manifest["worst_residual"].as_f64();
        assert_eq!(residual.is_some_and(|residual| residual > 0.0 && residual < 3e-3), solver == "pcg");

        let (found, expected) = (work.table(&format!("{precision}/table.csv")), work.table("cpu/table.csv"));
        for name in ["design", "hole_radius_mm", "half_width_ratio", "indentation_mm", "method", "status"] {
            assert_eq!(found.column(name), expected.column(name));
        }
        assert_eq!(found.column("backend"), ["gpu"; 18]);
        let mut differences = Vec::new();
        for name in [
            "force_n",
            "tangent_stiffness_n_per_mm",
            "contact_half_angle_deg",
            "peak_pressure_mpa",
            "energy_mj",
        ] {
            for (found, expected) in found.column(name).into_iter().zip(expected.column(name)) {
                let (found, expected): (f64, f64) = (found.parse().unwrap(), expected.parse().unwrap());
                differences.push(if expected == 0.0 { found } else { found / expected - 1.0 });
            }
        }
        // Five results of six designs under three loads.
        assert_eq!(differences.len(), 5 * 18);
        let worst = greatest(differences);
        println!("{precision}: {worst:.1e}");
        assert!(worst < allowed, "{precision}: {worst:e}");
    }
}

/// A large sweep is interpolated across bodies whatever condenses those that the fits rest on: the same designs are, and their
/// forces agree far better than to the accuracy asked.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_sweep_is_interpolated_on_both_backends() {
    let work = Workdir::new("interpolated");
    work.write("auto.toml", &config(&LARGE));
    work.write("off.toml", &config(&Varied { solve: r#"interpolation = "off""#, ..LARGE }));
    for name in ["auto", "off"] {
        let config = format!("{name}.toml");
        work.run(&["run", &config, "--out", name, "--backend", "cpu"]).expect(0);
    }
    let arguments = ["run", "auto.toml", "--out", "gpu", "--precision", "f32"];
    work.run(&[&arguments[..], &ANY].concat()).expect(0);
    let manifest = work.json("gpu/manifest.json");
    assert!(manifest["fallback"].is_null() && manifest["adapter"]["solver"] == "auto");
    let [on_cpu, on_meshes, on_gpu] = ["auto", "off", "gpu"].map(|name| {
        let table = work.table(&format!("{name}/table.csv"));
        assert_eq!(table.column("status"), ["ok"; 2500], "{name}");
        table
    });
    assert_eq!(on_gpu.column("method"), on_cpu.column("method"));
    assert_eq!(on_meshes.column("method"), ["fe"; 2500]);
    // Polynomials are added up here; bodies that are not interpolated come from the device.
    let mut count = 0;
    for (method, backend) in on_gpu.column("method").into_iter().zip(on_gpu.column("backend")) {
        assert_eq!(backend, if method == "interpolated" { "cpu" } else { "gpu" });
        count += usize::from(method == "interpolated");
    }
    assert!(count > 2300, "{count} rows interpolated");

    let [alike, other] = [&on_cpu, &on_meshes].map(|table| worst_force(&on_gpu, table));
    println!("{count} interpolated: {alike:.1e}, against meshes {other:.1e}");
    // Seen: 5.1e-6, and 4.7e-4 against meshes.
    assert!(alike < 6.7e-6, "{alike:e}");
    // Control: interpolated forces are not those of the meshes. Each side has 1 %.
    assert!(other > 10.0 * alike && other < 0.02, "{other:e}");
}

/// The greatest relative difference of the forces of the same designs.
fn worst_force(found: &Rows, expected: &Rows) -> f64 {
    assert_eq!(found.column("core_radius_ratio"), expected.column("core_radius_ratio"));
    let forces = |rows: &Rows| -> Vec<f64> {
        rows.column("force_n").into_iter().map(|force| force.parse().unwrap()).collect()
    };
    let (found, expected) = (forces(found), forces(expected));
    assert_eq!((found.len(), expected.len()), (2500, 2500));
    greatest(found.iter().zip(&expected).map(|(a, b)| a / b - 1.0))
}

#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn an_adapter_that_is_not_there_is_an_error_that_names_those_that_are() {
    let work = Workdir::new("adapters");
    work.write("sweep.toml", &config(&SWEEP));
    let refused = work.run(&["run", "sweep.toml", "--adapter", "no such thing"]).expect(1);
    let start = "error: no adapter is called `no such thing`; there are: ";
    let line = refused.stderr.lines().find(|line| line.starts_with(start)).expect(&refused.stderr);
    assert!(line.len() > start.len());
    assert_eq!(work.files(), ["sweep.toml"]);
}

/// What `devices --measure` finds is what later runs go by; what is no such file is measured anew, and so is what cannot be kept.
#[test]
#[cfg(target_os = "linux")]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn a_device_is_measured_once() {
    let work = Workdir::new("rates");
    let mut command = work.command(&["devices", "--measure"]);
    let told = Ended::new(command.env("XDG_CACHE_HOME", work.path("cache")).output().unwrap()).expect(0);
    assert!(told.stdout.contains("  measured   condenses like "), "{}", told.stdout);
    assert_eq!(told.stderr, "");
    let (folder, name) = (work.path("cache/jointsweep"), format!("cache/jointsweep/{RATES}"));
    let kept: serde_json::Value = serde_json::from_str(&work.read(&name)).unwrap();
    let entries = kept.as_array().unwrap();
    assert_eq!(entries.len(), told.stdout.matches("  measured   condenses like ").count());

    let device = Adapters::enumerate().open(AdapterChoice::Named("")).unwrap();
    let choice = GpuChoice::new(&device, Precision::preferred(&device.facts, 0.01));
    let of_device = |entry: &&serde_json::Value| entry["of"]["adapter"] == device.facts.name;
    let own = entries.iter().find(of_device).unwrap();
    let read = rates(Some(&folder), &choice).unwrap();
    assert!(read.1.is_none());
    assert_eq!(serde_json::to_value(read.0).unwrap(), own["rates"]);
    // A thread of the processor was timed, and the device.
    let Pace { in_lanes, others } = read.0.processor;
    assert!([in_lanes, others].iter().all(|pace| (0.05..50.0).contains(pace)), "{read:?}");
    assert!(read.0.threads() > 1e-4, "{read:?}");

    for (told, is_believed) in [("12345.0", true), ("-1.0", false), ("1e999", false), ("}", false)] {
        let own = own["rates"]["start"].to_string();
        work.write(&name, &serde_json::to_string(&kept).unwrap().replace(&own, told));
        let (found, not_kept) = rates(Some(&folder), &choice).unwrap();
        assert!(not_kept.is_none());
        assert_eq!(found.start == 12345.0, is_believed, "{told}: {found:?}");
        assert!(found.are_sound());
        assert_eq!(rates(Some(&folder), &choice).unwrap().0, found, "{told}");
    }
    work.write("file", "");
    let (found, not_kept) = rates(Some(&work.path("file/jointsweep")), &choice).unwrap();
    assert!(found.are_sound() && not_kept.unwrap().to_string().contains("file/jointsweep"));
}
