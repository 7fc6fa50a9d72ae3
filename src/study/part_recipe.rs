//! A part of the joint whose every quantity may sweep, with its layers.

use crate::error::Error;
use crate::mechanics::body::Shape;
use crate::mechanics::compliance::near_field::Common;
use crate::study::design::Limits;
use crate::study::layers::MOST_LAYERS;
use crate::study::reader::{Choice, Quantity, Reader};
use crate::study::source::{Item, Section};
use crate::study::units::Dimension;
use crate::study::values::{Counts, Pick, Values};

/// The keys of a part whatever its model.
pub(super) const OF_ANY_PART: [&str; 4] = ["youngs_modulus", "poissons_ratio", "yield_stress", "layers"];

/// What a layer's thickness is told by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Measure {
    Length,
    /// Over the radius at the contact.
    OfRadius,
    /// The radius where it ends, over the radius at the contact; of pins.
    DownTo,
}

/// [joint.pin] or [joint.plate].
#[derive(Clone, Debug)]
pub(super) struct PartRecipe {
    pub(super) shape: &'static Shape,
    pub(super) parameters: Vec<Quantity>,
    pub(super) support: Choice<usize>,
    pub(super) youngs_modulus: Quantity,
    pub(super) poissons_ratio: Quantity,
    /// Changes no answer and does not sweep.
    pub(super) yield_stress: Option<YieldStress>,
    pub(super) layers: Vec<LayerRecipe>,
}

#[derive(Clone, Debug)]
pub(super) struct LayerRecipe {
    pub(super) thickness: Quantity,
    pub(super) measure: Measure,
    pub(super) youngs_modulus: Quantity,
    pub(super) poissons_ratio: Quantity,
    pub(super) yield_stress: Option<YieldStress>,
}

/// MPa, and the key that has it.
#[derive(Clone, Debug)]
pub(super) struct YieldStress {
    pub(super) value: f64,
    pub(super) key: String,
}

impl PartRecipe {
    /// With the keys of any part.
    pub(super) fn of_shape<'a>(
        part: &Section<'a>,
        shape: &'static Shape,
        parameters: Vec<Quantity>,
        reader: &mut Reader<'a>,
    ) -> Result<PartRecipe, Error> {
        Ok(PartRecipe {
            shape,
            parameters,
            support: Choice { options: vec![0], axis: None },
            youngs_modulus: reader.quantity(
                &part.need("youngs_modulus")?,
                Some(Dimension::Stress),
                Limits::POSITIVE,
            )?,
            poissons_ratio: reader.quantity(&part.need("poissons_ratio")?, None, Limits::POISSONS_RATIO)?,
            yield_stress: yield_stress(part)?,
            layers: match part.find("layers") {
                Some(item) => LayerRecipe::read_all(&item, reader)?,
                None => Vec::new(),
            },
        })
    }
}

impl PartRecipe {
    /// What its bodies have in common.
    pub(super) fn in_common(&self) -> Common {
        let PartRecipe { parameters, poissons_ratio, layers, .. } = self;
        Common {
            // With layers the material at the contact is not this one.
            poissons_ratio: layers.is_empty() && !poissons_ratio.varies(),
            outline: parameters.iter().all(|parameter| !parameter.varies()),
        }
    }

    /// The keys of its yield stresses, its own and those of its layers.
    pub(super) fn yield_stress_keys(&self) -> Vec<&str> {
        let of_layers = self.layers.iter().map(|layer| &layer.yield_stress);
        let all = [&self.yield_stress].into_iter().chain(of_layers);
        all.flatten().map(|own| own.key.as_str()).collect()
    }
}

impl LayerRecipe {
    /// Reads [[joint.pin.layers]] or [[joint.plate.layers]].
    fn read_all<'a>(item: &Item<'a>, reader: &mut Reader<'a>) -> Result<Vec<LayerRecipe>, Error> {
        let tables = item.tables()?;
        if tables.len() > MOST_LAYERS {
            return Err(item.error(format!("{} layers; at most {MOST_LAYERS} are allowed", tables.len())));
        }
        tables.iter().map(|table| LayerRecipe::read(table, reader)).collect()
    }

    fn read<'a>(table: &Section<'a>, reader: &mut Reader<'a>) -> Result<LayerRecipe, Error> {
        table.allow(&["thickness", "thickness_ratio", "youngs_modulus", "poissons_ratio", "yield_stress"])?;
        let (thickness, measure) = match (table.find("thickness"), table.find("thickness_ratio")) {
            (Some(item), None) => {
                (reader.quantity(&item, Some(Dimension::Length), Limits::POSITIVE)?, Measure::Length)
            }
            (None, Some(item)) => (reader.quantity(&item, None, Limits::POSITIVE)?, Measure::OfRadius),
            (Some(_), Some(item)) => {
                return Err(item.error("`thickness` is given, too; only one of the two is allowed"));
            }
            (None, None) => {
                let problem = "the key `thickness` (or `thickness_ratio`) is missing";
                return Err(table.error(problem.to_string()));
            }
        };
        let youngs_modulus =
            reader.quantity(&table.need("youngs_modulus")?, Some(Dimension::Stress), Limits::POSITIVE)?;
        let poissons_ratio = reader.quantity(&table.need("poissons_ratio")?, None, Limits::POISSONS_RATIO)?;
        let yield_stress = yield_stress(table)?;
        Ok(LayerRecipe { thickness, measure, youngs_modulus, poissons_ratio, yield_stress })
    }
}

/// MPa, one value: it has no column, so that designs that differ in it alone could not be told apart.
fn yield_stress(material: &Section) -> Result<Option<YieldStress>, Error> {
    let Some(item) = material.find("yield_stress") else { return Ok(None) };
    let values = Values::read(&item, Some(Dimension::Stress), Limits::POSITIVE, Counts::Required)?;
    if values.count() != Some(1) {
        return Err(item.error("one value; a yield stress changes no answer and does not sweep"));
    }
    Ok(Some(YieldStress { value: values.at(Pick::Index(0)), key: item.key }))
}
