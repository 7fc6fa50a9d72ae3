//! Reads the quantities and words of a config's joint, and numbers the axes of what sweeps.

use crate::error::Error;
use crate::mechanics::body::ShapeParameter;
use crate::study::design::Limits;
use crate::study::fits::radial_clearances;
use crate::study::sampling::{Axis, Scheme};
use crate::study::source::{Item, Section};
use crate::study::units::Dimension;
use crate::study::values::{Counts, Values};

/// The values of one quantity, and its axis if there is more than one.
#[derive(Clone, Debug)]
pub(super) struct Quantity {
    pub(super) values: Values,
    pub(super) axis: Option<usize>,
}

impl Quantity {
    /// A list may have one value many times.
    pub(super) fn varies(&self) -> bool {
        self.axis.is_some() && self.values.smallest() != self.values.largest()
    }
}

/// The options of something that is no number, and its axis if there is more than one.
#[derive(Clone, Debug)]
pub(super) struct Choice<T> {
    pub(super) options: Vec<T>,
    pub(super) axis: Option<usize>,
}

impl<T: PartialEq> Choice<T> {
    pub(super) fn varies(&self) -> bool {
        self.options.iter().any(|option| *option != self.options[0])
    }
}

/// Reads quantities and numbers the axes they make.
pub(super) struct Reader<'a> {
    counts: Counts,
    pub(super) axes: Vec<Axis>,
    /// By axis, for complaints.
    pub(super) items: Vec<Item<'a>>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(scheme: Scheme) -> Reader<'a> {
        let counts = match scheme {
            Scheme::Grid | Scheme::Zip | Scheme::Saltelli { .. } => Counts::Required,
            Scheme::LatinHypercube { .. } | Scheme::Sobol { .. } => Counts::Refused(scheme.name()),
        };
        Reader { counts, axes: Vec::new(), items: Vec::new() }
    }

    /// A ratio of a shape, or its default.
    pub(super) fn parameter(
        &mut self,
        part: &Section<'a>,
        parameter: &ShapeParameter,
    ) -> Result<Quantity, Error> {
        match (part.find(parameter.name), parameter.default) {
            (None, Some(default)) => Ok(Quantity { values: Values::List(vec![default]), axis: None }),
            _ => self.quantity(&part.need(parameter.name)?, None, Limits::of_parameter(parameter)),
        }
    }

    pub(super) fn quantity(
        &mut self,
        item: &Item<'a>,
        dimension: Option<Dimension>,
        limits: Limits,
    ) -> Result<Quantity, Error> {
        let values = Values::read(item, dimension, limits, self.counts)?;
        let axis = self.axis(item, values.count());
        Ok(Quantity { values, axis })
    }

    /// The clearances of an ISO 286 fit in a hole of one radius.
    pub(super) fn fit(&mut self, item: &Item<'a>, hole_radius: &Quantity) -> Result<Quantity, Error> {
        if hole_radius.varies() {
            return Err(
                item.error("a fit is one of a diameter, and `hole_radius` sweeps: give the clearances")
            );
        }
        let fit = item.string()?;
        let [least, greatest] =
            radial_clearances(fit, hole_radius.values.smallest()).map_err(|problem| item.refuse(&problem))?;
        let values = Values::between(least, greatest, self.counts);
        let axis = self.axis(item, values.count());
        Ok(Quantity { values, axis })
    }

    /// One word or a list of words, as positions in `allowed`.
    pub(super) fn choice(&mut self, item: &Item<'a>, allowed: &[&str]) -> Result<Choice<usize>, Error> {
        let options = match item.array()? {
            Some(elements) => {
                elements.iter().map(|element| element.word(allowed)).collect::<Result<_, _>>()?
            }
            None => vec![item.word(allowed)?],
        };
        let axis = self.axis(item, Some(options.len() as u64));
        Ok(Choice { options, axis })
    }

    /// A single value is no axis.
    fn axis(&mut self, item: &Item<'a>, count: Option<u64>) -> Option<usize> {
        if count == Some(1) {
            return None;
        }
        self.axes.push(Axis { key: item.key.clone(), line: item.line(), start: item.start(), count });
        self.items.push(item.clone());
        Some(self.axes.len() - 1)
    }
}
