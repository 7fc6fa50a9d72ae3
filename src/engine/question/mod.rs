//! What `[select]` and `[reduce]` ask of all rows together, as a device answers it: it counts the rows of the designs whose values are sure,
//! and tells which designs the processor must look at, be it for want of sureness or because they may be among the extreme ones. So what
//! comes back of a batch does not grow with its rows, and everything that is told of single rows is the processor's.

pub mod counted;
pub mod formula;
pub mod tables;
pub mod drawn;

use counted::Layout;
use formula::{AskedLoad, Givens, function, is_given};

use crate::engine::outcome::DesignOutcome;
use crate::study::config::Study;
use crate::study::expression::Expression;
use crate::study::reduce::{Objective, Order, Reduce};

/// How far a device's number is from the processor's, at most, relative: of what it finds of the same bodies, of what it adds to that in
/// calculating (each operation), and of what it is given.
pub const FOUND: f64 = 3e-5;
pub const CALCULATED: f64 = 1e-6;
pub const ROUNDED: f64 = 1.2e-7;

/// A number is counted that is known this well, relative.
pub const TRUSTED: f64 = 1e-4;

/// Estimates of errors are known this well, relative.
pub const OF_ERRORS: f64 = 0.02;
/// And with this beside, absolute: what rounding leaves of differences.
pub const NOISE: f64 = 1e-6;

/// Points of a front that a device compares with.
pub const MOST_POINTS: usize = 1024;

/// Quantities, and bins of histograms all together, that it has counts for.
const MOST_QUANTITIES: usize = 16;
const MOST_EDGES: usize = 20_000;

/// A question that a device can answer.
#[derive(Debug)]
pub struct Question {
    /// Functions of the kernel: `condition` and `quantity`.
    pub text: String,
    pub givens: Givens,
    pub layout: Layout,
    /// Each once, however often it is asked for.
    pub quantities: Vec<AskedQuantity>,
    pub histograms: Vec<AskedHistogram>,
    /// What is extreme, in the order of `[reduce]`: of statistics and histograms the smallest and the largest.
    pub watches: Vec<Watch>,
    /// Of a front.
    pub axes: Vec<Watch>,
    pub accuracy: f64,
}

/// A quantity of which the extreme rows are told.
#[derive(Clone, Copy, Debug)]
pub struct Watch {
    pub quantity: usize,
    /// 1 where small ones are good, -1 where large ones are.
    pub sign: f64,
}

#[derive(Clone, Debug)]
pub struct AskedQuantity {
    pub of: Expression,
    /// Whether its sums are asked for, and a fine count of its values.
    pub has_sums: bool,
    pub has_sketch: bool,
    /// Whether the processor knows it beforehand: then it also tells, without any radius, which rows are among the extreme ones. Inputs
    /// have few values, and rows that are as good as those before are not extreme.
    pub is_given: bool,
}

#[derive(Clone, Debug)]
pub struct AskedHistogram {
    pub quantity: usize,
    /// Ascending.
    pub edges: Vec<f64>,
}

/// What rows must reach to be among the extreme ones, so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limits {
    /// Of each watch: the value times its sign that is just good enough. Infinity where any is.
    pub watches: Vec<f64>,
    /// Points of the front by their scores, small being good: some are enough.
    pub points: Vec<[f64; 3]>,
}

/// Who asks: it knows what is extreme so far.
pub trait Asker: Sync {
    fn question(&self) -> &Question;

    fn limits(&self) -> Limits;

    /// Looks at designs that are solved, open ones and candidates, and makes failures of answers that no row can have.
    fn look(&self, outcomes: &mut [DesignOutcome]);
}

impl Watch {
    fn both(quantity: usize) -> [Watch; 2] {
        [1.0, -1.0].map(|sign| Watch { quantity, sign })
    }
}

impl Question {
    /// `None` where rows are written, too, where nothing is asked, and where a device does not know what is asked.
    pub fn of(study: &Study) -> Option<Question> {
        if study.writes_table() || study.fits_laws() {
            return None;
        }
        let Reduce { statistics, quantiles, best, pareto, histograms } = study.reduce.as_ref()?;
        let asked = AskedLoad::of(study.loads());
        let mut quantities = Quantities(Vec::new(), asked);
        let (mut watches, mut bins) = (Vec::new(), Vec::new());
        for of in statistics {
            let own = quantities.place(of);
            quantities.0[own].has_sums = true;
            quantities.0[own].has_sketch |= !quantiles.is_empty();
            watches.extend(Watch::both(own));
        }
        for asked in best {
            watches.push(Watch { quantity: quantities.place(&asked.by), sign: sign(asked.order) });
        }
        for asked in histograms {
            let own = quantities.place(&asked.of);
            match asked.edges() {
                Some(edges) => bins.push(AskedHistogram { quantity: own, edges }),
                None => {
                    (quantities.0[own].has_sums, quantities.0[own].has_sketch) = (true, true);
                    watches.extend(Watch::both(own));
                }
            }
        }
        let axis =
            |asked: &Objective| Watch { quantity: quantities.place(&asked.of), sign: sign(asked.order) };
        let axes = pareto.iter().map(axis).collect();
        let quantities = quantities.0;
        let edges: usize = bins.iter().map(|histogram| histogram.edges.len()).sum();
        if quantities.len() > MOST_QUANTITIES || edges > MOST_EDGES {
            return None;
        }
        let mut givens = Givens::default();
        let mut text = match &study.select {
            Some(condition) => function("condition", condition.operations(), asked, &mut givens)?,
            None => "fn condition(row: Row) -> vec2<f32> {\n    return vec2<f32>(1.0, 0.0);\n}\n".to_string(),
        };
        let mut cases = String::new();
        for (number, quantity) in quantities.iter().enumerate() {
            let name = format!("quantity_{number}");
            text += &function(&name, quantity.of.operations(), asked, &mut givens)?;
            cases += &format!("        case {number}u: {{\n            return {name}(row);\n        }}\n");
        }
        text += &format!(
            "fn quantity(number: u32, row: Row) -> vec2<f32> {{\n    switch number {{\n{cases}        default: {{\n            return \
             unknown();\n        }}\n    }}\n}}\n"
        );
        let layout = Layout::new(&quantities, &bins);
        let accuracy = study.solve.accuracy;
        Some(Question { text, givens, layout, quantities, histograms: bins, watches, axes, accuracy })
    }
}

struct Quantities(Vec<AskedQuantity>, AskedLoad);

impl Quantities {
    fn place(&mut self, of: &Expression) -> usize {
        self.0.iter().position(|known| known.of == *of).unwrap_or_else(|| {
            let is_given = is_given(of.operations(), self.1);
            self.0.push(AskedQuantity { of: of.clone(), has_sums: false, has_sketch: false, is_given });
            self.0.len() - 1
        })
    }
}

/// What values are multiplied by, so that small ones are good.
pub fn sign(order: Order) -> f64 {
    match order {
        Order::Largest => -1.0,
        Order::Smallest => 1.0,
    }
}
