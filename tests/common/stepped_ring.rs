//! Modes of a ring without any of the library's own mechanics: by stepping through its wall.
//!
//! Lengths over the ring's radius, per unit thickness.

use jointsweep::internals::mechanics::material::Idealization;

/// A ring from radius 1 to `fixed_radius_ratio`, where it is held.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    pub fixed_radius_ratio: f64,
    pub youngs_modulus: f64,
    pub poissons_ratio: f64,
    pub idealization: Idealization,
    /// Other materials beyond the one at the edge, from there on.
    pub beyond: &'static [Beyond],
}

/// A bonded layer from a radius on.
#[derive(Clone, Copy, Debug)]
pub struct Beyond {
    pub radius_ratio: f64,
    pub youngs_modulus: f64,
    pub poissons_ratio: f64,
}

pub type Matrix = [[f64; 4]; 4];

/// Modes beyond this many wall thicknesses do not feel the held side: what is left is below 1e-20.
const DEEP: f64 = 30.0;

impl Ring {
    /// Displacement of the ring's edge away from the other body, over the pressure cos(n phi) that makes it.
    pub fn mode(&self, n: usize) -> f64 {
        let wall = self.beyond.first().map_or(self.fixed_radius_ratio, |first| first.radius_ratio).ln();
        let (shear, lame) = self.lame(self.youngs_modulus, self.poissons_ratio);
        if n as f64 * wall.abs() > DEEP {
            // Flamant's half-plane with the curvature of the edge.
            let (m, side) = (n as f64, wall.signum());
            let kolosov = (lame + 3.0 * shear) / (lame + shear);
            let beta = side * (kolosov - 1.0) / (kolosov + 1.0);
            return (kolosov + 1.0) / (4.0 * shear) * (m + beta) / (m * m - 1.0);
        }
        -wall.signum() * self.compliance(n)[0][0]
    }

    /// u_r and u_theta on the edge over the tractions sigma_r and sigma_r_theta there, cos and sin of n theta taken out.
    pub fn compliance(&self, n: usize) -> [[f64; 2]; 2] {
        // From the held side to the edge, in steps of ln r that are short for the mode; no deeper than it reaches.
        let deepest = DEEP / n.max(1) as f64;
        let depth = |radius_ratio: f64| radius_ratio.ln().clamp(-deepest, deepest);
        // Displacement over traction, 2 by 2.
        let mut compliance = [[0.0; 2]; 2];
        let mut far = depth(self.fixed_radius_ratio);
        let own = Beyond {
            radius_ratio: 1.0,
            youngs_modulus: self.youngs_modulus,
            poissons_ratio: self.poissons_ratio,
        };
        for layer in self.beyond.iter().rev().chain([&own]) {
            let near = depth(layer.radius_ratio);
            let wall = far - near;
            far = near;
            if wall == 0.0 {
                continue;
            }
            let steps = (8.0 * (n as f64 + 2.0) * wall.abs()).ceil().max(4.0);
            let step = exponential(&scaled(&self.generator(n as f64, layer), -wall / steps));
            let block = |rows: usize, columns: usize| -> [[f64; 2]; 2] {
                std::array::from_fn(|i| std::array::from_fn(|j| step[2 * rows + i][2 * columns + j]))
            };
            let (uu, ut, tu, tt) = (block(0, 0), block(0, 1), block(1, 0), block(1, 1));
            for _ in 0..steps as usize {
                let displacement = add(&times(&uu, &compliance), &ut);
                let traction = add(&times(&tu, &compliance), &tt);
                compliance = times(&displacement, &inverse(&traction));
            }
        }
        compliance
    }

    /// Shear modulus and Lame's constant of the plane.
    pub fn lame(&self, e: f64, nu: f64) -> (f64, f64) {
        let (shear, lame) = (e / (2.0 * (1.0 + nu)), e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
        match self.idealization {
            Idealization::PlaneStrain => (shear, lame),
            Idealization::PlaneStress => (shear, 2.0 * lame * shear / (lame + 2.0 * shear)),
        }
    }

    /// d/d(ln r) of (u_r, u_theta, r sigma_r, r sigma_r_theta), cos and sin of n phi taken out: Hooke's law and equilibrium.
    pub fn generator(&self, n: f64, layer: &Beyond) -> Matrix {
        let (shear, lame) = self.lame(layer.youngs_modulus, layer.poissons_ratio);
        let stiff = lame + 2.0 * shear;
        let hoop = 4.0 * shear * (lame + shear) / stiff;
        let share = lame / stiff;
        [
            [-share, -n * share, 1.0 / stiff, 0.0],
            [n, 1.0, 0.0, 1.0 / shear],
            [hoop, n * hoop, share, -n],
            [n * hoop, n * n * hoop, n * share, -1.0],
        ]
    }
}

pub fn exponential(matrix: &Matrix) -> Matrix {
    let product = |a: &Matrix, b: &Matrix| -> Matrix {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
    };
    let mut term: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let mut sum = term;
    for k in 1..30 {
        term = scaled(&product(&term, matrix), 1.0 / f64::from(k));
        sum = std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j] + term[i][j]));
    }
    sum
}

pub fn scaled(matrix: &Matrix, factor: f64) -> Matrix {
    matrix.map(|row| row.map(|value| factor * value))
}

fn times(a: &[[f64; 2]; 2], b: &[[f64; 2]; 2]) -> [[f64; 2]; 2] {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

fn add(a: &[[f64; 2]; 2], b: &[[f64; 2]; 2]) -> [[f64; 2]; 2] {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + b[i][j]))
}

fn inverse([[a, b], [c, d]]: &[[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let determinant = a * d - b * c;
    [[d / determinant, -b / determinant], [-c / determinant, a / determinant]]
}
