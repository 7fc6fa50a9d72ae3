//! Measures what a mesh level is worth: of random bodies of every shape the error of the work of the contact pressure on
//! each level, against `series` where there is one and the finest mesh elsewhere, the other body of the joint being
//! rigid. Prints a CSV; `src/engine/known_errors.rs` has what was read from it.
//!
//! ```text
//! cargo run --release --example mesh_errors -- 400 > mesh_errors.csv           # of each shape; block alone takes minutes
//! cargo run --release --example mesh_errors -- 1000 rigid-core annulus > concentric.csv
//! cargo run --release --example mesh_errors -- 400 stiff block > stiff_block.csv      # in plane strain, nu from 0.42 to 0.49
//! ```

#[path = "../tests/common/random.rs"]
mod random;

use std::f64::consts::PI;

use jointsweep::engine::bodies::BodyLibrary;
use jointsweep::engine::plan::space_of;
use jointsweep::engine::request::{BodyRequest, Fidelity};
use jointsweep::mechanics::body::{Body, SHAPES, Shape};
use jointsweep::mechanics::compliance::PressureCompliance;
use jointsweep::mechanics::contact::loading::{DimensionlessLoad, JointCurve};
use jointsweep::mechanics::contact::pressure::JointCompliance;
use jointsweep::mechanics::grading::LEVEL_COUNT;
use jointsweep::mechanics::material::Idealization;
use random::Random;

/// A body anywhere in the range that the program is meant for.
fn draw(random: &mut Random, shape: &'static Shape, is_stiff: bool) -> Body {
    let idealization = Idealization::ALL[(random.unit() * 2.0) as usize];
    let poissons_ratio = match (random.unit() * 8.0) as u32 {
        0 => 0.5 - random.log(1e-4, 0.1),
        1 => -0.9 + random.log(1e-4, 0.3),
        2 => random.linear(-0.9, 0.0),
        _ => random.linear(0.0, 0.49),
    };
    let (idealization, poissons_ratio) = match is_stiff {
        true => (Idealization::PlaneStrain, random.linear(0.42, 0.49)),
        false => (idealization, poissons_ratio),
    };
    let mut parameters = [0.0; 3];
    for (parameter, value) in shape.parameters.iter().zip(&mut parameters) {
        let ratio = match shape.sides.is_empty() {
            // Finer meshes of others take minutes.
            false => random.log(1.2, 10.0),
            true if random.unit() < 0.3 => 1.0 + random.log(0.02, 1.0),
            true => random.log(1.1, 300.0),
        };
        *value = if parameter.below <= 1.0 { (1.0 / ratio).max(0.01) } else { ratio };
    }
    let support = (random.unit() * shape.supports.len().max(1) as f64) as usize;
    Body { shape, parameters, support, poissons_ratio, idealization }
}

/// A joint with the body and a rigid partner; modulus of what does not yield.
const RIGID: f64 = 1e12;

/// Contact half angles under loads of eight decades, deg, with the error of each level but the finest.
fn errors(library: &BodyLibrary, body: &Body) -> Option<Vec<(f64, [f64; LEVELS])>> {
    let space = space_of(body, body, 1e-6, PI);
    let key = |fidelity| BodyRequest { body: *body, fidelity, space }.key();
    let finest = Fidelity::Mesh { level: LEVEL_COUNT - 1 };
    let exact = library.compliance(&key(if body.shape.concentric { Fidelity::Series } else { finest }));
    let partner = PressureCompliance {
        terms: exact.terms,
        amplitude: 0.0,
        bed: 0.0,
        values: vec![0.0; exact.values.len()],
    };
    let joint = JointCompliance::new(library.space(space), (exact, 1.0), (&partner, RIGID));
    let curve = JointCurve::new(joint).ok()?;
    let loads = [1e-6, 1e-4, 1e-2, 0.1, 0.5, 2.0, 10.0, 1e2].map(DimensionlessLoad::Indentation);
    let states: Vec<_> = curve.states(1.0, &loads).into_iter().flatten().collect();
    let mut rows: Vec<(f64, [f64; LEVELS])> =
        states.iter().map(|state| (state.arc.half_angle.to_degrees(), [0.0; LEVELS])).collect();
    for level in 0..LEVELS {
        let mesh = library.compliance(&key(Fidelity::Mesh { level }));
        let changes = curve.joint().relative_changes(&states, &mesh.minus(exact));
        rows.iter_mut().zip(changes).for_each(|(row, change)| row.1[level] = change);
    }
    Some(rows)
}

/// All but the finest.
const LEVELS: usize = LEVEL_COUNT - 1;

fn main() {
    let count: usize = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(400);
    let mut random = Random::new(91);
    println!(
        "shape,support,idealization,poissons_ratio,ratio_1,ratio_2,ratio_3,least_depth,greatest_depth,\
         half_angle_deg,level_0,level_1,level_2,level_3,level_4"
    );
    let mut library = BodyLibrary::default();
    let (stiff, wanted): (Vec<String>, Vec<String>) =
        std::env::args().skip(2).partition(|word| word == "stiff");
    for shape in SHAPES {
        if !wanted.is_empty() && !wanted.iter().any(|name| name == shape.name) {
            continue;
        }
        let bodies: Vec<Body> = (0..count).map(|_| draw(&mut random, shape, !stiff.is_empty())).collect();
        for bodies in bodies.chunks(64) {
            // The finest takes longest and judges the shapes without `series` alone.
            let levels = if shape.concentric { LEVEL_COUNT - 1 } else { LEVEL_COUNT };
            let fidelities = (0..levels).map(|level| Fidelity::Mesh { level });
            let fidelities: Vec<Fidelity> =
                fidelities.chain(shape.concentric.then_some(Fidelity::Series)).collect();
            let requests: Vec<BodyRequest> = bodies
                .iter()
                .flat_map(|body| {
                    fidelities.iter().map(|&fidelity| BodyRequest {
                        body: *body,
                        fidelity,
                        space: space_of(body, body, 1e-6, PI),
                    })
                })
                .collect();
            library.solve(&requests);
            for body in bodies {
                let (least, greatest) = (shape.depth_range)(&body.parameters);
                let [a, b, c] = body.parameters;
                for (half_angle, errors) in errors(&library, body).into_iter().flatten() {
                    let (name, support, nu) = (shape.name, body.support, body.poissons_ratio);
                    print!("{name},{support},{},{nu},{a},{b},{c},", body.idealization.name());
                    print!("{least},{greatest},{half_angle}");
                    errors.iter().for_each(|error| print!(",{error:e}"));
                    println!();
                }
            }
        }
    }
}
