//! What meshes make of the work of the contact pressure on arcs of every size, the other body of the joint being rigid.

use std::f64::consts::PI;

use jointsweep::internals::engine::bodies::BodyLibrary;
use jointsweep::internals::engine::body_request::{BodyRequest, Fidelity};
use jointsweep::internals::engine::spaces::{SpaceKey, Spaces};
use jointsweep::internals::mechanics::body::Body;
use jointsweep::internals::mechanics::compliance::pressure_space::Tilt;
use jointsweep::internals::mechanics::contact::edge::EdgeStates;
use jointsweep::internals::mechanics::contact::outlines::Outlines;

/// Narrower contacts, deg, are like this one.
const NARROWEST: f64 = 0.01;

/// A body with what it was solved on: meshes, coarsest first, and what they are measured against.
pub struct Measured {
    pub body: Body,
    pub meshes: Vec<Fidelity>,
    pub judge: Fidelity,
}

/// Of one arc the half angle, rad; of each mesh the relative error of the work; and of each mesh but the coarsest the relative
/// change of the work since the next coarser one.
pub type OfArc = (f64, Vec<f64>, Vec<f64>);

impl Measured {
    pub fn requests(&self) -> impl Iterator<Item = BodyRequest> {
        let fidelities = self.meshes.iter().chain([&self.judge]);
        fidelities.map(|fidelity| BodyRequest { body: self.body.clone(), fidelity: *fidelity })
    }

    /// On each arc up to the neat fit. The library has solved the requests.
    pub fn arcs(&self, library: &BodyLibrary, spaces: &mut Spaces) -> Vec<OfArc> {
        let key = SpaceKey::coarsest(&self.body, &self.body, 1e-6, PI);
        let solved: Vec<_> = self.requests().map(|request| &library.solved(&request).compliance).collect();
        spaces.prepare(solved.iter().map(|body| (key, *body)));
        let space = &spaces.get(key).pressures;
        let Some((exact, meshes)) = solved.split_last() else { return Vec::new() };
        let states = EdgeStates::new(space, &[&space.joint(&[(*exact, 1.0)], Tilt::NONE)], &Outlines::ALIKE);
        let between =
            |one, other| states.work_shares(space, &space.joint(&[(one, 1.0), (other, -1.0)], Tilt::NONE));
        let errors: Vec<Vec<f64>> = meshes.iter().map(|mesh| between(*mesh, *exact)).collect();
        let changes: Vec<Vec<f64>> = meshes.windows(2).map(|pair| between(pair[1], pair[0])).collect();
        let places = (0..space.arcs.len()).filter(|place| {
            states.indentation(*place) < 1.0 && space.arcs[*place].half_angle.to_degrees() > NARROWEST
        });
        let at = |all: &[Vec<f64>], place: usize| all.iter().map(|values| values[place].abs()).collect();
        let of_place = |place: usize| (space.arcs[place].half_angle, at(&errors, place), at(&changes, place));
        places.map(of_place).collect()
    }
}

/// Rounded up to two digits.
pub fn rounded_up(error: f64) -> f64 {
    let unit = 10.0_f64.powf(error.log10().floor() - 1.0);
    (error / unit).ceil() * unit
}
