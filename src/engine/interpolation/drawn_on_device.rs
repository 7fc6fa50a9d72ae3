//! Designs that a device draws itself, finds in their fits and counts: the tables that tell it of these fits. Whatever depends on Poisson's ratio
//! by steps is asked here of one body between two steps.

use std::ops::Range;

use crate::engine::accuracy::known_errors::{DEPTHS, Group};
use crate::engine::backend::drawn::{
    DrawSettings, DrawnDesigns, DrawnShape, LoadKind, MOST_KINDS, NOWHERE, SIDE_WORDS, TERMS_SHIFT, UNKNOWN,
};
use crate::engine::backend::joints::{
    AskedOfJoints, BodyTables, JointTables, MOST_COORDINATES, SolvedJoints,
};
use crate::engine::bodies::BodyLibrary;
use crate::engine::interpolation::family::{FamilyKey, coordinate_count};
use crate::engine::interpolation::fit::FittedFamily;
use crate::engine::interpolation::fit_plan::InterpolationPlan;
use crate::engine::interpolation::interpolated::Interpolation;
use crate::engine::question::drawn::{Shapes, functions};
use crate::engine::question::tables::Standing;
use crate::engine::question::{Asker, Question};
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::mechanics::body::lining::Lining;
use crate::mechanics::body::{Body, MAX_PARAMETERS, Shape, Side, block};
use crate::mechanics::contact::outlines::Outlines;
use crate::mechanics::material::{Compressibility, Idealization};
use crate::study::config::Study;
use crate::study::design::Load;
use crate::study::draw_tables::DrawTables;

/// What a device needs of a study and of what is asked about it, whatever the fits.
#[derive(Clone, Debug)]
pub struct Drawing {
    tables: DrawTables,
    shapes: Shapes,
    loads: Vec<Load>,
    functions: String,
}

impl Drawing {
    /// `None` where a device cannot draw the designs, or cannot tell what is given of them.
    pub fn of(study: &Study, question: &Question) -> Option<Drawing> {
        // The processor tells by what is given which rows are among the extreme ones.
        let is_given = |quantity: usize| question.quantities[quantity].is_given;
        if question.watches.iter().chain(&question.axes).any(|watch| is_given(watch.quantity)) {
            return None;
        }
        let first = study.cases().ok()?.next()?.ok()?.joint;
        let shapes = [first.pin.shape, first.plate.shape];
        shape_of(shapes[0]).and(shape_of(shapes[1]))?;
        let loads = study.loads().to_vec();
        let functions = functions(&question.givens, shapes)?;
        (!loads.is_empty()).then_some(Drawing { tables: study.draw_tables()?, shapes, loads, functions })
    }
}

fn shape_of(shape: &Shape) -> Option<DrawnShape> {
    match shape.parameters.len() {
        0 => Some(DrawnShape::Plain),
        1 if shape.concentric => Some(DrawnShape::Concentric),
        _ => (*shape == block::SHAPE).then_some(DrawnShape::Block),
    }
}

/// Where Poisson's ratio makes a body of another kind: the least one of each kind but the first.
fn cuts(state: Idealization) -> Vec<f64> {
    let steps: &[f64] = match state {
        Idealization::PlaneStress => &[Compressibility::NEARLY_CONFORMAL, 0.0],
        Idealization::PlaneStrain => &[
            0.0,
            Compressibility::STIFF,
            Compressibility::VERY_STIFF,
            Compressibility::NEARLY_INCOMPRESSIBLE,
            Compressibility::LOCKING,
        ],
    };
    // Steps may belong to either side.
    steps.iter().flat_map(|step| [*step, step.next_up()]).collect()
}

/// Below all of them.
const LEAST_RATIO: f64 = -0.9;

/// A depth of a wall that is neither thin nor deep.
const MIDDLING: f64 = 0.5 * (DEPTHS[4] + DEPTHS[5]);

/// A fit of bodies of one side, and where among the tables of the question its bounds are.
struct OfSide<'a> {
    key: FamilyKey,
    fit: &'a FittedFamily,
    bound_at: u32,
}

/// Words and numbers that grow.
struct Tables {
    words: Vec<u32>,
    numbers: Vec<f64>,
}

impl Tables {
    /// Where numbers begin that are added.
    fn add(&mut self, numbers: impl IntoIterator<Item = f64>) -> u32 {
        let at = self.numbers.len() as u32;
        self.numbers.extend(numbers);
        at
    }

    /// What a device needs of the bodies of one side; tells where that begins.
    fn add_side(&mut self, shape: &'static Shape, half_ring: bool, fits: &[OfSide]) -> Option<u32> {
        let at = self.words.len();
        self.words.resize(at + SIDE_WORDS, 0);
        let states = [Idealization::PlaneStress, Idealization::PlaneStrain];
        let supports = shape.supports.len().max(1);
        for support in 0..supports {
            for state in states {
                let cuts = cuts(state);
                let firsts = std::iter::once(LEAST_RATIO).chain(cuts.iter().copied());
                let from = self.words.len();
                for poissons_ratio in firsts {
                    let probe = Probe { shape, support, state, poissons_ratio };
                    let key = FamilyKey::of(&probe.body(MIDDLING), half_ring);
                    let place = key.and_then(|key| fits.iter().position(|own| own.key == key));
                    let row = match place {
                        Some(place) => [place as u32, self.add(probe.known(fits[place].fit))],
                        None => [NOWHERE, 0],
                    };
                    self.words.extend(row);
                }
                if self.words.len() - from > 2 * MOST_KINDS {
                    return None;
                }
                self.words.resize(from + 2 * MOST_KINDS, NOWHERE);
            }
        }
        let fits_at = self.words.len();
        for OfSide { fit, bound_at, .. } in fits {
            let ranges = &fit.fit.polynomials.ranges;
            let ranges = ranges.iter().copied().chain(std::iter::repeat((0.0, 0.0)));
            let ranges: Vec<f64> =
                ranges.take(MOST_COORDINATES).flat_map(|(low, high)| [low, high]).collect();
            let ranges_at = self.add(ranges);
            self.words.extend([ranges_at, *bound_at]);
        }
        let of_states = states.map(|state| {
            let cuts = cuts(state);
            [self.add(cuts.iter().copied()), cuts.len() as u32]
        });
        let plain = (shape.depth_range)(&[0.0; MAX_PARAMETERS]).0;
        let depths_at = self.add(DEPTHS.into_iter().chain([plain]));
        let [of_stress, of_strain] = of_states;
        let header = [
            coordinate_count(shape) as u32 - 1,
            shape_of(shape)? as u32,
            of_stress[0],
            of_stress[1],
            of_strain[0],
            of_strain[1],
            fits_at as u32,
            depths_at,
        ];
        self.words[at..at + SIDE_WORDS].copy_from_slice(&header);
        Some(at as u32)
    }
}

/// A body between two steps of Poisson's ratio.
#[derive(Clone, Copy)]
struct Probe {
    shape: &'static Shape,
    support: usize,
    state: Idealization,
    poissons_ratio: f64,
}

impl Probe {
    /// With a wall of a depth |ln r|.
    fn body(self, depth: f64) -> Body {
        let Probe { shape, support, state, poissons_ratio } = self;
        let mut parameters = [0.0; MAX_PARAMETERS];
        for (value, parameter) in parameters.iter_mut().zip(shape.parameters) {
            *value = if parameter.below <= 1.0 { (-depth).exp() } else { depth.exp() };
        }
        Body {
            shape,
            parameters,
            support,
            poissons_ratio,
            idealization: state,
            lining: Lining::NONE,
            all_around: false,
        }
    }

    /// The deepest of them that are known, then of each depth where what meshes leave stands, `UNKNOWN` of those of which nothing is known.
    fn known(self, fit: &FittedFamily) -> Vec<f64> {
        let deepest = match fit.bound.known_level() {
            None => f64::INFINITY,
            Some(_) => Group::of(&self.body(MIDDLING)).map_or(0.0, |group| group.depths()[1]),
        };
        let of_depth = |depth: &f64| {
            // Just within.
            let places = fit.bound.of(&self.body(depth * (1.0 + 1e-9)), true).places();
            places.map_or(UNKNOWN, |(_, of_mesh)| of_mesh as f64)
        };
        std::iter::once(deepest).chain(DEPTHS.iter().map(of_depth)).collect()
    }
}

impl Interpolation {
    /// Has a device draw the designs of these numbers and count their rows; false where it cannot.
    pub fn begin_drawn(
        &mut self,
        library: &mut BodyLibrary,
        spaces: &mut Spaces,
        drawing: &Drawing,
        asker: &dyn Asker,
        designs: Range<u32>,
    ) -> bool {
        if library.solves_joints() < SolvedJoints::Interpolated {
            return false;
        }
        self.prepare(library, spaces);
        self.drawn(spaces, drawing, asker, designs).is_some_and(|drawn| library.begin_drawn(&drawn))
    }

    /// The designs of these numbers as a device draws and counts them; `None` where it cannot.
    fn drawn<'a>(
        &'a self,
        spaces: &'a Spaces,
        drawing: &'a Drawing,
        asker: &'a dyn Asker,
        designs: Range<u32>,
    ) -> Option<DrawnDesigns<'a>> {
        let InterpolationPlan { accuracy, pairs, .. } = &*self.plan;
        let half_ring = drawing.shapes[0].end_angle < std::f64::consts::PI;
        let (mut fits, question) = ([Vec::new(), Vec::new()], asker.question());
        let standing = Standing::new(question, asker.limits());
        let mut asked = standing.tables();
        for fit in self.fits_in_order() {
            let side = usize::from(fit.side() == Side::Plate);
            let key = self.plan.families[fit.number].0.key;
            fits[side].push(OfSide { key, fit, bound_at: asked.len() as u32 });
            asked.extend(fit.bound.table().map(|number| number as f32));
        }
        let DrawTables { words, numbers, count, mixed_seed } = drawing.tables.clone();
        let mut tables = Tables { words, numbers };
        let [of_pins, of_plates] = &fits;
        let sides_at = [
            tables.add_side(drawing.shapes[0], half_ring, of_pins)?,
            tables.add_side(drawing.shapes[1], half_ring, of_plates)?,
        ];
        let loads_at = [tables.words.len() as u32, tables.add(drawing.loads.iter().map(|load| load.value()))];
        tables.words.extend(drawing.loads.iter().map(|load| match load {
            Load::Indentation(_) => LoadKind::Indentation as u32,
            Load::Offset(_) => LoadKind::Offset as u32,
            Load::Force(_) => LoadKind::Force as u32,
        }));
        let keys: Vec<SpaceKey> = SpaceKey::of_fits_of_thick_walls(half_ring, *accuracy).collect();
        let pairs_at = tables.words.len() as u32;
        let mut joints: Vec<JointTables> = Vec::new();
        for pin in of_pins {
            for plate in of_plates {
                for key in &keys {
                    let are_fitted = pairs.contains(&(pin.key, plate.key));
                    let own = are_fitted.then(|| pair_of(spaces, [pin.fit, plate.fit], *key)).flatten();
                    let place = own.map_or(NOWHERE, |own| {
                        joints.push(own);
                        (joints.len() - 1) as u32 | (key.terms as u32) << TERMS_SHIFT
                    });
                    tables.words.push(place);
                }
            }
        }
        if joints.is_empty() {
            return None;
        }
        let settings = DrawSettings {
            count,
            load_count: drawing.loads.len() as u32,
            seed: [mixed_seed as u32, (mixed_seed >> 32) as u32],
            given_of_design: question.givens.of_design.len() as u32,
            given_of_row: question.givens.of_row.len() as u32,
            behind_row: 1 + question.axes.len() as u32,
            plate_fit_count: of_plates.len() as u32,
            sides_at,
            loads_at,
            pairs_at,
            ..DrawSettings::default()
        };
        Some(DrawnDesigns {
            designs,
            settings: settings.sized(),
            words: tables.words,
            numbers: tables.numbers,
            functions: &drawing.functions,
            tables: joints,
            asked: AskedOfJoints { question, tables: asked, ranges: standing.ranges() },
        })
    }
}

/// What joints of bodies in two fits have in common in a space; `None` where a device has no kernel for them.
fn pair_of<'a>(spaces: &'a Spaces, fits: [&'a FittedFamily; 2], key: SpaceKey) -> Option<JointTables<'a>> {
    let of_fit = |fit: &'a FittedFamily| Some(BodyTables::Fit(fit.number, &fit.fit, fit.rows(key)?));
    let tables = JointTables { bodies: [of_fit(fits[0])?, of_fit(fits[1])?], space: (key, spaces.get(key)) };
    // Whatever the clearance, which the kernel looks at.
    tables.are_for_devices(&Outlines::ALIKE).then_some(tables)
}
