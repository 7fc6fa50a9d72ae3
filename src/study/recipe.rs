//! The [joint] of a config: a joint whose every quantity may sweep.

use std::ops::Not;

use crate::error::{Error, quoted};
use crate::mechanics::body::{MAX_PARAMETERS, Shape, ShapeParameter, Side, cored_disc};
use crate::mechanics::material::{Idealization, Material};
use crate::study::columns::{Cell, Column, LayerQuantity, joint_columns, side_name};
use crate::study::design::{JointDesign, Limits, Part, refuse_clearance};
use crate::study::fits::radial_clearances;
use crate::study::layers::{Layer, LayerCounts, Layers, MOST_LAYERS};
use crate::study::sampling::{Axis, Sampler, Scheme};
use crate::study::source::{Item, Section};
use crate::study::units::{Dimension, tidy};
use crate::study::values::{Counts, Pick, Values};

/// The values of one quantity, and its axis if there is more than one.
#[derive(Clone, Debug)]
struct Quantity {
    values: Values,
    axis: Option<usize>,
}

impl Quantity {
    /// A list may have one value many times.
    fn varies(&self) -> bool {
        self.axis.is_some() && self.values.smallest() != self.values.largest()
    }
}

/// The options of something that is no number, and its axis if there is more than one.
#[derive(Clone, Debug)]
struct Choice<T> {
    options: Vec<T>,
    axis: Option<usize>,
}

impl<T: PartialEq> Choice<T> {
    fn varies(&self) -> bool {
        self.options.iter().any(|option| *option != self.options[0])
    }
}

/// What a layer's thickness is told by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Measure {
    Length,
    /// Over the radius at the contact.
    OfRadius,
    /// The radius where it ends, over the radius at the contact; of pins.
    DownTo,
}

/// The word for a pin with a bore. It is no shape of its own: a disc around a rigid core, or the layer of one.
pub const TUBE: &str = "tube";

/// The keys of a part whatever its model.
const OF_ANY_PART: [&str; 4] = ["youngs_modulus", "poissons_ratio", "yield_stress", "layers"];

/// Keys that only a tube has.
const OF_TUBES: [&str; 2] = ["bore_radius_ratio", "inner"];

#[derive(Clone, Debug)]
struct PartRecipe {
    shape: &'static Shape,
    parameters: Vec<Quantity>,
    support: Choice<usize>,
    youngs_modulus: Quantity,
    poissons_ratio: Quantity,
    /// Changes no answer and does not sweep.
    yield_stress: Option<f64>,
    layers: Vec<LayerRecipe>,
}

#[derive(Clone, Debug)]
struct LayerRecipe {
    thickness: Quantity,
    measure: Measure,
    youngs_modulus: Quantity,
    poissons_ratio: Quantity,
    yield_stress: Option<f64>,
}

/// A joint with all the values it takes over a sweep.
#[derive(Clone, Debug)]
pub struct Recipe {
    idealization: Choice<Idealization>,
    hole_radius: Quantity,
    radial_clearance: Quantity,
    thickness: Quantity,
    pin: PartRecipe,
    plate: PartRecipe,
    axes: Vec<Axis>,
    sampler: Sampler,
}

impl Recipe {
    /// Reads [joint]; `scheme` is what [sampling] says.
    pub fn read(joint: &Section, scheme: Scheme) -> Result<Recipe, Error> {
        const KEYS: [&str; 8] = [
            "idealization",
            "hole_radius",
            "radial_clearance",
            "diametral_clearance",
            "fit",
            "thickness",
            "pin",
            "plate",
        ];
        joint.allow(&KEYS)?;
        let mut reader = Reader::new(scheme);
        let idealization =
            reader.choice(&joint.need("idealization")?, &Idealization::ALL.map(|one| one.name()))?;
        let hole_item = joint.need("hole_radius")?;
        let hole_radius = reader.quantity(&hole_item, Some(Dimension::Length), Limits::POSITIVE)?;
        let (clearance_item, radial_clearance) = clearance(joint, &hole_radius, &mut reader)?;
        let thickness =
            reader.quantity(&joint.need("thickness")?, Some(Dimension::Length), Limits::POSITIVE)?;
        let pin = PartRecipe::read(joint, Side::Pin, &mut reader)?;
        let plate = PartRecipe::read(joint, Side::Plate, &mut reader)?;
        if let (Scheme::LatinHypercube { .. } | Scheme::Sobol { .. }, true) = (scheme, reader.axes.is_empty())
        {
            let name = scheme.name();
            return Err(joint.error(format!("nothing for the {name} sampler to vary: no list, no range")));
        }
        let sampler = Sampler::new(scheme, &reader.axes)
            .map_err(|(axis, problem)| reader.items[axis].error(problem))?;
        let recipe = Recipe {
            idealization: Choice {
                options: idealization.options.iter().map(|&option| Idealization::ALL[option]).collect(),
                axis: idealization.axis,
            },
            hole_radius,
            radial_clearance,
            thickness,
            pin,
            plate,
            axes: reader.axes,
            sampler,
        };
        recipe.check_fit(&hole_item, &clearance_item)?;
        Ok(recipe)
    }

    pub fn sampler(&self) -> &Sampler {
        &self.sampler
    }

    /// The keys of what sweeps, as listed, without `joint.` before them.
    pub fn factors(&self) -> Vec<&str> {
        let mut axes: Vec<&Axis> = self.axes.iter().collect();
        axes.sort_by_key(|axis| axis.start);
        axes.iter().map(|axis| axis.key.strip_prefix("joint.").unwrap_or(&axis.key)).collect()
    }

    /// The same quantities in a design for sensitivity indices: counted ranges are continuous there, lists equally likely. On
    /// failure, what is wrong.
    pub fn for_sensitivity(&self, rows: u64, seed: u64) -> Result<Recipe, String> {
        let factors = self.factors();
        if factors.is_empty() {
            return Err("nothing sweeps: give at least one quantity of [joint] a range or a list".into());
        }
        if self.sampler.scheme() == Scheme::Zip && factors.len() > 1 {
            return Err(format!(
                "zip moves {} together, so what one of them does cannot be told from the others: a sensitivity needs factors \
                 that vary each by itself; leave `method = \"zip\"` out of [sampling]",
                quoted(&factors)
            ));
        }
        let sampler =
            Sampler::new(Scheme::Saltelli { rows, seed }, &self.axes).map_err(|(_, problem)| problem)?;
        Ok(Recipe { sampler, ..self.clone() })
    }

    /// Design number `design` of the sweep.
    pub fn joint(&self, design: u64) -> JointDesign {
        let hole_radius = self.value(&self.hole_radius, design);
        let radial_clearance = self.value(&self.radial_clearance, design);
        JointDesign {
            idealization: self.option(&self.idealization, design),
            hole_radius,
            radial_clearance,
            thickness: self.value(&self.thickness, design),
            pin: self.part(&self.pin, hole_radius - radial_clearance, design),
            plate: self.part(&self.plate, hole_radius, design),
        }
    }

    /// Whether a pin may be larger than its hole.
    pub fn has_press_fits(&self) -> bool {
        self.radial_clearance.values.smallest() < 0.0
    }

    /// Layers of pin and plate.
    pub fn layer_counts(&self) -> LayerCounts {
        LayerCounts { pin: self.pin.layers.len(), plate: self.plate.layers.len() }
    }

    /// The inputs that no list or range varies, in the order of the table's columns.
    pub fn constants(&self) -> Vec<(Column, Cell)> {
        let joint = self.joint(0);
        let constant = joint_columns(self.layer_counts()).into_iter().filter(|column| !self.varies(column));
        constant.map(|column| (column, column.cell(&joint))).collect()
    }

    fn varies(&self, column: &Column) -> bool {
        let part = |side: Side| match side {
            Side::Pin => &self.pin,
            Side::Plate => &self.plate,
        };
        match *column {
            Column::HoleRadius => self.hole_radius.varies(),
            Column::RadialClearance => self.radial_clearance.varies(),
            Column::Thickness => self.thickness.varies(),
            Column::Idealization => self.idealization.varies(),
            Column::Model(_) => false,
            Column::Parameter(side, name) => {
                let PartRecipe { shape, parameters, .. } = part(side);
                let mut own = shape.parameters.iter().zip(parameters);
                own.any(|(parameter, quantity)| parameter.name == name && quantity.varies())
            }
            Column::Support(side) => part(side).support.varies(),
            Column::YoungsModulus(side) => part(side).youngs_modulus.varies(),
            Column::PoissonsRatio(side) => part(side).poissons_ratio.varies(),
            Column::Layer(side, number, quantity) => part(side).layers.get(number).is_some_and(|layer| {
                let of_pin = side == Side::Pin && self.radial_clearance.varies();
                let of_radius = self.hole_radius.varies() || of_pin;
                match (quantity, layer.measure) {
                    (LayerQuantity::Thickness, Measure::Length) => layer.thickness.varies(),
                    (LayerQuantity::Thickness, Measure::OfRadius) => layer.thickness.varies() || of_radius,
                    (LayerQuantity::Thickness, Measure::DownTo) => {
                        let before = &part(side).layers[..=number];
                        of_radius || before.iter().any(|layer| layer.thickness.varies())
                    }
                    (LayerQuantity::YoungsModulus, _) => layer.youngs_modulus.varies(),
                    (LayerQuantity::PoissonsRatio, _) => layer.poissons_ratio.varies(),
                }
            }),
        }
    }

    /// A part with its radius at the contact, mm.
    fn part(&self, part: &PartRecipe, radius: f64, design: u64) -> Part {
        let mut parameters = [0.0; MAX_PARAMETERS];
        for (slot, quantity) in parameters.iter_mut().zip(&part.parameters) {
            *slot = self.value(quantity, design);
        }
        let mut depth = 0.0;
        let layer = |layer: &LayerRecipe| {
            let told = self.value(&layer.thickness, design);
            let thickness = match layer.measure {
                Measure::Length => told,
                Measure::OfRadius => told * radius,
                Measure::DownTo => tidy((1.0 - told) * radius - depth),
            };
            depth += thickness;
            let material = Material {
                youngs_modulus: self.value(&layer.youngs_modulus, design),
                poissons_ratio: self.value(&layer.poissons_ratio, design),
            };
            Layer { thickness, material, yield_stress: layer.yield_stress }
        };
        Part {
            shape: part.shape,
            parameters,
            support: self.option(&part.support, design),
            material: Material {
                youngs_modulus: self.value(&part.youngs_modulus, design),
                poissons_ratio: self.value(&part.poissons_ratio, design),
            },
            yield_stress: part.yield_stress,
            layers: Layers::new(part.layers.iter().map(layer).collect()),
        }
    }

    fn pick(&self, axis: Option<usize>, design: u64) -> Pick {
        axis.map_or(Pick::Index(0), |axis| self.sampler.pick(design, axis))
    }

    fn value(&self, quantity: &Quantity, design: u64) -> f64 {
        quantity.values.at(self.pick(quantity.axis, design))
    }

    fn option<T: Copy>(&self, choice: &Choice<T>, design: u64) -> T {
        choice.options[self.pick(choice.axis, design).of(choice.options.len())]
    }

    /// Refuses a sweep in which some design has a clearance that leaves no pin, or an overlap as large.
    fn check_fit(&self, hole: &Item, clearance: &Item) -> Result<(), Error> {
        let smallest = self.hole_radius.values.smallest();
        let ends = [self.radial_clearance.values.smallest(), self.radial_clearance.values.largest()];
        let largest = if ends[0].abs() > ends[1].abs() { ends[0] } else { ends[1] };
        if refuse_clearance(largest, smallest).is_none() {
            return Ok(());
        }
        // Zip pairs its values; everywhere else the largest clearance does or may meet the smallest hole.
        let (hole_radius, radial_clearance) = if self.sampler.scheme() == Scheme::Zip {
            let pairs = (0..self.sampler.design_count()).map(|design| {
                (self.value(&self.hole_radius, design), self.value(&self.radial_clearance, design))
            });
            match pairs
                .into_iter()
                .find(|(hole_radius, clearance)| refuse_clearance(*clearance, *hole_radius).is_some())
            {
                None => return Ok(()),
                Some(pair) => pair,
            }
        } else {
            (smallest, largest)
        };
        let line = hole.line();
        let what = if radial_clearance < 0.0 { "the overlap of a press fit" } else { "it" };
        let sweeps = self.hole_radius.axis.or(self.radial_clearance.axis).is_some();
        let among = if sweeps { "among the combinations of this sweep, " } else { "" };
        Err(clearance.error(format!(
            "{among}a radial clearance of {radial_clearance} mm meets a hole radius of {hole_radius} mm (line {line}); \
             {what} must be below the hole radius"
        )))
    }
}

/// Reads the clearance by one of its three keys.
fn clearance<'a>(
    joint: &Section<'a>,
    hole_radius: &Quantity,
    reader: &mut Reader<'a>,
) -> Result<(Item<'a>, Quantity), Error> {
    let given = ["radial_clearance", "diametral_clearance", "fit"].map(|key| (key, joint.find(key)));
    let mut given = given.into_iter().filter_map(|(key, item)| Some((key, item?)));
    let Some((key, item)) = given.next() else {
        let problem = "the key `radial_clearance` (or `diametral_clearance`, or `fit`) is missing";
        return Err(joint.error(problem.to_string()));
    };
    if let Some((_, other)) = given.next() {
        return Err(other.error(format!("`{key}` is given, too; only one of the two is allowed")));
    }
    if key == "fit" {
        let quantity = reader.fit(&item, hole_radius)?;
        return Ok((item, quantity));
    }
    let mut quantity = reader.quantity(&item, Some(Dimension::Length), Limits::ANY)?;
    if key == "diametral_clearance" {
        quantity.values = quantity.values.halved();
    }
    Ok((item, quantity))
}

impl PartRecipe {
    /// Reads [joint.pin] or [joint.plate]; which keys there are depends on the model.
    fn read<'a>(joint: &Section<'a>, side: Side, reader: &mut Reader<'a>) -> Result<PartRecipe, Error> {
        let part = joint.need(side_name(side))?.section()?;
        let model = part.need("model")?;
        let shapes: Vec<&'static Shape> = Shape::of_side(side).collect();
        let mut names: Vec<&str> = shapes.iter().map(|shape| shape.name).collect();
        names.extend((side == Side::Pin).then_some(TUBE));
        let Some(shape) = shapes.get(model.word(&names)?) else {
            return PartRecipe::read_tube(&part, reader);
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
        let support = match part.find("support") {
            Some(item) => Some(reader.choice(&item, shape.supports)?),
            None => None,
        };
        let recipe = PartRecipe::of_shape(&part, shape, parameters, reader)?;
        Ok(PartRecipe { support: support.unwrap_or(recipe.support), ..recipe })
    }

    /// With the keys of any part.
    fn of_shape<'a>(
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

    /// A pin with a bore: held there, it is a disc around a rigid core that is the bore; with an inner part bonded into it, which moves
    /// it, it is a layer around that part, behind its own layers.
    fn read_tube<'a>(part: &Section<'a>, reader: &mut Reader<'a>) -> Result<PartRecipe, Error> {
        let shape = &cored_disc::SHAPE;
        let [core] = shape.parameters else { unreachable!("a disc around a core has one ratio") };
        let [of_bore, of_inner] = OF_TUBES;
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
fn yield_stress(material: &Section) -> Result<Option<f64>, Error> {
    let Some(item) = material.find("yield_stress") else { return Ok(None) };
    let values = Values::read(&item, Some(Dimension::Stress), Limits::POSITIVE, Counts::Required)?;
    if values.count() != Some(1) {
        return Err(item.error("one value; a yield stress changes no answer and does not sweep"));
    }
    Ok(Some(values.at(Pick::Index(0))))
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
    match OF_TUBES.into_iter().find_map(|key| part.find(key)) {
        Some(item) if shape.side == Side::Pin => {
            Err(item.error(format!("model `{}` does not have this key; model `{TUBE}` does", shape.name)))
        }
        _ => Ok(()),
    }
}

/// Reads quantities and numbers the axes they make.
struct Reader<'a> {
    counts: Counts,
    axes: Vec<Axis>,
    /// By axis, for complaints.
    items: Vec<Item<'a>>,
}

impl<'a> Reader<'a> {
    fn new(scheme: Scheme) -> Reader<'a> {
        let counts = match scheme {
            Scheme::Grid | Scheme::Zip | Scheme::Saltelli { .. } => Counts::Required,
            Scheme::LatinHypercube { .. } | Scheme::Sobol { .. } => Counts::Refused(scheme.name()),
        };
        Reader { counts, axes: Vec::new(), items: Vec::new() }
    }

    /// A ratio of a shape, or its default.
    fn parameter(&mut self, part: &Section<'a>, parameter: &ShapeParameter) -> Result<Quantity, Error> {
        match (part.find(parameter.name), parameter.default) {
            (None, Some(default)) => Ok(Quantity { values: Values::List(vec![default]), axis: None }),
            _ => self.quantity(&part.need(parameter.name)?, None, Limits::of_parameter(parameter)),
        }
    }

    fn quantity(
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
    fn fit(&mut self, item: &Item<'a>, hole_radius: &Quantity) -> Result<Quantity, Error> {
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
    fn choice(&mut self, item: &Item<'a>, allowed: &[&str]) -> Result<Choice<usize>, Error> {
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
