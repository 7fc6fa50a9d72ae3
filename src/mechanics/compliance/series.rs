//! `series`: the exact compliance of rotationally symmetric bodies, mode by mode.
//!
//! A pressure p_n cos(n phi) on the ring of an annulus or a cored disc, its other boundary fixed, gives the normal
//! displacement lambda_n p_n cos(n phi). With Kolosov's constant kappa the fields of mode n are Michell's (J. R.
//! Barber, Elasticity, tables 8.1 and 9.1). Where the fixed boundary is far, lambda_n tends to
//!
//! ```text
//!   lambda_n = c [n +- beta]/(n^2 - 1),   c = (kappa + 1)/(4 mu),   beta = (kappa - 1)/(kappa + 1),
//! ```
//!
//! plus for a hole and minus for a disc, whose sums are known in closed form (`infinite_body`); what is left of each
//! mode falls like (ratio of radii)^(-2 n).

use std::f64::consts::PI;

use super::lane_work::{LaneWork, in_lanes};
use super::layered_ring::{Layer, apply, inverse, less, product, reflection};
use super::second_order::{Bands, bands};
use super::thin_wall::{bed_compliance, strip_error};
use super::{BodyCompliance, Boundary};
use crate::mechanics::body::lining::{Interface, Lining};
use crate::mechanics::body::{Body, Side, THINNEST_RING};
use crate::mechanics::material::Idealization;
use crate::mechanics::real::{LANES, Lanes, Real};

/// A body between the ring (radius 1) and a concentric circle of radius `fixed_radius_ratio` on which it is fixed: above 1
/// for a plate, below 1 for a pin. Poisson's ratio is that at the ring, where Young's modulus is 1.
#[derive(Clone, Debug, PartialEq)]
pub struct ConcentricBody {
    pub fixed_radius_ratio: f64,
    pub poissons_ratio: f64,
    pub idealization: Idealization,
    pub lining: Lining,
}

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
const NEGLIGIBLE_SECOND: f64 = 1e-3;

/// Radial and shear stress on the ring: a pressure cos(n phi), and sin(n phi) along the ring.
type Stress = [f64; 2];
const PRESSURE: Stress = [-1.0, 0.0];
const SHEAR: Stress = [0.0, 1.0];

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
    /// `None` where no concentric circle bounds the body.
    pub fn of(body: &Body) -> Option<ConcentricBody> {
        body.fixed_radius_ratio().map(|fixed_radius_ratio| ConcentricBody::like(body, fixed_radius_ratio))
    }

    /// Any concentric body with the layers of a body; `None` of a bare one.
    pub fn with_layers_of(body: &Body) -> Option<ConcentricBody> {
        let last = body.lining.list().last()?;
        let beyond = if body.shape.side == Side::Plate { 2.0 } else { 0.5 };
        Some(ConcentricBody::like(body, beyond * last.radius_ratio))
    }

    fn like(body: &Body, fixed_radius_ratio: f64) -> ConcentricBody {
        ConcentricBody {
            fixed_radius_ratio,
            poissons_ratio: body.poissons_ratio,
            idealization: body.idealization,
            lining: body.lining.clone(),
        }
    }

    pub(super) fn side(&self) -> Side {
        if self.fixed_radius_ratio > 1.0 { Side::Plate } else { Side::Pin }
    }

    /// 2 mu for Young's modulus 1.
    fn twice_shear_modulus(&self) -> f64 {
        1.0 / (1.0 + self.poissons_ratio)
    }

    fn kolosov(&self) -> f64 {
        self.idealization.kolosov(self.poissons_ratio)
    }

    /// Where the material at the ring ends: at the first interface, or at the fixed circle.
    pub(super) fn near_radius_ratio(&self) -> f64 {
        self.lining.list().first().map_or(self.fixed_radius_ratio, |interface| interface.radius_ratio)
    }

    /// What lies between an interface and a radius beyond it.
    fn layer_beyond(&self, interface: &Interface, far: f64) -> Layer {
        let kolosov = self.idealization.kolosov(interface.poissons_ratio);
        let twice_shear_modulus = interface.modulus_ratio / (1.0 + interface.poissons_ratio);
        Layer::new(far / interface.radius_ratio, kolosov, twice_shear_modulus)
    }

    /// The material at the ring as a layer before others.
    fn near_layer(&self) -> Layer {
        Layer::new(self.near_radius_ratio(), self.kolosov(), self.twice_shear_modulus())
    }

    /// All materials, from the ring on.
    pub(super) fn layers(&self) -> Vec<Layer> {
        let interfaces = self.lining.list();
        let far = interfaces
            .iter()
            .skip(1)
            .map(|interface| interface.radius_ratio)
            .chain([self.fixed_radius_ratio]);
        let beyond = interfaces.iter().zip(far).map(|(interface, far)| self.layer_beyond(interface, far));
        std::iter::once(self.near_layer()).chain(beyond).collect()
    }

    /// What is made of its layers; a bare body's one needs no room of its own.
    fn with_layers<T>(&self, make: impl FnOnce(&[Layer]) -> T) -> T {
        if self.lining.is_empty() { make(&[self.near_layer()]) } else { make(&self.layers()) }
    }

    /// c, the amplitude of the logarithmic kernel, for Young's modulus 1: 2/E'.
    pub fn amplitude(&self) -> f64 {
        amplitude(&self.near_layer())
    }

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
    /// of them, so that nothing jumps where modes end.
    fn film(&self, layers: &[Layer]) -> Option<Film> {
        if !self.is_cut() || self.taken_up() < TOO_SOFT {
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

    /// What mode n, 1 and above, of an infinite body of a material has less than that of another; of mode 1 what `infinite_body` takes it for.
    fn difference(&self, [less, more]: [&Layer; 2], n: usize, stress: Stress) -> [f64; 2] {
        if n == 1 {
            let own = amplitude(more) - amplitude(less);
            return if stress == PRESSURE { [own, 0.0] } else { [0.0, own] };
        }
        let [less, more] = [less, more].map(|layer| self.alone(layer, n, stress));
        [more[0] - less[0], more[1] - less[1]]
    }

    /// Mode n, 2 and above, of an infinite body of a material.
    fn alone(&self, layer: &Layer, n: usize, stress: Stress) -> [f64; 2] {
        let [[near, _], _] = layer.fields(n as f64);
        let [radial, along] = apply(near.displacements, apply(inverse(near.stresses), stress));
        [self.side().outward() * radial, along].map(|value| value / layer.twice_shear_modulus)
    }

    /// lambda_n, and the amplitude of the displacement along the ring, u_phi = along sin(n phi), or those under shear, each less that of the same body with
    /// its fixed circle infinitely far (or small) and without layers beyond the one at the ring, n >= 2, of one mode or several abreast, under each
    /// of some stresses. Free of cancellation.
    ///
    /// With x the amplitudes of the two fields that fall from the ring, y of the two that fall from the far circle of the material at
    /// the ring, q = (ratio of radii)^n what is left of them at the other circle, and Z how that yields (0 where it is held),
    ///
    /// ```text
    ///   ring:   N x + q M y = t          far circle:   q (P - Z Np) x + (Q - Z Mp) y = 0,
    /// ```
    ///
    /// so x = x0 + q^2 (N - q^2 S)^-1 S x0 with N x0 = t and S = M (Q - Z Mp)^-1 (P - Z Np).
    #[inline(always)]
    fn finite_part<T: Real, const STRESSES: usize>(
        &self,
        layers: &[Layer],
        n: T,
        stresses: [Stress; STRESSES],
    ) -> [[T; 2]; STRESSES] {
        let layer = &layers[0];
        let q = layer.left_of(n);
        // Nothing is left, and powers of radii like 1e300 are no numbers.
        if (T::from_f64(1e-30) - q).is_positive() {
            return [[T::zero(); 2]; STRESSES];
        }
        let [[near, far], on_circle] = layer.fields(n);
        // y = -q R x.
        let reflection = if self.lining.is_empty() {
            product(inverse(on_circle[1].displacements), on_circle[0].displacements)
        } else {
            let mut beyond = [[T::zero(); 2]; 2];
            for layer in layers[1..].iter().rev() {
                beyond = layer.compliance(n, beyond);
            }
            reflection(on_circle, layer.own(beyond))
        };
        let back = product(far.stresses, reflection);
        let square = q * q;
        let (of_near, of_both) = (inverse(near.stresses), inverse(less(near.stresses, square, back)));
        let mut parts = [[T::zero(); 2]; STRESSES];
        for (part, [radial, along]) in parts.iter_mut().zip(stresses) {
            let alone = apply(of_near, [T::from_f64(radial), T::from_f64(along)]);
            let [more, other] = apply(of_both, apply(back, alone));
            let more = [square * more, square * other];
            let reflected = apply(reflection, [alone[0] + more[0], alone[1] + more[1]]);
            let (near, far) = (apply(near.displacements, more), apply(far.displacements, reflected));
            let radial = near[0].minus_product(square, far[0]);
            *part = self.normal_and_along([radial, near[1].minus_product(square, far[1])]);
        }
        parts
    }

    /// From 2 mu times u_r and u_phi: a pressure pushes a hole outwards and a disc inwards.
    #[inline(always)]
    fn normal_and_along<T: Real>(&self, [radial, along]: [T; 2]) -> [T; 2] {
        let share = 1.0 / self.twice_shear_modulus();
        [T::from_f64(self.side().outward() * share) * radial, T::from_f64(share) * along]
    }

    /// lambda_1, and the amplitude of u_phi, or those under shear. The fields are r^3, the single-valued point force, 1/r and the translation;
    /// the first three have amplitudes A, L and D, and what the translation adds cancels in u_r + u_phi.
    fn first_mode(&self, stress: Stress) -> [f64; 2] {
        if !self.lining.is_empty() {
            let layers = self.layers();
            let beyond = beyond(&layers, [[0.0; 2]; 2], |layer, beyond| layer.first_compliance(beyond));
            let resultant = 0.5 * (stress[0] - stress[1]);
            let [sum, difference] = apply(layers[0].first_compliance(beyond), [stress[1], resultant]);
            let own = [0.5 * (sum + difference), 0.5 * (sum - difference)];
            return self.normal_and_along(own.map(|value| value * self.twice_shear_modulus()));
        }
        let kappa = self.kolosov();
        // Radial and shear stress on the ring: 2 A + (kappa + 3) L - 2 D and 2 A + (1 - kappa) L - 2 D.
        let point = 0.5 * (stress[0] - stress[1]) / (kappa + 1.0);
        let excess = 0.5 * ((1.0 - kappa) * point - stress[1]);
        // u_r + u_phi = 0 on the fixed circle: kappa A rho^2 - L + D/rho^2 = 0. A and A rho^2, without powers that overflow.
        let square = self.fixed_radius_ratio * self.fixed_radius_ratio;
        let [rising, risen] = match self.side() {
            Side::Plate => {
                let risen = (point - excess / square) / (kappa + 1.0 / square / square);
                [risen / square, risen]
            }
            Side::Pin => {
                let rising = (point * square - excess) / (kappa * square * square + 1.0);
                [rising, rising * square]
            }
        };
        // u_r - u_phi = 0 there: -4 A rho^2 + 4 kappa L ln rho + 2 T = 0.
        let translation = 2.0 * risen - 2.0 * kappa * point * self.fixed_radius_ratio.ln();
        let radial = (kappa - 1.0) * rising + excess - point + translation;
        let along = (kappa + 3.0) * rising + excess - point - translation;
        self.normal_and_along([radial, along])
    }

    /// The mean motion of the ring in the load's direction under a pressure cos(phi), the plate's along the load and the pin's
    /// against it, for Young's modulus 1. Only the first mode moves a ring: u_r = a cos(phi), u_phi = b sin(phi) have the mean
    /// displacement (a - b)/2 along the load line.
    pub fn mean_ring_motion(&self) -> f64 {
        let [normal, along] = self.first_mode(PRESSURE);
        // The pressure pushes a disc inwards: u_r = -normal cos(phi).
        0.5 * (normal - self.side().outward() * along)
    }

    /// lambda_0: the normal displacement under pressure 1 all around, for Young's modulus 1 at the ring.
    pub fn uniform_mode(&self) -> f64 {
        if self.lining.is_empty() {
            return bed_compliance(self.fixed_radius_ratio, self.poissons_ratio, self.idealization);
        }
        let layers = self.layers();
        let beyond = beyond(&layers, 0.0, |layer, beyond| layer.uniform_compliance(beyond));
        // A pressure is a negative stress.
        -self.side().outward() * layers[0].uniform_compliance(beyond)
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
            Side::Pin => self.second_order_count(),
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

    /// What lies beyond the material at the ring changes of lambda_n, half of it for n = 0, and of the amplitude of u_phi.
    pub fn boundary_mode(&self, n: usize) -> [f64; 2] {
        match n {
            0 => [0.5 * self.uniform_mode(), 0.0],
            1 => {
                let [normal, along] = self.first_mode(PRESSURE);
                [normal - self.amplitude(), along]
            }
            _ => {
                let [own] = self.finite_part(&self.layers(), n as f64, [PRESSURE]);
                own
            }
        }
    }

    /// What the fixed circle of a pin adds to second order; nothing of a bed.
    pub fn second_order(&self) -> Vec<Bands> {
        if self.is_bed() {
            return Vec::new();
        }
        let count = self.second_order_count();
        let [normal, along, shear] = self.modes(count, count);
        bands([&normal, &along, &shear], count)
    }

    /// As many as `second_order` has.
    pub fn second_order_count(&self) -> usize {
        let decay = 2.0 * self.near_radius_ratio().ln().abs();
        (((-NEGLIGIBLE_SECOND.ln() + 4.0) / decay).ceil() as usize + 2).min(MOST_MODES)
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

/// What lies beyond the first of some layers, from the far circle of the last one on, which is held: joined by `add`.
fn beyond<T>(layers: &[Layer], held: T, add: impl Fn(&Layer, T) -> T) -> T {
    layers[1..].iter().rev().fold(held, |beyond, layer| add(layer, beyond))
}

/// c of an infinite body of a material.
fn amplitude(layer: &Layer) -> f64 {
    (layer.kolosov + 1.0) / (2.0 * layer.twice_shear_modulus)
}
