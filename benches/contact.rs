//! Time of the contact of one joint, one core, its bodies being solved: the joint's compliance from its two bodies', the
//! curve through its nodes, ten loads found on it, and what an error estimate takes: `cargo bench --bench contact`.

use divan::{Bencher, black_box};
use jointsweep::internals::mechanics::body::Side;
use jointsweep::internals::mechanics::compliance::BodyCompliance;
use jointsweep::internals::mechanics::compliance::Boundary;
use jointsweep::internals::mechanics::compliance::concentric_body::ConcentricBody;
use jointsweep::internals::mechanics::compliance::pressure_space::JointCompliance;
use jointsweep::internals::mechanics::compliance::ring_modes::RingModes;
use jointsweep::internals::mechanics::contact::curve::ContactCurve;
use jointsweep::internals::mechanics::contact::curve_space::{CurveSpace, Variable};
use jointsweep::internals::mechanics::contact::load::DimensionlessLoad;
use jointsweep::internals::mechanics::contact::outlines::Outlines;
use jointsweep::internals::mechanics::material::Idealization;

const RADIAL_CLEARANCE: f64 = 1e-3;

/// Trial pressures and nodes of spaces that sweeps use.
const SPACES: [(usize, usize); 5] = [(6, 16), (6, 24), (10, 32), (16, 48), (24, 64)];

/// Pin and plate in eight modes of their rings, as bodies on meshes are.
struct Joint {
    space: CurveSpace,
    bodies: [BodyCompliance; 2],
}

impl Joint {
    fn new((terms, nodes): (usize, usize)) -> Joint {
        let mut space = CurveSpace::new(Variable::Root, terms, nodes, 2.4);
        let modes = RingModes::whole(5, 8);
        let bodies = [0.3, 3.0].map(|fixed_radius_ratio| {
            let idealization = Idealization::PlaneStress;
            let body = ConcentricBody::bare(fixed_radius_ratio, 0.3, idealization);
            let side = if fixed_radius_ratio < 1.0 { Side::Pin } else { Side::Plate };
            let works = modes.works_of_modes(side, &[body.boundary_modes()]).remove(0);
            BodyCompliance { boundary: Boundary::RingModes(modes, works), ..body.compliance() }
        });
        bodies.iter().for_each(|body| space.pressures.prepare(body));
        Joint { space, bodies }
    }

    fn parts(&self) -> [JointCompliance<'static>; 2] {
        let pin = self.space.part(Side::Pin, &[(&self.bodies[0], 1.0)], &outlines());
        let plate = self.space.part(Side::Plate, &[(&self.bodies[1], 1.0 / 0.4)], &outlines());
        [pin, plate]
    }
}

fn outlines() -> Outlines {
    Outlines::new(RADIAL_CLEARANCE)
}

/// Indentations from a hundredth of the clearance to ten times it.
fn loads() -> impl Iterator<Item = DimensionlessLoad> {
    (0..10)
        .map(|i| DimensionlessLoad::Indentation(RADIAL_CLEARANCE * 10.0_f64.powf(-2.0 + f64::from(i) / 3.0)))
}

fn main() {
    divan::main();
}

#[divan::bench(args = SPACES)]
fn joint_from_bodies(bencher: Bencher, space: (usize, usize)) {
    let joint = Joint::new(space);
    bencher.bench_local(|| black_box(&joint).parts());
}

#[divan::bench(args = SPACES)]
fn curve_through_nodes(bencher: Bencher, space: (usize, usize)) {
    let joint = Joint::new(space);
    let parts = joint.parts();
    bencher
        .bench_local(|| ContactCurve::new(&joint.space, &black_box(&parts).each_ref(), outlines()).is_some());
}

#[divan::bench(args = SPACES)]
fn ten_loads_found(bencher: Bencher, space: (usize, usize)) {
    let joint = Joint::new(space);
    let parts = joint.parts();
    let curve = ContactCurve::new(&joint.space, &parts.each_ref(), outlines()).expect("positive definite");
    bencher.bench_local(|| curve.states(&mut black_box(loads())));
}

/// The share of the work that goes into one body.
#[divan::bench(args = SPACES)]
fn work_share(bencher: Bencher, space: (usize, usize)) {
    let joint = Joint::new(space);
    let curve =
        ContactCurve::new(&joint.space, &joint.parts().each_ref(), outlines()).expect("positive definite");
    let pressures = &joint.space.pressures;
    let body = pressures.joint(&[(&joint.bodies[0], 1.0)], outlines().tilt());
    bencher.bench_local(|| curve.states.work_shares(pressures, black_box(&body)));
}

/// What a new space takes, made once in a sweep.
#[divan::bench(args = SPACES)]
fn space_made(bencher: Bencher, (terms, nodes): (usize, usize)) {
    bencher.bench_local(|| CurveSpace::new(Variable::Root, black_box(terms), nodes, 2.4));
}
