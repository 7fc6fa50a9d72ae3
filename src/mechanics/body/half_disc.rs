//! `rigid-midplane`: the lower half disc of the pin, its flat face through the centre rigid.

use super::{Shape, Side};

pub static SHAPE: Shape = Shape { name: "rigid-midplane", side: Side::Pin, parameters: &[], supports: &[] };
