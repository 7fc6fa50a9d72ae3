//! What a part of an expression measures: powers of N, mm and deg. MPa is N/mm^2 and mJ is N mm, so no factor is needed.

use crate::study::units::Dimension;

/// Powers of N, mm and deg.
#[derive(Clone, Copy, Debug)]
pub struct Unit([f64; 3]);

/// Powers closer than this are the same: exponents like 1/3 are rounded.
const SAME: f64 = 1e-9;

impl PartialEq for Unit {
    fn eq(&self, other: &Unit) -> bool {
        self.0.iter().zip(other.0).all(|(a, b)| (a - b).abs() < SAME)
    }
}

impl Unit {
    pub const NONE: Unit = Unit([0.0; 3]);

    pub fn of(dimension: Dimension) -> Unit {
        Unit(dimension.powers().map(f64::from))
    }

    /// From the unit of a table's column; "-" and words have none.
    pub fn of_column(unit: &str) -> Unit {
        let dimension = Dimension::ALL.into_iter().find(|dimension| dimension.unit() == unit);
        dimension.map_or(Unit::NONE, Unit::of)
    }

    pub fn is_none(self) -> bool {
        self == Unit::NONE
    }

    pub fn times(self, other: Unit) -> Unit {
        Unit(std::array::from_fn(|place| self.0[place] + other.0[place]))
    }

    pub fn over(self, other: Unit) -> Unit {
        Unit(std::array::from_fn(|place| self.0[place] - other.0[place]))
    }

    pub fn to_the(self, power: f64) -> Unit {
        Unit(self.0.map(|own| own * power))
    }

    /// What it is a product of, and what it is over.
    fn parts(self) -> [Vec<String>; 2] {
        [1.0, -1.0].map(|sign| {
            let powers = self.0.map(|power| power * sign);
            let named = powers.into_iter().zip(["N", "mm", "deg"]).filter(|(power, _)| *power > SAME);
            let written = named.map(|(power, name)| match (power - 1.0).abs() < SAME {
                true => name.to_string(),
                false => format!("{name}^{}", (power * 1e6).round() / 1e6),
            });
            written.collect()
        })
    }

    fn dimension(self) -> Option<Dimension> {
        Dimension::ALL.into_iter().find(|dimension| Unit::of(*dimension) == self)
    }

    /// A value of it as an expression has it: `3 MPa`, `3 N^2 / (1 mm)`.
    pub fn example(self, value: f64) -> String {
        if let Some(dimension) = self.dimension() {
            return format!("{value} {}", dimension.unit());
        }
        let [above, below] = self.parts();
        let mut above = above.into_iter();
        let first = above.next().map_or(value.to_string(), |first| format!("{value} {first}"));
        let others = above.map(|other| format!(" * (1 {other})"));
        others
            .chain(below.into_iter().map(|other| format!(" / (1 {other})")))
            .fold(first, |text, more| text + &more)
    }

    /// As in the heads of tables: "MPa", "N^2/mm"; "-" for none.
    pub fn text(self) -> String {
        if self.is_none() {
            return "-".to_string();
        }
        if let Some(dimension) = self.dimension() {
            return dimension.unit().to_string();
        }
        let [above, below] = self.parts();
        let above = if above.is_empty() { "1".to_string() } else { above.join(" ") };
        match below.as_slice() {
            [] => above,
            [one] => format!("{above}/{one}"),
            more => format!("{above}/({})", more.join(" ")),
        }
    }

    /// In a sentence: "a stress (MPa)", "a number without a unit".
    pub fn said(self) -> String {
        match self.dimension() {
            _ if self.is_none() => "a number without a unit".to_string(),
            Some(dimension) => {
                let name = dimension.name();
                let article = if name.starts_with(['a', 'e']) { "an" } else { "a" };
                format!("{article} {name} ({})", dimension.unit())
            }
            None => format!("a value in {}", self.text()),
        }
    }
}
