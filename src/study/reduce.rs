//! `[select]` and `[reduce]`: which rows are wanted, and what is wanted of them in the place of the rows themselves.

use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::study::expression::Expression;
use crate::study::source::{Item, Section};

/// What a config asks of all kept rows together.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reduce {
    /// Quantities whose count, extremes, mean and standard deviation are told.
    pub statistics: Vec<Expression>,
    /// Of the same quantities, each in [0, 1].
    pub quantiles: Vec<f64>,
    pub best: Vec<Best>,
    /// Two or three, or none.
    pub pareto: Vec<Objective>,
    pub histograms: Vec<Histogram>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Order {
    Largest,
    Smallest,
}

impl Order {
    pub const ALL: [Order; 2] = [Order::Largest, Order::Smallest];

    /// The word in configs and files.
    pub fn name(self) -> &'static str {
        match self {
            Order::Largest => "largest",
            Order::Smallest => "smallest",
        }
    }
}

/// The rows with the largest or smallest values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Best {
    pub count: usize,
    pub by: Expression,
    pub order: Order,
}

/// A quantity that is to be large, or small.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Objective {
    pub of: Expression,
    pub order: Order,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Spacing {
    Linear,
    Log,
}

/// How many rows have a value in each of some bins of equal width, or of equal ratio.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Histogram {
    pub of: Expression,
    pub bins: usize,
    pub spacing: Spacing,
    /// `None` takes the smallest and largest value there is.
    pub range: Option<(f64, f64)>,
}

/// Lists of `[reduce]` have at most this many entries, ...
pub const MOST_ENTRIES: usize = 50;
/// ... rankings this many places ...
pub const MOST_BEST: u64 = 10_000;
/// ... and histograms this many bins.
pub const MOST_BINS: u64 = 10_000;
/// Where the config does not say.
pub const DEFAULT_BEST: u64 = 10;
pub const DEFAULT_BINS: u64 = 20;

/// The condition of `[select]`.
pub fn read_select(table: &Section) -> Result<Expression, Error> {
    table.allow(&["keep"])?;
    let item = table.need("keep")?;
    let text = item.string().map_err(|_| item.wrong_type("a condition like \"force < 2 kN\""))?;
    Expression::condition(text).map_err(|problem| item.error(problem))
}

impl Reduce {
    pub fn read(table: &Section) -> Result<Reduce, Error> {
        table.allow(&["statistics", "quantiles", "best", "pareto", "histogram"])?;
        let mut reduce = Reduce::default();
        if let Some(item) = table.find("statistics") {
            reduce.statistics = several(&item, quantity)?;
        }
        if let Some(item) = table.find("quantiles") {
            if reduce.statistics.is_empty() {
                return Err(item.error("quantiles are of the columns in `statistics`, which is missing"));
            }
            reduce.quantiles = several(&item, fraction)?;
        }
        if let Some(item) = table.find("best") {
            reduce.best = several(&item, |item| Best::read(&item.section()?))?;
        }
        if let Some(item) = table.find("pareto") {
            reduce.pareto = read_pareto(&item.section()?)?;
        }
        if let Some(item) = table.find("histogram") {
            reduce.histograms = several(&item, |item| Histogram::read(&item.section()?))?;
        }
        if reduce == Reduce::default() {
            let problem = "asks for nothing: give `statistics`, `best`, `pareto` or `histogram`";
            return Err(table.error(problem.to_string()));
        }
        Ok(reduce)
    }
}

/// One entry, or a list of them.
fn several<T>(item: &Item, read: impl Fn(&Item) -> Result<T, Error>) -> Result<Vec<T>, Error> {
    let Some(items) = item.array()? else { return Ok(vec![read(item)?]) };
    if items.len() > MOST_ENTRIES {
        return Err(item.error(format!("{} entries; at most {MOST_ENTRIES} are allowed", items.len())));
    }
    items.iter().map(read).collect()
}

fn quantity(item: &Item) -> Result<Expression, Error> {
    let text = item.string().map_err(|_| item.wrong_type("a column like \"peak_pressure\""))?;
    Expression::quantity(text).map_err(|problem| item.error(problem))
}

fn fraction(item: &Item) -> Result<f64, Error> {
    match item.number()? {
        Some(number) if (0.0..=1.0).contains(&number) => Ok(number),
        Some(_) => Err(item.refuse("must be from 0 (the smallest value) to 1 (the largest)")),
        None => Err(item.wrong_type("a number from 0 to 1")),
    }
}

impl Best {
    fn read(table: &Section) -> Result<Best, Error> {
        table.allow(&["count", "by", "order"])?;
        let count = table.find("count").map_or(Ok(DEFAULT_BEST), |item| item.whole(1, MOST_BEST))? as usize;
        let order = table.find("order").map_or(Ok(0), |item| item.word(&Order::ALL.map(Order::name)))?;
        Ok(Best { count, by: quantity(&table.need("by")?)?, order: Order::ALL[order] })
    }
}

fn read_pareto(table: &Section) -> Result<Vec<Objective>, Error> {
    table.allow(&Order::ALL.map(Order::name))?;
    let mut objectives = Vec::new();
    for order in Order::ALL {
        if let Some(item) = table.find(order.name()) {
            let of = several(&item, quantity)?;
            objectives.extend(of.into_iter().map(|of| Objective { of, order }));
        }
    }
    match objectives.len() {
        2 | 3 => Ok(objectives),
        count => {
            let problem =
                format!("a front is of two or three columns in `largest` and `smallest`, not of {count}");
            Err(table.error(problem))
        }
    }
}

impl Histogram {
    /// Where bin `place` begins, and the one before it ends, of bins from one value to another.
    pub fn edge(&self, place: usize, from: f64, to: f64) -> f64 {
        let share = place as f64 / self.bins as f64;
        match (place, self.spacing) {
            (0, _) => from,
            (place, _) if place == self.bins => to,
            (_, Spacing::Linear) => from * (1.0 - share) + to * share,
            (_, Spacing::Log) => (from.ln() * (1.0 - share) + to.ln() * share).exp().max(from).min(to),
        }
    }

    /// All of these where the config says what they go from and to.
    pub fn edges(&self) -> Option<Vec<f64>> {
        let (from, to) = self.range?;
        Some((0..=self.bins).map(|place| self.edge(place, from, to)).collect())
    }

    fn read(table: &Section) -> Result<Histogram, Error> {
        table.allow(&["of", "bins", "spacing", "from", "to"])?;
        let bins = table.find("bins").map_or(Ok(DEFAULT_BINS), |item| item.whole(1, MOST_BINS))? as usize;
        let spacing = match table.find("spacing").map_or(Ok(0), |item| item.word(&["linear", "log"]))? {
            0 => Spacing::Linear,
            _ => Spacing::Log,
        };
        let of = quantity(&table.need("of")?)?;
        let range = match (table.find("from"), table.find("to")) {
            (None, None) => None,
            (None, Some(item)) => return Err(item.error("`from` is missing beside it")),
            (Some(item), None) => return Err(item.error("`to` is missing beside it")),
            (Some(from_item), Some(to_item)) => {
                let (from, to) = (limit(&from_item, &of)?, limit(&to_item, &of)?);
                if from >= to {
                    let problem = format!("must be above `from`, which is {}", from_item.written());
                    return Err(to_item.refuse(&problem));
                }
                if spacing == Spacing::Log && from <= 0.0 {
                    return Err(from_item.refuse("must be above 0 for spacing = \"log\""));
                }
                Some((from, to))
            }
        };
        Ok(Histogram { of, bins, spacing, range })
    }
}

/// An end of a range of `of`, with its unit.
fn limit(item: &Item, of: &Expression) -> Result<f64, Error> {
    let text = match item.number()? {
        Some(_) => item.written(),
        None => item.string().map_err(|_| item.wrong_type("a number with its unit"))?.to_string(),
    };
    Expression::value(&text, of.unit()).map_err(|problem| item.error(problem))
}
