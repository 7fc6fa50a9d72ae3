//! How a ring of bonded layers yields, mode by mode: the fields of every layer (J. R. Barber, Elasticity, tables 8.1 and 9.1)
//! joined from the far circle, which is held, to the ring.
//!
//! What lies beyond a circle is told by its compliance Z there: displacement (u_r, u_phi) = Z (s_r, s_phi) under the stresses
//! s_r cos(n phi) and s_phi sin(n phi); a held circle has Z = 0. With x the amplitudes of the two fields of a layer that fall from its
//! near circle, y of the two that fall from its far one, each scaled to 1 on its own circle, and q = (near radius/far radius)^n, or its
//! inverse, below 1,
//!
//! ```text
//!   near:  N x + q M y = s           far:  q (P - Z Np) x + (Q - Z Mp) y = 0,    so  y = -q R x,  R = (Q - Z Mp)^-1 (P - Z Np)
//!   Z of the near circle = (U - q^2 V R)(N - q^2 M R)^-1,
//! ```
//!
//! N, M, Np, Mp stresses and U, V, P, Q displacements of the fields at the near and the far circle. Nothing overflows: q underflows.
//! One mode n is a number, several abreast are the lanes of one.
//! Lengths are over the layer's own near radius and displacements times its own 2 mu, until they are handed on.

use crate::mechanics::real::Real;

/// A 2 x 2 matrix by rows.
pub type Matrix<T = f64> = [[T; 2]; 2];

/// A layer of one material between two concentric circles.
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    /// Far radius over near radius; above 1 where the layer lies around its near circle.
    pub ratio: f64,
    /// |ln| of that.
    depth: f64,
    pub kolosov: f64,
    /// 2 mu, for Young's modulus 1 at the ring.
    pub twice_shear_modulus: f64,
}

/// Fields of mode n at a radius, their powers r^n or r^-n taken out: radial and hoop displacement times 2 mu, radial and shear stress.
#[derive(Clone, Copy, Debug)]
pub struct Fields<T> {
    pub displacements: Matrix<T>,
    pub stresses: Matrix<T>,
}

impl<T: Real> Fields<T> {
    /// Of the stress functions r^(n+2), r^n and r^(2-n), r^-n, n >= 2.
    #[inline(always)]
    fn rising_and_falling(kappa: f64, n: T, r: f64) -> [Fields<T>; 2] {
        let number = T::from_f64;
        let (one, two, kappa) = (number(1.0), number(2.0), number(kappa));
        let (radius, over_radius, over_square) = (number(r), n * number(1.0 / r), number(1.0 / (r * r)));
        let (below, above) = (n * (n - one), n * (n + one));
        let (below_over, above_over) = (below * over_square, above * over_square);
        [
            Fields {
                displacements: [
                    [(kappa - n - one) * radius, -over_radius],
                    [(kappa + n + one) * radius, over_radius],
                ],
                stresses: [[-(n + one) * (n - two), -below_over], [above, below_over]],
            },
            Fields {
                displacements: [
                    [(kappa + n - one) * radius, over_radius],
                    [(n - one - kappa) * radius, over_radius],
                ],
                stresses: [[-(n - one) * (n + two), -above_over], [-below, -above_over]],
            },
        ]
    }

    /// Displacements that are left where what lies beyond yields by Z under the stresses.
    #[inline(always)]
    fn less(&self, beyond: Matrix<T>) -> Matrix<T> {
        less(self.displacements, T::from_f64(1.0), product(beyond, self.stresses))
    }
}

/// Mode 1 of a layer: (u_r + u_phi), (u_r - u_phi) of its near circle and s_phi of its far one, in its own units.
struct FirstField {
    sum: f64,
    difference: f64,
    far_shear: f64,
}

impl Layer {
    pub fn new(ratio: f64, kolosov: f64, twice_shear_modulus: f64) -> Layer {
        Layer { ratio, depth: ratio.ln().abs(), kolosov, twice_shear_modulus }
    }

    /// Z of its near circle from that of its far one, mode n >= 2.
    #[inline(always)]
    pub fn compliance<T: Real>(&self, n: T, beyond: Matrix<T>) -> Matrix<T> {
        let q = self.left_of(n);
        let [[near, far], far_circle] = self.fields(n);
        let Fields { mut displacements, mut stresses } = near;
        // Of what is less, nothing is left beside 1; and powers of radii like 1e300 are no numbers.
        if !(T::from_f64(1e-9) - q).is_positive() {
            let reflection = reflection(far_circle, self.own(beyond));
            stresses = less(stresses, q * q, product(far.stresses, reflection));
            displacements = less(displacements, q * q, product(far.displacements, reflection));
        }
        self.handed_on(product(displacements, inverse(stresses)))
    }

    /// The compliance under uniform stress of its near circle from that of its far one, mode 0: u = z s_r. Free of cancellation.
    pub fn uniform_compliance(&self, beyond: f64) -> f64 {
        // s_r = A - B/r^2, 2 mu u = k A r + B/r.
        let k = 0.5 * (self.kolosov - 1.0);
        let (r, z) = (self.ratio, beyond * self.ratio * self.twice_shear_modulus);
        let own = k * (1.0 / r - r) + z * (1.0 + k / r / r);
        own / (k * r + 1.0 / r - z * (1.0 - 1.0 / r / r)) / self.twice_shear_modulus
    }

    /// Mode 1, where the resultant passes from layer to layer: (u_r + u_phi, u_r - u_phi) of the near circle under s_phi and
    /// r (s_r - s_phi)/2, from those of the far one.
    pub fn first_compliance(&self, beyond: Matrix) -> Matrix {
        let beyond = self.own(beyond);
        let [of_shear, of_resultant] =
            [(1.0, 0.0), (0.0, 1.0)].map(|(shear, resultant)| self.first_field(shear, resultant, beyond));
        self.handed_on([[of_shear.sum, of_resultant.sum], [of_shear.difference, of_resultant.difference]])
    }

    /// Mode 1 under a shear stress and a resultant on the near circle; what lies beyond in the layer's own units.
    fn first_field(&self, shear: f64, resultant: f64, [of_sum, of_difference]: Matrix) -> FirstField {
        let (kappa, rho) = (self.kolosov, self.ratio);
        // The resultant per length of the near radius is that of the far one times rho.
        let (sum_of_resultant, difference_of_resultant) = (of_sum[1] / rho, of_difference[1] / rho);
        // Stresses 2 A r + (kappa + 3) L/r - 2 D/r^3 and 2 A r + (1 - kappa) L/r - 2 D/r^3.
        let point = resultant / (kappa + 1.0);
        let excess = 0.5 * ((1.0 - kappa) * point - shear);
        // u_r + u_phi = 2 kappa A r^2 - 2 L + 2 D/r^2 on the far circle, D = A + excess; with A rho^2 in the place of A.
        let square = rho * rho;
        let known = 2.0 * point - 2.0 * excess / square
            + of_sum[0] * ((1.0 - kappa) * point / rho - 2.0 * excess / rho / square)
            + sum_of_resultant * resultant;
        let of_risen =
            2.0 * kappa + 2.0 / square / square - 2.0 * of_sum[0] * (1.0 / rho - 1.0 / rho / square / square);
        let risen = known / of_risen;
        let rising = risen / square;
        let falling = rising + excess;
        let far_shear = 2.0 * risen / rho + (1.0 - kappa) * point / rho - 2.0 * falling / rho / square;
        // u_r - u_phi = -4 A r^2 + 4 kappa L ln r + 2 T there.
        let far_difference = of_difference[0] * far_shear + difference_of_resultant * resultant;
        let translation = far_difference + 4.0 * risen - 4.0 * kappa * point * rho.ln();
        FirstField {
            sum: 2.0 * kappa * rising - 2.0 * point + 2.0 * falling,
            difference: translation - 4.0 * rising,
            far_shear,
        }
    }

    /// Radial and shear stress of its far circle under those of its near one, any mode; what lies beyond as `compliance` takes it, in mode 1 as
    /// `first_compliance`, in mode 0 as `uniform_compliance` in the first place.
    pub fn far_stress(&self, n: usize, [radial, shear]: [f64; 2], beyond: Matrix) -> [f64; 2] {
        let rho = self.ratio;
        let beyond = self.own(beyond);
        match n {
            0 => {
                // s_r = A - B/r^2, 2 mu u = k A r + B/r.
                let (k, z) = (0.5 * (self.kolosov - 1.0), beyond[0][0]);
                let reflected = radial * (z - k * rho) / (k * rho + 1.0 / rho - z + z / rho / rho);
                [radial + reflected * (1.0 - 1.0 / rho / rho), 0.0]
            }
            1 => {
                let resultant = 0.5 * (radial - shear);
                let far_shear = self.first_field(shear, resultant, beyond).far_shear;
                [far_shear + 2.0 * resultant / rho, far_shear]
            }
            _ => {
                let q = self.left_of(n as f64);
                // Powers of radii like 1e300 are no numbers.
                if q < 1e-30 {
                    return [0.0, 0.0];
                }
                let [near_circle, far_circle] = self.fields(n as f64);
                let reflection = reflection(far_circle, beyond);
                let left = |circle: [Fields<f64>; 2], share: f64| {
                    less(circle[0].stresses, share, product(circle[1].stresses, reflection))
                };
                let (near, far) = (left(near_circle, q * q), left(far_circle, 1.0));
                apply(far, apply(inverse(near), [radial, shear])).map(|stress| q * stress)
            }
        }
    }

    /// What is left of a wave of mode n on the far circle of one on the near circle, (near radius/far radius)^n or its inverse.
    #[inline(always)]
    pub fn left_of<T: Real>(&self, n: T) -> T {
        (-T::from_f64(self.depth) * n).exp()
    }

    /// On the near and the far circle: what falls from the near one, and from the far one.
    #[inline(always)]
    pub fn fields<T: Real>(&self, n: T) -> [[Fields<T>; 2]; 2] {
        let [near_rising, near_falling] = Fields::rising_and_falling(self.kolosov, n, 1.0);
        let [far_rising, far_falling] = Fields::rising_and_falling(self.kolosov, n, self.ratio);
        if self.ratio > 1.0 {
            [[near_falling, near_rising], [far_falling, far_rising]]
        } else {
            [[near_rising, near_falling], [far_rising, far_falling]]
        }
    }

    /// What lies beyond the far circle, in the layer's own units: of length its near radius, displacements times 2 mu.
    #[inline(always)]
    pub fn own<T: Real>(&self, beyond: Matrix<T>) -> Matrix<T> {
        scaled(self.ratio * self.twice_shear_modulus, beyond)
    }

    /// Displacements over the near radius, for Young's modulus 1 at the ring.
    #[inline(always)]
    fn handed_on<T: Real>(&self, own: Matrix<T>) -> Matrix<T> {
        scaled(1.0 / self.twice_shear_modulus, own)
    }
}

/// R of the fields on a far circle beyond which there is Z.
#[inline(always)]
pub fn reflection<T: Real>([near, far]: [Fields<T>; 2], beyond: Matrix<T>) -> Matrix<T> {
    product(inverse(far.less(beyond)), near.less(beyond))
}

// These are written out: closures over arrays are not compiled for the vectors.

#[inline(always)]
fn scaled<T: Real>(scale: f64, [[a, b], [c, d]]: Matrix<T>) -> Matrix<T> {
    let scale = T::from_f64(scale);
    [[scale * a, scale * b], [scale * c, scale * d]]
}

/// a - share b.
#[inline(always)]
pub fn less<T: Real>(a: Matrix<T>, share: T, b: Matrix<T>) -> Matrix<T> {
    let row = |i: usize| [a[i][0].minus_product(share, b[i][0]), a[i][1].minus_product(share, b[i][1])];
    [row(0), row(1)]
}

#[inline(always)]
pub fn product<T: Real>(a: Matrix<T>, b: Matrix<T>) -> Matrix<T> {
    let column = |j: usize| apply(a, [b[0][j], b[1][j]]);
    let ([first, third], [second, fourth]) = (column(0), column(1));
    [[first, second], [third, fourth]]
}

#[inline(always)]
pub fn apply<T: Real>(a: Matrix<T>, x: [T; 2]) -> [T; 2] {
    [a[0][0] * x[0] + a[0][1] * x[1], a[1][0] * x[0] + a[1][1] * x[1]]
}

#[inline(always)]
pub fn inverse<T: Real>([[a, b], [c, d]]: Matrix<T>) -> Matrix<T> {
    let share = T::from_f64(1.0) / (a * d - b * c);
    [[share * d, -share * b], [-share * c, share * a]]
}
