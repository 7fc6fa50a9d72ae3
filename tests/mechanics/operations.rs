//! The counts of floating-point operations that speeds are judged by, against a number that counts what is done to it.

use std::cell::Cell;
use std::f64::consts::PI;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use jointsweep::internals::mechanics::body::{Body, block};
use jointsweep::internals::mechanics::element::stiffness::{
    Elasticity, ElementRule, element_stiffness, stiffness_operations,
};
use jointsweep::internals::mechanics::element::{ElementKind, MAX_NODES};
use jointsweep::internals::mechanics::grading::GradingClass;
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::mechanics::mesh::RingTopology;
use jointsweep::internals::mechanics::real::Real;
use jointsweep::internals::mechanics::solve::band::{BandStructure, TILE};

thread_local! {
    static DONE: Cell<u64> = const { Cell::new(0) };
}

/// A number that counts its operations; changes of sign and comparisons are free.
#[derive(Clone, Copy)]
struct Counted(f64);

fn count(operations: u64, value: f64) -> Counted {
    DONE.set(DONE.get() + operations);
    Counted(value)
}

macro_rules! counted {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Counted {
            type Output = Counted;
            fn $method(self, other: Counted) -> Counted {
                count(1, self.0 $op other.0)
            }
        }
    };
}
counted!(Add, add, +);
counted!(Sub, sub, -);
counted!(Mul, mul, *);
counted!(Div, div, /);

impl Neg for Counted {
    type Output = Counted;
    fn neg(self) -> Counted {
        Counted(-self.0)
    }
}

impl AddAssign for Counted {
    fn add_assign(&mut self, other: Counted) {
        *self = *self + other;
    }
}

impl SubAssign for Counted {
    fn sub_assign(&mut self, other: Counted) {
        *self = *self - other;
    }
}

impl Real for Counted {
    fn from_f64(value: f64) -> Counted {
        Counted(value)
    }
    fn sqrt(self) -> Counted {
        count(1, self.0.sqrt())
    }
    fn exp(self) -> Counted {
        count(1, self.0.exp())
    }
    fn least(self, other: Counted) -> Counted {
        Counted(self.0.least(other.0))
    }
    fn is_positive(self) -> bool {
        self.0 > 0.0
    }
    fn minus_product(self, a: Counted, b: Counted) -> Counted {
        count(2, self.0 - a.0 * b.0)
    }
}

/// Operations done by `work`.
fn operations(work: impl FnOnce()) -> u64 {
    DONE.set(0);
    work();
    DONE.get()
}

/// A block, whose band is uneven: one of its sides is held, the others free.
fn structure(level: usize) -> BandStructure {
    let body = Body {
        shape: &block::SHAPE,
        parameters: [3.0, 4.0, 2.5],
        support: 0,
        poissons_ratio: 0.3,
        idealization: Idealization::PlaneStress,
        lining: Default::default(),
        all_around: false,
    };
    let class = GradingClass::of(&body, ElementKind::Quad8, level);
    BandStructure::new(&RingTopology::new(&body, &class.grading(PI)))
}

#[test]
fn the_factorisation_does_what_is_counted() {
    for level in 0..3 {
        let structure = structure(level);
        let tiles = structure.empty::<Counted>();
        let done = operations(|| structure.factorise::<_, 1, 1>(&mut tiles.clone()));
        assert_eq!(structure.factorise_operations(), done, "level {level}");
        let two_rows = operations(|| structure.factorise::<_, 4, 2>(&mut tiles.clone()));
        assert_eq!(two_rows, done, "level {level}, two rows at a time");
    }
}

#[test]
fn the_substitution_does_what_is_counted() {
    let structure = structure(1);
    let tiles = structure.empty::<Counted>();
    let ring = (structure.size - structure.ring_start) / TILE;
    for start in [0, ring / 2, ring - 1] {
        let mut values = vec![[[Counted(1.0); 12]; TILE]; ring - start];
        let done = operations(|| structure.substitute_ring::<_, 12, 4>(&tiles, start, &mut values));
        assert_eq!(structure.substitute_operations(ring - start, 12), done, "from tile row {start}");
    }
}

#[test]
fn the_element_stiffness_does_what_is_counted() {
    let square = [
        [-1.0, -1.0],
        [1.0, -1.0],
        [1.0, 1.0],
        [-1.0, 1.0],
        [0.0, -1.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [-1.0, 0.0],
    ];
    let nodes: [[Counted; 2]; MAX_NODES] = square.map(|point| point.map(Counted));
    let elasticity = Elasticity::new(Idealization::PlaneStress, Counted(0.3));
    for kind in [ElementKind::Quad4, ElementKind::Quad8] {
        let rule = ElementRule::new(kind);
        let done = operations(|| _ = element_stiffness(&rule, &elasticity, &nodes));
        assert_eq!(stiffness_operations(kind), done, "{kind:?}");
    }
}
