//! The contact pressures that are tried: a contact half angle, and on it Chebyshev polynomials over the square-root
//! singularity of a punch.
//!
//! With b = tan(eps/2), s = tan(phi/2)/b = cos(tau), the trial pressures are
//!
//! ```text
//!   p_k d(phi) = cos(2 k tau) d(tau) = T_2k(s)/sqrt(1 - s^2) ds,      k = 0, 1, ... terms - 1.
//! ```
//!
//! Their sum of coefficients is the strength of the edge singularity; contact with a free edge is where it vanishes.
//! In this basis the logarithmic kernel of plane elasticity is diagonal up to rank two, and every other integral is
//! smooth.
//!
//! A press fit is in contact over nearly the whole ring, where tan(eps/2) has no bound. There
//!
//! ```text
//!   b = sin(eps/2),   sin(phi/2)/b = cos(tau),   p_k d(phi) = cos(2 k tau) d(tau),
//! ```
//!
//! the logarithmic kernel is diagonal on every arc, and on the whole ring, tau = (pi - phi)/2, the p_k are cosines of the angle.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::mechanics::real::Real;

/// The most trial pressures a space may have.
pub const MAX_TERMS: usize = 24;

/// Counts of trial pressures there is compiled code for.
pub const TERM_CHOICES: [usize; 4] = [6, 10, 16, MAX_TERMS];

/// Fewer than any sweep is solved with, on the processor alone: what meshes without the exact near field can bear.
pub const FEW_TERMS: [usize; 1] = [3];

/// Which function of half the angle is cos(tau) times its value at the edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ArcMap {
    /// Of arcs that end before the far side of the ring.
    Tangent,
    /// Of arcs up to the whole ring.
    Sine,
}

impl ArcMap {
    /// phi from that function of phi/2.
    pub fn angle(self, of_half: f64) -> f64 {
        match self {
            ArcMap::Tangent => 2.0 * of_half.atan(),
            ArcMap::Sine => 2.0 * of_half.min(1.0).asin(),
        }
    }

    /// The function of phi/2.
    pub fn of_half(self, angle: f64) -> f64 {
        match self {
            ArcMap::Tangent => (0.5 * angle).tan(),
            ArcMap::Sine => (0.5 * angle).sin(),
        }
    }

    /// d(of_half)/d(phi/2) as a function of `of_half`.
    #[inline(always)]
    pub fn slope<T: Real>(self, of_half: T) -> T {
        let one = T::from_f64(1.0);
        match self {
            ArcMap::Tangent => one + of_half * of_half,
            ArcMap::Sine => (-(of_half * of_half - one).least(T::zero())).sqrt(),
        }
    }
}

/// Geometry of one contact half angle.
#[derive(Clone, Copy, Debug)]
pub struct ContactArc {
    pub map: ArcMap,
    /// Contact half angle, rad.
    pub half_angle: f64,
    /// b = tan(eps/2), or sin(eps/2).
    pub b: f64,
    pub ln_b: f64,
    /// Of tangents: t = tan(atan(b)/2), 1 + b^2 cos^2(tau) = (1 + 2 t^2 cos(2 tau) + t^4)/(1 - t^2)^2.
    pub(super) t: f64,
}

impl ContactArc {
    pub fn new(half_angle: f64) -> ContactArc {
        let b = (0.5 * half_angle).tan();
        ContactArc { map: ArcMap::Tangent, half_angle, b, ln_b: b.ln(), t: b / (1.0 + (1.0 + b * b).sqrt()) }
    }

    /// An arc of sines that leaves a gap: cos(eps/2), from 0, the whole ring, to below 1.
    pub fn leaving(cosine: f64) -> ContactArc {
        let square = cosine * cosine;
        let (b, ln_b) = ((1.0 - square).sqrt(), 0.5 * (-square).ln_1p());
        ContactArc { map: ArcMap::Sine, half_angle: 2.0 * cosine.acos(), b, ln_b, t: 0.0 }
    }

    /// phi at tau.
    pub fn angle(&self, tau: f64) -> f64 {
        self.map.angle(self.b * tau.cos())
    }

    /// tau at phi, 0 at and beyond the edge.
    pub fn tau(&self, angle: f64) -> f64 {
        (self.map.of_half(angle) / self.b).min(1.0).acos()
    }

    /// Integral of p_k over the half arc: pi/2 for k = 0, else 0.
    pub fn resultant(k: usize) -> f64 {
        if k == 0 { FRAC_PI_2 } else { 0.0 }
    }

    /// Integrals of p_k (1 - cos phi) over b^2, of sines, for k = 0, 1, ...: those of 2 cos^2(tau) = 1 + cos(2 tau).
    pub fn versines_of_sines<const TERMS: usize>() -> [f64; TERMS] {
        std::array::from_fn(|k| match k {
            0 => FRAC_PI_2,
            1 => 0.5 * FRAC_PI_2,
            _ => 0.0,
        })
    }

    /// The same of tangents: pi [delta_k0 - (-t^2)^k/sqrt(1 + b^2)]/b^2, free of cancellation.
    #[inline(always)]
    pub fn versines<T: Real, const TERMS: usize>(b: T) -> [T; TERMS] {
        let (one, pi) = (T::from_f64(1.0), T::from_f64(PI));
        let root = (one + b * b).sqrt();
        let inverse = one / (one + root);
        let t = b * inverse;
        let mut next = pi / root * inverse * inverse;
        let mut versines = [pi / root * inverse; TERMS];
        for versine in &mut versines[1..] {
            *versine = next;
            next = -next * t * t;
        }
        versines
    }

    /// Integrals of p_k sin^2(phi) (1 - cos phi) over b^2, for k = 0, 1, ...: with r = 1/sqrt(1 + b^2) and q = b^2 r^2
    /// pi (-t^2)^k r [2 r^2 k^2 - (2 r + 3 r q) k + 3/2 q^2]/b^2. By the derivatives D of the integrals of 1 - cos phi by ln b, D - D^2/2.
    #[inline(always)]
    pub fn bent_versines<T: Real, const TERMS: usize>(b: T) -> [T; TERMS] {
        let number = T::from_f64;
        let root = (number(1.0) + b * b).sqrt();
        let (r, inverse) = (number(1.0) / root, number(1.0) / (number(1.0) + root));
        let (t, q) = (b * inverse, b * b * r * r);
        let (square, single) = (number(2.0) * r * r, r * (number(2.0) + number(3.0) * q));
        let mut bent = [number(1.5 * PI) * r * q * r * r; TERMS];
        // pi r (-t^2)^k/b^2.
        let mut factor = -number(PI) * r * inverse * inverse;
        for (k, bent) in bent.iter_mut().enumerate().skip(1) {
            let k = number(k as f64);
            *bent = factor * (k * (k * square - single) + number(1.5) * q * q);
            factor = -factor * t * t;
        }
        bent
    }
}

/// Entries of the lower triangle of a symmetric `terms` x `terms` matrix.
pub const fn packed_count(terms: usize) -> usize {
    terms * (terms + 1) / 2
}

/// Position of (row, column), row >= column, in the packed lower triangle. It does not depend on the count of terms,
/// so a space of fewer terms is a prefix of one of more.
pub const fn packed(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// cos(k x) for k = 0 ... `terms` - 1 from cos x; the others are zero.
pub fn cosines(cosine: f64, terms: usize) -> [f64; MAX_TERMS] {
    let (mut value, mut previous) = (1.0, cosine);
    let mut cosines = [0.0; MAX_TERMS];
    for own in &mut cosines[..terms] {
        *own = value;
        (value, previous) = (2.0 * cosine * value - previous, value);
    }
    cosines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::element::quadrature::gauss_legendre;

    /// tau undoes the angle, to the rounding of acos; the edge and all beyond it are at 0.
    #[test]
    fn tau_and_the_angle_are_inverse() {
        for arc in
            [1e-6, 0.3, 2.4].map(ContactArc::new).into_iter().chain([0.2, 0.8].map(ContactArc::leaving))
        {
            let half_angle = arc.half_angle;
            for tau in [0.1, 1.0, FRAC_PI_2] {
                assert!((arc.tau(arc.angle(tau)) - tau).abs() < 1e-14);
            }
            assert!((arc.angle(0.0) / half_angle - 1.0).abs() < 1e-15);
            assert_eq!([1.001, 1.1].map(|factor| arc.tau(factor * half_angle)), [0.0; 2]);
        }
    }

    #[test]
    fn versine_equals_its_integral() {
        let tangents = ContactArc::new(1.3);
        for (arc, versines) in [
            (tangents, ContactArc::versines::<f64, 5>(tangents.b)),
            (ContactArc::leaving(0.3), ContactArc::versines_of_sines()),
        ] {
            for (k, versine) in versines.iter().enumerate() {
                let sum: f64 = gauss_legendre(40)
                    .iter()
                    .map(|(x, w)| {
                        let tau = 0.5 * FRAC_PI_2 * (1.0 + x);
                        0.5 * FRAC_PI_2 * w * (2.0 * k as f64 * tau).cos() * (1.0 - arc.angle(tau).cos())
                    })
                    .sum();
                assert!((versine * arc.b * arc.b - sum).abs() < 1e-14, "{:?}, k = {k}", arc.map);
            }
        }
    }

    #[test]
    fn bent_versine_equals_its_integral() {
        for half_angle in [0.02, 1.3] {
            let arc = ContactArc::new(half_angle);
            let bent: [f64; 5] = ContactArc::bent_versines(arc.b);
            for (k, bent) in bent.iter().enumerate() {
                let sum: f64 = gauss_legendre(40)
                    .iter()
                    .map(|(x, w)| {
                        let tau = 0.5 * FRAC_PI_2 * (1.0 + x);
                        let (sine, cosine) = arc.angle(tau).sin_cos();
                        0.5 * FRAC_PI_2 * w * (2.0 * k as f64 * tau).cos() * sine * sine * (1.0 - cosine)
                    })
                    .sum();
                assert!((bent * arc.b * arc.b - sum).abs() < 1e-14, "{half_angle}, k = {k}: {bent} {sum}");
            }
        }
    }
}
