//! The joint of two rings as the library has it: hole radius and thickness 1 mm.

use jointsweep::internals::mechanics::body::{Shape, annulus, cored_disc};
use jointsweep::internals::mechanics::material::Material;
use jointsweep::internals::study::design::{JointDesign, Part};
use jointsweep::internals::study::layers::{Layer, Layers};

use super::stepped_ring::Ring;

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
        Layer { thickness, material: *material }
    });
    Part {
        shape,
        parameters: [ring.fixed_radius_ratio, 0.0, 0.0],
        support: 0,
        layers: Layers::new(layers.collect()),
        material: materials[ring.beyond.len()],
    }
}
