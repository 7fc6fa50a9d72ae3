//! The figures of docs/liu2007.md: charts with data from the joint's own curves, shared by the example that writes them
//! and the test that holds the written ones to it.

use jointsweep::internals::mechanics::laws::{LAWS, Law, Pair, PerssonContact, winkler};
use jointsweep::internals::output::chart::{Axis, LineChart, Marking, Series};
use jointsweep::{
    Curve, Dimensions, Error, Idealization, Joint, Load, Material, MethodChoice, Options, Part, Response,
};

/// The study's joint: steel in steel, plane stress, a half disc under a rigid plane.
const STEEL: Material = Material { youngs_modulus: 200e3, poissons_ratio: 0.3 };
const HOLE_RADIUS: f64 = 100.0;
/// E* of steel on steel in plane stress, MPa.
const EFFECTIVE_MODULUS: f64 = 1e5;
pub const PLATES: [f64; 5] = [1.5, 2.0, 3.0, 5.0, 10.0];
/// The plate of configs/liu2007.toml.
const PLATE: f64 = 2.0;
/// The study's largest indentation, mm.
const DEEPEST: f64 = 0.2;
/// Where the load parameter is one function of the angle: so small that R1 = R2 to 1e-5.
const CLEARANCE: f64 = 1e-3;
pub const ACCURACY: f64 = 2e-4;
const POINTS: usize = 100;

pub type Anything = Box<dyn std::error::Error>;

/// Every figure with the name of its file.
pub fn figures() -> Result<Vec<(&'static str, LineChart)>, Anything> {
    Ok(vec![
        ("force-1mm.svg", force(1.0)?),
        ("force-0.1mm.svg", force(0.1)?),
        ("load-parameter-b.svg", against_tangent()?),
        ("load-over-persson.svg", over_persson()?),
        ("load-parameter-k.svg", against_sine()?),
        ("load-over-winkler.svg", over_winkler()?),
        ("pressure-30deg.svg", pressure(30.0)?),
        ("pressure-60deg.svg", pressure(60.0)?),
        ("pressure-80deg.svg", pressure(80.0)?),
        ("peak-pressure.svg", peak_pressure()?),
        ("laws-5mm.svg", laws(5.0)?),
        ("laws-1mm.svg", laws(1.0)?),
        ("laws-0.5mm.svg", laws(0.5)?),
        ("laws-0.1mm.svg", laws(0.1)?),
    ])
}

fn curve(plate: f64, radial_clearance: f64) -> Result<Curve, Error> {
    let pin = Part::new("rigid-midplane", &[], None, STEEL)?;
    let plate = Part::new("annulus", &[("outer_radius_ratio", plate)], None, STEEL)?;
    let sizes = Dimensions { hole_radius: HOLE_RADIUS, radial_clearance, thickness: 1.0 };
    let joint = Joint::new(sizes, Idealization::PlaneStress, pin, plate)?;
    joint.curve(Options { accuracy: ACCURACY, method: MethodChoice::Auto })
}

fn pair(clearance: f64) -> Pair {
    let plane_stress = Idealization::PlaneStress;
    Pair::new(HOLE_RADIUS, clearance, 1.0, &STEEL, &STEEL, plane_stress).expect("the study's joint is a pair")
}

/// Answers to indentations from `low` to `high`, mm, in even ratios.
fn responses(curve: &Curve, low: f64, high: f64) -> Result<Vec<Response>, Error> {
    let at = |i: usize| low * (high / low).powf(i as f64 / POINTS as f64);
    let loads: Vec<Load> = (0..=POINTS).map(at).map(Load::Indentation).collect();
    Ok(curve.answers(&loads)?.into_iter().filter_map(|step| step.response).collect())
}

/// Answers to indentations up to the study's largest, denser where they begin.
fn up_to_deepest(curve: &Curve) -> Result<Vec<Response>, Error> {
    let at = |i: usize| DEEPEST * (i as f64 / POINTS as f64).powi(2);
    let loads: Vec<Load> = (1..=POINTS).map(at).map(Load::Indentation).collect();
    Ok(curve.answers(&loads)?.into_iter().filter_map(|step| step.response).collect())
}

fn plate_name(plate: f64) -> String {
    format!("plate {plate} R\u{2082}")
}

/// A law over the study's indentations, as far as it goes: mm and kN.
fn law_points(law: &Law, clearance: f64) -> Vec<(f64, f64)> {
    let Ok(curve) = law.curve(&pair(clearance)) else { return Vec::new() };
    let end = DEEPEST.min(curve.indentation_limit() * (1.0 - 1e-9));
    // Denser at the end, where some laws rise without bound.
    let at = |i: usize| end * (0.5 * std::f64::consts::PI * i as f64 / POINTS as f64).sin();
    let force = |indentation| Some((indentation, 1e-3 * curve.force_per_thickness(indentation).ok()?));
    (0..=POINTS).map(at).filter_map(force).collect()
}

/// Where a law ends before the study's indentations do.
fn ends(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    points.last().copied().filter(|point| point.0 < 0.999 * DEEPEST).into_iter().collect()
}

/// Force against indentation in every plate, with the compression that the study calls Hertz's, and Johnson's.
fn force(clearance: f64) -> Result<LineChart, Error> {
    let mut series = vec![];
    for (place, plate) in PLATES.into_iter().enumerate() {
        let curve = curve(plate, clearance)?;
        let mut points = vec![(0.0, 0.0)];
        points.extend(up_to_deepest(&curve)?.iter().map(|r| (r.indentation, 1e-3 * r.force)));
        series.push(Series::new(plate_name(plate), place, Marking::Line, points));
    }
    let top = series.iter().flat_map(|one| &one.points).map(|point| point.1).fold(0.0, f64::max);
    for (place, name, words) in [(7, "hertz-liu-as-printed", "Hertz as printed"), (6, "johnson", "Johnson")] {
        let law = Law::named(name).expect("one of the laws");
        let points = law_points(law, clearance);
        series.push(Series::new("", place, Marking::Points, ends(&points)));
        series.push(Series::new(words, place, Marking::Dashed, points));
    }
    Ok(LineChart {
        title: format!("Force against indentation, \u{394}R = {clearance} mm"),
        x: Axis::from_zero("indentation \u{3b4}, mm", [DEEPEST].into_iter()),
        y: Axis::from_zero("force, kN", [1.1 * top].into_iter()),
        series,
        limits: Vec::new(),
    })
}

/// E* dR/F against b = tan(eps/2), every plate and Persson's infinite one.
fn against_tangent() -> Result<LineChart, Error> {
    let mut series = load_parameters(|angle| (0.5 * angle).tan())?;
    let persson = |i: usize| {
        let b = 0.05 + (0.91 - 0.05) * i as f64 / POINTS as f64;
        let contact = PerssonContact::from_contact_half_angle(&pair(CLEARANCE), 2.0 * b.atan()).ok()?;
        Some((b, EFFECTIVE_MODULUS * CLEARANCE / contact.force_per_thickness()))
    };
    let points = (0..=POINTS).filter_map(persson).collect();
    series.push(Series::new("Persson", 7, Marking::Dashed, points));
    Ok(LineChart {
        title: "Load parameter against contact angle".into(),
        x: Axis::from_zero("b = tan(\u{3b5}/2)", [0.95].into_iter()),
        y: Axis::log("E* \u{394}R/F", [0.06, 20.0].into_iter()),
        series,
        limits: vec![(0.6, "the study: from b = 0.6 on".into())],
    })
}

/// E* dR/F against k = sin(eps/2), eps where the undeformed circles cross, with the study's Winkler law.
fn against_sine() -> Result<LineChart, Error> {
    let mut series = Vec::new();
    for (place, plate) in PLATES.into_iter().enumerate() {
        let responses = responses(&curve(plate, CLEARANCE)?, 0.01 * CLEARANCE, 12.0 * CLEARANCE)?;
        let point = |r: &Response| (sine(r.indentation), EFFECTIVE_MODULUS * CLEARANCE / r.force);
        series.push(Series::new(
            plate_name(plate),
            place,
            Marking::Line,
            responses.iter().map(point).collect(),
        ));
    }
    let law = Law::named("winkler").and_then(|law| law.curve(&pair(CLEARANCE)).ok());
    let law = law.expect("a law for any clearance");
    let point = |i: usize| {
        let k = 0.06 + (0.68 - 0.06) * i as f64 / POINTS as f64;
        let indentation = 2.0 * k * k / (1.0 - 2.0 * k * k) * CLEARANCE;
        Some((k, EFFECTIVE_MODULUS * CLEARANCE / law.force_per_thickness(indentation).ok()?))
    };
    series.push(Series::new("Winkler law", 7, Marking::Dashed, (0..=POINTS).filter_map(point).collect()));
    Ok(LineChart {
        title: "Load parameter against k".into(),
        x: Axis::from_zero("k = sin(\u{3b5}/2)", [0.7].into_iter()),
        y: Axis::log("E* \u{394}R/F", [0.06, 20.0].into_iter()),
        series,
        limits: vec![(0.2, "the study: within 2 % from k = 0.2 on".into())],
    })
}

/// FE's force over Persson's where both contacts have the same angle, against b.
fn over_persson() -> Result<LineChart, Error> {
    let mut series = load_parameters(|angle| (0.5 * angle).tan())?;
    for one in &mut series {
        let over = |&(b, parameter): &(f64, f64)| {
            let persson = PerssonContact::from_contact_half_angle(&pair(CLEARANCE), 2.0 * b.atan()).ok()?;
            Some((b, EFFECTIVE_MODULUS * CLEARANCE / parameter / persson.force_per_thickness()))
        };
        one.points = one.points.iter().filter_map(over).collect();
    }
    Ok(LineChart {
        title: "Force over Persson's at the same angle".into(),
        x: Axis::from_zero("b = tan(\u{3b5}/2)", [0.95].into_iter()),
        y: Axis { low: 0.9, ..Axis::from_zero("F/F Persson", [1.5].into_iter()) },
        series,
        limits: vec![(0.6, "the study: from b = 0.6 on".into())],
    })
}

/// FE's force over the Winkler law's, against the law's k.
fn over_winkler() -> Result<LineChart, Error> {
    let law = Law::named("winkler").and_then(|law| law.curve(&pair(CLEARANCE)).ok());
    let law = law.expect("a law for any clearance");
    let mut series = Vec::new();
    for (place, plate) in PLATES.into_iter().enumerate() {
        let responses = responses(&curve(plate, CLEARANCE)?, 0.01 * CLEARANCE, 12.0 * CLEARANCE)?;
        let point = |r: &Response| {
            Some((sine(r.indentation), r.force / law.force_per_thickness(r.indentation).ok()?))
        };
        let points = responses.iter().filter_map(point).collect();
        series.push(Series::new(plate_name(plate), place, Marking::Line, points));
    }
    Ok(LineChart {
        title: "Force over the Winkler law's".into(),
        x: Axis::from_zero("k = sin(\u{3b5}/2)", [0.7].into_iter()),
        y: Axis { low: 0.5, ..Axis::from_zero("F/F Winkler", [2.0].into_iter()) },
        series,
        limits: vec![(0.2, "the study: within 2 % from k = 0.2 on".into())],
    })
}

/// k of the Winkler law: cos(eps) = dR/(dR + delta).
fn sine(indentation: f64) -> f64 {
    (indentation / (2.0 * (CLEARANCE + indentation))).sqrt()
}

/// For every plate E* dR/F against a measure of FE's own angle.
fn load_parameters(measure: impl Fn(f64) -> f64) -> Result<Vec<Series>, Error> {
    let mut series = Vec::new();
    for (place, plate) in PLATES.into_iter().enumerate() {
        let responses = responses(&curve(plate, CLEARANCE)?, 0.01 * CLEARANCE, 60.0 * CLEARANCE)?;
        let point =
            |r: &Response| Some((measure(r.contact_half_angle?), EFFECTIVE_MODULUS * CLEARANCE / r.force));
        let points = responses.iter().filter_map(point).collect();
        series.push(Series::new(plate_name(plate), place, Marking::Line, points));
    }
    Ok(series)
}

/// The pressure along the arc over the mean pressure F/(2 R2 t), where the contact ends at `degrees`.
fn pressure(degrees: f64) -> Result<LineChart, Anything> {
    let mut series = Vec::new();
    for (place, plate) in PLATES.into_iter().enumerate() {
        let curve = curve(plate, CLEARANCE)?;
        let load = at_angle(&curve, degrees.to_radians())?;
        let mean = curve.at(load)?.force / (2.0 * HOLE_RADIUS);
        let points = curve.pressure(load, POINTS)?;
        let points =
            points.into_iter().map(|(angle, pressure)| (angle.to_degrees(), pressure / mean)).collect();
        series.push(Series::new(plate_name(plate), place, Marking::Line, points));
    }
    let contact = PerssonContact::from_contact_half_angle(&pair(CLEARANCE), degrees.to_radians())?;
    let mean = contact.force_per_thickness() / (2.0 * HOLE_RADIUS);
    let mut points = Vec::new();
    for i in 0..=POINTS {
        let angle = degrees.to_radians() * (0.5 * std::f64::consts::PI * i as f64 / POINTS as f64).sin();
        points.push((angle.to_degrees(), contact.pressure(angle)? / mean));
    }
    series.push(Series::new("Persson", 7, Marking::Dashed, points));
    let top = series.iter().flat_map(|one| &one.points).map(|point| point.1);
    Ok(LineChart {
        title: format!("Pressure along the arc, \u{3b5} = {degrees} deg"),
        x: Axis::from_zero("angle from the load line, deg", [degrees].into_iter()),
        y: Axis::from_zero("p/(F/(2 R\u{2082} t))", top),
        series,
        limits: Vec::new(),
    })
}

/// The load under which the contact ends at an angle: bisection in the indentation's logarithm.
fn at_angle(curve: &Curve, angle: f64) -> Result<Load, Error> {
    let (mut low, mut high) = (1e-3 * CLEARANCE, 1e3 * CLEARANCE);
    while high / low > 1.0 + 1e-9 {
        let middle = (low * high).sqrt();
        // Wider than the half disc is no state, and too wide.
        let is_narrow = curve.at(Load::Indentation(middle));
        let is_narrow = is_narrow.is_ok_and(|state| state.contact_half_angle.is_some_and(|own| own < angle));
        if is_narrow { low = middle } else { high = middle }
    }
    Ok(Load::Indentation(low))
}

/// Peak pressure against E delta/(2 R2) over the study's grid of clearances, plate of ratio 2.
fn peak_pressure() -> Result<LineChart, Error> {
    let mut series = Vec::new();
    for (place, clearance) in [0.1, 0.2, 0.5, 1.0, 5.0].into_iter().enumerate() {
        let responses = up_to_deepest(&curve(PLATE, clearance)?)?;
        let law = |r: &Response| STEEL.youngs_modulus * r.indentation / (2.0 * HOLE_RADIUS);
        let mut points = vec![(0.0, 0.0)];
        points.extend(responses.iter().filter_map(|r| Some((law(r), r.peak_pressure?))));
        series.push(Series::new(format!("\u{394}R = {clearance} mm"), place, Marking::Line, points));
    }
    let end = winkler::peak_pressure(&pair(1.0), DEEPEST).expect("inside the law's range");
    series.push(Series::new(
        "p\u{2080} = E \u{3b4}/(2 R\u{2082})",
        7,
        Marking::Dashed,
        vec![(0.0, 0.0), (end, end)],
    ));
    Ok(LineChart {
        title: "Peak pressure against the study's law, plate 2 R\u{2082}".into(),
        x: Axis::from_zero("E \u{3b4}/(2 R\u{2082}), MPa", [end].into_iter()),
        y: Axis::from_zero(
            "peak pressure, MPa",
            series.iter().flat_map(|one| &one.points).map(|point| point.1),
        ),
        series,
        limits: Vec::new(),
    })
}

/// One clearance with all laws, plate of ratio 2: force against indentation.
fn laws(clearance: f64) -> Result<LineChart, Error> {
    let mut points = vec![(0.0, 0.0)];
    points.extend(up_to_deepest(&curve(PLATE, clearance)?)?.iter().map(|r| (r.indentation, 1e-3 * r.force)));
    let top = points.iter().map(|point| point.1).fold(0.0, f64::max);
    let mut series = vec![Series::new(format!("FE, {}", plate_name(PLATE)), 0, Marking::Line, points)];
    for (place, law) in LAWS.into_iter().enumerate() {
        let marking = if place < LAWS.len() / 2 { Marking::Dashed } else { Marking::Dotted };
        let points = law_points(law, clearance);
        if points.len() > 1 {
            series.push(Series::new("", 1 + place % 7, Marking::Points, ends(&points)));
            series.push(Series::new(law.name, 1 + place % 7, marking, points));
        }
    }
    Ok(LineChart {
        title: format!("All laws, \u{394}R = {clearance} mm, plate 2 R\u{2082}"),
        x: Axis::from_zero("indentation \u{3b4}, mm", [DEEPEST].into_iter()),
        y: Axis::from_zero("force, kN", [1.6 * top].into_iter()),
        series,
        limits: Vec::new(),
    })
}
