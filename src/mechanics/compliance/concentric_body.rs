//! Rotationally symmetric bodies, exactly: one mode of the ring at a time.
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

use super::layered_ring::{Layer, apply, inverse, less, product, reflection};
use super::thin_wall::bed_compliance;
use crate::mechanics::body::lining::{Interface, Lining};
use crate::mechanics::body::{Body, Side};
use crate::mechanics::material::Idealization;
use crate::mechanics::real::Real;

/// A body between the ring (radius 1) and a concentric circle of radius `fixed_radius_ratio` on which it is fixed: above 1
/// for a plate, below 1 for a pin. Poisson's ratio is that at the ring, where Young's modulus is 1.
#[derive(Clone, Debug, PartialEq)]
pub struct ConcentricBody {
    pub fixed_radius_ratio: f64,
    pub poissons_ratio: f64,
    pub idealization: Idealization,
    pub lining: Lining,
    /// Of a joint whose contact may reach all around.
    pub all_around: bool,
}

/// Radial and shear stress on the ring: a pressure cos(n phi), and sin(n phi) along the ring.
pub(super) type Stress = [f64; 2];
pub(super) const PRESSURE: Stress = [-1.0, 0.0];
pub(super) const SHEAR: Stress = [0.0, 1.0];

impl ConcentricBody {
    /// Of one material, for contacts with clearance.
    pub fn bare(fixed_radius_ratio: f64, poissons_ratio: f64, idealization: Idealization) -> ConcentricBody {
        let lining = Lining::NONE;
        ConcentricBody { fixed_radius_ratio, poissons_ratio, idealization, lining, all_around: false }
    }

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
            all_around: body.all_around,
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
    pub(super) fn near_layer(&self) -> Layer {
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
    pub(super) fn with_layers<T>(&self, make: impl FnOnce(&[Layer]) -> T) -> T {
        if self.lining.is_empty() { make(&[self.near_layer()]) } else { make(&self.layers()) }
    }

    /// c, the amplitude of the logarithmic kernel, for Young's modulus 1: 2/E'.
    pub fn amplitude(&self) -> f64 {
        amplitude(&self.near_layer())
    }

    /// What mode n, 1 and above, of an infinite body of a material has less than that of another; of mode 1 what `infinite_body` takes it for.
    pub(super) fn difference(&self, [less, more]: [&Layer; 2], n: usize, stress: Stress) -> [f64; 2] {
        if n == 1 {
            let own = amplitude(more) - amplitude(less);
            return if stress == PRESSURE { [own, 0.0] } else { [0.0, own] };
        }
        let [less, more] = [less, more].map(|layer| self.alone(layer, n, stress));
        [more[0] - less[0], more[1] - less[1]]
    }

    /// Mode n, 2 and above, of an infinite body of a material.
    pub(super) fn alone(&self, layer: &Layer, n: usize, stress: Stress) -> [f64; 2] {
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
    pub(super) fn finite_part<T: Real, const STRESSES: usize>(
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
    pub(super) fn first_mode(&self, stress: Stress) -> [f64; 2] {
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
}

/// What lies beyond the first of some layers, from the far circle of the last one on, which is held: joined by `add`.
fn beyond<T>(layers: &[Layer], held: T, add: impl Fn(&Layer, T) -> T) -> T {
    layers[1..].iter().rev().fold(held, |beyond, layer| add(layer, beyond))
}

/// c of an infinite body of a material.
pub(super) fn amplitude(layer: &Layer) -> f64 {
    (layer.kolosov + 1.0) / (2.0 * layer.twice_shear_modulus)
}
