//! Bonded layers of a part, as they are made: bushes, liners, coatings, sleeves.

use serde::{Deserialize, Serialize};

use crate::mechanics::body::Side;
pub use crate::mechanics::body::lining::MOST_LAYERS;
use crate::mechanics::body::lining::Stack;
use crate::mechanics::material::Material;

/// One layer: its thickness, mm, and its material, MPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    pub thickness: f64,
    pub material: Material,
    /// MPa, where it is known.
    pub yield_stress: Option<f64>,
    /// Whether this is the wall of a `tube` that has an inner part; the layers beyond it are those of the inner part.
    pub is_tube: bool,
}

impl Layer {
    /// Without a yield stress. mm.
    pub fn new(thickness: f64, material: Material) -> Layer {
        Layer { thickness, material, yield_stress: None, is_tube: false }
    }
}

/// The layers of a part from the contact into it, perfectly bonded; what is left of the part is of the part's own material.
pub type Layers = Stack<Layer>;

/// How many layers pin and plate have at most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LayerCounts {
    pub pin: usize,
    pub plate: usize,
}

impl LayerCounts {
    pub const NONE: LayerCounts = LayerCounts { pin: 0, plate: 0 };
    pub const ONE: LayerCounts = LayerCounts { pin: 1, plate: 1 };
    /// All that there can be.
    pub const MOST: LayerCounts = LayerCounts { pin: MOST_LAYERS, plate: MOST_LAYERS };

    pub fn of(self, side: Side) -> usize {
        match side {
            Side::Pin => self.pin,
            Side::Plate => self.plate,
        }
    }

    /// Those of two together.
    pub fn and(self, other: LayerCounts) -> LayerCounts {
        LayerCounts { pin: self.pin.max(other.pin), plate: self.plate.max(other.plate) }
    }
}
