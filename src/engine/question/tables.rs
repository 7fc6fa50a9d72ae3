//! What a device is told of a question, and of a design for it.

use super::formula::{Givens, value};
use super::{Limits, MOST_POINTS, Question, Watch};
use crate::engine::accuracy::geometry_error::OutlineError;
use crate::engine::accuracy::known_errors::{self, COLUMNS, NO_MESH};
use crate::engine::joint_scale::JointScale;
use crate::study::design::{DesignCase, Load};

/// Numbers of a design before its givens: sizes of the joint and its outlines, and bounds of its bodies.
pub const SCENE_NUMBERS: usize = 7;
pub const BOUND_NUMBERS: usize = 3;
pub const DESIGN_NUMBERS: usize = SCENE_NUMBERS + 2 * BOUND_NUMBERS;

/// Numbers of the question before its tables, in their order: how many there are of what, and where it begins.
#[derive(Clone, Copy)]
pub enum Field {
    Accuracy,
    QuantityCount,
    QuantitiesAt,
    WatchCount,
    WatchesAt,
    AxisCount,
    PointCount,
    AxesAt,
    HistogramCount,
    HistogramsAt,
    GivenOfDesign,
    GivenOfRow,
    VerdictsAt,
    ColumnBeginsAt,
    MeshErrorsAt,
    /// 1 where bodies are on meshes, 0 where they are interpolated.
    OnMeshes,
    /// How many these are.
    Count,
}

/// Where a device finds the bound of a body.
pub struct BoundPlaces {
    /// Among the tables of the question, that of its fit.
    pub of_fit: usize,
    /// Which of the kinds in this it is.
    pub kind: usize,
    /// Among `known_errors::all`, what its mesh leaves.
    pub of_mesh: usize,
}

/// Where limits and points end.
const FARTHEST: f64 = f32::MAX as f64;

/// A question with what rows must reach so far.
pub struct Standing<'a> {
    question: &'a Question,
    limits: Limits,
    /// Watches of what is given, each with its limit.
    given: Vec<(&'a Watch, f64)>,
    /// What rounding adds to the errors of meshes, where bodies are on these.
    on_meshes: Option<f64>,
    /// Of each axis that is given the scores of points, ascending.
    scores: Vec<Vec<f64>>,
}

impl<'a> Standing<'a> {
    /// Of interpolated bodies.
    pub fn new(question: &'a Question, mut limits: Limits) -> Standing<'a> {
        limits.points.truncate(MOST_POINTS);
        let scores = (0..question.axes.len()).map(|axis| {
            let mut scores: Vec<f64> = limits.points.iter().map(|point| point[axis]).collect();
            scores.sort_by(f64::total_cmp);
            scores
        });
        let scores = scores.collect();
        let given = watches(question, &limits).filter(|(watch, _)| is_given(question, watch)).collect();
        Standing { question, limits, given, on_meshes: None, scores }
    }

    /// Of bodies on meshes, to whose errors rounding adds so much.
    pub fn on_meshes(self, rounding: f64) -> Standing<'a> {
        Standing { on_meshes: Some(rounding), ..self }
    }

    /// Before the bounds of fits, or one of none (`FitBound::of_none`).
    pub fn tables(&self) -> Vec<f32> {
        let Standing { question, limits, on_meshes, .. } = self;
        let mut tables = vec![0.0; Field::Count as usize];
        let set = |tables: &mut Vec<f32>, field: Field, number: usize| tables[field as usize] = number as f32;
        let begin = |tables: &mut Vec<f32>, field: Field| tables[field as usize] = tables.len() as f32;
        tables[Field::Accuracy as usize] = question.accuracy as f32;
        set(&mut tables, Field::OnMeshes, usize::from(on_meshes.is_some()));
        set(&mut tables, Field::GivenOfDesign, question.givens.of_design.len());
        set(&mut tables, Field::GivenOfRow, question.givens.of_row.len());
        set(&mut tables, Field::VerdictsAt, question.layout.verdicts);

        set(&mut tables, Field::QuantityCount, question.quantities.len());
        begin(&mut tables, Field::QuantitiesAt);
        tables.extend(question.layout.quantities.iter().flatten().map(|at| *at as f32));

        let made: Vec<_> = self.watches().filter(|(watch, _)| !self.is_given(watch)).collect();
        set(&mut tables, Field::WatchCount, made.len());
        begin(&mut tables, Field::WatchesAt);
        for (Watch { quantity, sign }, limit) in made {
            tables.extend([*quantity as f32, *sign as f32, wider(limit)]);
        }

        set(&mut tables, Field::AxisCount, question.axes.len());
        set(&mut tables, Field::PointCount, limits.points.len());
        begin(&mut tables, Field::AxesAt);
        // An axis that is given is a number of the row, in the place of a quantity.
        let first = question.givens.of_row.len() + 1;
        for (axis, watch) in question.axes.iter().enumerate() {
            let [of, sign] = if self.is_given(watch) {
                [(first + axis) as f32, 0.0]
            } else {
                [watch.quantity as f32, watch.sign as f32]
            };
            tables.extend([of, sign]);
        }
        for point in &limits.points {
            let score = |(axis, watch): (usize, &Watch)| match self.is_given(watch) {
                true => self.rank(axis, point[axis]),
                false => wider(point[axis]),
            };
            tables.extend(question.axes.iter().enumerate().map(score));
        }

        set(&mut tables, Field::HistogramCount, question.histograms.len());
        begin(&mut tables, Field::HistogramsAt);
        let mut edges_at = tables.len() + 4 * question.histograms.len();
        for (histogram, at) in question.histograms.iter().zip(&question.layout.histograms) {
            let count = histogram.edges.len();
            tables.extend([histogram.quantity, count, edges_at, *at].map(|number| number as f32));
            edges_at += count;
        }
        tables.extend(question.histograms.iter().flat_map(|own| &own.edges).map(|edge| *edge as f32));

        begin(&mut tables, Field::ColumnBeginsAt);
        tables.extend(COLUMNS.map(|begin| begin.to_radians() as f32));

        begin(&mut tables, Field::MeshErrorsAt);
        let rounding = on_meshes.unwrap_or(0.0);
        let with_rounding = |(place, known): (usize, &known_errors::Known)| {
            known.map(|known| if place == NO_MESH { known } else { known + rounding } as f32)
        };
        tables.extend(known_errors::all().iter().enumerate().flat_map(with_rounding));
        tables
    }

    /// What the kernel is given of a design behind the numbers of its joint, whose infinite bodies come to `even`, and of the bounds of its
    /// bodies. `false` where it is not for a device: a load without contact, an input that is missing.
    pub fn push_design(
        &self,
        case: &DesignCase,
        even: f64,
        bounds: [BoundPlaces; 2],
        to: &mut Vec<f32>,
    ) -> bool {
        let DesignCase { joint, steps, .. } = case;
        let scale = JointScale::of(joint);
        let clearance = scale.outlines.radial_clearance;
        let softest = joint.pin.least_modulus().min(joint.plate.least_modulus());
        let [of_all, of_shear] = OutlineError::of(joint, &scale.outlines).numbers();
        let from = to.len();
        let scene = [joint.hole_radius, joint.thickness, even, clearance, softest, of_all, of_shear];
        to.extend(scene.iter().map(|number| *number as f32));
        for BoundPlaces { of_fit, kind, of_mesh } in bounds {
            to.extend([of_fit, kind, of_mesh].map(|number| number as f32));
        }
        let Givens { of_design, of_row } = &self.question.givens;
        to.extend(of_design.iter().map(|given| value(given, case, 0) as f32));
        for (step, load) in steps.iter().enumerate() {
            let [of_length, of_force] = match joint.from_first_touch(*load) {
                Load::Indentation(length) | Load::Offset(length) if length > 0.0 => {
                    [clearance + length / joint.hole_radius, 0.0]
                }
                Load::Force(force) if force > 0.0 => [0.0, force / (joint.thickness * joint.hole_radius)],
                _ => return false,
            };
            to.extend_from_slice(&[of_length as f32, of_force as f32]);
            to.extend(of_row.iter().map(|given| value(given, case, step) as f32));
            self.push_extremes(case, step, to);
        }
        to[from..].iter().all(|number| number.is_finite())
    }

    /// Behind what is given of a row: whether it is an extreme one by what is given, and its ranks along the axes that are.
    pub fn push_extremes(&self, case: &DesignCase, step: usize, to: &mut Vec<f32>) {
        let score = |watch: &Watch| {
            watch.sign * value(self.question.quantities[watch.quantity].of.operations(), case, step)
        };
        let is_extreme = |(watch, limit): &(&Watch, f64)| score(watch) < *limit;
        to.push(if self.given.iter().any(is_extreme) { 1.0 } else { 0.0 });
        let rank = |(axis, watch): (usize, &Watch)| match self.is_given(watch) {
            true => self.rank(axis, score(watch)),
            false => 0.0,
        };
        to.extend(self.question.axes.iter().enumerate().map(rank));
    }

    /// Of each quantity the least and the greatest value so far, where its extremes are told.
    pub fn ranges(&self) -> Vec<Option<[f64; 2]>> {
        let range = |quantity: usize| {
            let limit = |sign: f64| {
                let own = |(watch, _): &(&Watch, f64)| watch.quantity == quantity && watch.sign == sign;
                self.watches().find(own).map(|(_, limit)| sign * limit).filter(|limit| limit.is_finite())
            };
            Some([limit(1.0)?, limit(-1.0)?])
        };
        (0..self.question.quantities.len()).map(range).collect()
    }

    fn watches(&self) -> impl Iterator<Item = (&Watch, f64)> {
        watches(self.question, &self.limits)
    }

    fn is_given(&self, watch: &Watch) -> bool {
        is_given(self.question, watch)
    }

    /// How many points have no greater score along an axis: of two scores the greater one has no smaller rank.
    fn rank(&self, axis: usize, score: f64) -> f32 {
        self.scores[axis].partition_point(|own| *own <= score) as f32
    }
}

/// Each with its limit.
fn watches<'a>(question: &'a Question, limits: &Limits) -> impl Iterator<Item = (&'a Watch, f64)> {
    let limit = |place: usize| limits.watches.get(place).copied().unwrap_or(f64::INFINITY);
    question.watches.iter().enumerate().map(move |(place, watch)| (watch, limit(place)))
}

fn is_given(question: &Question, watch: &Watch) -> bool {
    question.quantities[watch.quantity].is_given
}

/// In f32, and no smaller.
fn wider(limit: f64) -> f32 {
    let limit = limit.clamp(-FARTHEST, FARTHEST);
    let rounded = limit as f32;
    if f64::from(rounded) < limit { rounded.next_up() } else { rounded }
}
