//! ISO 286 fits by name: which clearances "H7/p6" leaves of a diameter. iso286.csv has the tolerances and the shafts' fundamental deviations, um, by the
//! greatest diameter they are for; hole-basis fits, the preferred ones and their neighbours.

/// The tables of ISO 286-1.
const TABLE: &str = include_str!("iso286.csv");

/// Shafts above the nominal size are told by their lower deviation, those below it by their upper one.
const ABOVE: [&str; 7] = ["k", "m", "n", "p", "r", "s", "u"];

/// Between grades 4 and 7 a k shaft is above the nominal size, beyond it begins there.
const LAST_GRADE_OF_K: u32 = 7;

/// The least and the greatest radial clearance, mm, of a fit such as "H7/p6" in a hole of that nominal radius, mm; below zero of press fits. On failure, what is allowed.
pub fn radial_clearances(fit: &str, hole_radius: f64) -> Result<[f64; 2], String> {
    let mut lines = TABLE.lines().map(|line| line.split(',').collect::<Vec<&str>>());
    let columns = lines.next().unwrap_or_default();
    let diameter = 2.0 * hole_radius;
    let Some(row) = lines.find(|row| row[0].parse::<f64>().is_ok_and(|up_to| diameter <= up_to)) else {
        return Err(format!("ISO 286 is known up to a diameter of 500 mm, and the hole has {diameter} mm"));
    };
    let entry = |column: &str| -> Option<f64> {
        row.get(columns.iter().position(|own| *own == column)?)?.parse().ok()
    };
    let tolerance = |grade: u32| entry(&format!("IT{grade}"));
    let limits = || -> Option<[f64; 4]> {
        let (hole, shaft) = fit.split_once('/')?;
        let greatest_hole = tolerance(hole.strip_prefix('H')?.parse().ok()?)?;
        let (letter, grade) = shaft.split_at(shaft.find(|c: char| c.is_ascii_digit())?);
        let grade: u32 = grade.parse().ok()?;
        let width = tolerance(grade)?;
        let lower = match letter {
            "h" => -width,
            "js" => -0.5 * width,
            "k" if grade > LAST_GRADE_OF_K => 0.0,
            above if ABOVE.contains(&above) => entry(above)?,
            below if below.len() == 1 => entry(below)? - width,
            _ => return None,
        };
        Some([0.0, greatest_hole, lower, lower + width])
    };
    let Some([least_hole, greatest_hole, least_shaft, greatest_shaft]) = limits() else {
        return Err("not a fit that is known; holes H5 to H11 with shafts c, d, e, f, g, h, js, k, m, n, p, r, s or u of grades 5 to 11 are, such as \
                    \"H7/p6\""
            .into());
    };
    // From um of the diameter.
    Ok([least_hole - greatest_shaft, greatest_hole - least_shaft].map(|clearance| 5e-4 * clearance))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of ISO 286-2, um.
    #[test]
    fn fits_are_those_of_the_standard() {
        for (fit, diameter, least, greatest) in [
            ("H7/p6", 20.0, -35.0, -1.0),
            ("H7/f7", 20.0, 20.0, 62.0),
            ("H7/g6", 50.0, 9.0, 50.0),
            ("H7/h6", 18.0, 0.0, 29.0),
            ("H8/h9", 18.1, 0.0, 85.0),
            ("H7/k6", 80.0, -21.0, 28.0),
            ("H8/k8", 80.0, -46.0, 46.0),
            ("H7/n6", 3.0, -10.0, 6.0),
            ("H7/s6", 65.0, -72.0, -23.0),
            ("H7/s6", 65.1, -78.0, -29.0),
            ("H7/u6", 250.0, -313.0, -238.0),
            ("H11/c11", 500.0, 480.0, 1280.0),
            ("H9/d9", 120.0, 120.0, 294.0),
            ("H7/js6", 30.0, -6.5, 27.5),
            ("H6/r5", 400.0, -139.0, -78.0),
        ] {
            let found = radial_clearances(fit, 0.5 * diameter).unwrap();
            for (found, expected) in found.into_iter().zip([least, greatest]) {
                assert!((2e3 * found - expected).abs() < 1e-9, "{fit} of {diameter} mm: {found}");
            }
        }
        for bad in [
            "H7",
            "H7/",
            "H7/p",
            "H4/p6",
            "H7/p12",
            "G7/h6",
            "H7/x6",
            "h6/H7",
            "H7/jss6",
            "H7/p6 ",
            "H7/IT6",
            "H7/up_to_mm6",
            "",
        ] {
            assert!(radial_clearances(bad, 10.0).unwrap_err().contains("not a fit that is known"), "{bad}");
        }
        assert!(radial_clearances("H7/p6", 250.1).unwrap_err().contains("500 mm"));
    }
}
