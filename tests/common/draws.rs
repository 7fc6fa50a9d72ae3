//! Random designs over the whole range the program is meant for: dissimilar materials, both idealizations, dR/R2 from
//! 1e-6 to 0.03, delta/dR from 0.01 to 100, plates from thin (1.2) to wide (50).

use jointsweep::internals::mechanics::body::{Shape, annulus, block, cored_disc, half_disc};
use jointsweep::internals::mechanics::material::{Idealization, Material};
use jointsweep::internals::study::design::{DesignCase, JointDesign, Load, Part};

use super::random::Random;

fn part(random: &mut Random, shape: &'static Shape, parameters: [f64; 3], support: usize) -> Part {
    let material =
        Material { youngs_modulus: random.log(1e3, 5e5), poissons_ratio: random.linear(0.0, 0.49) };
    Part { shape, parameters, support, material, layers: Default::default(), yield_stress: None }
}

/// Designs with the bodies that `shapes` draws.
pub fn draw(seed: u64, count: u64, shapes: fn(&mut Random) -> (Part, Part)) -> Vec<DesignCase> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|index| {
            let hole_radius = random.log(1.0, 1000.0);
            let radial_clearance = hole_radius * random.log(1e-6, 0.03);
            let indentation = radial_clearance * random.log(0.01, 100.0);
            let (pin, plate) = shapes(&mut random);
            let idealization = Idealization::ALL[(random.unit() * 2.0) as usize];
            let joint =
                JointDesign { idealization, hole_radius, radial_clearance, thickness: 1.0, pin, plate };
            DesignCase { index, joint, steps: vec![Load::Indentation(indentation)].into() }
        })
        .collect()
}

pub fn concentric(random: &mut Random) -> (Part, Part) {
    let core = random.linear(0.03, 0.8);
    let ratio = random.log(1.2, 50.0);
    (
        part(random, &cored_disc::SHAPE, [core, 0.0, 0.0], 0),
        part(random, &annulus::SHAPE, [ratio, 0.0, 0.0], 0),
    )
}

pub fn half_disc_in_annulus(random: &mut Random) -> (Part, Part) {
    let ratio = random.log(1.2, 50.0);
    (part(random, &half_disc::SHAPE, [0.0; 3], 0), part(random, &annulus::SHAPE, [ratio, 0.0, 0.0], 0))
}

pub fn disc_in_block(random: &mut Random) -> (Part, Part) {
    let core = random.linear(0.03, 0.8);
    let ratios = [random.log(1.2, 10.0), random.log(1.2, 10.0), random.log(1.2, 10.0)];
    let support = (random.unit() * 2.0) as usize;
    (part(random, &cored_disc::SHAPE, [core, 0.0, 0.0], 0), part(random, &block::SHAPE, ratios, support))
}
