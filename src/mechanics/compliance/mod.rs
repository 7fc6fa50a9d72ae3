//! What contact needs to know of a body: how its ring yields.

pub mod condense;
pub mod arc;
pub mod lane_work;
pub mod arc_lanes;
pub mod infinite_body;
pub mod sine_arcs;
pub mod thin_wall;
pub mod ring_modes;
pub mod second_order;
pub mod layered_ring;
pub mod concentric_body;
pub mod series;
pub mod circle_stresses;
pub mod trial_moments;
pub mod work_sums;
pub mod pressure_space;
pub mod lane_condensation;
pub mod near_field;
pub mod lined_reference;
pub mod mesh_stresses;
pub mod row_sums;
pub mod body_fit;

use concentric_body::ConcentricBody;
use ring_modes::RingModes;
use second_order::Bands;
use series::NEGLIGIBLE_SECOND;

use crate::mechanics::body::{Body, Side};

/// Compliance of a ring: displacement of each of the ring's unknowns (the last ones of its `RingTopology`, in order)
/// per unit force on each, for Young's modulus 1, thickness 1 and ring radius 1. Symmetric, row-major.
#[derive(Clone, Debug)]
pub struct RingCompliance {
    pub size: usize,
    pub values: Vec<f64>,
}

/// How the ring of a body yields under normal pressure, for Young's modulus 1 and ring radius 1: as that of an infinite body,
/// whose normal displacement under cos(n phi) is `even` n/(n^2 - 1) + `odd`/(n^2 - 1), and that along the ring, of a disc,
/// `even`/(n^2 - 1) + `odd` n/(n^2 - 1) times sin(n phi); plus `bed` at each place; plus what its boundary changes.
///
/// A pin is not pressed along its own normal but along the hole's (`contact::outlines`). What that changes of its compliance
/// is told per unit of tilt, and to second order per unit of the clearance ratio squared.
#[derive(Clone, Debug)]
pub struct BodyCompliance {
    /// c = 2/E'.
    pub even: f64,
    /// c (kappa - 1)/(kappa + 1), positive for a hole and negative for a disc.
    pub odd: f64,
    /// What is so thin that each place of it yields by itself, a Winkler bed: displacement per unit pressure. A thin wall is nothing
    /// else, thin soft layers lie on what is infinite.
    pub bed: f64,
    pub boundary: Boundary,
    /// Of a concentric pin that is no bed: what its boundary adds to second order (`second_order`).
    pub second: Vec<Bands>,
}

/// What its boundary changes of a body's compliance.
#[derive(Clone, Debug)]
pub enum Boundary {
    /// Nothing: of a wall that is a bed.
    Nothing,
    /// Of a concentric body: the displacement under cos(n phi), n = 0, 1, ...; half of it for n = 0. Of a pin also the amplitude
    /// of what is along the ring, sin(n phi).
    Modes { normal: Vec<f64>, along: Vec<f64> },
    /// The works of pressures in ring modes, packed; of a pin after them what unit tilt adds to them.
    RingModes(RingModes, Vec<f64>),
    /// Of a lined body on a mesh: as `Modes` those of a concentric body with the same layers, and as `RingModes` what it differs from that.
    BesideModes { normal: Vec<f64>, along: Vec<f64>, modes: RingModes, works: Vec<f64> },
}

impl Boundary {
    /// Normal and along the ring, of what concentric circles change.
    pub fn modes(&self) -> Option<[&[f64]; 2]> {
        match self {
            Boundary::Modes { normal, along } | Boundary::BesideModes { normal, along, .. } => {
                Some([normal, along])
            }
            Boundary::Nothing | Boundary::RingModes(..) => None,
        }
    }

    /// With the works in them.
    pub fn ring_modes(&self) -> Option<(&RingModes, &[f64])> {
        match self {
            Boundary::RingModes(modes, works) | Boundary::BesideModes { modes, works, .. } => {
                Some((modes, works))
            }
            Boundary::Nothing | Boundary::Modes { .. } => None,
        }
    }

    /// How many numbers it has.
    fn count(&self) -> usize {
        let modes: usize = self.modes().into_iter().flatten().map(<[f64]>::len).sum();
        modes + self.ring_modes().map_or(0, |(_, works)| works.len())
    }
}

impl BodyCompliance {
    /// Of a body with that boundary. Of pins that are not concentric only what is infinite is known to second order.
    pub fn new(body: &Body, boundary: Boundary) -> BodyCompliance {
        let [even, odd] = infinite(body);
        let second = concentric_pin(body).map_or_else(Vec::new, |body| body.second_order(NEGLIGIBLE_SECOND));
        BodyCompliance { even, odd, bed: 0.0, boundary, second }
    }

    /// How many modes of concentric bodies it is told by.
    pub fn mode_count(&self) -> usize {
        self.boundary.modes().map_or(0, |[normal, _]| normal.len()).max(self.second.len())
    }

    /// What it takes, in bytes, with what keeps it.
    pub fn bytes(&self) -> usize {
        const KEEPING: usize = 160;
        let numbers = self.boundary.count() + self.second.as_flattened().len();
        KEEPING + size_of::<BodyCompliance>() + size_of::<f64>() * numbers
    }
}

/// What is known to second order: a concentric pin.
pub fn concentric_pin(body: &Body) -> Option<ConcentricBody> {
    ConcentricBody::of(body).filter(|_| body.shape.side == Side::Pin)
}

/// `even` and `odd` of a body.
pub fn infinite(body: &Body) -> [f64; 2] {
    let even = 2.0 / body.idealization.plane_modulus_ratio(body.poissons_ratio);
    let kappa = body.idealization.kolosov(body.poissons_ratio);
    [even, body.shape.side.outward() * even * (kappa - 1.0) / (kappa + 1.0)]
}
