//! Closed forms: typed, cited, each with its range of validity.
//!
//! A law that gives force for indentation is one file with one static `Law`, listed in `LAWS`; it builds a `Curve` for
//! a `Pair`, and the curve gives force, indentation and tangent stiffness. Hertz and Persson relate force, contact
//! width and pressure but know no indentation, so they have functions of their own. Outside its range every law
//! returns a `LawError`.
//!
//! A warning that holds for all of them: in two dimensions the indentation depends on the plate's extent and support,
//! which none of these laws contains.

pub mod law_error;
pub mod pair;
pub mod lambert;
mod logarithmic;
mod power;
mod wedge;
pub mod law_curve;

pub mod hertz;
pub mod hertz_liu;
pub mod johnson;
pub mod radzimovsky;
pub mod esdu;
pub mod dubowsky_freudenstein;
pub mod lankarani_nikravesh;
pub mod damping;
pub mod pereira;
pub mod winkler;
pub mod persson;
pub mod calibrated;

pub use damping::Damping;
pub use hertz::HertzContact;
pub use law_curve::Curve;
pub use law_error::LawError;
pub use pair::Pair;
pub use persson::PerssonContact;

/// In which units a law holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// Any consistent set: the law is dimensionally homogeneous.
    Consistent,
    /// mm, MPa and N/mm only: the law's coefficients carry dimensions.
    MillimetreMegapascal,
}

/// A published law between force and indentation.
#[derive(Debug)]
pub struct Law {
    /// The name in configs, tables and on the command line.
    pub name: &'static str,
    pub citation: &'static str,
    /// Where the law may be used, in words.
    pub range: &'static str,
    pub units: Units,
    build: fn(&Pair) -> Result<Curve, LawError>,
}

/// Every law that gives a force for an indentation.
pub static LAWS: [&Law; 8] = [
    &hertz_liu::LAW,
    &johnson::LAW,
    &radzimovsky::LAW,
    &esdu::LAW,
    &dubowsky_freudenstein::LAW,
    &lankarani_nikravesh::LAW,
    &pereira::LAW,
    &winkler::LAW,
];

impl Law {
    /// The law with the given name, if there is one.
    pub fn named(name: &str) -> Option<&'static Law> {
        LAWS.into_iter().find(|law| law.name == name)
    }

    /// The law for one pair of bodies; an error where the law has no curve for them.
    pub fn curve(&self, pair: &Pair) -> Result<Curve, LawError> {
        (self.build)(pair)
    }
}
