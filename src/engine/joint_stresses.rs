//! The stresses of a joint on circles: at the contact, at each interface, where a concentric body is held. Exact for concentric bodies; others
//! are told beside a concentric one, on meshes that become finer until the stresses change no more.

use crate::engine::joint_curve::JointCurve;
use crate::engine::joint_scale::JointScale;
use crate::mechanics::body::lining::MOST_LAYERS;
use crate::mechanics::body::{Body, Side};
use crate::mechanics::compliance::circle_stresses::{Stress, with_circles};
use crate::mechanics::compliance::concentric_body::ConcentricBody;
use crate::mechanics::compliance::mesh_stresses::MeshStresses;
use crate::mechanics::contact::arc_pressure::ArcPressure;
use crate::mechanics::grading::LEVEL_COUNT;
use crate::study::design::{JointDesign, Load};

/// On one circle, in one of the materials that meet there.
#[derive(Clone, Debug)]
pub struct CircleStresses {
    pub side: Side,
    /// From 1 at the contact; 0 is the part's own material.
    pub layer: usize,
    /// mm.
    pub radius: f64,
    pub points: Vec<PointStress>,
}

/// MPa.
#[derive(Clone, Copy, Debug)]
pub struct PointStress {
    /// From the load line, rad, of the pin at the pin's centre.
    pub angle: f64,
    pub radial: f64,
    pub hoop: f64,
    pub shear: f64,
    pub von_mises: f64,
}

/// Why a part has no stresses.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoStresses {
    /// Waves as short as the arc do not fade out before the modes end.
    #[error("the contact is too narrow beside what lies below it")]
    TooNarrow,
    #[error(
        "{circles} interfaces and depths; a mesh takes {MOST_LAYERS} at most: give fewer depths, or each in a call of its own"
    )]
    TooManyCircles { circles: usize },
    #[error(
        "on the finest mesh the stresses are known to {:.2} % of the greatest, where {:.2} % was asked", 100.0 * .change, 100.0 * .accuracy
    )]
    Rough { change: f64, accuracy: f64 },
    #[error("no mesh carries this body")]
    NoMesh,
}

/// Points from the load line to an end: half of them on the arc, where the stresses change most.
pub fn angles(points: usize, half_angle: f64, end: f64) -> Vec<f64> {
    let on_arc = if half_angle >= end { points } else { points / 2 + 1 };
    let even = |i: usize, count: usize| i as f64 / (count - 1).max(1) as f64;
    let beyond = points - on_arc;
    let on_arc = (0..on_arc).map(|i| half_angle.min(end) * even(i, on_arc));
    on_arc.chain((1..=beyond).map(|i| half_angle + (end - half_angle) * i as f64 / beyond as f64)).collect()
}

/// Where the circles of a body end, rad: in the corner of a half pin and its held face no stress is bounded.
fn end_angle(body: &Body) -> f64 {
    const BEFORE_CORNER: f64 = 0.85;
    body.shape.end_angle * if body.shape.end_face_held { BEFORE_CORNER } else { 1.0 }
}

/// The first mesh of those that become finer.
const COARSEST: usize = 1;

/// Pieces of the pressure that load a mesh.
const PIECES: usize = 2000;

/// Modes below this share of the greatest are rounding.
const ROUNDING: f64 = 1e-14;

impl JointCurve {
    /// The stresses of one side under a load on circles: of each material its near and its far one, from the contact on, and where there is room those at further
    /// depths below the contact, mm. Empty where nothing is pressed or the load has no state. `points` are 3 or more.
    pub fn stresses(
        &self,
        side: Side,
        load: Load,
        points: usize,
        depths: &[f64],
    ) -> Result<Vec<CircleStresses>, NoStresses> {
        let joint = self.joint();
        let bare = joint.body(joint.part(side));
        let radii: Vec<f64> =
            depths.iter().map(|depth| 1.0 + side.outward() * depth / joint.contact_radius(side)).collect();
        let body = Body { lining: with_circles(&bare, &radii), ..bare };
        let outlines = JointScale::of(joint).outlines;
        let of_pressure = |half_angle: f64, pressure: &ArcPressure, unit: f64| {
            let on_pin = pressure.on_pin(outlines.ratio());
            let (pressure, half_angle) = match side {
                Side::Pin => (&on_pin, outlines.of_pin(half_angle)),
                Side::Plate => (pressure, half_angle),
            };
            let angles = angles(points.max(3), half_angle, end_angle(&body));
            let stresses = match ConcentricBody::of(&body) {
                Some(body) => exact(&body, pressure, half_angle, &angles)?,
                None => on_meshes(&body, pressure, half_angle, &angles, self.accuracy())?,
            };
            Ok(circles(joint, &body, &angles, stresses, unit))
        };
        self.with_pressure(load, of_pressure).unwrap_or(Ok(Vec::new()))
    }
}

/// Of each material of a body its near circle and its far one, at angles, in the unit of the pressure.
pub type OfMaterials = Vec<[Vec<Stress>; 2]>;

/// Those of a concentric body, by its modes.
pub fn exact(
    body: &ConcentricBody,
    pressure: &ArcPressure,
    half_angle: f64,
    angles: &[f64],
) -> Result<OfMaterials, NoStresses> {
    let count = body.stress_modes(half_angle).ok_or(NoStresses::TooNarrow)?;
    Ok(sums(body, pressure, count, angles))
}

/// Those of a reference and what is beyond them, on meshes that become finer until no stress changes by more than the accuracy, relative to the
/// greatest. What is beyond the last circle of the body is the reference's own.
pub fn on_meshes(
    body: &Body,
    pressure: &ArcPressure,
    half_angle: f64,
    angles: &[f64],
    accuracy: f64,
) -> Result<OfMaterials, NoStresses> {
    let circles = body.lining.list().len();
    if circles > MOST_LAYERS {
        return Err(NoStresses::TooManyCircles { circles });
    }
    let pieces: Vec<(f64, f64)> = pressure.pieces(PIECES).collect();
    let mut before: Option<OfMaterials> = None;
    let mut change = f64::INFINITY;
    for level in COARSEST..LEVEL_COUNT {
        let Ok(meshes) = MeshStresses::new(body, level, &pieces) else { continue };
        let reference = ConcentricBody::of(&meshes.reference).ok_or(NoStresses::NoMesh)?;
        let mut own = exact(&reference, pressure, half_angle, angles)?;
        for (circle, difference) in meshes.differences().iter().enumerate() {
            for (place, angle) in angles.iter().enumerate() {
                let beyond = difference.at(*angle);
                if let Some(before) = circle.checked_sub(1) {
                    own[before][1][place] += reference.stress_on(before, beyond);
                }
                own[circle][0][place] += reference.stress_on(circle, beyond);
            }
        }
        if let Some(before) = &before {
            change = greatest_change(before, &own);
            if change <= accuracy {
                return Ok(own);
            }
        }
        before = Some(own);
    }
    Err(if before.is_some() { NoStresses::Rough { change, accuracy } } else { NoStresses::NoMesh })
}

/// Of any stress on a circle of the body, over the greatest.
pub fn greatest_change(before: &OfMaterials, own: &OfMaterials) -> f64 {
    let last = own.len() - 1;
    let on_body = |all: &OfMaterials| -> Vec<[f64; 3]> {
        let circles = all.iter().enumerate().flat_map(|(material, [near, far])| {
            near.iter().chain(far.iter().take(if material == last { 0 } else { far.len() }))
        });
        circles.map(|stress| [stress.radial, stress.hoop, stress.shear]).collect()
    };
    let (before, own) = (on_body(before), on_body(own));
    let greatest = own.as_flattened().iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let changes = before.as_flattened().iter().zip(own.as_flattened()).map(|(a, b)| (a - b).abs());
    // Not where it is NaN.
    changes.fold(0.0, |most: f64, change| if change <= most { most } else { change }) / greatest
}

fn sums(body: &ConcentricBody, pressure: &ArcPressure, count: usize, angles: &[f64]) -> OfMaterials {
    let none = vec![Stress::default(); angles.len()];
    let mut sums = vec![[none.clone(), none]; body.circles().len() - 1];
    let modes = pressure.modes(count);
    let least = ROUNDING * modes.iter().fold(0.0, |most: f64, mode| most.max(mode.abs()));
    for (n, of_mode) in modes.into_iter().enumerate().filter(|(_, mode)| mode.abs() > least) {
        let mut amplitudes = body.circle_stresses(n);
        // At the contact the radial stress is the pressure, which needs no sum, and the hoop stress the same and what lies beyond.
        let [contact, _] = &mut amplitudes[0];
        *contact = Stress { radial: 0.0, hoop: contact.hoop - contact.radial, shear: 0.0 };
        for (amplitude, sums) in amplitudes.as_flattened().iter().zip(sums.as_flattened_mut()) {
            for (angle, sum) in angles.iter().zip(sums) {
                let (sine, cosine) = (n as f64 * angle).sin_cos();
                sum.radial += of_mode * amplitude.radial * cosine;
                sum.hoop += of_mode * amplitude.hoop * cosine;
                sum.shear += of_mode * amplitude.shear * sine;
            }
        }
    }
    for (angle, sum) in angles.iter().zip(&mut sums[0][0]) {
        let pressure = pressure.at(*angle);
        (sum.radial, sum.hoop) = (-pressure, sum.hoop - pressure);
    }
    sums
}

/// As they are told: where nothing changes, one side of a circle is as good as the other.
fn circles(
    joint: &JointDesign,
    body: &Body,
    angles: &[f64],
    stresses: OfMaterials,
    unit: f64,
) -> Vec<CircleStresses> {
    let side = body.shape.side;
    let part = joint.part(side);
    // Where each layer ends, as the body has it.
    let ends: Vec<f64> =
        joint.body(part).lining.list().iter().map(|interface| interface.radius_ratio).collect();
    let interfaces = body.lining.list().iter().map(|interface| interface.radius_ratio);
    let radii: Vec<f64> = std::iter::once(1.0).chain(interfaces).chain(body.fixed_radius_ratio()).collect();
    let mut circles = Vec::new();
    for (place, [near, far]) in stresses.into_iter().enumerate() {
        let number = ends.iter().filter(|end| radii[..=place].contains(end)).count();
        let layer = part.layer_of(number);
        let axial_share = joint.idealization.axial_share(part.layer_material(layer).poissons_ratio);
        let point = |(angle, stress): (&f64, Stress)| {
            let [radial, hoop, shear] = [stress.radial, stress.hoop, stress.shear].map(|value| unit * value);
            let von_mises = Stress { radial, hoop, shear }.von_mises(axial_share);
            PointStress { angle: *angle, radial, hoop, shear, von_mises }
        };
        let is_edge = place == 0 || ends.contains(&radii[place]);
        let own = [(radii.get(place), near), (radii.get(place + 1), far)];
        for (radius, stresses) in own.into_iter().skip(usize::from(!is_edge)) {
            let Some(radius) = radius else { continue };
            circles.push(CircleStresses {
                side,
                layer,
                radius: joint.contact_radius(side) * radius,
                points: angles.iter().zip(stresses).map(point).collect(),
            });
        }
    }
    circles
}
