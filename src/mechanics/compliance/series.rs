//! `series`: the exact compliance of rotationally symmetric bodies, by as many modes (`concentric_body`) as are felt; how those of thin layers, which
//! end before they are negligible, fade out, and what that leaves.

use std::f64::consts::PI;

use super::concentric_body::{ConcentricBody, PRESSURE, SHEAR, amplitude};
use super::lane_work::{LaneWork, in_lanes};
use super::layered_ring::Layer;
use super::second_order::{Bands, bands};
use super::thin_wall::{bed_compliance, strip_error};
use super::{BodyCompliance, Boundary};
use crate::mechanics::body::{Side, THINNEST_RING};
use crate::mechanics::real::{LANES, Lanes};

/// Modes whose finite-size part is below this share of the mode are left out.
const NEGLIGIBLE: f64 = 1e-13;

/// The same beyond the first layer of a lined body: what a smooth pressure has of modes so high takes it below 1e-8 of the force.
const NEGLIGIBLE_BEYOND: f64 = 1e-7;

/// No more modes than these: of layers that are thinner than waves so short, `left_out` tells what that leaves.
const MOST_MODES: usize = 1500;

/// A layer that takes up more of the waves beyond all modes than this, over what the body does, is taken for a bed.
const TOO_SOFT: f64 = 2.0;

/// So many times its inverse depth of modes resolve a layer.
const RESOLVED: f64 = 5.0;

/// The same of what counts by the clearance ratio squared.
pub const NEGLIGIBLE_SECOND: f64 = 1e-3;

/// What a device leaves out of a compliance at most, relative: a tenth of what single precision leaves.
pub const UNFELT: f64 = 1e-5;

/// No more than this times the clearance ratio squared is added to a compliance, over its greatest entry.
const MOST_OF_SECOND: f64 = 40.0;

/// What the modes of a body are told from, as `BodyCompliance` has it.
#[derive(Clone, Copy, Debug)]
pub struct Infinite {
    pub even: f64,
    pub odd: f64,
    pub bed: f64,
}

/// First layers that are taken for a bed, and the material beyond them.
struct Film {
    bed: f64,
    /// |ln| of the radius where they end.
    depth: f64,
    beyond: Layer,
}

impl ConcentricBody {
    /// The infinite body that the modes are told from, of the material at the ring; of first layers that are a bed that of the material
    /// beyond them.
    pub fn infinite(&self) -> Infinite {
        let film = self.with_layers(|layers| self.film(layers));
        let layer = film.as_ref().map_or_else(|| self.near_layer(), |film| film.beyond);
        let (even, kappa) = (amplitude(&layer), layer.kolosov);
        let odd = self.side().outward() * even * (kappa - 1.0) / (kappa + 1.0);
        Infinite { even, odd, bed: film.map_or(0.0, |film| film.bed) }
    }

    /// First layers so thin and soft that they are no bodies to the waves of any mode. As a bed they yield by what the highest mode finds
    /// of them, so that nothing jumps where modes end. Contacts that may reach all around are wide, and feel no modes so high.
    fn film(&self, layers: &[Layer]) -> Option<Film> {
        if self.all_around || !self.is_cut() || self.taken_up() < TOO_SOFT {
            return None;
        }
        let interfaces = self.lining.list();
        let is_resolved = |place: &usize| {
            let end = interfaces.get(place + 1).map_or(self.fixed_radius_ratio, |next| next.radius_ratio);
            end.ln().abs() * MOST_MODES as f64 > RESOLVED
        };
        let place = (0..interfaces.len()).find(is_resolved)?;
        let beyond = layers[place + 1];
        let [own] = self.finite_part(layers, MOST_MODES as f64, [PRESSURE]);
        let own = own[0] + self.alone(&layers[0], MOST_MODES, PRESSURE)[0];
        let bed = own - self.alone(&beyond, MOST_MODES, PRESSURE)[0];
        let depth = interfaces[place].radius_ratio.ln().abs();
        (bed > 0.0).then_some(Film { bed, depth, beyond })
    }

    /// Whether the body is so thin that it is taken for a Winkler bed, which needs no modes.
    fn is_bed(&self) -> bool {
        self.fixed_radius_ratio.ln().abs() < THINNEST_RING
    }

    /// The highest mode that `compliance` needs.
    pub fn modes_needed(&self) -> usize {
        if self.is_bed() { 0 } else { self.highest_mode() }
    }

    /// The highest mode that is felt beyond the material at the ring.
    pub fn highest_mode(&self) -> usize {
        let decay = 2.0 * self.near_radius_ratio().ln().abs();
        // The finite-size part falls like n^2 exp(-decay n); the square costs a few modes more.
        let needed = |negligible: f64| ((-negligible.ln() + 4.0) / decay).ceil() as usize + 4;
        if self.lining.is_empty() { needed(NEGLIGIBLE) } else { needed(NEGLIGIBLE_BEYOND).min(MOST_MODES) }
    }

    /// Relative error of the work that goes into a body whose modes are cut, under a contact of a half angle, rad, by the modes beyond
    /// the highest being those of the material at the ring alone.
    ///
    /// The pressure's share of mode n is (4/pi) (n eps)^-3, so that all beyond N have 4/(3 pi) (N eps)^-3 of the work of the first; what
    /// lies beyond a layer of depth d counts there like (1 + (n d)^2) exp(-2 n d).
    ///
    /// Where the layer is a bed, all beyond N that it yields too much is less than 0.4 (N eps)^-2 of its work under the pressure
    /// of Hertz; and what a thin bed is wrong by (`thin_wall`).
    pub fn left_out(&self, half_angle: f64) -> f64 {
        let reach = 0.5 * MOST_MODES as f64 * half_angle;
        if let Some(film) = self.film(&self.layers()) {
            let of_strip = strip_error(self.poissons_ratio, self.idealization, film.depth / half_angle);
            return of_strip.min(0.1 * reach.powi(-2));
        }
        4.0 / (3.0 * PI) * self.taken_up() * reach.max(1.0).powi(-3)
    }

    /// What the material at the ring takes up of the waves beyond all modes, over what the whole body does of long ones, at most.
    fn taken_up(&self) -> f64 {
        let Some(beyond) = self.lining.list().first() else { return 0.0 };
        let compliance = |ratio: f64| 1.0 / self.idealization.plane_modulus_ratio(ratio);
        // A layer that is softer than what it lies on has more compliance of its own than the whole.
        let own = compliance(self.poissons_ratio) * beyond.modulus_ratio / compliance(beyond.poissons_ratio);
        // The others fade out.
        let highest = 0.5 * MOST_MODES as f64;
        let depth = highest * beyond.radius_ratio.ln().abs();
        let felt = ((1.0 + depth * depth) * (-2.0 * depth).exp()).min(1.0);
        own.max(1.0) * felt
    }

    /// How the ring yields, of a thin wall as that of a bed.
    pub fn compliance(&self) -> BodyCompliance {
        if self.is_bed() {
            let bed = bed_compliance(self.fixed_radius_ratio, self.poissons_ratio, self.idealization);
            return BodyCompliance {
                even: 0.0,
                odd: 0.0,
                bed,
                boundary: Boundary::Nothing,
                second: Vec::new(),
            };
        }
        let Infinite { even, odd, bed } = self.infinite();
        // Of plates, which have no tilt, the rest is not asked for.
        let second_count = match self.side() {
            Side::Pin => self.second_order_count(NEGLIGIBLE_SECOND),
            Side::Plate => 0,
        };
        let [normal, mut along, shear] = self.modes(self.highest_mode() + 1, second_count);
        let second = bands([&normal, &along, &shear], second_count);
        if self.side() == Side::Plate {
            along.clear();
        }
        BodyCompliance { even, odd, bed, boundary: Boundary::Modes { normal, along }, second }
    }

    /// What lies beyond the material at the ring changes of each mode, as far as it is felt: `boundary_mode`.
    pub fn boundary_modes(&self) -> [Vec<f64>; 2] {
        let [normal, along, _] = self.modes(self.highest_mode() + 1, 0);
        [normal, along]
    }

    /// Of so many modes from 0 on, two at least, `boundary_mode`; and of the first so many, none or two at least, the amplitude of u_phi under
    /// shear, less that of an infinite body.
    fn modes(&self, count: usize, shear_count: usize) -> [Vec<f64>; 3] {
        self.with_layers(|layers| self.modes_of(layers, count, shear_count))
    }

    fn modes_of(&self, layers: &[Layer], count: usize, shear_count: usize) -> [Vec<f64>; 3] {
        let taper = self.taper();
        let [mut normal, mut along, mut shear] =
            in_lanes(FiniteParts { body: self, layers, count, shear_count });
        for n in [0, 1] {
            [normal[n], along[n]] = self.boundary_mode(n);
        }
        if let Some(first) = shear.get_mut(1) {
            *first = self.first_mode(SHEAR)[1] - self.amplitude();
        }
        let film = self.film(layers);
        if let Some(Film { bed, beyond, .. }) = &film {
            normal[0] -= 0.5 * bed;
            for n in 1..count {
                let more = self.difference([beyond, &layers[0]], n, PRESSURE);
                normal[n] += more[0] - bed;
                along[n] += more[1];
            }
            for (n, own) in shear.iter_mut().enumerate().skip(1) {
                *own += self.difference([beyond, &layers[0]], n, SHEAR)[1];
            }
        } else {
            normal.iter_mut().enumerate().for_each(|(n, value)| *value *= taper(n));
        }
        for values in [&mut along, &mut shear] {
            values.iter_mut().enumerate().for_each(|(n, value)| *value *= taper(n));
        }
        [normal, along, shear]
    }

    /// Of each mode 1, but where they end before they are negligible. There they fade out: an end of a sudden would make the
    /// compliance of wider and wider arcs go up and down.
    fn taper(&self) -> impl Fn(usize) -> f64 + use<> {
        let is_cut = self.is_cut();
        move |n| {
            let over = n as f64 / MOST_MODES as f64;
            if is_cut && over > 0.5 { (PI * (over - 0.5)).cos().powi(2) } else { 1.0 }
        }
    }

    /// Whether the material at the ring is so thin a layer that modes end before they are negligible.
    pub fn is_cut(&self) -> bool {
        !self.lining.is_empty() && self.highest_mode() == MOST_MODES
    }

    /// What the fixed circle of a pin adds to second order, modes left out whose share of it is negligible; nothing of a bed.
    pub fn second_order(&self, negligible: f64) -> Vec<Bands> {
        let count = self.second_order_count(negligible);
        if self.is_bed() || count == 0 {
            return Vec::new();
        }
        let [normal, along, shear] = self.modes(count, count);
        bands([&normal, &along, &shear], count)
    }

    /// As much of it as is felt in single precision where the clearance ratio squared is this.
    pub fn second_order_felt(&self, square: f64) -> Vec<Bands> {
        self.second_order((UNFELT / square).max(NEGLIGIBLE_SECOND))
    }

    /// As many as `second_order` has, but for beds.
    pub fn second_order_count(&self, negligible: f64) -> usize {
        let decay = 2.0 * self.near_radius_ratio().ln().abs();
        let felt = ((-negligible.ln() + 4.0) / decay).ceil() as usize;
        // The first mode, which most of it is, reaches two beyond its own.
        if negligible > MOST_OF_SECOND { 0 } else { (felt.max(2) + 2).min(MOST_MODES) }
    }
}

/// `finite_part` of so many modes, two at least, and what is along the ring under shear of the first of them, none or two at least: of 0 and 1
/// nothing. As many modes abreast as there are lanes.
struct FiniteParts<'a> {
    body: &'a ConcentricBody,
    layers: &'a [Layer],
    count: usize,
    shear_count: usize,
}

impl LaneWork for FiniteParts<'_> {
    type Output = [Vec<f64>; 3];

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> [Vec<f64>; 3] {
        let FiniteParts { body, layers, count, shear_count } = self;
        let mut parts = [count, count, shear_count].map(|count| {
            let mut part = Vec::new();
            if count > 0 {
                part.reserve_exact(count + LANES);
                part.extend([0.0; 2]);
            }
            part
        });
        for first in (2..count).step_by(LANES) {
            let n = Lanes::<WIDTH>(std::array::from_fn(|lane| (first + lane) as f64));
            let [normal, along, shear] = &mut parts;
            let own = if first < shear_count {
                let [own, under_shear] = body.finite_part(layers, n, [PRESSURE, SHEAR]);
                shear.extend_from_slice(&under_shear[1].0);
                own
            } else {
                let [own] = body.finite_part(layers, n, [PRESSURE]);
                own
            };
            normal.extend_from_slice(&own[0].0);
            along.extend_from_slice(&own[1].0);
        }
        for (part, count) in parts.iter_mut().zip([count, count, shear_count]) {
            part.truncate(count);
        }
        parts
    }
}
