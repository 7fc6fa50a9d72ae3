//! The stresses of a joint on the circles of its concentric bodies: at the contact, at each interface, where a body is held.

use std::f64::consts::PI;

use crate::engine::joint_curve::JointCurve;
use crate::engine::joint_scale::JointScale;
use crate::mechanics::body::Side;
use crate::mechanics::compliance::circle_stresses::Stress;
use crate::mechanics::compliance::series::ConcentricBody;
use crate::mechanics::contact::arc_pressure::ArcPressure;
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoStresses {
    /// Only concentric bodies have exact modes.
    #[error("stresses are known of concentric bodies only, a rigid-core pin and an annulus")]
    NotConcentric,
    /// Waves as short as the arc do not fade out before the modes end.
    #[error("the contact is too narrow beside what lies below it")]
    TooNarrow,
}

/// Points from the load line to the far side: half of them on the arc, where the stresses change most.
fn angles(points: usize, half_angle: f64) -> Vec<f64> {
    let on_arc = if half_angle == PI { points } else { points / 2 + 1 };
    let even = |i: usize, count: usize| i as f64 / (count - 1).max(1) as f64;
    let beyond = points - on_arc;
    let on_arc = (0..on_arc).map(|i| half_angle * even(i, on_arc));
    on_arc.chain((1..=beyond).map(|i| half_angle + (PI - half_angle) * i as f64 / beyond as f64)).collect()
}

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
        let bare = ConcentricBody::of(&joint.body(joint.part(side))).ok_or(NoStresses::NotConcentric)?;
        let radii: Vec<f64> =
            depths.iter().map(|depth| 1.0 + side.outward() * depth / joint.contact_radius(side)).collect();
        let body = bare.with_circles(&radii);
        let outlines = JointScale::of(joint).outlines;
        let of_pressure = |half_angle: f64, pressure: &ArcPressure, unit: f64| {
            let on_pin = pressure.on_pin(outlines.ratio());
            let (pressure, half_angle) = match side {
                Side::Pin => (&on_pin, outlines.of_pin(half_angle)),
                Side::Plate => (pressure, half_angle),
            };
            let count = body.stress_modes(half_angle).ok_or(NoStresses::TooNarrow)?;
            let angles = angles(points.max(3), half_angle);
            let sums = sums(&body, pressure, count, &angles);
            Ok(circles(joint, side, &body, &angles, sums, unit))
        };
        self.with_pressure(load, of_pressure).unwrap_or(Ok(Vec::new()))
    }
}

/// Of each material of a body its near circle and its far one, in the unit of the pressure.
fn sums(
    body: &ConcentricBody,
    pressure: &ArcPressure,
    count: usize,
    angles: &[f64],
) -> Vec<[Vec<Stress>; 2]> {
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

fn circles(
    joint: &JointDesign,
    side: Side,
    body: &ConcentricBody,
    angles: &[f64],
    sums: Vec<[Vec<Stress>; 2]>,
    unit: f64,
) -> Vec<CircleStresses> {
    let part = joint.part(side);
    // Where each layer ends, as the body has it.
    let ends: Vec<f64> =
        joint.body(part).lining.list().iter().map(|interface| interface.radius_ratio).collect();
    let radii = body.circles();
    let mut circles = Vec::new();
    for (place, [near, far]) in sums.into_iter().enumerate() {
        let number = ends.iter().filter(|end| radii[..=place].contains(end)).count();
        let layer = part.layer_of(number);
        let axial_share = joint.idealization.axial_share(part.layer_material(layer).poissons_ratio);
        let point = |(angle, stress): (&f64, Stress)| {
            let [radial, hoop, shear] = [stress.radial, stress.hoop, stress.shear].map(|value| unit * value);
            let von_mises = Stress { radial, hoop, shear }.von_mises(axial_share);
            PointStress { angle: *angle, radial, hoop, shear, von_mises }
        };
        // Where nothing changes, one side is as good as the other.
        let is_edge = place == 0 || ends.contains(&radii[place]);
        for (radius, stresses) in
            [(radii[place], near), (radii[place + 1], far)].into_iter().skip(usize::from(!is_edge))
        {
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
