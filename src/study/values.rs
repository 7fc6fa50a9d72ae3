//! What a swept quantity may be: one value, a list, or a range from one value to another.

use crate::error::Error;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::study::design::Limits;
use crate::study::source::{Item, Section};
use crate::study::units::{self, Dimension};

/// Which of a parameter's values a design takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pick {
    /// Position in a list or counted range.
    Index(u64),
    /// Position along a range, or share of a list, in [0, 1).
    Fraction(f64),
}

impl Pick {
    /// The position in a list of `count` options; equal shares for fractions.
    pub fn of(self, count: usize) -> usize {
        let position = match self {
            Pick::Index(index) => usize::try_from(index).unwrap_or(usize::MAX),
            Pick::Fraction(fraction) => (fraction * count as f64) as usize,
        };
        position.min(count.saturating_sub(1))
    }
}

/// Those of several designs, of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Picks<const N: usize> {
    Index([u64; N]),
    Fraction([f64; N]),
}

impl<const N: usize> Picks<N> {
    pub fn of(&self, place: usize) -> Pick {
        match self {
            Picks::Index(indices) => Pick::Index(indices[place]),
            Picks::Fraction(fractions) => Pick::Fraction(fractions[place]),
        }
    }
}

/// Whether ranges must or must not say how many values they stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counts {
    Required,
    /// With the name of the sampler, whose own count rules.
    Refused(&'static str),
}

/// The values of one quantity, in mm, N, MPa or as a ratio.
#[derive(Clone, Debug)]
pub enum Values {
    List(Vec<f64>),
    Range(Range),
}

/// From one value to a larger one, both included, evenly in the value or in its logarithm.
#[derive(Clone, Debug)]
pub struct Range {
    from: f64,
    to: f64,
    /// `None` when a sampler decides.
    count: Option<u64>,
    /// For logarithmic spacing: (to/from)^(1/2), (to/from)^(1/4) ...
    roots: Option<Box<[f64; ROOTS]>>,
}

/// The bits of a fraction.
pub const ROOTS: usize = 53;

/// Counted ranges have at most this many values; more is taken for a slip of the pen.
pub const MAX_RANGE: u64 = 1_000_000_000;

impl Values {
    /// Reads one value, a list or a range, all within `limits`. `dimension` is `None` for plain numbers.
    pub fn read(
        item: &Item,
        dimension: Option<Dimension>,
        limits: Limits,
        counts: Counts,
    ) -> Result<Values, Error> {
        if let Some(elements) = item.array()? {
            let values = elements.iter().map(|element| scalar(element, dimension, limits));
            return Ok(Values::List(values.collect::<Result<_, _>>()?));
        }
        if item.is_table() {
            return Ok(Values::Range(Range::read(&item.section()?, dimension, limits, counts)?));
        }
        Ok(Values::List(vec![scalar(item, dimension, limits)?]))
    }

    /// From one value to a larger one; where values must be counted, both ends and the mean.
    pub fn between(from: f64, to: f64, counts: Counts) -> Values {
        match counts {
            Counts::Required => Values::List(vec![from, units::tidy(0.5 * (from + to)), to]),
            Counts::Refused(_) => Values::Range(Range::new(from, to, None, false)),
        }
    }

    /// How many values there are; `None` for a range without a count.
    pub fn count(&self) -> Option<u64> {
        match self {
            Values::List(values) => Some(values.len() as u64),
            Values::Range(range) => range.count,
        }
    }

    pub fn at(&self, pick: Pick) -> f64 {
        let picks = match pick {
            Pick::Index(index) => Picks::Index([index]),
            Pick::Fraction(fraction) => Picks::Fraction([fraction]),
        };
        self.at_each(&picks)[0]
    }

    pub fn at_each<const N: usize>(&self, picks: &Picks<N>) -> [f64; N] {
        match self {
            Values::List(values) => std::array::from_fn(|place| values[picks.of(place).of(values.len())]),
            Values::Range(range) => range.at_each(picks),
        }
    }

    pub fn smallest(&self) -> f64 {
        match self {
            Values::List(values) => values.iter().copied().fold(f64::INFINITY, f64::min),
            Values::Range(range) => range.from,
        }
    }

    pub fn largest(&self) -> f64 {
        match self {
            Values::List(values) => values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            Values::Range(range) => range.to,
        }
    }

    /// From diameters to radii. Halves are exact in binary arithmetic.
    pub fn halved(self) -> Values {
        match self {
            Values::List(values) => Values::List(values.iter().map(|value| 0.5 * value).collect()),
            Values::Range(range) => {
                Values::Range(Range { from: 0.5 * range.from, to: 0.5 * range.to, ..range })
            }
        }
    }
}

impl Range {
    fn read(
        table: &Section,
        dimension: Option<Dimension>,
        limits: Limits,
        counts: Counts,
    ) -> Result<Range, Error> {
        table.allow(&["from", "to", "count", "spacing"])?;
        let from_item = table.need("from")?;
        let to_item = table.need("to")?;
        let from = scalar(&from_item, dimension, limits)?;
        let to = scalar(&to_item, dimension, limits)?;
        if from >= to {
            let problem = format!("must be above `from`, which is {}", from_item.written());
            return Err(to_item.refuse(&problem));
        }
        let logarithmic = match table.find("spacing") {
            None => false,
            Some(item) => item.word(&["linear", "log"])? == 1,
        };
        if logarithmic && from <= 0.0 {
            return Err(from_item.refuse("must be above 0 for spacing = \"log\""));
        }
        let count = match (counts, table.find("count")) {
            (Counts::Required, Some(item)) => Some(item.whole(2, MAX_RANGE)?),
            (Counts::Required, None) => {
                return Err(table.error("this range needs a `count` of values".to_string()));
            }
            (Counts::Refused(_), None) => None,
            (Counts::Refused(sampler), Some(item)) => {
                let problem = format!("a range of the {sampler} sampler has no count; it is in [sampling]");
                return Err(item.refuse(&problem));
            }
        };
        Ok(Range::new(from, to, count, logarithmic))
    }

    fn new(from: f64, to: f64, count: Option<u64>, logarithmic: bool) -> Range {
        let roots = logarithmic.then(|| {
            // Roots first: the quotient of the ends themselves may be too large for a number.
            let mut root = to.sqrt() / from.sqrt();
            Box::new(std::array::from_fn(|_| {
                let current = root;
                root = root.sqrt();
                current
            }))
        });
        Range { from, to, count, roots }
    }

    /// The count, both ends, and for logarithmic spacing the roots of their quotient, one for each bit of a fraction, the highest first.
    pub(super) fn ends_and_roots(&self) -> (Option<u64>, [f64; 2], &[f64]) {
        (self.count, [self.from, self.to], self.roots.as_ref().map_or(&[], |roots| &roots[..]))
    }

    /// Its first values, so many.
    pub(super) fn counted(&self, count: u64) -> impl Iterator<Item = f64> {
        (0..count).map(|index| self.at_each(&Picks::Index([index]))[0])
    }

    fn at_each<const N: usize>(&self, picks: &Picks<N>) -> [f64; N] {
        let mut values =
            match picks {
                Picks::Fraction(fractions) => in_lanes(Along { range: self, fractions }),
                Picks::Index(indices) => {
                    let last = self.count.unwrap_or(1).saturating_sub(1);
                    let along = in_lanes(Along {
                        range: self,
                        fractions: &indices.map(|index| index as f64 / last as f64),
                    });
                    std::array::from_fn(|place| {
                        if indices[place] >= last { self.to } else { units::tidy(along[place]) }
                    })
                }
            };
        // Rounding must not lead out of what has been checked.
        for value in &mut values {
            *value = value.clamp(self.from, self.to);
        }
        values
    }
}

/// The values at fractions of the way. Only operations that every machine rounds alike (no logarithm, no
/// power), so that a study has the same designs everywhere, to the last bit.
struct Along<'a, const N: usize> {
    range: &'a Range,
    fractions: &'a [f64; N],
}

impl<const N: usize> LaneWork for Along<'_, N> {
    type Output = [f64; N];

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> [f64; N] {
        let Along { range: Range { from, to, roots, .. }, fractions } = self;
        let mut values = [*from; N];
        let Some(roots) = roots else {
            for (value, fraction) in values.iter_mut().zip(fractions) {
                *value = from * (1.0 - fraction) + to * fraction;
            }
            return values;
        };
        // By the bits of the fraction that are set, the highest first. A fraction that was rounded up to 1 is the one before.
        const WHOLE: u64 = 1 << ROOTS;
        let mut bits = [0; N];
        for (bits, fraction) in bits.iter_mut().zip(fractions) {
            *bits = ((fraction * WHOLE as f64) as u64).min(WHOLE - 1);
        }
        for (place, root) in roots.iter().enumerate() {
            let bit = WHOLE >> (place + 1);
            for lane in 0..N {
                let longer = values[lane] * root;
                values[lane] = if bits[lane] & bit != 0 { longer } else { values[lane] };
            }
        }
        values
    }
}

/// One number with or without a unit, within `limits`.
fn scalar(item: &Item, dimension: Option<Dimension>, limits: Limits) -> Result<f64, Error> {
    let value = match (dimension, item.number()?) {
        (None, Some(number)) => number,
        (None, None) => return Err(item.wrong_type("a plain number")),
        (Some(dimension), Some(_)) => {
            let example = format!("\"{} {}\"", item.written(), dimension.unit());
            return Err(item.refuse(&format!("the unit is missing; write it like {example}")));
        }
        (Some(dimension), None) => {
            let text = item.string().map_err(|_| item.wrong_type("a string with a number and a unit"))?;
            units::parse_quantity(text, dimension).map_err(|problem| item.refuse(&problem))?
        }
    };
    limits.refuse(value).map_err(|problem| item.refuse(&problem))?;
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(range: &Range, pick: Pick) -> f64 {
        Values::Range(range.clone()).at(pick)
    }

    fn counted(range: &Range) -> Vec<f64> {
        (0..range.count.unwrap()).map(|index| at(range, Pick::Index(index))).collect()
    }

    #[test]
    fn counted_ranges_have_the_decimals_a_reader_expects() {
        assert_eq!(
            counted(&Range::new(0.02, 0.2, Some(10), false)),
            [0.02, 0.04, 0.06, 0.08, 0.1, 0.12, 0.14, 0.16, 0.18, 0.2]
        );
        assert_eq!(counted(&Range::new(1e-3, 1e2, Some(6), true)), [1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0]);
    }

    /// Against the power function; 53 products of roundings of 1.1e-16 each stay below 1e-14.
    #[test]
    fn a_log_range_is_even_in_the_logarithm() {
        let range = Range::new(0.3, 700.0, None, true);
        for step in 0..1000 {
            let fraction = step as f64 / 1000.0 + 3e-4;
            let expected = 0.3 * (700.0f64 / 0.3).powf(fraction);
            let value = at(&range, Pick::Fraction(fraction));
            assert!((value / expected - 1.0).abs() < 1e-14, "{fraction}: {value} against {expected}");
        }
        // What was rounded up to the end is there.
        assert!((at(&range, Pick::Fraction(1.0)) / 700.0 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_widest_range_stays_within_its_ends() {
        // The quotient of the ends is no number, the middle is.
        let middle = at(&Range::new(1e-300, 1e300, None, true), Pick::Fraction(0.5));
        assert!((middle - 1.0).abs() < 1e-14, "{middle}");
        let range = Range::new(5e-324, f64::MAX, None, true);
        for fraction in [0.0, 0.1, 0.5, 0.999, 1.0] {
            let value = at(&range, Pick::Fraction(fraction));
            assert!((5e-324..=f64::MAX).contains(&value), "{fraction}: {value}");
        }
    }
}
