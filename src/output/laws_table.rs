//! `laws.csv`: a row for each design and law.

use crate::engine::outcome::{DesignLaws, DesignOutcome};
use crate::mechanics::laws::calibrated::FittedLaw;
use crate::output::folder::LAWS;
use crate::output::number::push_rounded;
use crate::output::schema::law_columns;
use crate::output::sink::Sink;
use crate::output::table::push_text;

/// Writes the laws of outcomes as rows.
#[derive(Default)]
pub struct LawsTable;

/// Constants that have columns; a list of points has none.
pub const CONSTANTS: usize = 4;

impl Sink for LawsTable {
    fn file_name(&self) -> &'static str {
        LAWS
    }

    fn header(&self) -> Vec<u8> {
        let names: Vec<&str> = law_columns().iter().map(|(name, ..)| *name).collect();
        format!("{}\n", names.join(",")).into()
    }

    fn rows(&self, outcomes: &[DesignOutcome]) -> Vec<u8> {
        let mut out = Vec::new();
        outcomes.iter().for_each(|outcome| push_laws(&mut out, outcome));
        out
    }
}

/// The rows of a design.
fn push_laws(out: &mut Vec<u8>, outcome: &DesignOutcome) {
    let design = outcome.case.index.to_string();
    let Some(laws) = &outcome.laws else { return };
    if let Some(why) = laws.missing {
        let empty = ",".repeat(law_columns().len() - 2);
        out.extend_from_slice(format!("{design},none{empty}no: {why}\n").as_bytes());
    }
    for (place, law) in laws.laws.iter().enumerate() {
        out.extend_from_slice(design.as_bytes());
        push_law(out, law, laws, place);
    }
}

/// The cells after the design's number.
fn push_law(out: &mut Vec<u8>, law: &FittedLaw, laws: &DesignLaws, place: usize) {
    out.push(b',');
    out.extend_from_slice(law.law.name.as_bytes());
    let constants = (0..CONSTANTS).map(|k| law.constants.get(k).filter(|_| !law.law.constants.is_empty()));
    let numbers = constants.map(Option::<&f64>::copied).chain(
        [
            law.sizes.stiffness,
            law.sizes.radial_clearance,
            law.range.0,
            law.range.1,
            law.force_misfit[0],
            law.force_misfit[1],
            law.stiffness_misfit[0],
            law.stiffness_misfit[1],
        ]
        .map(Some),
    );
    for value in numbers.chain([laws.small_load_constant, laws.stiffness_of_large_loads]) {
        out.push(b',');
        if let Some(value) = value.filter(|value| value.is_finite()) {
            push_rounded(out, value);
        }
    }
    let recommended = match laws.recommended {
        Some((best, why)) if best == place => format!("yes: {why}"),
        _ => "no".into(),
    };
    for text in [&law.formula(), law.law.outside, "support", &recommended] {
        out.push(b',');
        push_text(out, text);
    }
    out.push(b'\n');
}
