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
//! Lengths are over the layer's own near radius and displacements times its own 2 mu, until they are handed on.

/// A 2 x 2 matrix by rows.
pub type Matrix = [[f64; 2]; 2];

pub const ZERO: Matrix = [[0.0; 2]; 2];

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
pub struct Fields {
    pub displacements: Matrix,
    pub stresses: Matrix,
}

impl Fields {
    /// Of the stress functions r^(n+2), r^n and r^(2-n), r^-n, n >= 2.
    fn rising_and_falling(kappa: f64, n: f64, r: f64) -> [Fields; 2] {
        let square = r * r;
        [
            Fields {
                displacements: [[(kappa - n - 1.0) * r, -n / r], [(kappa + n + 1.0) * r, n / r]],
                stresses: [
                    [-(n + 1.0) * (n - 2.0), -n * (n - 1.0) / square],
                    [n * (n + 1.0), n * (n - 1.0) / square],
                ],
            },
            Fields {
                displacements: [[(kappa + n - 1.0) * r, n / r], [(n - 1.0 - kappa) * r, n / r]],
                stresses: [
                    [-(n - 1.0) * (n + 2.0), -n * (n + 1.0) / square],
                    [-n * (n - 1.0), -n * (n + 1.0) / square],
                ],
            },
        ]
    }

    /// Displacements that are left where what lies beyond yields by Z under the stresses.
    fn less(&self, beyond: Matrix) -> Matrix {
        let yielding = product(beyond, self.stresses);
        std::array::from_fn(|i| std::array::from_fn(|j| self.displacements[i][j] - yielding[i][j]))
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
    pub fn compliance(&self, n: usize, beyond: Matrix) -> Matrix {
        let q = self.left_of(n);
        let [near_circle, far_circle] = self.fields(n);
        let beyond = self.own(beyond);
        let [near, far] = near_circle;
        let mut stresses = near.stresses;
        let mut displacements = near.displacements;
        // Of what is less, nothing is left beside 1; and powers of radii like 1e300 are no numbers.
        if q > 1e-9 {
            let reflection = reflection(far_circle, beyond);
            let square = q * q;
            subtract(&mut stresses, square, product(far.stresses, reflection));
            subtract(&mut displacements, square, product(far.displacements, reflection));
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
                let q = self.left_of(n);
                // Powers of radii like 1e300 are no numbers.
                if q < 1e-30 {
                    return [0.0, 0.0];
                }
                let [near_circle, far_circle] = self.fields(n);
                let reflection = reflection(far_circle, beyond);
                let mut near = near_circle[0].stresses;
                subtract(&mut near, q * q, product(near_circle[1].stresses, reflection));
                let mut far = far_circle[0].stresses;
                subtract(&mut far, 1.0, product(far_circle[1].stresses, reflection));
                apply(far, apply(inverse(near), [radial, shear])).map(|stress| q * stress)
            }
        }
    }

    /// What is left of a wave of mode n on the far circle of one on the near circle, (near radius/far radius)^n or its inverse.
    pub fn left_of(&self, n: usize) -> f64 {
        (-self.depth * n as f64).exp()
    }

    /// On the near and the far circle: what falls from the near one, and from the far one.
    pub fn fields(&self, n: usize) -> [[Fields; 2]; 2] {
        [1.0, self.ratio].map(|r| {
            let [rising, falling] = Fields::rising_and_falling(self.kolosov, n as f64, r);
            if self.ratio > 1.0 { [falling, rising] } else { [rising, falling] }
        })
    }

    /// What lies beyond the far circle, in the layer's own units: of length its near radius, displacements times 2 mu.
    fn own(&self, beyond: Matrix) -> Matrix {
        beyond.map(|row| row.map(|value| value * self.ratio * self.twice_shear_modulus))
    }

    /// Displacements over the near radius, for Young's modulus 1 at the ring.
    fn handed_on(&self, own: Matrix) -> Matrix {
        own.map(|row| row.map(|value| value / self.twice_shear_modulus))
    }
}

/// R of the fields on a far circle beyond which there is Z.
pub fn reflection([near, far]: [Fields; 2], beyond: Matrix) -> Matrix {
    product(inverse(far.less(beyond)), near.less(beyond))
}

pub fn subtract(from: &mut Matrix, scale: f64, value: Matrix) {
    for (from, value) in from.as_flattened_mut().iter_mut().zip(value.as_flattened()) {
        *from -= scale * value;
    }
}

pub fn product(a: Matrix, b: Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

pub fn apply(a: Matrix, x: [f64; 2]) -> [f64; 2] {
    a.map(|row| row[0] * x[0] + row[1] * x[1])
}

pub fn inverse([[a, b], [c, d]]: Matrix) -> Matrix {
    let determinant = a * d - b * c;
    [[d / determinant, -b / determinant], [-c / determinant, a / determinant]]
}
