//! What the processor lays out for bodies of a topology: the same for all who have a device in common, so that it is made once.

use std::sync::Arc;

use foldhash::HashMap;
use rayon::prelude::*;

use super::front::FrontLayout;
use super::layout::MeshLayout;
use crate::engine::body_request::TopologyKey;
use crate::engine::made_once::MadeOnce;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::ring_modes::RingModes;

/// The mesh of bodies, and how it is eliminated; or why there is none.
pub type Layout = Result<(MeshLayout, FrontLayout), String>;

#[derive(Default)]
pub struct Layouts {
    made: MadeOnce<TopologyKey, Layout>,
}

impl Layouts {
    /// Of some different topologies, each with one of its bodies.
    pub fn of(&self, topologies: &[(&TopologyKey, &Body)]) -> Vec<Arc<Layout>> {
        let bodies: HashMap<&TopologyKey, &Body> = topologies.iter().copied().collect();
        let lay_out = |key: TopologyKey| {
            let body = bodies[&key];
            let grading = key.grading(body);
            let layout = MeshLayout::new(body, &grading).map_err(|error| error.to_string()).map(|mesh| {
                let front = FrontLayout::new(body, &grading, &RingModes::of(&key.class), &mesh);
                (mesh, front)
            });
            (key, layout)
        };
        let keys: Vec<TopologyKey> = topologies.iter().map(|(key, _)| (*key).clone()).collect();
        self.made.of(&keys, |open| open.into_par_iter().map(lay_out).collect())
    }

    /// Forgets them; who has one keeps it.
    pub fn forget(&self) {
        self.made.forget();
    }
}
