//! The designs of a study, one after the other, each made when it is asked for.

use std::sync::Arc;

use crate::error::Error;
use crate::study::design::{DesignCase, Load};
use crate::study::designs_file::Rows;
use crate::study::recipe::{JointValues, Recipe};

/// The designs of a study in their order. Sampled ones are skipped to in no time; errors can only come from a
/// list of designs that has changed since it was checked.
pub struct Cases<'a>(Kind<'a>);

enum Kind<'a> {
    Sampled(Box<Sampled<'a>>),
    Listed(Box<Rows>),
}

/// Designs that are drawn at a time where they follow each other.
const ABREAST: usize = 32;

/// Designs that have their loads in common: about as many as a thread solves at a time.
const SHARING: u64 = 64;

impl Cases<'_> {
    /// Under these loads.
    pub(super) fn sampled<'a>(recipe: &'a Recipe, steps: &'a [Load]) -> Cases<'a> {
        Cases(Kind::Sampled(Box::new(Sampled { recipe, steps, shared: steps.into(), next: 0, drawn: None })))
    }

    pub(super) fn listed(rows: Rows) -> Cases<'static> {
        Cases(Kind::Listed(Box::new(rows)))
    }
}

struct Sampled<'a> {
    recipe: &'a Recipe,
    steps: &'a [Load],
    /// Of `SHARING` designs, so that threads that drop them do not all write to one count.
    shared: Arc<[Load]>,
    /// The number of the next design.
    next: u64,
    /// The values of some designs that follow each other, and the number of the first.
    drawn: Option<(u64, JointValues<'a, ABREAST>)>,
}

impl Sampled<'_> {
    fn nth(&mut self, skipped: u64) -> Option<DesignCase> {
        let index = self.next.saturating_add(skipped);
        self.next = index.saturating_add(1);
        let last = self.recipe.sampler().design_count().checked_sub(1)?;
        if index > last {
            return None;
        }
        // Designs that are skipped to are drawn one by one.
        let is_drawn = |first: u64| index < first + ABREAST as u64;
        if skipped == 0 && !self.drawn.as_ref().is_some_and(|(first, _)| is_drawn(*first)) {
            let numbers = std::array::from_fn(|place| last.min(index + place as u64));
            self.drawn = Some((index, self.recipe.values_of(&numbers)));
        }
        let joint = match &self.drawn {
            Some((first, values)) if is_drawn(*first) => values.joint((index - first) as usize),
            _ => self.recipe.joint(index),
        };
        if index.is_multiple_of(SHARING) {
            self.shared = self.steps.into();
        }
        Some(DesignCase { index, joint, steps: self.shared.clone() })
    }
}

impl Iterator for Cases<'_> {
    type Item = Result<DesignCase, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.nth(0)
    }

    fn nth(&mut self, skipped: usize) -> Option<Self::Item> {
        match &mut self.0 {
            Kind::Listed(rows) => rows.nth(skipped),
            Kind::Sampled(sampled) => sampled.nth(skipped as u64).map(Ok),
        }
    }
}
