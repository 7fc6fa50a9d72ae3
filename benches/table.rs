//! Rows a second, and bytes, that the text of table.csv is made with, one core; items are rows:
//! `cargo bench --bench table`.

use divan::Bencher;
use divan::counter::{BytesCount, ItemsCount};
use jointsweep::internals::engine::outcome::{BackendKind, DesignOutcome, Method, Response, StepOutcome};
use jointsweep::internals::engine::status::Status;
use jointsweep::internals::mechanics::body::{annulus, cored_disc};
use jointsweep::internals::mechanics::material::{Idealization, Material};
use jointsweep::internals::output::sink::Sink;
use jointsweep::internals::output::table::Table;
use jointsweep::internals::study::design::{DesignCase, JointDesign, Load, Part};

fn outcome(index: u64, step_count: usize) -> DesignOutcome {
    // Numbers with all their digits, as a random sweep has them.
    let wild = |scale: f64, salt: u64| scale * (1.0 + ((index * 16 + salt) as f64).sin().abs());
    let part = |shape, ratio, salt| Part {
        shape,
        parameters: [ratio, 0.0, 0.0],
        support: 0,
        material: Material { youngs_modulus: wild(1e5, salt), poissons_ratio: wild(0.2, salt + 1) },
        layers: Default::default(),
        yield_stress: None,
    };
    let joint = JointDesign {
        idealization: Idealization::PlaneStrain,
        hole_radius: wild(10.0, 0),
        radial_clearance: wild(0.01, 1),
        thickness: wild(5.0, 2),
        pin: part(&cored_disc::SHAPE, wild(0.1, 3), 4),
        plate: part(&annulus::SHAPE, wild(2.0, 6), 7),
    };
    let step = |step: usize| StepOutcome {
        response: Some(Response {
            offset: 0.15,
            indentation: wild(0.01, step as u64),
            force: wild(5e3, step as u64),
            tangent_stiffness: wild(1e5, step as u64),
            contact_half_angle: Some(wild(0.4, step as u64)),
            peak_pressure_angle: None,
            peak_pressure: Some(wild(80.0, step as u64)),
            energy: Some(wild(25.0, step as u64)),
            force_error: wild(1e-3, step as u64),
            linearity_error: Some(0.0012),
            method: Method::Fe,
        }),
        status: Status::OK,
    };
    let steps = (0..step_count).map(|step| Load::Indentation(wild(0.01, step as u64))).collect();
    DesignOutcome {
        case: DesignCase { index, joint, steps },
        backend: BackendKind::Cpu,
        steps: (0..step_count).map(step).collect(),
        laws: None,
    }
}

const ROWS: usize = 1000;

fn main() {
    divan::main();
}

/// By the count of steps a design, whose rows share the text of its inputs.
#[divan::bench(args = [1, 10])]
fn rows(bencher: Bencher, step_count: usize) {
    let outcomes: Vec<_> = (0..ROWS / step_count).map(|i| outcome(i as u64, step_count)).collect();
    let table = Table::default();
    let write = || table.rows(&outcomes).len();
    let bytes = write();
    bencher.counter(ItemsCount::new(ROWS)).counter(BytesCount::new(bytes)).bench_local(write);
}
