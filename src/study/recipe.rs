//! The [joint] of a config: a joint whose every quantity may sweep.

use crate::error::{Error, quoted};
use crate::mechanics::body::{MAX_PARAMETERS, Side};
use crate::mechanics::compliance::near_field::InCommon;
use crate::mechanics::material::{Idealization, Material};
use crate::study::columns::{Cell, Column, LayerQuantity, joint_columns};
use crate::study::design::{JointDesign, Limits, Part, refuse_clearance};
use crate::study::layers::{Layer, LayerCounts};
use crate::study::model::read_part;
use crate::study::part_recipe::{LayerRecipe, Measure, PartRecipe};
use crate::study::reader::{Choice, Quantity, Reader};
use crate::study::sampling::{Axis, Sampler, Scheme};
use crate::study::source::{Item, Section};
use crate::study::units::{Dimension, tidy};
use crate::study::values::Picks;

/// A joint with all the values it takes over a sweep.
#[derive(Clone, Debug)]
pub struct Recipe {
    pub(super) idealization: Choice<Idealization>,
    pub(super) hole_radius: Quantity,
    pub(super) radial_clearance: Quantity,
    pub(super) thickness: Quantity,
    pub(super) pin: PartRecipe,
    pub(super) plate: PartRecipe,
    axes: Vec<Axis>,
    sampler: Sampler,
}

/// The values that several designs take.
pub struct JointValues<'a, const N: usize> {
    idealizations: [Idealization; N],
    hole_radii: [f64; N],
    radial_clearances: [f64; N],
    thicknesses: [f64; N],
    pins: PartValues<'a, N>,
    plates: PartValues<'a, N>,
}

impl<const N: usize> JointValues<'_, N> {
    /// The joint of one of them.
    pub fn joint(&self, place: usize) -> JointDesign {
        let (hole_radius, radial_clearance) = (self.hole_radii[place], self.radial_clearances[place]);
        JointDesign {
            idealization: self.idealizations[place],
            hole_radius,
            radial_clearance,
            thickness: self.thicknesses[place],
            pin: self.pins.part(place, hole_radius - radial_clearance),
            plate: self.plates.part(place, hole_radius),
        }
    }
}

struct PartValues<'a, const N: usize> {
    recipe: &'a PartRecipe,
    parameters: [[f64; N]; MAX_PARAMETERS],
    supports: [usize; N],
    materials: [Material; N],
    layers: Vec<LayerValues<'a, N>>,
}

impl<const N: usize> PartValues<'_, N> {
    /// The part of one of them, with its radius at the contact, mm.
    fn part(&self, place: usize, radius: f64) -> Part {
        let mut depth = 0.0;
        let layer = |values: &LayerValues<N>| {
            let LayerRecipe { measure, yield_stress, .. } = values.recipe;
            let told = values.told[place];
            let thickness = match measure {
                Measure::Length => told,
                Measure::OfRadius => told * radius,
                Measure::DownTo => tidy((1.0 - told) * radius - depth),
            };
            depth += thickness;
            Layer {
                thickness,
                material: values.materials[place],
                yield_stress: yield_stress.as_ref().map(|own| own.value),
                is_tube: *measure == Measure::DownTo,
            }
        };
        Part {
            shape: self.recipe.shape,
            parameters: std::array::from_fn(|slot| self.parameters[slot][place]),
            support: self.supports[place],
            material: self.materials[place],
            yield_stress: self.recipe.yield_stress.as_ref().map(|own| own.value),
            layers: self.layers.iter().map(layer).collect(),
        }
    }
}

struct LayerValues<'a, const N: usize> {
    recipe: &'a LayerRecipe,
    /// What its thickness is told by.
    told: [f64; N],
    materials: [Material; N],
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
        let pin = read_part(joint, Side::Pin, &mut reader)?;
        let plate = read_part(joint, Side::Plate, &mut reader)?;
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
        self.values_of(&[design]).joint(0)
    }

    /// The values that designs of these numbers take.
    pub fn values_of<const N: usize>(&self, designs: &[u64; N]) -> JointValues<'_, N> {
        JointValues {
            idealizations: self.options(&self.idealization, designs),
            hole_radii: self.values(&self.hole_radius, designs),
            radial_clearances: self.values(&self.radial_clearance, designs),
            thicknesses: self.values(&self.thickness, designs),
            pins: self.part_values(&self.pin, designs),
            plates: self.part_values(&self.plate, designs),
        }
    }

    /// Whether a pin may be larger than its hole.
    pub fn has_press_fits(&self) -> bool {
        self.radial_clearance.values.smallest() < 0.0
    }

    /// Whether such a hole is in a plate that is not concentric.
    pub fn has_lopsided_fits(&self) -> bool {
        self.has_press_fits() && !self.plate.shape.concentric
    }

    /// What a reader of the config must be told of its yield stresses: which of them rows do not heed, and why.
    pub fn unused_yield_stresses(&self) -> Vec<String> {
        let lopsided = [&self.pin, &self.plate].into_iter().find(|part| !part.shape.concentric);
        let Some(lopsided) = lopsided.filter(|_| self.has_press_fits()) else { return Vec::new() };
        let keys = [&self.pin, &self.plate].map(PartRecipe::yield_stress_keys).concat();
        if keys.is_empty() {
            return Vec::new();
        }
        vec![format!(
            "{}: has no effect on the status of press fits, because their stresses at rest are known between concentric bodies \
             only, not with a {}; `jointsweep stresses` uses it",
            keys.join(", "),
            lopsided.shape.name
        )]
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

    /// What its bodies have in common.
    pub fn in_common(&self) -> InCommon {
        InCommon { pins: self.pin.in_common(), plates: self.plate.in_common() }
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

    fn part_values<'a, const N: usize>(
        &self,
        recipe: &'a PartRecipe,
        designs: &[u64; N],
    ) -> PartValues<'a, N> {
        let mut parameters = [[0.0; N]; MAX_PARAMETERS];
        for (values, quantity) in parameters.iter_mut().zip(&recipe.parameters) {
            *values = self.values(quantity, designs);
        }
        let of_layer = |layer: &'a LayerRecipe| LayerValues {
            recipe: layer,
            told: self.values(&layer.thickness, designs),
            materials: self.materials(&layer.youngs_modulus, &layer.poissons_ratio, designs),
        };
        PartValues {
            recipe,
            parameters,
            supports: self.options(&recipe.support, designs),
            materials: self.materials(&recipe.youngs_modulus, &recipe.poissons_ratio, designs),
            layers: recipe.layers.iter().map(of_layer).collect(),
        }
    }

    fn materials<const N: usize>(
        &self,
        youngs_modulus: &Quantity,
        poissons_ratio: &Quantity,
        designs: &[u64; N],
    ) -> [Material; N] {
        let moduli = self.values(youngs_modulus, designs);
        let ratios = self.values(poissons_ratio, designs);
        std::array::from_fn(|place| Material { youngs_modulus: moduli[place], poissons_ratio: ratios[place] })
    }

    fn picks<const N: usize>(&self, axis: Option<usize>, designs: &[u64; N]) -> Picks<N> {
        axis.map_or(Picks::Index([0; N]), |axis| self.sampler.picks(designs, axis))
    }

    fn value(&self, quantity: &Quantity, design: u64) -> f64 {
        self.values(quantity, &[design])[0]
    }

    fn values<const N: usize>(&self, quantity: &Quantity, designs: &[u64; N]) -> [f64; N] {
        quantity.values.at_each(&self.picks(quantity.axis, designs))
    }

    fn options<T: Copy, const N: usize>(&self, choice: &Choice<T>, designs: &[u64; N]) -> [T; N] {
        let picks = self.picks(choice.axis, designs);
        std::array::from_fn(|place| choice.options[picks.of(place).of(choice.options.len())])
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
