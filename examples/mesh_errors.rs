//! Measures what a mesh level is worth: of random bodies of every kind the error of the work of the contact pressure on each
//! level, against `series` where there is one and the finest mesh elsewhere, the other body of the joint being rigid.
//!
//! ```text
//! cargo run --release --example mesh_errors > known_errors.csv     # fifteen minutes; then over src/engine/accuracy/known_errors.csv
//! ```
//!
//! A number of the file is the error that 99 of 100 arcs of a kind are below, a quarter more, rounded up to two digits; and no
//! finer level is said to be worse than a coarser one.

#[path = "common/mesh_works.rs"]
mod mesh_works;
#[path = "../tests/common/random.rs"]
mod random;

use jointsweep::internals::engine::accuracy::known_errors::{
    COLUMNS, DEPTHS, Group, KNOWN_LEVELS, Kind, Stiffness, column,
};
use jointsweep::internals::engine::bodies::BodyLibrary;
use jointsweep::internals::engine::body_request::{BodyRequest, Fidelity};
use jointsweep::internals::engine::spaces::Spaces;
use jointsweep::internals::mechanics::body::{Body, annulus, block, cored_disc, half_disc};
use jointsweep::internals::mechanics::grading::LEVEL_COUNT;
use jointsweep::internals::mechanics::material::{Compressibility, Idealization};
use mesh_works::{Measured, rounded_up};
use random::Random;

/// Bodies of each group and stiffness, and within them of each depth; more blocks, which differ more.
const COUNT: usize = 60;
const COUNT_OF_BLOCKS: usize = 200;

/// Fewer arcs than this tell nothing.
const LEAST: usize = 24;

/// Share of the errors that a number is above, and how much it is raised.
const SHARE: f64 = 0.99;
const RAISED: f64 = 1.25;

/// Least and greatest Poisson's ratio.
fn range_in_plane_strain(stiffness: Stiffness) -> [f64; 2] {
    match stiffness {
        Stiffness::Auxetic => [Compressibility::NEARLY_CONFORMAL, 0.0],
        Stiffness::Ordinary => [0.0, Compressibility::STIFF],
        Stiffness::Stiff => [Compressibility::STIFF, Compressibility::VERY_STIFF],
        Stiffness::VeryStiff => [Compressibility::VERY_STIFF, Compressibility::NEARLY_INCOMPRESSIBLE],
        Stiffness::NearlyIncompressible => [Compressibility::NEARLY_INCOMPRESSIBLE, Compressibility::LOCKING],
    }
}

/// A body of a group and stiffness whose least depth is in a range.
fn draw(random: &mut Random, group: Group, stiffness: Stiffness, depths: [f64; 2]) -> Body {
    let idealization = match stiffness {
        Stiffness::Auxetic | Stiffness::Ordinary => Idealization::ALL[(random.unit() * 2.0) as usize],
        _ => Idealization::PlaneStrain,
    };
    let [least, greatest] = match idealization {
        Idealization::PlaneStress if stiffness == Stiffness::Ordinary => [0.0, 0.5],
        _ => range_in_plane_strain(stiffness),
    };
    let poissons_ratio = random.linear(least, greatest);
    // Where two sides are as long as that, the corner between them is as far as anything that was measured.
    let longest = group.depths()[1] - 0.5 * 2.0_f64.ln();
    let depth = |random: &mut Random| random.log(depths[0], depths[1].min(longest)).exp();
    let side = |random: &mut Random| random.log(depths[0], longest).exp();
    let (shape, parameters, support) = match group {
        Group::Concentric => {
            let ratio = random.log(depths[0], depths[1]).exp();
            match random.unit() < 0.5 {
                true => (&cored_disc::SHAPE, [1.0 / ratio, 0.0, 0.0], 0),
                false => (&annulus::SHAPE, [ratio, 0.0, 0.0], 0),
            }
        }
        Group::HalfDisc => (&half_disc::SHAPE, [0.0; 3], 0),
        Group::BlockOnBase | Group::BlockHeldAround => {
            let mut sides = [side(random), side(random), side(random)];
            sides[(random.unit() * 3.0) as usize] = depth(random);
            (&block::SHAPE, sides, usize::from(group == Group::BlockHeldAround))
        }
    };
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

/// A body with the levels that are to be known and what they are measured against.
fn measured(body: Body) -> Measured {
    let meshes = (0..KNOWN_LEVELS).map(|level| Fidelity::Mesh { level }).collect();
    let finest = Fidelity::Mesh { level: LEVEL_COUNT - 1 };
    Measured {
        body: body.clone(),
        meshes,
        judge: if body.shape.concentric { Fidelity::Series } else { finest },
    }
}

fn main() {
    let (mut library, mut spaces) = (BodyLibrary::default(), Spaces::default());
    let mut table = csv::Writer::from_writer(std::io::stdout());
    let columns = ["below_10_deg", "below_45_deg", "below_75_deg", "wider"];
    table.write_record(["group", "stiffness", "least_depth", "level"].iter().chain(&columns)).unwrap();
    for group in Group::ALL {
        let count = match group {
            Group::Concentric | Group::HalfDisc => COUNT,
            Group::BlockOnBase | Group::BlockHeldAround => COUNT_OF_BLOCKS,
        };
        for stiffness in Stiffness::ALL {
            for depths in DEPTHS.windows(2).filter(|depths| depths[0] >= group.depths()[0]) {
                let mut random = Random::new(91);
                // By the depth of the body; blocks have others than they were drawn for where sides are alike.
                let bodies: Vec<Body> =
                    (0..count).map(|_| draw(&mut random, group, stiffness, [depths[0], depths[1]])).collect();
                let kind = |body: &&Body| {
                    Kind::of(body).filter(|kind| kind.group == group && DEPTHS[kind.depth] == depths[0])
                };
                let of_kind = bodies.iter().filter(|body| kind(body).is_some());
                let bodies: Vec<Measured> = of_kind.cloned().map(measured).collect();
                let mut found: [Vec<Vec<f64>>; COLUMNS.len() + 1] = [const { Vec::new() }; 4];
                for bodies in bodies.chunks(64) {
                    library.solve(&bodies.iter().flat_map(Measured::requests).collect::<Vec<BodyRequest>>());
                    let arcs = bodies.iter().flat_map(|body| body.arcs(&library, &mut spaces));
                    for (half_angle, errors, _) in arcs {
                        found[column(half_angle)].push(errors);
                    }
                }
                if found[0].len() < LEAST {
                    continue;
                }
                let mut rows = [[0.0; COLUMNS.len() + 1]; KNOWN_LEVELS];
                for (column, errors) in found.iter().enumerate() {
                    // Wide contacts that no load comes to are like those before.
                    if errors.len() < LEAST {
                        rows.iter_mut().for_each(|row| row[column] = row[column - 1]);
                        continue;
                    }
                    let mut least: f64 = 0.0;
                    for level in (0..KNOWN_LEVELS).rev() {
                        let mut of_level: Vec<f64> = errors.iter().map(|errors| errors[level]).collect();
                        of_level.sort_by(f64::total_cmp);
                        let error = RAISED * of_level[(SHARE * of_level.len() as f64) as usize];
                        least = least.max(rounded_up(error));
                        rows[level][column] = least;
                    }
                }
                for (level, errors) in rows.iter().enumerate() {
                    let errors = errors.map(|error| format!("{error:.1e}"));
                    table.serialize((group, stiffness, depths[0], level, errors)).unwrap();
                }
            }
        }
    }
}
