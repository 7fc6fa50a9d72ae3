//! Stresses on the circles of a concentric body - the ring, each interface, the circle that is held - mode by mode.
//!
//! Radial and shear stress pass from circle to circle with the fields of `layered_ring`. The hoop stress follows from what both
//! sides of a circle have in common, the hoop strain, which is known from the compliance Z of what lies beyond it: with nu' = nu in plane
//! strain and nu/(1 + nu) in plane stress,
//!
//! ```text
//!   2 mu e_phi = s_phi - nu' (s_r + s_phi),     e_phi = (u_r + n u_phi)/r.
//! ```

use super::concentric_body::ConcentricBody;
use super::layered_ring::{Layer, Matrix, apply};
use crate::mechanics::body::Body;
use crate::mechanics::body::lining::{Interface, Lining};

/// On one side of a circle: amplitudes of cos(n phi), of the shear stress of sin(n phi); or the stresses themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stress {
    pub radial: f64,
    pub hoop: f64,
    pub shear: f64,
}

impl Stress {
    /// Von Mises' stress, with the stress along the axis over the sum of those in the plane.
    pub fn von_mises(self, axial_share: f64) -> f64 {
        let Stress { radial, hoop, shear } = self;
        let axial = axial_share * (radial + hoop);
        let differences = [radial - hoop, hoop - axial, axial - radial];
        (0.5 * differences.map(|difference| difference * difference).iter().sum::<f64>()
            + 3.0 * shear * shear)
            .sqrt()
    }
}

impl std::ops::AddAssign for Stress {
    fn add_assign(&mut self, other: Stress) {
        self.radial += other.radial;
        self.hoop += other.hoop;
        self.shear += other.shear;
    }
}

/// On a circle, in any of the materials that meet there: stresses for Young's modulus 1 at the ring, or amplitudes of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OnCircle {
    pub radial: f64,
    pub shear: f64,
    pub hoop_strain: f64,
}

/// n ln(radius) at which a wave of mode n has 4e-8 of its stresses left.
const FADED: f64 = 20.0;

/// n times the half angle of a contact beyond which its pressure has 2e-4 of what it has in the first modes.
const SHORT: f64 = 300.0;

/// No more modes than these, or for narrow contacts than those.
const MOST_MODES: f64 = 16_384.0;
const MOST_OF_NARROW: f64 = 65_536.0;

/// Circles of logarithms of radii closer than this are one: what lies between them would be rounding.
const CLOSEST: f64 = 1e-5;

impl ConcentricBody {
    /// How many modes of the pressure of a contact of that half angle, rad, count below the ring; `None` where they are too many.
    pub fn stress_modes(&self, half_angle: f64) -> Option<usize> {
        let needed = FADED / self.near_radius_ratio().ln().abs() + 4.0;
        let enough = (SHORT / half_angle).max(MOST_MODES);
        let count = needed.min(enough);
        (count <= MOST_OF_NARROW).then_some(count as usize)
    }

    /// In a material, 0 that at the ring.
    pub fn stress_on(&self, material: usize, OnCircle { radial, shear, hoop_strain }: OnCircle) -> Stress {
        self.layers()[material].with_hoop([radial, shear], hoop_strain)
    }

    /// Radii of all circles over the ring's, from the ring on.
    pub fn circles(&self) -> Vec<f64> {
        let interfaces = self.lining.list().iter().map(|interface| interface.radius_ratio);
        std::iter::once(1.0).chain(interfaces).chain([self.fixed_radius_ratio]).collect()
    }

    /// Under a pressure cos(n phi) on the ring: of each material, from the ring on, what there is on its near circle and on its far one.
    pub fn circle_stresses(&self, n: usize) -> Vec<[Stress; 2]> {
        let layers = self.layers();
        // How what lies beyond each circle yields, of the held one not at all.
        let mut beyond = vec![[[0.0; 2]; 2]; layers.len() + 1];
        for (place, layer) in layers.iter().enumerate().rev() {
            beyond[place] = match n {
                0 => [[layer.uniform_compliance(beyond[place + 1][0][0]), 0.0], [0.0, 0.0]],
                1 => layer.first_compliance(beyond[place + 1]),
                _ => layer.compliance(n as f64, beyond[place + 1]),
            };
        }
        let mut passing = [-1.0, 0.0];
        let of_layer = |(place, layer): (usize, &Layer)| {
            let near = layer.with_hoop(passing, hoop_strain(n, passing, beyond[place]));
            passing = layer.far_stress(n, passing, beyond[place + 1]);
            [near, layer.with_hoop(passing, hoop_strain(n, passing, beyond[place + 1]))]
        };
        layers.iter().enumerate().map(of_layer).collect()
    }
}

/// The layers of a body with circles at further radii, over the ring's, where nothing changes; without those that are not inside of its thinnest
/// wall or next to another one.
pub fn with_circles(body: &Body, radii: &[f64]) -> Lining {
    let (outward, (thinnest, _)) = (body.shape.side.outward(), body.depth_range());
    let mut interfaces = body.lining.list().to_vec();
    for &radius_ratio in radii {
        let depth = outward * radius_ratio.ln();
        let depths = interfaces.iter().map(|own| own.radius_ratio.ln().abs()).chain([0.0, thinnest]);
        // Not where it is NaN.
        if !(depth > 0.0 && depth < thinnest) || depths.into_iter().any(|own| (own - depth).abs() < CLOSEST) {
            continue;
        }
        let number = interfaces.iter().filter(|own| own.radius_ratio.ln().abs() < depth).count();
        let before = number.checked_sub(1).map(|place| interfaces[place]);
        let own = Interface { radius_ratio: 1.0, modulus_ratio: 1.0, poissons_ratio: body.poissons_ratio };
        interfaces.insert(number, Interface { radius_ratio, ..before.unwrap_or(own) });
    }
    Lining::new(interfaces)
}

/// Of a circle under stresses of mode n from how what lies beyond it yields.
fn hoop_strain(n: usize, stress: [f64; 2], beyond: Matrix) -> f64 {
    match n {
        0 => beyond[0][0] * stress[0],
        // u_r + u_phi under the shear stress and the resultant.
        1 => beyond[0][0] * stress[1] + beyond[0][1] * 0.5 * (stress[0] - stress[1]),
        _ => {
            let [radial, along] = apply(beyond, stress);
            radial + n as f64 * along
        }
    }
}

impl Layer {
    fn with_hoop(&self, [radial, shear]: [f64; 2], hoop_strain: f64) -> Stress {
        let share = 0.25 * (3.0 - self.kolosov);
        let hoop = (self.twice_shear_modulus * hoop_strain + share * radial) / (1.0 - share);
        Stress { radial, hoop, shear }
    }
}
