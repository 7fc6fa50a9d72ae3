//! The model of a part, and which keys the part then has.

use std::ops::Not;

use crate::error::Error;
use crate::mechanics::body::{Shape, Side};
use crate::study::columns::side_name;
use crate::study::part_recipe::{OF_ANY_PART, PartRecipe};
use crate::study::reader::Reader;
use crate::study::source::Section;
use crate::study::tube;

/// Reads [joint.pin] or [joint.plate]; which keys there are depends on the model.
pub(super) fn read_part<'a>(
    joint: &Section<'a>,
    side: Side,
    reader: &mut Reader<'a>,
) -> Result<PartRecipe, Error> {
    let part = joint.need(side_name(side))?.section()?;
    let model = part.need("model")?;
    let shapes: Vec<&'static Shape> = Shape::of_side(side).collect();
    let mut names: Vec<&str> = shapes.iter().map(|shape| shape.name).collect();
    names.extend((side == Side::Pin).then_some(tube::NAME));
    let Some(shape) = shapes.get(model.word(&names)?) else {
        return tube::read(&part, reader);
    };

    refuse_foreign(&part, shape, &shapes)?;
    let (first, last) = OF_ANY_PART.split_at(2);
    let mut keys = [&["model"], first].concat();
    keys.extend(shape.parameters.iter().map(|parameter| parameter.name));
    keys.extend(shape.supports.is_empty().not().then_some("support"));
    keys.extend(last);
    part.allow(&keys)?;

    let mut parameters = Vec::new();
    for parameter in shape.parameters {
        parameters.push(reader.parameter(&part, parameter)?);
    }
    let mut recipe = PartRecipe::of_shape(&part, shape, parameters, reader)?;
    if let Some(item) = part.find("support") {
        recipe.support = reader.choice(&item, shape.supports)?;
    }
    Ok(recipe)
}

/// A key of another model is no slip of the pen: say whose it is.
fn refuse_foreign(part: &Section, shape: &Shape, shapes: &[&'static Shape]) -> Result<(), Error> {
    for other in shapes {
        let parameters = other.parameters.iter().map(|parameter| parameter.name);
        let support = other.supports.is_empty().not().then_some("support");
        for key in parameters.chain(support) {
            let known = shape.parameters.iter().any(|parameter| parameter.name == key)
                || (key == "support" && !shape.supports.is_empty());
            if let (false, Some(item)) = (known, part.find(key)) {
                let (this, that) = (shape.name, other.name);
                return Err(item.error(format!("model `{this}` does not have this key; model `{that}` does")));
            }
        }
    }
    match tube::KEYS.into_iter().find_map(|key| part.find(key)) {
        Some(item) if shape.side == Side::Pin => Err(item.error(format!(
            "model `{}` does not have this key; model `{}` does",
            shape.name,
            tube::NAME
        ))),
        _ => Ok(()),
    }
}
