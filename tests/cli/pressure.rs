//! `jointsweep pressure`: what the table says of a joint is what its pressure sums to.

use super::SMALL;
use super::commands::half_pins;
use crate::common::workdir::{Rows, Workdir};

fn numbers(table: &Rows, name: &str) -> Vec<f64> {
    table.column(name).iter().map(|cell| cell.parse().unwrap()).collect()
}

/// A sleeve on a soft layer, which presses most towards its edges.
fn lined() -> String {
    let layers = "[[joint.plate.layers]]\nthickness = \"0.2 mm\"\nyoungs_modulus = \"200 GPa\"\npoissons_ratio = 0.3\n\
                  [[joint.plate.layers]]\nthickness = \"1 mm\"\nyoungs_modulus = \"0.5 GPa\"\npoissons_ratio = 0.4\n[load]";
    SMALL.replace("[load]", layers)
}

/// Twice the integral of p cos(phi) over the arc, times hole radius and thickness; and the greatest pressure.
#[test]
fn pressures_are_those_of_the_table() {
    let work = Workdir::new("pressure");
    work.write("bare.toml", &SMALL);
    work.write("lined.toml", &lined());
    for name in ["bare", "lined"] {
        let config = format!("{name}.toml");
        work.run(&["run", &config]).expect(0);
        let pressures = format!("{name}.csv");
        let both = ["--design", "1", "--design", "0", "--points", "401"];
        work.run(&[&["pressure", &config, "--out", &pressures][..], &both].concat()).expect(0);
        let (table, pressures) = (work.table(&format!("out/{name}/table.csv")), work.table(&pressures));
        let [designs, steps, angles, values] =
            ["design", "step", "angle_deg", "pressure_mpa"].map(|name| numbers(&pressures, name));
        assert_eq!(designs.len(), 2 * 3 * 401);
        assert_eq!((designs[0], designs[3 * 401]), (1.0, 0.0));
        let of_table = |name| numbers(&table, name);
        let [radius, thickness, forces, errors, half_angles, peaks] = [
            "hole_radius_mm",
            "thickness_mm",
            "force_n",
            "force_error",
            "contact_half_angle_deg",
            "peak_pressure_mpa",
        ]
        .map(of_table);
        for (place, (angles, values)) in angles.chunks(401).zip(values.chunks(401)).enumerate() {
            let row = designs[place * 401] as usize * 3 + steps[place * 401] as usize;
            let sum: f64 = (1..401)
                .map(|i| {
                    let [from, to] = [angles[i - 1], angles[i]].map(f64::to_radians);
                    0.5 * (values[i - 1] * from.cos() + values[i] * to.cos()) * (to - from)
                })
                .sum();
            let force = 2.0 * radius[row] * thickness[row] * sum;
            assert!(
                (force / forces[row] - 1.0).abs() < errors[row] + 1e-4,
                "{name}, row {row}: {force} N of {} N",
                forces[row]
            );
            assert!((angles[400] / half_angles[row] - 1.0).abs() < 1e-6 && angles[0] == 0.0);
            assert!(values[400].abs() < 1e-6 * peaks[row], "{name}, row {row}: {}", values[400]);
            let peak = values.iter().copied().fold(0.0, f64::max);
            assert!(
                (peak / peaks[row] - 1.0).abs() < 1e-4,
                "{name}, row {row}: {peak} MPa of {}",
                peaks[row]
            );
        }
    }
}

#[test]
fn what_has_no_pressure_is_refused() {
    let work = Workdir::new("pressure-refused");
    work.write("small.toml", &SMALL);
    let refused = |arguments: &[&str]| work.run(arguments).expect(1).stderr;
    let told = refused(&["pressure", "small.toml"]);
    assert!(told.contains("--design: one of the 2 designs is needed, by its number"), "{told}");
    let told = refused(&["pressure", "small.toml", "--design", "2"]);
    assert!(told.contains("2"), "{told}");
    let told = refused(&["pressure", "small.toml", "--design", "0", "--set", "solve.method=closed-form"]);
    assert!(
        told.contains("solve.method: closed-form: has no pressure of the joint; take auto, series or fe"),
        "{told}"
    );
    work.write("taken.csv", "mine");
    let told = refused(&["pressure", "small.toml", "--design", "0", "--out", "taken.csv"]);
    assert!(told.contains("taken.csv is there already"), "{told}");
    assert_eq!(work.read("taken.csv"), "mine");
    work.run(&["pressure", "small.toml", "--design", "0", "--out", "taken.csv", "--force"]).expect(0);
    // To the terminal, the same.
    let told = work.run(&["pressure", "small.toml", "--design", "0"]).expect(0).stdout;
    assert_eq!(told, work.read("taken.csv"));
    // A load that has no state leaves no pressure, and says so.
    let text = half_pins(&SMALL).replace("\"0.002 mm\", \"0.005 mm\"", "\"4 mm\", \"20 mm\"");
    work.write("deep.toml", &text.replace("\"0.1 mm\"", "\"3 mm\""));
    let ended = work.run(&["pressure", "deep.toml", "--design", "0"]).expect(2);
    assert!(ended.stderr.contains("design 0, step 2 ("), "{}", ended.stderr);
    let rows: Vec<&str> = ended.stdout.lines().skip(1).collect();
    assert!(rows.len() == 2 * 61 && rows.iter().all(|row| !row.starts_with("0,2,")), "{}", ended.stdout);
}
