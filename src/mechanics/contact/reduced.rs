//! What the equations of one arc come to, and what follows from it: the formulas of `edge`, over any numbers.

use std::f64::consts::FRAC_PI_2;

use super::outlines::Outlines;
use crate::mechanics::real::{LANES, Real};

macro_rules! reduced {
    ($($(#[$about:meta])* $function:ident,)*) => {
        /// What the equations of one arc come to, without what goes to zero with the arc. b is the pin's.
        #[derive(Clone, Copy, Debug)]
        pub struct Reduced<T> {
            $($(#[$about])* pub $function: T,)*
        }

        /// How many functions of the arc a `Reduced` has.
        pub const FUNCTIONS: usize = [$(stringify!($function)),*].len();

        impl<T: Copy> Reduced<T> {
            #[inline(always)]
            pub fn functions(&self) -> [T; FUNCTIONS] {
                [$(self.$function),*]
            }

            /// The reverse of `functions`.
            #[inline(always)]
            pub fn of_functions(functions: [T; FUNCTIONS]) -> Reduced<T> {
                let [$($function),*] = functions;
                Reduced { $($function),* }
            }
        }
    };
}

reduced! {
    /// S.
    singular,
    /// D.
    edge,
    /// N/b^2.
    edge_of_versine,
    /// N_g/b^2.
    edge_of_gap,
    /// V/b^2.
    versine,
    /// G/b^2.
    gap,
    /// Q/b^4.
    work,
    /// Q_vg/b^4.
    mixed_work,
    /// Q_gg/b^4.
    work_of_gap,
    /// The pressure at the load line times 2 b is W `peak` - b^2 [x `peak_of_versine` + (1 - x) `peak_of_gap`].
    peak,
    peak_of_versine,
    peak_of_gap,
}

/// Those that force and energy follow from, the first of `Reduced::functions`: all but those of the peak pressure.
pub const DECISIVE: usize = 9;

/// Those that indentation and force follow from, the first of these.
pub const OF_LOAD: usize = 8;

/// A state with a free edge, as the fields of `ContactState`.
#[derive(Clone, Copy, Debug)]
pub struct FreeEdge<T> {
    pub indentation: T,
    pub force: T,
    pub tangent_stiffness: T,
    pub energy: T,
    pub peak_pressure: T,
}

impl<T: Real> Reduced<T> {
    /// With those functions that grow like 1/S over a scale, and S times it.
    #[inline(always)]
    pub fn scaled(&self, scale: T) -> Reduced<T> {
        Reduced {
            singular: self.singular * scale,
            edge_of_versine: self.edge_of_versine / scale,
            edge_of_gap: self.edge_of_gap / scale,
            work: self.work / scale,
            mixed_work: self.mixed_work / scale,
            work_of_gap: self.work_of_gap / scale,
            peak_of_versine: self.peak_of_versine / scale,
            peak_of_gap: self.peak_of_gap / scale,
            ..*self
        }
    }

    /// W/b^2 of a state with that x.
    #[inline(always)]
    pub(super) fn first(&self, indentation: T) -> T {
        self.between(indentation, self.edge_of_versine, self.edge_of_gap) / self.edge
    }

    /// x a + (1 - x) b.
    #[inline(always)]
    pub(super) fn between(&self, indentation: T, of_versine: T, of_gap: T) -> T {
        of_gap + indentation * (of_versine - of_gap)
    }

    /// Strain energy over e^2 b^4.
    #[inline(always)]
    pub(super) fn energy(&self, indentation: T) -> T {
        let first = self.first(indentation);
        let of_versine = self.between(indentation, self.work, self.mixed_work);
        let of_gap = self.between(indentation, self.mixed_work, self.work_of_gap);
        self.singular * first * first + self.between(indentation, of_versine, of_gap)
    }

    /// delta/e and F/e of the state with a free edge.
    #[inline(always)]
    pub fn load(&self, b: T) -> (T, T) {
        let (two, b2) = (T::from_f64(2.0), b * b);
        let arm = T::from_f64(FRAC_PI_2) - b2 * self.versine;
        let flexible = self.singular / self.edge;
        let closed = b2 * (self.gap + flexible * self.edge_of_gap);
        let indentation = closed / (arm + closed - b2 * flexible * self.edge_of_versine);
        let work = b2 * b2 * self.between(indentation, self.work, self.mixed_work);
        // 2 makes the whole joint of both halves.
        (indentation, two * (b2 * self.first(indentation) * arm + work))
    }

    #[inline(always)]
    pub fn free_edge(&self, b: T, outlines: &Outlines) -> FreeEdge<T> {
        let (two, b2) = (T::from_f64(2.0), b * b);
        let (indentation, force) = self.load(b);
        let arm = T::from_f64(FRAC_PI_2) - b2 * self.versine;
        let first = b2 * self.first(indentation);
        let peak = self.between(indentation, self.peak_of_versine, self.peak_of_gap);
        FreeEdge {
            indentation,
            force,
            tangent_stiffness: two * (arm * arm / self.singular + b2 * b2 * self.work),
            energy: b2 * b2 * self.energy(indentation),
            // Over the hole's b.
            peak_pressure: (first * self.peak - b2 * peak) * T::from_f64(0.5 * outlines.ratio()) / b,
        }
    }
}

/// Those of `Reduced` at as many arcs, or degrees, as there are lanes.
pub(super) type Functions = [[f64; LANES]; FUNCTIONS];
