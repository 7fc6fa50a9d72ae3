//! Draws docs/joint.svg, the README's picture: the scene, and beside it force against indentation of the README's joint, with
//! Johnson's law.
//!
//! ```sh
//! cargo run --release --example joint_picture
//! ```

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;

use jointsweep::internals::mechanics::laws::{Pair, johnson};
use jointsweep::{Dimensions, Idealization, Joint, Material, Options, Part};

type Point = (f64, f64);

const INK: &str = "#24292f";
const FAINT: &str = "#8b949e";
const RED: &str = "#c0392b";
const COLOURS: [&str; 3] = ["#0b5fa5", "#1f8a4c", "#b35900"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut svg = String::new();
    svg.push_str(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 960 430\" width=\"960\" height=\"430\" \
         font-family=\"Helvetica, Arial, sans-serif\" font-size=\"15\">\n\
         <title>A pin in a hole with clearance, and its force against indentation</title>\n\
         <rect width=\"960\" height=\"430\" fill=\"#ffffff\"/>\n",
    );
    scene(&mut svg)?;
    chart(&mut svg)?;
    svg.push_str("</svg>\n");
    std::fs::write(root.join("docs/joint.svg"), svg)?;
    Ok(())
}

// The scene, with clearance and indentation far larger than true, px.
const HOLE: Point = (190.0, 232.0);
const PLATE_RADIUS: f64 = 172.0;
const HOLE_RADIUS: f64 = 118.0;
const PIN_RADIUS: f64 = 88.0;
const INDENTATION: f64 = 14.0;
const CLEARANCE: f64 = HOLE_RADIUS - PIN_RADIUS;
const OFFSET: f64 = CLEARANCE + INDENTATION;
const CORE_RATIO: f64 = 0.2;

/// At `radius` from `centre`, at an angle from the load line, deg.
fn polar(centre: Point, radius: f64, degrees: f64) -> Point {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    (centre.0 + radius * sine, centre.1 + radius * cosine)
}

fn scene(svg: &mut String) -> std::fmt::Result {
    let (x, y) = HOLE;
    let pin = (x, y + OFFSET);
    // Where the undeformed circles cross.
    let cosine = (HOLE_RADIUS.powi(2) + OFFSET.powi(2) - PIN_RADIUS.powi(2)) / (2.0 * HOLE_RADIUS * OFFSET);
    let half_angle = cosine.acos().to_degrees();

    writeln!(svg, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{PLATE_RADIUS}\" fill=\"#e6e9ed\" stroke=\"{INK}\"/>")?;
    let hatch: String = (0..72).fold(String::new(), |mut path, i| {
        let (a, b) = (
            polar(HOLE, PLATE_RADIUS, 5.0 * f64::from(i)),
            polar(HOLE, PLATE_RADIUS + 9.0, 5.0 * f64::from(i) + 3.0),
        );
        let _ = write!(path, "M{:.1} {:.1}L{:.1} {:.1}", a.0, a.1, b.0, b.1);
        path
    });
    writeln!(svg, "<path d=\"{hatch}\" stroke=\"{FAINT}\" fill=\"none\"/>")?;
    writeln!(svg, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{HOLE_RADIUS}\" fill=\"#ffffff\" stroke=\"{INK}\"/>")?;

    // The pin, clipped to the hole: contact flattens it.
    writeln!(svg, "<clipPath id=\"hole\"><circle cx=\"{x}\" cy=\"{y}\" r=\"{HOLE_RADIUS}\"/></clipPath>")?;
    let circle = format!("<circle cx=\"{x}\" cy=\"{:.1}\"", pin.1);
    writeln!(
        svg,
        "{circle} r=\"{PIN_RADIUS}\" clip-path=\"url(#hole)\" fill=\"#cfe0f1\" stroke=\"{INK}\"/>"
    )?;
    // Its rigid core.
    writeln!(svg, "{circle} r=\"{:.1}\" fill=\"{INK}\"/>", CORE_RATIO * PIN_RADIUS)?;

    // Pressure: elliptic over the arc, drawn into the plate.
    let arrows = 9;
    let mut tips = String::new();
    for i in 0..=40 {
        let share = f64::from(i) / 20.0 - 1.0;
        let tip = polar(HOLE, HOLE_RADIUS + 30.0 * (1.0 - share * share).sqrt(), share * half_angle);
        let _ = write!(tips, "{}{:.1} {:.1}", if i == 0 { "M" } else { "L" }, tip.0, tip.1);
    }
    writeln!(svg, "<path d=\"{tips}\" fill=\"none\" stroke=\"{RED}\"/>")?;
    for i in 1..arrows {
        let share = 2.0 * f64::from(i) / f64::from(arrows) - 1.0;
        let angle = share * half_angle;
        let tail = polar(HOLE, HOLE_RADIUS + 30.0 * (1.0 - share * share).sqrt(), angle);
        arrow(svg, tail, polar(HOLE, HOLE_RADIUS + 1.0, angle), RED, 1.2)?;
    }
    label(svg, polar(HOLE, 166.0, -9.0), "p", RED, "middle")?;

    // Load line, its arrow, and the edges of contact.
    let end = polar(HOLE, HOLE_RADIUS, 0.0);
    line(svg, (x, pin.1), end, FAINT, "8 3 2 3")?;
    for side in [-1.0, 1.0] {
        line(svg, HOLE, polar(HOLE, HOLE_RADIUS, side * half_angle), INK, "")?;
    }
    let arc = (polar(HOLE, 84.0, 0.0), polar(HOLE, 84.0, half_angle));
    writeln!(
        svg,
        "<path d=\"M{:.1} {:.1}A84 84 0 0 0 {:.1} {:.1}\" fill=\"none\" stroke=\"{INK}\"/>",
        arc.0.0, arc.0.1, arc.1.0, arc.1.1
    )?;
    italic(svg, polar(HOLE, 101.0, 0.45 * half_angle), "ε", "middle")?;
    arrow(svg, (x, 18.0), (x, pin.1 - 7.0), INK, 3.0)?;
    italic(svg, (x + 12.0, 34.0), "F", "start")?;

    // Radii.
    let rim = polar(HOLE, HOLE_RADIUS, 142.0);
    arrow(svg, HOLE, rim, INK, 1.0)?;
    radius(svg, (x + 47.0, y - 38.0), "R", "2")?;
    let rim = polar(pin, PIN_RADIUS, -128.0);
    arrow(svg, pin, rim, INK, 1.0)?;
    radius(svg, (x - 66.0, pin.1 - 26.0), "R", "1")?;
    dot(svg, HOLE)?;
    dot(svg, pin)?;

    // dR and delta: the pin's centre at first touch and now, right of the plate.
    let out = x + PLATE_RADIUS + 46.0;
    for (height, from) in [(y, x + 6.0), (y + CLEARANCE, x + 6.0), (pin.1, x + PIN_RADIUS + 4.0)] {
        line(svg, (from, height), (out, height), FAINT, "3 3")?;
    }
    let at = out - 12.0;
    arrow(svg, (at, y + 14.0), (at, y + 1.0), INK, 1.0)?;
    arrow(svg, (at, y + CLEARANCE - 14.0), (at, y + CLEARANCE - 1.0), INK, 1.0)?;
    label(svg, (out + 6.0, y + 0.5 * CLEARANCE + 5.0), "ΔR = R₂ − R₁", INK, "start")?;
    arrow(svg, (at, pin.1 + 18.0), (at, pin.1 + 1.0), INK, 1.0)?;
    line(svg, (at, y + CLEARANCE), (at, pin.1), INK, "")?;
    label(svg, (out + 6.0, pin.1 + 9.0), "δ", INK, "start")?;
    // What the parts are.
    label(svg, polar(HOLE, 148.0, 52.0), "plate", INK, "middle")?;
    label(svg, (x - 116.0, 30.0), "fixed boundary", FAINT, "middle")?;
    label(svg, (x - 20.0, pin.1 + 62.0), "pin", INK, "middle")?;
    label(svg, (x + 19.0, pin.1 + 20.0), "rigid core", INK, "start")
}

// The chart.
const LEFT: f64 = 586.0;
const RIGHT: f64 = 870.0;
const TOP: f64 = 96.0;
const BOTTOM: f64 = 372.0;
/// mm and kN.
const MOST_INDENTATION: f64 = 0.02;
const MOST_FORCE: f64 = 16.0;

fn place(indentation: f64, kilonewton: f64) -> Point {
    (
        LEFT + (RIGHT - LEFT) * indentation / MOST_INDENTATION,
        BOTTOM - (BOTTOM - TOP) * kilonewton / MOST_FORCE,
    )
}

/// The joint of the README's example, one of its plates.
const HOLE_RADIUS_MM: f64 = 10.0;
const THICKNESS_MM: f64 = 8.0;
const PLATE_RATIO: f64 = 3.0;
const CLEARANCES_MM: [f64; 3] = [0.01, 0.02, 0.05];
const PIN: Material = Material { youngs_modulus: 210e3, poissons_ratio: 0.3 };
const PLATE: Material = Material { youngs_modulus: 70e3, poissons_ratio: 0.33 };

fn joint(radial_clearance: f64) -> Result<Joint, jointsweep::Error> {
    Joint::new(
        Dimensions { hole_radius: HOLE_RADIUS_MM, radial_clearance, thickness: THICKNESS_MM },
        Idealization::PlaneStress,
        Part::new("rigid-core", &[("core_radius_ratio", CORE_RATIO)], None, PIN)?,
        Part::new("annulus", &[("outer_radius_ratio", PLATE_RATIO)], None, PLATE)?,
    )
}

/// Points of a drawn curve.
const POINTS: u32 = 120;

fn chart(svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    for i in 0..=4 {
        let value = 0.25 * MOST_FORCE * f64::from(i);
        let (from, to) = (place(0.0, value), place(MOST_INDENTATION, value));
        line(svg, from, to, if i == 0 { INK } else { "#dfe3e8" }, "")?;
        label(svg, (LEFT - 8.0, from.1 + 5.0), &format!("{value}"), INK, "end")?;
        let value = 0.25 * MOST_INDENTATION * f64::from(i);
        let at = place(value, 0.0);
        line(svg, at, (at.0, at.1 + 5.0), INK, "")?;
        label(svg, (at.0, at.1 + 22.0), &format!("{value:.3}"), INK, "middle")?;
    }
    line(svg, place(0.0, 0.0), place(0.0, MOST_FORCE), INK, "")?;
    label(svg, (0.5 * (LEFT + RIGHT), BOTTOM + 46.0), "indentation δ, mm", INK, "middle")?;
    label(svg, (LEFT - 30.0, TOP - 16.0), "F, kN", INK, "start")?;
    let scene = "steel pin in aluminium, R₂ = 10 mm, 8 mm thick, plate to 3 R₂";
    label(svg, (LEFT - 50.0, 30.0), scene, FAINT, "start")?;

    let mut ends_at = 0.0;
    for (clearance, colour) in CLEARANCES_MM.into_iter().zip(COLOURS) {
        let curve = joint(clearance)?.curve(Options { accuracy: 1e-4, ..Options::default() })?;
        let mut points = Vec::new();
        for i in 0..=POINTS {
            // Closer together at the start, where the slope changes most.
            let delta = MOST_INDENTATION * (f64::from(i) / f64::from(POINTS)).powi(2);
            points.push(place(delta, 1e-3 * curve.force(delta)?));
        }
        polyline(svg, &points, colour, "")?;
        let last = points[points.len() - 1];
        let name = format!("{clearance} mm");
        label(svg, (last.0 + 8.0, last.1 + 5.0), &name, colour, "start")?;

        let pair =
            Pair::new(HOLE_RADIUS_MM, clearance, THICKNESS_MM, &PIN, &PLATE, Idealization::PlaneStress)?;
        let law = johnson::LAW.curve(&pair)?;
        ends_at = law.indentation_limit() / clearance;
        let end = law.indentation_limit().min(MOST_INDENTATION);
        let mut points = Vec::new();
        for i in 0..=POINTS {
            // Closer together at the end, where the law's slope grows without bound.
            let delta = end * (0.5 * PI * f64::from(i) / f64::from(POINTS)).sin() * (1.0 - 1e-9);
            points.push(place(delta, 1e-3 * THICKNESS_MM * law.force_per_thickness(delta)?));
        }
        polyline(svg, &points, colour, "5 4")?;
        if law.indentation_limit() < MOST_INDENTATION {
            let last = points[points.len() - 1];
            writeln!(
                svg,
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3.5\" fill=\"#ffffff\" stroke=\"{colour}\" stroke-width=\"1.6\"/>",
                last.0, last.1
            )?;
        }
    }
    label(svg, (RIGHT + 8.0, TOP - 16.0), "ΔR", INK, "start")?;
    // The key, above the chart.
    let key = (LEFT + 48.0, TOP - 42.0);
    polyline(svg, &[key, (key.0 + 30.0, key.1)], INK, "")?;
    label(svg, (key.0 + 38.0, key.1 + 5.0), "jointsweep", INK, "start")?;
    let key = (key.0 + 132.0, key.1);
    polyline(svg, &[key, (key.0 + 30.0, key.1)], INK, "5 4")?;
    label(svg, (key.0 + 38.0, key.1 + 5.0), "Johnson's law", INK, "start")?;
    label(svg, (LEFT + 8.0, TOP + 30.0), &format!("○ ends at {ends_at:.2} ΔR"), FAINT, "start")?;
    Ok(())
}

fn line(svg: &mut String, a: Point, b: Point, colour: &str, dashes: &str) -> std::fmt::Result {
    polyline_of(svg, &[a, b], colour, dashes, 1.0)
}

fn polyline(svg: &mut String, points: &[Point], colour: &str, dashes: &str) -> std::fmt::Result {
    polyline_of(svg, points, colour, dashes, if dashes.is_empty() { 2.4 } else { 1.6 })
}

fn polyline_of(
    svg: &mut String,
    points: &[Point],
    colour: &str,
    dashes: &str,
    width: f64,
) -> std::fmt::Result {
    let points: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    let dashes = if dashes.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dashes}\"") };
    writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{dashes}/>",
        points.join(" ")
    )
}

/// From `a`, with its head at `b`.
fn arrow(svg: &mut String, a: Point, b: Point, colour: &str, width: f64) -> std::fmt::Result {
    let length = (b.0 - a.0).hypot(b.1 - a.1);
    let (x, y) = ((b.0 - a.0) / length, (b.1 - a.1) / length);
    let head = (4.0 + 2.4 * width).min(length);
    let base = (b.0 - head * x, b.1 - head * y);
    let half = 0.38 * head;
    polyline_of(svg, &[a, base], colour, "", width)?;
    writeln!(
        svg,
        "<path d=\"M{:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}Z\" fill=\"{colour}\"/>",
        b.0,
        b.1,
        base.0 - half * y,
        base.1 + half * x,
        base.0 + half * y,
        base.1 - half * x
    )
}

fn dot(svg: &mut String, at: Point) -> std::fmt::Result {
    writeln!(svg, "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{INK}\"/>", at.0, at.1)
}

fn label(svg: &mut String, at: Point, text: &str, colour: &str, anchor: &str) -> std::fmt::Result {
    writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{text}</text>",
        at.0, at.1
    )
}

fn italic(svg: &mut String, at: Point, text: &str, anchor: &str) -> std::fmt::Result {
    label(svg, at, &format!("<tspan font-style=\"italic\" font-size=\"19\">{text}</tspan>"), INK, anchor)
}

fn radius(svg: &mut String, at: Point, letter: &str, index: &str) -> std::fmt::Result {
    let text = format!(
        "<tspan font-style=\"italic\">{letter}</tspan><tspan font-size=\"11\" dy=\"4\">{index}</tspan>"
    );
    label(svg, at, &text, INK, "start")
}
