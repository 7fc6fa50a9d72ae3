//! The library in WebAssembly: a joint behind functions of numbers, which a page calls as its own.
//!
//! cargo build --release --no-default-features --example wasm_joint --target wasm32-unknown-unknown
//! node tests/wasm/check.mjs target/wasm32-unknown-unknown/release/examples/wasm_joint.wasm

use jointsweep::{
    Dimensions, Error, Idealization, Joint, Load, Material, MethodChoice, Options, Part, solve,
};

/// The force, N, on a steel pin of radius 9.95 mm with a rigid core of 2 mm, in a steel ring of 10 and `outer_radius` mm, 8 mm thick, in
/// plane stress, at an indentation in mm; by finite elements at 0.1 %, or by series. NaN where there is none.
#[unsafe(no_mangle)]
pub extern "C" fn force(outer_radius: f64, indentation: f64, is_series: bool) -> f64 {
    of_ring(outer_radius, indentation, is_series).unwrap_or(f64::NAN)
}

fn of_ring(outer_radius: f64, indentation: f64, is_series: bool) -> Result<f64, Error> {
    let steel = Material { youngs_modulus: 210e3, poissons_ratio: 0.3 };
    let joint = Joint::new(
        Dimensions { hole_radius: 10.0, radial_clearance: 0.05, thickness: 8.0 },
        Idealization::PlaneStress,
        Part::new("rigid-core", &[("core_radius_ratio", 0.2)], None, steel)?,
        Part::new("annulus", &[("outer_radius_ratio", outer_radius / 10.0)], None, steel)?,
    )?;
    let method = if is_series { MethodChoice::Series } else { MethodChoice::Fe };
    let steps = solve(&joint, &[Load::Indentation(indentation)], Options { method, accuracy: 1e-3 })?;
    Ok(steps[0].response.as_ref().map_or(f64::NAN, |response| response.force))
}
