//! The near fields of classes of bodies. Each is made once and kept while there is room.

use std::sync::Arc;

use foldhash::{HashMap, HashSet};
use rayon::prelude::*;

use crate::engine::made_once::MadeOnce;
use crate::engine::ring_loads::RingLoads;
use crate::mechanics::body::Body;
use crate::mechanics::compliance::lane_condensation::CondensationPlan;
use crate::mechanics::compliance::near_field::{InCommon, NearField, NearFieldClass, ReferenceMesh};
use crate::mechanics::grading::GradingClass;
use crate::mechanics::real::LANES;

/// Near fields beyond these many bytes are dropped before the next ones are made.
const KEPT_BYTES: usize = 32 << 20;

/// So many near fields at most are made body by body where they are the first: a small study has its answer before there is memory for
/// lanes.
const FEW: usize = 8;

#[derive(Default)]
pub struct NearFieldLibrary {
    /// Of the bodies to come.
    pub in_common: InCommon,
    near_fields: HashMap<NearFieldClass, Arc<NearField>>,
    /// Those that twins have made, too.
    common: Arc<MadeOnce<NearFieldClass, NearField>>,
}

impl NearFieldLibrary {
    /// Another one, so that what either makes the other has.
    pub fn twin(&self) -> NearFieldLibrary {
        let NearFieldLibrary { in_common, near_fields, common } = self;
        NearFieldLibrary {
            in_common: *in_common,
            near_fields: near_fields.clone(),
            common: Arc::clone(common),
        }
    }

    /// Adds to condensed works the near field of their body, whose mesh is of a class. It was prepared.
    pub fn correct(&self, body: &Body, class: GradingClass, works: &mut [f64]) {
        let (around, between) = NearFieldClass::around(body, class, &self.in_common);
        let around = around.each_ref().map(|class| &*self.near_fields[class]);
        NearField::correct(around, between, body, works);
    }

    /// Those of classes, which were prepared.
    pub fn all(&self, classes: &[NearFieldClass]) -> Vec<&NearField> {
        classes.iter().map(|class| &*self.near_fields[class]).collect()
    }

    /// What the near fields take.
    pub fn bytes(&self) -> usize {
        self.near_fields.values().map(|near_field| near_field.bytes()).sum()
    }

    /// Whether it has one.
    pub fn has(&self, class: &NearFieldClass) -> bool {
        self.near_fields.contains_key(class)
    }

    /// Makes near fields, as far as they are not there yet. Others may be gone then.
    pub fn prepare(&mut self, classes: impl Iterator<Item = NearFieldClass>, ring_loads: &RingLoads) {
        if self.bytes() > KEPT_BYTES {
            self.near_fields.clear();
            self.common.forget();
        }
        let new: HashSet<NearFieldClass> =
            classes.filter(|class| !self.near_fields.contains_key(class)).collect();
        let new: Vec<NearFieldClass> = new.into_iter().collect();
        let is_first = self.near_fields.is_empty() && new.len() <= FEW;
        let condense = |plan: &CondensationPlan, bodies: &[Body]| -> Vec<Vec<f64>> {
            match is_first {
                true => bodies.par_iter().map(|body| plan.condense_alone(body)).collect(),
                false => bodies.par_chunks(LANES).flat_map_iter(|bodies| plan.condense(bodies)).collect(),
            }
        };
        let on_mesh = |(mesh, mut classes): (ReferenceMesh, Vec<NearFieldClass>)| {
            // References of the same outlines lie side by side.
            classes.sort_unstable_by_key(|class| class.growth);
            let near_fields = NearField::on_mesh(&mesh, &classes, &ring_loads.of(&mesh.ring()), condense);
            classes.into_iter().zip(near_fields).collect::<Vec<_>>()
        };
        let made = self.common.of(&new, |open| {
            let mut by_mesh: HashMap<ReferenceMesh, Vec<NearFieldClass>> = HashMap::default();
            open.into_iter().for_each(|class| by_mesh.entry(class.mesh()).or_default().push(class));
            by_mesh.into_par_iter().flat_map_iter(on_mesh).collect()
        });
        self.near_fields.extend(new.into_iter().zip(made));
    }
}
