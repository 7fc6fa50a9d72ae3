//! Bonded layers of a body: what lies behind the material at the ring.

use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// A bonded interface and the material beyond it, seen from the ring.
#[derive(Clone, Copy, Debug)]
pub struct Interface {
    /// Radius of the interface over that of the ring: above 1 in a plate, below 1 in a pin.
    pub radius_ratio: f64,
    /// Young's modulus beyond it, over that at the ring.
    pub modulus_ratio: f64,
    pub poissons_ratio: f64,
}

impl Interface {
    fn bits(&self) -> [u64; 3] {
        [self.radius_ratio, self.modulus_ratio, self.poissons_ratio].map(f64::to_bits)
    }
}

/// Interfaces of a body from the ring into it; none of a bare body.
#[derive(Clone, Debug, Default)]
pub struct Lining(Option<Arc<[Interface]>>);

impl Lining {
    pub const BARE: Lining = Lining(None);

    /// In the order in which a ray from the ring meets them.
    pub fn new(interfaces: Vec<Interface>) -> Lining {
        Lining((!interfaces.is_empty()).then(|| interfaces.into()))
    }

    pub fn interfaces(&self) -> &[Interface] {
        self.0.as_deref().unwrap_or_default()
    }

    pub fn is_bare(&self) -> bool {
        self.0.is_none()
    }
}

/// Equal to the bit.
impl PartialEq for Lining {
    fn eq(&self, other: &Lining) -> bool {
        self.interfaces().iter().map(Interface::bits).eq(other.interfaces().iter().map(Interface::bits))
    }
}

impl Eq for Lining {}

impl Hash for Lining {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.interfaces().iter().for_each(|interface| interface.bits().hash(state));
    }
}
