//! Time of the contact of one joint, one core, its bodies being solved: the joint's compliance from its two bodies', the
//! curve's samples, ten loads found on it, and what an error estimate takes: `cargo bench --bench contact`.

use divan::{Bencher, black_box};
use jointsweep::mechanics::compliance::PressureCompliance;
use jointsweep::mechanics::compliance::arc::TERM_CHOICES;
use jointsweep::mechanics::compliance::pressure_space::PressureSpace;
use jointsweep::mechanics::compliance::series::ConcentricBody;
use jointsweep::mechanics::contact::arc_state::ArcState;
use jointsweep::mechanics::contact::loading::{DimensionlessLoad, JointCurve};
use jointsweep::mechanics::contact::pressure::JointCompliance;
use jointsweep::mechanics::contact::smooth_curve::nodes::CurveNodes;
use jointsweep::mechanics::contact::smooth_curve::{CURVE_TERMS, SmoothCurve};
use jointsweep::mechanics::material::Idealization;

const RADIAL_CLEARANCE: f64 = 1e-3;

struct Joint {
    space: PressureSpace,
    pin: PressureCompliance,
    plate: PressureCompliance,
}

impl Joint {
    fn new(terms: usize) -> Joint {
        let space = PressureSpace::new(terms, 2.4);
        let highest = 60;
        let moments = space.moments(highest);
        let solve = |fixed_radius| {
            let idealization = Idealization::PlaneStress;
            let body = ConcentricBody { fixed_radius, poissons_ratio: 0.3, idealization };
            body.compliance(&space, &moments, highest)
        };
        let (pin, plate) = (solve(0.3), solve(3.0));
        Joint { space, pin, plate }
    }

    /// At the nodes of curves, with its amplitude.
    fn resampled(&self, nodes: &CurveNodes) -> (Vec<f64>, f64) {
        let [pin, plate] = [&self.pin, &self.plate].map(|body| nodes.resample(&self.space, &body.values));
        let values = pin.iter().zip(&plate).map(|(pin, plate)| pin + plate / 0.4).collect();
        (values, self.pin.amplitude + self.plate.amplitude / 0.4)
    }

    fn compliance(&self) -> JointCompliance<'_> {
        JointCompliance::new(&self.space, (&self.pin, 1.0), (&self.plate, 0.4))
    }
}

/// Indentations from a hundredth of the clearance to ten times it.
fn loads() -> [DimensionlessLoad; 10] {
    std::array::from_fn(|i| {
        DimensionlessLoad::Indentation(RADIAL_CLEARANCE * 10.0_f64.powf(-2.0 + i as f64 / 3.0))
    })
}

fn main() {
    divan::main();
}

#[divan::bench(args = TERM_CHOICES)]
fn joint_from_bodies(bencher: Bencher, terms: usize) {
    let joint = Joint::new(terms);
    bencher.bench_local(|| black_box(joint.compliance()));
}

#[divan::bench(args = TERM_CHOICES)]
fn curve_sampled(bencher: Bencher, terms: usize) {
    let joint = Joint::new(terms);
    bencher.with_inputs(|| joint.compliance()).bench_local_values(|joint| JointCurve::new(joint).unwrap());
}

#[divan::bench(args = TERM_CHOICES)]
fn ten_loads_found(bencher: Bencher, terms: usize) {
    let joint = Joint::new(terms);
    let curve = JointCurve::new(joint.compliance()).unwrap();
    let loads = loads();
    bencher.bench_local(|| curve.states(RADIAL_CLEARANCE, black_box(&loads)));
}

/// The change that one body's coarser mesh would make, for ten states.
#[divan::bench(args = TERM_CHOICES)]
fn ten_changes(bencher: Bencher, terms: usize) {
    let joint = Joint::new(terms);
    let curve = JointCurve::new(joint.compliance()).unwrap();
    let states: Vec<ArcState> =
        curve.states(RADIAL_CLEARANCE, &loads()).into_iter().map(Result::unwrap).collect();
    bencher.bench_local(|| curve.joint().relative_changes(&states, black_box(&joint.pin)));
}

#[divan::bench(args = TERM_CHOICES)]
fn ten_pressures_checked(bencher: Bencher, terms: usize) {
    let joint = Joint::new(terms);
    let curve = JointCurve::new(joint.compliance()).unwrap();
    let states: Vec<ArcState> =
        curve.states(RADIAL_CLEARANCE, &loads()).into_iter().map(Result::unwrap).collect();
    bencher.bench_local(|| black_box(&states).iter().filter(|state| state.pressure_is_positive()).count());
}

/// Of interpolated bodies: the curve from its nodes, checked, and ten loads found on it.
#[divan::bench]
fn smooth_curve_with_ten_loads(bencher: Bencher) {
    let joint = Joint::new(CURVE_TERMS);
    let nodes = CurveNodes::new(joint.space.limit);
    let (values, amplitude) = joint.resampled(&nodes);
    let loads = loads();
    let mut states = Vec::new();
    bencher.bench_local(|| {
        states.clear();
        let curve = SmoothCurve::new(&nodes, amplitude, black_box(&values)).unwrap();
        curve.states(RADIAL_CLEARANCE, loads.iter().copied(), &mut states);
        states.len()
    });
}
