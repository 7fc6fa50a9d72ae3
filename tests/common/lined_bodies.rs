//! Random bodies with layers.

use jointsweep::internals::mechanics::body::lining::{Interface, Lining};
use jointsweep::internals::mechanics::body::{Body, Shape, annulus, block, cored_disc, half_disc};
use jointsweep::internals::mechanics::material::Idealization;

use super::random::Random;

/// One to four layers, each of 0.3 to 30 % of the radius where it begins, moduli 0.003 to 300 of that at the ring; with the outermost
/// radius.
fn lining(random: &mut Random, outward: bool) -> (Lining, f64) {
    let count = 1 + (random.unit() * 4.0) as usize;
    let mut radius_ratio = 1.0;
    let mut interface = || {
        let thickness = random.log(3e-3, 0.3);
        radius_ratio *= if outward { 1.0 + thickness } else { 1.0 - thickness };
        Interface {
            radius_ratio,
            modulus_ratio: random.log(3e-3, 300.0),
            poissons_ratio: random.linear(-0.2, 0.46),
        }
    };
    let interfaces = (0..count).map(|_| interface()).collect();
    (Lining::new(interfaces), radius_ratio)
}

/// A lined plate or pin with exact modes.
pub fn concentric(random: &mut Random) -> Body {
    let is_plate = random.unit() < 0.5;
    let (lining, last) = lining(random, is_plate);
    let ratio = last * if is_plate { random.log(1.05, 30.0) } else { random.linear(0.02, 0.95) };
    body(random, if is_plate { &annulus::SHAPE } else { &cored_disc::SHAPE }, [ratio, 0.0, 0.0], lining)
}

/// A lined block or half disc.
pub fn without_modes(random: &mut Random) -> Body {
    let is_plate = random.unit() < 0.7;
    let (lining, last) = lining(random, is_plate);
    if !is_plate {
        return body(random, &half_disc::SHAPE, [0.0; 3], lining);
    }
    let ratios = [(); 3].map(|()| last * random.log(1.2, 10.0));
    body(random, &block::SHAPE, ratios, lining)
}

/// Either.
pub fn any(random: &mut Random) -> Body {
    if random.unit() < 0.4 { concentric(random) } else { without_modes(random) }
}

fn body(random: &mut Random, shape: &'static Shape, parameters: [f64; 3], lining: Lining) -> Body {
    Body {
        shape,
        parameters,
        support: (random.unit() * shape.supports.len() as f64) as usize,
        poissons_ratio: random.linear(-0.2, 0.46),
        idealization: Idealization::ALL[(random.unit() * 2.0) as usize],
        lining,
        all_around: false,
    }
}
