//! The near fields of classes of bodies. Each is made once and kept while there is room.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use crate::engine::ring_loads::RingLoads;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::near_field::{LoadedRing, NearField, NearFieldClass};
use crate::mechanics::grading::GradingClass;

/// Near fields beyond these many bytes are dropped before the next ones are made.
const KEPT_BYTES: usize = 32 << 20;

/// So many near fields at most are made body by body where they are the first: a small study has its answer before there is memory for
/// lanes.
const FEW: usize = 8;

#[derive(Default)]
pub struct NearFieldLibrary {
    near_fields: HashMap<NearFieldClass, NearField>,
}

impl NearFieldLibrary {
    /// Adds to condensed works the near field of their body, whose mesh is of a class. It was prepared.
    pub fn correct(&self, body: &Body, class: GradingClass, works: &mut [f64]) {
        let (around, between) = NearFieldClass::around(body, class);
        let around = around.each_ref().map(|class| &self.near_fields[class]);
        NearField::correct(around, between, body.poissons_ratio, works);
    }

    /// What the near fields take.
    pub fn bytes(&self) -> usize {
        self.near_fields.values().map(NearField::bytes).sum()
    }

    /// Whether it has one.
    pub fn has(&self, class: &NearFieldClass) -> bool {
        self.near_fields.contains_key(class)
    }

    /// Makes near fields, as far as they are not there yet. Others may be gone then.
    pub fn prepare(&mut self, classes: impl Iterator<Item = NearFieldClass>, ring_loads: &RingLoads) {
        if self.bytes() > KEPT_BYTES {
            self.near_fields.clear();
        }
        let new: HashSet<NearFieldClass> =
            classes.filter(|class| !self.near_fields.contains_key(class)).collect();
        let is_first = self.near_fields.is_empty() && new.len() <= FEW;
        let condense = |plan: &CondensationPlan, bodies: &[Body]| match is_first {
            true => bodies.par_iter().map(|body| plan.condense_alone(body)).collect(),
            false => plan.condense(bodies),
        };
        let near_field = |class: NearFieldClass| {
            let loads = ring_loads.of(&LoadedRing::of_near_field(&class));
            (class, NearField::with_loads(&class, &loads, condense))
        };
        let made: Vec<(NearFieldClass, NearField)> = new.into_par_iter().map(near_field).collect();
        self.near_fields.extend(made);
    }
}
