//! `model = "tube"`: a pin with a bore. It is no shape of its own, but a disc around a rigid core, or the layer of one.

use crate::error::Error;
use crate::mechanics::body::cored_disc;
use crate::study::design::Limits;
use crate::study::layers::MOST_LAYERS;
use crate::study::part_recipe::{LayerRecipe, Measure, OF_ANY_PART, PartRecipe};
use crate::study::reader::Reader;
use crate::study::source::Section;

/// The word for it in configs.
pub const NAME: &str = "tube";

/// Keys that only a tube has.
pub(super) const KEYS: [&str; 2] = ["bore_radius_ratio", "inner"];

/// A pin with a bore: held there, it is a disc around a rigid core that is the bore; with an inner part bonded into it, which moves
/// it, it is a layer around that part, behind its own layers.
pub(super) fn read<'a>(part: &Section<'a>, reader: &mut Reader<'a>) -> Result<PartRecipe, Error> {
    let shape = &cored_disc::SHAPE;
    let [core] = shape.parameters else { unreachable!("a disc around a core has one ratio") };
    let [of_bore, of_inner] = KEYS;
    part.allow(&[&["model", of_bore, of_inner], &OF_ANY_PART[..]].concat())?;
    let bore = reader.quantity(&part.need(of_bore)?, None, Limits::of_parameter(core))?;
    let tube = PartRecipe::of_shape(part, shape, vec![bore.clone()], reader)?;
    let Some(item) = part.find(of_inner) else { return Ok(tube) };
    let inner = item.section()?;
    inner.allow(&[&[core.name], &OF_ANY_PART[..]].concat())?;
    let core = reader.parameter(&inner, core)?;
    let inner = PartRecipe::of_shape(&inner, shape, vec![core], reader)?;
    let mut layers = tube.layers;
    layers.push(LayerRecipe {
        thickness: bore,
        measure: Measure::DownTo,
        youngs_modulus: tube.youngs_modulus,
        poissons_ratio: tube.poissons_ratio,
        yield_stress: tube.yield_stress,
    });
    layers.extend(inner.layers);
    if layers.len() > MOST_LAYERS {
        let problem = format!("with the tube {} layers; at most {MOST_LAYERS} are allowed", layers.len());
        return Err(item.error(problem));
    }
    Ok(PartRecipe { layers, ..inner })
}
