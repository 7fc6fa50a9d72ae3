//! A recipe as tables, by which a device draws designs by the same sampler (`shaders/draw.wgsl`): the values of each quantity, and which of
//! them a design takes.

use sobol_burley::parts::sobol_rev;

use crate::mechanics::body::MAX_PARAMETERS;
use crate::study::part_recipe::PartRecipe;
use crate::study::reader::{Choice, Quantity};
use crate::study::recipe::Recipe;
use crate::study::sampling::{AxisDraw, SOBOL_BITS, Scheme, Source, mix};
use crate::study::values::Values;

/// The quantities of a joint, in the order of their entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    HoleRadius,
    RadialClearance,
    Thickness,
    /// A place in `Idealization::ALL`.
    Idealization,
    /// Of the pin: its ratios, of which there are `MAX_PARAMETERS`, its support, Young's modulus and Poisson's ratio. Then the plate's.
    Pin,
    Plate = Slot::Pin as isize + OF_PART as isize,
    /// How many these are.
    Count = Slot::Plate as isize + OF_PART as isize,
}

/// Entries of a part, of which these are the last ones.
pub const OF_PART: usize = MAX_PARAMETERS + 3;
pub const SUPPORT: usize = MAX_PARAMETERS;
pub const YOUNGS_MODULUS: usize = MAX_PARAMETERS + 1;
pub const POISSONS_RATIO: usize = MAX_PARAMETERS + 2;

/// What an entry's values are.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    List,
    Linear,
    /// Even in the logarithm.
    Logarithmic,
}

/// Words of an entry, in their order: `Source`, designs before its axis moves on and values of that, two words of what its random numbers
/// begin with, its place among the axes, where its Sobol vectors are, `Kind`, where its values are and how many.
pub const ENTRY_WORDS: usize = 10;

/// Counted ranges become lists, up to this many values.
const LONGEST: u64 = 1 << 16;

/// What a device needs to draw the designs of a recipe. No layers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawTables {
    /// `Slot::Count` entries, then vectors.
    pub words: Vec<u32>,
    /// Lists; of ranges both ends, of logarithmic ones then the roots of their quotient.
    pub numbers: Vec<f64>,
    /// Designs of the sampler.
    pub count: u32,
    /// Of Sobol sequences.
    pub mixed_seed: u64,
}

impl Recipe {
    /// `None` where a device cannot draw its designs: layers, very long counted ranges, samplers of sensitivities.
    pub fn draw_tables(&self) -> Option<DrawTables> {
        let sampler = self.sampler();
        let count = u32::try_from(sampler.design_count()).ok()?;
        let mixed_seed = match sampler.scheme() {
            Scheme::Sobol { seed, .. } => mix(seed),
            Scheme::Saltelli { .. } => return None,
            Scheme::Grid | Scheme::Zip | Scheme::LatinHypercube { .. } => 0,
        };
        let words = vec![0; ENTRY_WORDS * Slot::Count as usize];
        let mut tables = DrawTables { words, numbers: Vec::new(), count, mixed_seed };
        let Recipe { hole_radius, radial_clearance, thickness, idealization, pin, plate, .. } = self;
        self.enter(&mut tables, Slot::HoleRadius as usize, hole_radius)?;
        self.enter(&mut tables, Slot::RadialClearance as usize, radial_clearance)?;
        self.enter(&mut tables, Slot::Thickness as usize, thickness)?;
        self.enter(&mut tables, Slot::Idealization as usize, &numbered(idealization, |own| *own as usize))?;
        for (slot, PartRecipe { parameters, support, youngs_modulus, poissons_ratio, layers, .. }) in
            [(Slot::Pin, pin), (Slot::Plate, plate)]
        {
            if !layers.is_empty() {
                return None;
            }
            for (place, parameter) in parameters.iter().enumerate() {
                self.enter(&mut tables, slot as usize + place, parameter)?;
            }
            self.enter(&mut tables, slot as usize + SUPPORT, &numbered(support, |own| *own))?;
            self.enter(&mut tables, slot as usize + YOUNGS_MODULUS, youngs_modulus)?;
            self.enter(&mut tables, slot as usize + POISSONS_RATIO, poissons_ratio)?;
        }
        Some(tables)
    }

    fn enter(&self, tables: &mut DrawTables, slot: usize, quantity: &Quantity) -> Option<()> {
        let values_at = tables.numbers.len();
        let kind = match &quantity.values {
            Values::List(values) => {
                tables.numbers.extend(values);
                Kind::List
            }
            Values::Range(range) => match range.ends_and_roots() {
                (None, ends, roots) => {
                    tables.numbers.extend(ends.iter().chain(roots));
                    if roots.is_empty() { Kind::Linear } else { Kind::Logarithmic }
                }
                (Some(count), ..) if count <= LONGEST => {
                    tables.numbers.extend(range.counted(count));
                    Kind::List
                }
                (Some(_), ..) => return None,
            },
        };
        let draw = quantity.axis.map(|axis| self.sampler().axis_draw(axis));
        let AxisDraw { source, stride, count, key, rank } = draw.unwrap_or(AxisDraw::NOTHING);
        let vectors_at = tables.words.len();
        if let Source::Sobol = source {
            tables.words.extend((0..SOBOL_BITS).map(|bit| sobol_rev((1 << 31) >> bit, rank)));
        }
        let [stride, count] = [u32::try_from(stride).ok()?, u32::try_from(count).ok()?];
        let (places, value_count) = ([vectors_at, values_at], tables.numbers.len() - values_at);
        let entry = [
            source as u32,
            stride,
            count,
            key as u32,
            (key >> 32) as u32,
            rank,
            u32::try_from(places[0]).ok()?,
            kind as u32,
            u32::try_from(places[1]).ok()?,
            u32::try_from(value_count).ok()?,
        ];
        tables.words[ENTRY_WORDS * slot..][..ENTRY_WORDS].copy_from_slice(&entry);
        Some(())
    }
}

/// Options as numbers.
fn numbered<T>(choice: &Choice<T>, number: impl Fn(&T) -> usize) -> Quantity {
    let numbers = choice.options.iter().map(|option| number(option) as f64).collect();
    Quantity { values: Values::List(numbers), axis: choice.axis }
}
