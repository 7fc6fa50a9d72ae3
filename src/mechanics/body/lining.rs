//! Bonded layers of a body: what lies behind the material at the ring.

use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// The most layers of a body.
pub const MOST_LAYERS: usize = 8;

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

/// Equal to the bit.
impl PartialEq for Interface {
    fn eq(&self, other: &Interface) -> bool {
        self.bits() == other.bits()
    }
}

impl Eq for Interface {}

impl Hash for Interface {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.bits().hash(state);
    }
}

/// What lies one behind the other from the ring into a body; copies share it, and what is bare has none.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Stack<T>(Option<Arc<[T]>>);

impl<T> Stack<T> {
    pub const NONE: Stack<T> = Stack(None);

    /// In the order in which a ray from the ring meets them.
    pub fn new(all: Vec<T>) -> Stack<T> {
        Stack((!all.is_empty()).then(|| all.into()))
    }

    pub fn list(&self) -> &[T] {
        self.0.as_deref().unwrap_or_default()
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_none()
    }
}

/// As `new`.
impl<T> FromIterator<T> for Stack<T> {
    fn from_iter<I: IntoIterator<Item = T>>(all: I) -> Stack<T> {
        let mut all = all.into_iter().peekable();
        Stack(all.peek().is_some().then(|| all.collect()))
    }
}

impl<T> Default for Stack<T> {
    fn default() -> Stack<T> {
        Stack::NONE
    }
}

/// The interfaces of a body.
pub type Lining = Stack<Interface>;

impl Lining {
    /// Young's modulus over that at the ring and Poisson's ratio of a material: 0 at the ring, with that Poisson's ratio, 1 beyond the
    /// first interface, and so on.
    pub fn material(&self, number: usize, at_ring: f64) -> [f64; 2] {
        let beyond = number.checked_sub(1).map(|place| self.list()[place]);
        beyond.map_or([1.0, at_ring], |own| [own.modulus_ratio, own.poissons_ratio])
    }
}
