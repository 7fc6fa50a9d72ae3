//! Measures how far the change from one mesh to the next finer one tells the error of the finer: of random bodies of each trust the
//! change and the error of the work of the contact pressure on each level, against `series` where there is one and the finest
//! mesh elsewhere, the other body of the joint being rigid.
//!
//! ```text
//! cargo run --release --example mesh_changes > mesh_changes.csv     # two to six minutes; then over src/engine/accuracy/mesh_changes.csv
//! ```
//!
//! The two numbers of a row: for each of some multiples of the change the floor is what the rest of the errors, each a quarter more, is
//! below on 98 of 100 arcs; where both meshes may be wrong alike, on 99. Of these pairs the one is taken whose estimates
//! have the least geometric mean, rounded up to two digits; and no finer level is said to be worse than a coarser one.

#[path = "common/mesh_works.rs"]
mod mesh_works;
#[path = "../tests/common/lined_bodies.rs"]
mod lined_bodies;
#[path = "../tests/common/random.rs"]
mod random;

use jointsweep::internals::engine::accuracy::mesh_change::Trust;
use jointsweep::internals::engine::bodies::BodyLibrary;
use jointsweep::internals::engine::body_request::{BodyRequest, Fidelity};
use jointsweep::internals::engine::refusal::{Refusal, is_bounded};
use jointsweep::internals::engine::spaces::Spaces;
use jointsweep::internals::mechanics::body::{Body, DEEPEST_MESHED, annulus, block, cored_disc, half_disc};
use jointsweep::internals::mechanics::grading::LEVEL_COUNT;
use jointsweep::internals::mechanics::material::Idealization;
use mesh_works::{Measured, rounded_up};
use random::Random;

/// Bodies of each trust.
const COUNT: usize = 160;

/// Multiples of the change that are tried.
const MULTIPLES: [f64; 11] = [0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0];

/// How much errors are raised.
const RAISED: f64 = 1.25;

/// Estimates below it are as good as it.
const GOOD: f64 = 1e-5;

/// Where both meshes may be wrong alike random bodies do not show the worst: neither number is below these, which held for the
/// designs of `tests/engine/extremes.rs`. By level, coarsest first.
const LEAST_OF_WARY: [[f64; 2]; LEVEL_COUNT] =
    [[12.0, 1.2e-2], [12.0, 1.2e-2], [6.0, 1.9e-3], [6.0, 1.2e-3], [4.0, 4.6e-4], [4.0, 2.3e-4]];
const LEAST_OF_FILMS: [[f64; 2]; LEVEL_COUNT] =
    [[4.0, 0.1], [4.0, 0.1], [2.0, 0.1], [2.0, 0.1], [1.5, 0.1], [1.5, 0.1]];

/// Far boundaries of blocks, |ln r|, are drawn up to here.
const FARTHEST_SIDE: f64 = 6.0;

/// A body of any kind that is solved on meshes, with the ends of each range drawn often.
fn draw(random: &mut Random) -> Body {
    let idealization = Idealization::ALL[(random.unit() * 2.0) as usize];
    let poissons_ratio = match (random.unit() * 4.0) as usize {
        0 => 0.5 - random.log(1e-4, 0.1),
        1 => -1.0 + random.log(0.01, 0.4),
        _ => random.linear(-0.9, 0.49),
    };
    let ring = |random: &mut Random| random.log(annulus::SHAPE.thinnest_meshed, DEEPEST_MESHED).exp();
    let side = |random: &mut Random| random.log(block::SHAPE.thinnest_meshed, FARTHEST_SIDE).exp();
    let (shape, parameters) = match (random.unit() * 5.0) as usize {
        0 => (&cored_disc::SHAPE, [1.0 / ring(random), 0.0, 0.0]),
        1 => (&annulus::SHAPE, [ring(random), 0.0, 0.0]),
        2 => (&half_disc::SHAPE, [0.0; 3]),
        _ => (&block::SHAPE, [side(random), side(random), side(random)]),
    };
    let support = (random.unit() * shape.supports.len() as f64) as usize;
    Body {
        shape,
        parameters,
        support,
        poissons_ratio,
        idealization,
        lining: Default::default(),
        all_around: false,
    }
}

/// A body with all its meshes that are not too large.
fn measured(body: Body) -> Measured {
    let bounded = (0..LEVEL_COUNT).take_while(|level| is_bounded(&body, *level));
    let mut meshes: Vec<Fidelity> = bounded.map(|level| Fidelity::Mesh { level }).collect();
    let finest = if body.shape.concentric { None } else { meshes.pop() };
    Measured { body, meshes, judge: finest.unwrap_or(Fidelity::Series) }
}

/// Bodies of a trust, lined ones apart: others are drawn as if there were none of these. No mesh judges another where films are squeezed.
fn drawn(random: &mut Random, trust: Trust) -> Vec<Measured> {
    let is_of_trust = |body: &Body| {
        let request = BodyRequest { body: body.clone(), fidelity: Fidelity::Mesh { level: 0 } };
        let has_judge = trust != Trust::SqueezedFilm || body.shape.concentric;
        Refusal::of_mesh(body).is_none() && Trust::of(&request) == trust && has_judge
    };
    let mut lined = Random::new(93);
    let draw = || if trust == Trust::Lined { lined_bodies::any(&mut lined) } else { draw(random) };
    std::iter::repeat_with(draw).filter(is_of_trust).map(measured).take(COUNT).collect()
}

/// Of one arc on one level, relative, of the work.
struct Sample {
    change: f64,
    error: f64,
}

/// Of each level from 1 on, as far as there is a judge.
fn samples(bodies: &[Measured]) -> [Vec<Sample>; LEVEL_COUNT] {
    let (mut library, mut spaces) = (BodyLibrary::default(), Spaces::default());
    let mut samples = [const { Vec::new() }; LEVEL_COUNT];
    for bodies in bodies.chunks(64) {
        library.solve(&bodies.iter().flat_map(Measured::requests).collect::<Vec<BodyRequest>>());
        for (_, errors, changes) in bodies.iter().flat_map(|body| body.arcs(&library, &mut spaces)) {
            for (place, (error, change)) in errors.into_iter().skip(1).zip(changes).enumerate() {
                samples[place + 1].push(Sample { change, error });
            }
        }
    }
    samples
}

/// Error per change and floor of a level, neither below its least.
fn fitted(samples: &[Sample], share: f64, least: [f64; 2]) -> [f64; 2] {
    let pair = |multiple: f64| {
        let mut rests: Vec<f64> =
            samples.iter().map(|Sample { change, error }| RAISED * error - multiple * change).collect();
        rests.sort_by(f64::total_cmp);
        [multiple, rests[(share * rests.len() as f64) as usize].max(least[1])]
    };
    let worth = |[multiple, floor]: &[f64; 2]| -> f64 {
        samples.iter().map(|sample| (multiple * sample.change + floor).max(GOOD).ln()).sum()
    };
    let pairs = MULTIPLES.into_iter().filter(|multiple| *multiple >= least[0]).map(pair);
    let [multiple, floor] = pairs.min_by(|one, other| worth(one).total_cmp(&worth(other))).unwrap_or(least);
    [multiple, rounded_up(floor.max(f64::MIN_POSITIVE))]
}

fn main() {
    let mut random = Random::new(92);
    let mut table = csv::Writer::from_writer(std::io::stdout());
    table.write_record(["trust", "level", "error_per_change", "floor"]).unwrap();
    for trust in Trust::ALL {
        let samples = samples(&drawn(&mut random, trust));
        let (share, least) = match trust {
            Trust::Concentric | Trust::Full => (0.98, [[0.0; 2]; LEVEL_COUNT]),
            Trust::Lined => (0.99, [[0.0; 2]; LEVEL_COUNT]),
            Trust::Wary => (0.99, LEAST_OF_WARY),
            Trust::SqueezedFilm => (0.99, LEAST_OF_FILMS),
        };
        // The finest mesh has no judge but `series`; elsewhere it is taken for no better than the one before.
        let last = if trust == Trust::Concentric { LEVEL_COUNT - 1 } else { LEVEL_COUNT - 2 };
        let mut rows = least;
        for level in (1..=last).rev() {
            let finer = if level == last { [0.0; 2] } else { rows[level + 1] };
            let least = [0, 1].map(|number| finer[number].max(least[level][number]));
            rows[level] = fitted(&samples[level], share, least);
        }
        rows[LEVEL_COUNT - 1] = rows[last];
        for (level, [multiple, floor]) in rows.into_iter().enumerate().skip(1) {
            table.serialize((trust, level, format!("{multiple:.1e}"), format!("{floor:.1e}"))).unwrap();
        }
    }
}
