//! What compliances in a space are sums of: rows, each times a number of a body or of its joint.
//!
//! A pin's compliance is linear in its tilt to first and to second order, a plate's is moved to the hole's arcs by powers of the clearance
//! ratio.

use super::curve_space::CurveSpace;
use super::outlines::Outlines;
use crate::mechanics::body::Side;
use crate::mechanics::compliance::arc::packed_count;
use crate::mechanics::compliance::pressure_space::{JointCompliance, Tilt, all_bands};
use crate::mechanics::compliance::ring_modes::RingModes;
use crate::mechanics::compliance::row_sums::Rows;
use crate::mechanics::compliance::second_order::{Bands, WIDTH};
use crate::mechanics::compliance::{BodyCompliance, Boundary};

/// Up to this clearance ratio a polynomial of it tells what the hole's arcs being smaller changes.
pub const NARROW: f64 = 0.05;

/// Where it goes through, beside zero, over `NARROW`.
const THROUGH: [f64; 3] = [0.25, 0.75, 1.0];

/// How often there are rows of each plate at most: of itself, and times powers of the clearance ratio.
pub const POWERS: usize = 1 + THROUGH.len();

/// A tilt of either order.
const TILTS: [Tilt; 2] = [Tilt { first: 1.0, ..Tilt::NONE }, Tilt { second: 1.0, ..Tilt::NONE }];

/// What unit bodies of one side add to a compliance, and behind that what pins add by unit tilt of either order, plates times the
/// clearance ratio, its square and its cube. They were prepared for.
pub fn rows_of_units(space: &CurveSpace, side: Side, units: &[BodyCompliance]) -> Rows {
    let own: Vec<JointCompliance> = units.iter().map(|unit| compliance(space, unit, Tilt::NONE)).collect();
    let mut rows: Vec<Vec<f64>> = own.iter().map(|own| own.values.to_vec()).collect();
    match side {
        Side::Pin => {
            for tilt in TILTS {
                rows.extend(units.iter().zip(&own).map(|(unit, own)| added_by(space, unit, own, tilt)));
            }
        }
        Side::Plate => rows.extend(added_by_clearance(space, &own)),
    }
    Rows::new(&rows)
}

/// Bodies that are told by so many modes: what each of these adds is the same for all of them. Pins have one row for each number, which
/// their tilt is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ModeMembers {
    side: Side,
    /// Of concentric bodies, in whole steps.
    modes: usize,
    ring_modes: Option<RingModes>,
}

/// Modes of concentric bodies go in steps, so that more bodies have as many.
const STEP: usize = 8;

impl ModeMembers {
    /// Of a body; `None` of beds.
    pub fn of(side: Side, body: &BodyCompliance) -> Option<ModeMembers> {
        let modes = body.mode_count().next_multiple_of(STEP);
        let ring_modes = body.boundary.ring_modes().map(|(modes, _)| *modes);
        (body.bed == 0.0).then_some(ModeMembers { side, modes, ring_modes })
    }

    /// Of a body on a mesh with these ring modes, a pin with so many bands of second order.
    pub fn of_mesh(side: Side, bands: usize, ring_modes: RingModes) -> ModeMembers {
        ModeMembers { side, modes: bands.next_multiple_of(STEP), ring_modes: Some(ring_modes) }
    }

    /// Rows beside `even` and `odd`.
    pub fn count(&self) -> usize {
        self.before_ring() + self.ring_modes.map_or(0, |modes| packed_count(modes.count))
    }

    /// Those of them that are not of ring modes, which come last.
    pub fn before_ring(&self) -> usize {
        match self.side {
            Side::Pin => 2 * TILTS.len() + WIDTH * self.modes,
            Side::Plate => self.modes,
        }
    }

    /// How often there are rows of each.
    pub fn orders(&self) -> usize {
        match self.side {
            Side::Pin => 1,
            Side::Plate => POWERS,
        }
    }

    /// The rows in a space that a body of this kind was prepared for, those of `even` and `odd` first.
    pub fn rows(&self, space: &CurveSpace) -> Rows {
        let infinite = [[1.0, 0.0], [0.0, 1.0]].map(|[even, odd]| BodyCompliance {
            even,
            odd,
            bed: 0.0,
            boundary: Boundary::Nothing,
            second: Vec::new(),
        });
        let bounded = |boundary, second| BodyCompliance { even: 0.0, odd: 0.0, bed: 0.0, boundary, second };
        let one_of = |place: usize, count: usize| (0..count).map(move |i| f64::from(u8::from(i == place)));
        let of_ring = self.ring_modes.into_iter().flat_map(|modes| {
            let count = packed_count(modes.count);
            // Of pins with the works of the tilt.
            let numbers = if self.side == Side::Pin { 2 * count } else { count };
            (0..count).map(move |work| {
                bounded(Boundary::RingModes(modes, one_of(work, numbers).collect()), Vec::new())
            })
        });
        if self.side == Side::Plate {
            let of_modes = (0..self.modes).map(|mode| {
                let normal = one_of(mode, self.modes).collect();
                bounded(Boundary::Modes { normal, along: Vec::new() }, Vec::new())
            });
            let units: Vec<BodyCompliance> = infinite.into_iter().chain(of_modes).chain(of_ring).collect();
            return rows_of_units(space, self.side, &units);
        }
        let values = |unit: &BodyCompliance| compliance(space, unit, Tilt::NONE).values.into_owned();
        let mut rows: Vec<Vec<f64>> = infinite.iter().map(values).collect();
        for tilt in TILTS {
            let added = |unit| added_by(space, unit, &compliance(space, unit, Tilt::NONE), tilt);
            rows.extend(infinite.iter().map(added));
        }
        // A band alone is what it adds to second order.
        let of_bands = (0..WIDTH * self.modes).map(|place| {
            let numbers: Vec<f64> = one_of(place, WIDTH * self.modes).collect();
            let unit = bounded(Boundary::Nothing, numbers.as_chunks().0.to_vec());
            compliance(space, &unit, TILTS[1]).values.into_owned()
        });
        rows.extend(of_bands);
        rows.extend(of_ring.map(|unit| values(&unit)));
        Rows::new(&rows)
    }

    /// What the rows beside `even` and `odd` are to be multiplied by for a body of this kind, under the tilt of its joint.
    pub fn amplitudes(&self, body: &BodyCompliance, tilt: Tilt, to: &mut Vec<f32>) {
        self.amplitudes_before_ring([body.even, body.odd], body.boundary.modes(), &body.second, tilt, to);
        let mut add = |number: f64| to.push(number as f32);
        if let Some((modes, works)) = body.boundary.ring_modes() {
            let (normal, added) = works.split_at(packed_count(modes.count));
            match self.side {
                Side::Pin => {
                    normal.iter().zip(added).for_each(|(own, added)| add(own + tilt.first * added));
                }
                Side::Plate => normal.iter().copied().for_each(add),
            }
        }
    }

    /// Those of the rows that are not of ring modes, from the parts of the body's compliance that they rest on.
    pub fn amplitudes_before_ring(
        &self,
        [even, odd]: [f64; 2],
        modes: Option<[&[f64]; 2]>,
        second: &[Bands],
        tilt: Tilt,
        to: &mut Vec<f32>,
    ) {
        let from = to.len();
        match self.side {
            Side::Pin => {
                let orders = [tilt.first, tilt.second].map(|order| [order * even, order * odd]);
                to.extend(orders.as_flattened().iter().map(|number| *number as f32));
                let (own, scale);
                let bands = match modes {
                    Some([normal, along]) => {
                        own = all_bands(normal, along, second, tilt);
                        scale = 1.0;
                        &own
                    }
                    None => {
                        scale = tilt.second;
                        second
                    }
                };
                to.extend(bands.as_flattened().iter().map(|number| (scale * number) as f32));
            }
            Side::Plate => {
                let normal = modes.map_or(&[][..], |[normal, _]| normal);
                to.extend(normal.iter().map(|number| *number as f32));
            }
        }
        to.resize(from + self.before_ring(), 0.0);
    }
}

fn compliance(space: &CurveSpace, unit: &BodyCompliance, tilt: Tilt) -> JointCompliance<'static> {
    space.pressures.joint(&[(unit, 1.0)], tilt)
}

/// What a tilt adds to the compliance of a pin without one.
fn added_by(space: &CurveSpace, unit: &BodyCompliance, own: &JointCompliance, tilt: Tilt) -> Vec<f64> {
    let tilted = compliance(space, unit, tilt);
    tilted.values.iter().zip(&*own.values).map(|(tilted, own)| tilted - own).collect()
}

/// What the compliances of plates have on the hole's arcs more than on those of a space, over the clearance ratio: a polynomial of it, the
/// coefficients of each power one after the other.
fn added_by_clearance(space: &CurveSpace, own: &[JointCompliance]) -> Vec<Vec<f64>> {
    let places = THROUGH.map(|place| NARROW * place);
    let mut powers = vec![Vec::new(); THROUGH.len()];
    let mut moved = Vec::new();
    for own in own {
        let added = places.map(|place| {
            space.to_hole(own, &Outlines::new(place), &mut moved);
            moved.iter().zip(&*own.values).map(|(moved, own)| (moved - own) / place).collect::<Vec<f64>>()
        });
        let of_entry = |entry: usize| quadratic(&places, added.each_ref().map(|added| added[entry]));
        let coefficients: Vec<[f64; 3]> = (0..own.values.len()).map(of_entry).collect();
        for (power, of_power) in powers.iter_mut().enumerate() {
            of_power.push(coefficients.iter().map(|own| own[power]).collect());
        }
    }
    powers.concat()
}

/// Coefficients of the polynomial through three values at places.
fn quadratic([a, b, c]: &[f64; 3], [at_a, at_b, at_c]: [f64; 3]) -> [f64; 3] {
    let (first, next) = ((at_b - at_a) / (b - a), (at_c - at_b) / (c - b));
    let second = (next - first) / (c - a);
    [at_a - a * first + a * b * second, first - (a + b) * second, second]
}
