//! The claims of Liu, Zhang & Yang, Mechanism and Machine Theory 42 (2007) 183-197, for five plates: computes every
//! table of docs/liu2007.md with the library's laws and the engine, and holds the document and results/ to them.
//!
//! Goal: the figures a reader is given are those the code gives, to the last digit printed.
//! Joint: steel in steel, plane stress, half disc under a rigid plane in an annulus fixed outside, R2 = 100 mm.
//! `cargo test --release --test engine liu2007:: -- --nocapture` prints the tables as the document has them.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use crate::common::study_joint::{ACCURACY, HOLE_RADIUS, STEEL, Solver, joint};
use jointsweep::internals::engine::outcome::Response;
use jointsweep::internals::mechanics::body::half_disc;
use jointsweep::internals::mechanics::laws::{HertzContact, Law, Pair, PerssonContact, winkler};
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::study::design::Load;

/// Ratios of outer radius to hole radius.
const PLATES: [f64; 5] = [1.5, 2.0, 3.0, 5.0, 10.0];
/// E* of steel on steel in plane stress, MPa.
const EFFECTIVE_MODULUS: f64 = 1e5;
/// Everything below is one function of the load over E* dR: a clearance so small that R1 = R2 to 1e-5.
const CLEARANCE: f64 = 1e-3;

struct Bench {
    solver: Solver,
}

impl Bench {
    fn new() -> Bench {
        Bench { solver: Solver::new(ACCURACY) }
    }

    fn at(&mut self, plate: f64, clearance: f64, load: Load) -> Response {
        self.solver.solve(joint(&half_disc::SHAPE, 0.0, plate, clearance), load)
    }

    /// Under F = `fraction` E* dR.
    fn under(&mut self, plate: f64, fraction: f64) -> Response {
        self.at(plate, CLEARANCE, Load::Force(fraction * EFFECTIVE_MODULUS * CLEARANCE))
    }

    /// At the indentation whose wedge has the sine k = sin(eps/2): cos(eps) = dR/(dR + delta).
    fn at_sine(&mut self, plate: f64, k: f64) -> Response {
        self.at(plate, CLEARANCE, Load::Indentation(indentation_at_sine(k)))
    }
}

fn indentation_at_sine(k: f64) -> f64 {
    2.0 * k * k / (1.0 - 2.0 * k * k) * CLEARANCE
}

fn pair(clearance: f64) -> Pair {
    Pair::new(HOLE_RADIUS, clearance, 1.0, &STEEL, &STEEL, Idealization::PlaneStress).unwrap()
}

fn law_force(name: &str, clearance: f64, indentation: f64) -> f64 {
    Law::named(name).unwrap().curve(&pair(clearance)).unwrap().force_per_thickness(indentation).unwrap()
}

fn law_indentation(name: &str, clearance: f64, force: f64) -> f64 {
    Law::named(name).unwrap().curve(&pair(clearance)).unwrap().indentation(force).unwrap()
}

fn half_angle(response: &Response) -> f64 {
    response.contact_half_angle.unwrap()
}

fn peak(response: &Response) -> f64 {
    response.peak_pressure.unwrap()
}

/// Holds the table `name` of the document to `rows`, whose first cells (the inputs) and others (the results) are
/// written with the decimals given.
///
/// A cell may be off by half its last digit, by the engine's accuracy, and by `slack`.
fn check_table_within(slack: f64, name: &str, decimals: &[usize], rows: &[Vec<f64>]) {
    let written: Vec<String> = rows
        .iter()
        .map(|row| {
            let cells = row.iter().zip(decimals).map(|(value, decimals)| format!("{value:.decimals$}"));
            format!("| {} |", cells.collect::<Vec<_>>().join(" | "))
        })
        .collect();
    println!("\n{name}\n{}", written.join("\n"));
    let document = std::fs::read_to_string(root().join("docs/liu2007.md")).unwrap();
    let marker = format!("<!-- table: {name} -->");
    let text = document.split(&marker).nth(1).unwrap_or_else(|| panic!("no {marker} in docs/liu2007.md"));
    let lines = text.trim_start().lines().take_while(|line| line.starts_with('|')).skip(2);
    let printed: Vec<Vec<f64>> = lines.map(|line| line.split('|').filter_map(number).collect()).collect();
    assert_eq!(printed.len(), rows.len(), "rows of {name}");
    for (printed, row) in printed.iter().zip(rows) {
        assert_eq!((printed.len(), decimals.len()), (row.len(), row.len()), "cells of {name}: {printed:?}");
        for ((printed, value), decimals) in printed.iter().zip(row).zip(decimals) {
            let digit = 10f64.powi(-(*decimals as i32));
            let allowed = slack + 0.51 * digit + 2.0 * ACCURACY * value.abs();
            assert!(
                (printed - value).abs() <= allowed,
                "{name}: {printed} printed, {value} found in {row:?}"
            );
        }
    }
}

fn check_table(name: &str, decimals: &[usize], rows: &[Vec<f64>]) {
    check_table_within(0.0, name, decimals, rows);
}

/// What meshes of this accuracy leave of a contact half angle, deg.
const ANGLE_ERROR: f64 = 0.03;

fn number(cell: &str) -> Option<f64> {
    cell.trim().replace(',', "").replace('−', "-").parse().ok()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf()
}

/// The step dR = delta = 0.1 mm, the study's closest fit, in every plate.
#[test]
fn the_plate_decides() {
    let mut bench = Bench::new();
    let rows = PLATES.map(|plate| {
        let response = bench.at(plate, 0.1, Load::Indentation(0.1));
        let angle = half_angle(&response).to_degrees();
        vec![
            plate,
            response.force,
            1e-3 * response.tangent_stiffness,
            angle,
            peak(&response),
            response.force / law_force("winkler", 0.1, 0.1),
            peak(&response) / winkler::peak_pressure(&pair(0.1), 0.1).unwrap(),
        ]
    });
    check_table("plates", &[1, 0, 1, 1, 1, 2, 2], &rows);
}

/// Both limits that the study sets for Hertz are one: F = E* dR/10.
#[test]
fn hertz_at_the_studys_limits() {
    let mut bench = Bench::new();
    let limits = [(0.5, 5000.0), (0.2, 2000.0)];
    for (clearance, force) in limits {
        assert_eq!(force, 0.1 * EFFECTIVE_MODULUS * clearance);
    }
    let rows = PLATES.map(|plate| {
        let [response, other] =
            limits.map(|(clearance, force)| bench.at(plate, clearance, Load::Force(force)));
        // The same load over the clearance, so the same angle and delta/dR but for what clearances of 0.5 and 0.2 % differ in.
        assert!((half_angle(&response) / half_angle(&other) - 1.0).abs() < 3e-3);
        assert!((response.indentation / other.indentation / 2.5 - 1.0).abs() < 3e-3);
        let hertz = HertzContact::from_force(&pair(CLEARANCE), 0.1 * EFFECTIVE_MODULUS * CLEARANCE).unwrap();
        let response = bench.under(plate, 0.1);
        vec![
            plate,
            half_angle(&response).to_degrees(),
            hertz.contact_half_width() / HOLE_RADIUS / half_angle(&response),
            hertz.peak_pressure() / peak(&response),
        ]
    });
    check_table("hertz limits", &[1, 1, 2, 2], &rows);
}

const FRACTIONS: [f64; 4] = [0.01, 0.03, 0.1, 0.3];

/// Hertz's peak pressure, and two compressions, against the load.
#[test]
fn hertz_against_the_load() {
    let mut bench = Bench::new();
    let mut table = |value: &dyn Fn(&Response, f64) -> f64| {
        PLATES.map(|plate| {
            let mut row = vec![plate];
            row.extend(FRACTIONS.map(|fraction| {
                let response = bench.under(plate, fraction);
                value(&response, fraction * EFFECTIVE_MODULUS * CLEARANCE)
            }));
            row
        })
    };
    let pressure = table(&|response, force| {
        HertzContact::from_force(&pair(CLEARANCE), force).unwrap().peak_pressure() / peak(response)
    });
    let printed = table(&|response, force| {
        law_indentation("hertz-liu-as-printed", CLEARANCE, force) / response.indentation
    });
    let johnson =
        table(&|response, force| law_indentation("johnson", CLEARANCE, force) / response.indentation);
    // C of delta = F/(pi E*) [ln(E* dR/F) + C], which Johnson sets to ln(4 pi) - 1 = 1.531.
    let constant = table(&|response, force| {
        PI * EFFECTIVE_MODULUS * response.indentation / force - (EFFECTIVE_MODULUS * CLEARANCE / force).ln()
    });
    check_table("hertz pressure", &[1, 2, 2, 2, 2], &pressure);
    check_table("printed compression", &[1, 2, 2, 2, 2], &printed);
    check_table("johnson compression", &[1, 2, 2, 2, 2], &johnson);
    check_table("constant", &[1, 2, 2, 2, 2], &constant);
}

const TANGENTS: [f64; 6] = [0.2, 0.4, 0.5, 0.6, 0.7, 0.8];

/// At the load that gives Persson's contact the tangent b = tan(eps/2).
#[test]
fn persson_from_small_to_wide() {
    let mut bench = Bench::new();
    let mut table = |value: &dyn Fn(&Response, &PerssonContact) -> f64| {
        PLATES.map(|plate| {
            let mut row = vec![plate];
            row.extend(TANGENTS.map(|b| {
                let pair = pair(CLEARANCE);
                let persson = PerssonContact::from_contact_half_angle(&pair, 2.0 * b.atan()).unwrap();
                let force = persson.force_per_thickness();
                let response = bench.at(plate, CLEARANCE, Load::Force(force));
                value(&response, &persson)
            }));
            row
        })
    };
    let angle =
        table(&|response, persson| (half_angle(response) - persson.contact_half_angle()).to_degrees());
    let pressure = table(&|response, persson| peak(response) / persson.peak_pressure());
    let force = table(&|response, persson| {
        let at_same_angle =
            PerssonContact::from_contact_half_angle(&pair(CLEARANCE), half_angle(response)).unwrap();
        persson.force_per_thickness() / at_same_angle.force_per_thickness()
    });
    check_table_within(ANGLE_ERROR, "persson angle", &[1, 1, 1, 1, 1, 1, 1], &angle);
    check_table("persson pressure", &[1, 2, 2, 2, 2, 2, 2], &pressure);
    // An angle error of 0.03 deg moves Persson's force by up to 0.4 %.
    check_table_within(0.005, "persson force", &[1, 2, 2, 2, 2, 2, 2], &force);
    // How far the study's own grid reaches: dR = 0.1 mm, delta = 0.2 mm.
    let reach = PLATES.map(|plate| {
        let response = bench.at(plate, 0.1, Load::Indentation(0.2));
        vec![plate, half_angle(&response).to_degrees(), (0.5 * half_angle(&response)).tan()]
    });
    check_table("reach", &[1, 1, 2], &reach);
}

const SINES: [f64; 7] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.65];
const SINES_ABOVE: [f64; 5] = [0.2, 0.3, 0.4, 0.5, 0.6];

#[test]
fn winkler_against_the_sine() {
    let mut bench = Bench::new();
    let mut table = |value: &dyn Fn(&Response) -> f64| {
        PLATES.map(|plate| {
            let mut row = vec![plate];
            row.extend(SINES.map(|k| value(&bench.at_sine(plate, k))));
            row
        })
    };
    let force = table(&|response| response.force / law_force("winkler", CLEARANCE, response.indentation));
    let pressure = table(&|response| {
        peak(response) / winkler::peak_pressure(&pair(CLEARANCE), response.indentation).unwrap()
    });
    let angle = table(&|response| half_angle(response).to_degrees());
    check_table("winkler force", &[1, 2, 2, 2, 2, 2, 2, 2], &force);
    check_table("winkler pressure", &[1, 2, 2, 2, 2, 2, 2, 2], &pressure);
    check_table_within(ANGLE_ERROR, "winkler angle", &[1, 1, 1, 1, 1, 1, 1, 1], &angle);
}

/// The annulus that would make the law right at each k: its force 2 % too low, right, 2 % too high.
#[test]
fn no_one_annulus_makes_the_winkler_law_right() {
    let mut bench = Bench::new();
    let rows = SINES_ABOVE.map(|k| {
        let indentation = indentation_at_sine(k);
        let law = law_force("winkler", CLEARANCE, indentation);
        [1.02, 1.0, 0.98].map(|share| {
            // The force falls as the plate grows; bisection in ln(ratio) to 1e-4.
            let (mut low, mut high) = (1.3_f64, 100.0_f64);
            while high / low > 1.0001 {
                let middle = (low * high).sqrt();
                if bench.at_sine(middle, k).force > share * law { low = middle } else { high = middle }
            }
            low
        })
    });
    let rows: Vec<Vec<f64>> =
        SINES_ABOVE.iter().zip(rows).map(|(k, row)| [&[*k][..], &row].concat()).collect();
    check_table("matching annulus", &[1, 2, 2, 2], &rows);
    // The annuli within 2 % at k = 0.2 and those at k = 0.3 and above have none in common.
    assert!(rows[1..].iter().all(|row| row[3] < rows[0][1]), "{rows:?}");
    // The nearest: ratio 2.2. 1e-3 for figures that the document rounds to 1 %.
    for (k, off) in [(0.3, 0.07), (0.4, 0.02), (0.45, 0.02), (0.5, 0.02), (0.55, 0.02), (0.65, 0.04)] {
        let response = bench.at_sine(2.2, k);
        let excess = response.force / law_force("winkler", CLEARANCE, response.indentation) - 1.0;
        println!("ratio 2.2, k = {k}: {excess:+.4}");
        assert!(excess.abs() < off + 1e-3, "{k}: {excess}");
    }
}

/// The tables in results/ are what the engine gives for the configs.
#[test]
fn results_are_the_engines() {
    // The narrowest contacts (2.4 deg) cannot be had to `ACCURACY`.
    let mut bench = Bench { solver: Solver::new(7e-4) };
    for (name, rows) in [("liu2007", 140), ("liu2007-plates", 700)] {
        let path = root().join(format!("results/{name}.csv"));
        let mut reader = csv::Reader::from_path(path).unwrap();
        let headers = reader.headers().unwrap().clone();
        let column = |name: &str| headers.iter().position(|header| header == name).unwrap();
        let columns = ["outer_radius_ratio", "radial_clearance_mm", "indentation_mm", "force_n"].map(column);
        let angle = column("contact_half_angle_deg");
        let mut count = 0;
        for record in reader.records().map(Result::unwrap) {
            let cell = |column: usize| record[column].parse::<f64>().unwrap();
            let [plate, clearance, indentation, force] = columns.map(cell);
            let response = bench.at(plate, clearance, Load::Indentation(indentation));
            // 0.1 % is the accuracy that the configs ask for, of the force; the angle is the weaker figure (seen 0.204 deg).
            assert!((force / response.force - 1.0).abs() < 1e-3, "{name}: {record:?}");
            assert!((cell(angle) - half_angle(&response).to_degrees()).abs() < 0.27, "{name}: {record:?}");
            count += 1;
        }
        assert_eq!(count, rows, "{name}");
        let manifest = std::fs::read_to_string(root().join(format!("results/{name}.manifest.json"))).unwrap();
        let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
        let config = std::fs::read_to_string(root().join(format!("configs/{name}.toml"))).unwrap();
        assert_eq!(
            manifest["config"]["text"].as_str(),
            Some(config.as_str()),
            "results/{name} is of another config"
        );
        assert_eq!(manifest["counts"]["rows"], rows);
        assert_eq!(manifest["state"], "complete");
    }
}
