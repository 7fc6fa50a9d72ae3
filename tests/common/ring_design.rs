//! The joint of two rings as the library has it, hole radius and thickness 1 mm; and rings to draw.

use jointsweep::internals::mechanics::body::{Shape, annulus, cored_disc};
use jointsweep::internals::mechanics::material::{Idealization, Material};
use jointsweep::internals::study::design::{JointDesign, Part};
use jointsweep::internals::study::layers::{Layer, Layers};

use super::random::Random;
use super::stepped_ring::{Beyond, Ring};

/// Of a pin and a plate, with a clearance, below zero of a press fit.
pub fn ring_design([pin, plate]: &[Ring; 2], radial_clearance: f64) -> JointDesign {
    JointDesign {
        idealization: pin.idealization,
        hole_radius: 1.0,
        radial_clearance,
        thickness: 1.0,
        pin: part(&cored_disc::SHAPE, pin, 1.0 - radial_clearance),
        plate: part(&annulus::SHAPE, plate, 1.0),
    }
}

fn part(shape: &'static Shape, ring: &Ring, radius: f64) -> Part {
    let material = |youngs_modulus, poissons_ratio| Material { youngs_modulus, poissons_ratio };
    let mut materials = vec![material(ring.youngs_modulus, ring.poissons_ratio)];
    materials.extend(ring.beyond.iter().map(|layer| material(layer.youngs_modulus, layer.poissons_ratio)));
    let mut near = 1.0;
    let layers = ring.beyond.iter().zip(&materials).map(|(layer, material)| {
        let thickness = radius * (layer.radius_ratio - near).abs();
        near = layer.radius_ratio;
        Layer::new(thickness, *material)
    });
    Part {
        shape,
        parameters: [ring.fixed_radius_ratio, 0.0, 0.0],
        support: 0,
        layers: Layers::new(layers.collect()),
        yield_stress: None,
        material: materials[ring.beyond.len()],
    }
}

/// A wall with up to two layers.
fn ring(random: &mut Random, outward: bool, idealization: Idealization) -> Ring {
    let mut radius_ratio = 1.0;
    let count = (random.unit() * 3.0) as usize;
    let beyond: Vec<Beyond> = (0..count)
        .map(|_| {
            let thickness = random.log(0.05, 0.2);
            radius_ratio *= if outward { 1.0 + thickness } else { 1.0 - thickness };
            Beyond {
                radius_ratio,
                youngs_modulus: 1e5 * random.log(0.03, 3.0),
                poissons_ratio: random.linear(0.0, 0.45),
            }
        })
        .collect();
    let wall = random.linear(0.3, 1.0);
    Ring {
        fixed_radius_ratio: radius_ratio * if outward { 1.0 + 2.0 * wall } else { 1.0 - 0.8 * wall },
        youngs_modulus: 1e5 * random.log(0.03, 3.0),
        poissons_ratio: random.linear(0.0, 0.45),
        idealization,
        beyond: beyond.leak(),
    }
}

/// A pin and a plate, MPa.
pub fn rings(random: &mut Random) -> [Ring; 2] {
    let idealization = Idealization::ALL[(random.unit() * 2.0) as usize];
    [ring(random, false, idealization), ring(random, true, idealization)]
}
