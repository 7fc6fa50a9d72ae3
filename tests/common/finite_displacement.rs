//! An elastic ring against a rigid circle at finite displacement and strain, plane strain: bilinear elements in total Lagrangian
//! form, nodes that touch where the ring has come to, Newton. No code of the library.
//!
//! The same mesh with linear elements and the pairing at first touch is what it is compared with, so that the mesh cancels.
//! Lengths over the hole's radius, per unit thickness; half of the ring.

use std::f64::consts::PI;

/// What stress follows from strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Small displacements, Hooke.
    Linear,
    StVenantKirchhoff,
    /// Compressible, with the logarithm of the volume.
    NeoHooke,
}

/// Which of the two bodies yields; the other is rigid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Soft {
    Pin,
    Plate,
}

#[derive(Clone, Copy, Debug)]
pub struct Scene {
    pub soft: Soft,
    /// Of the circle that is held, over the soft body's ring.
    pub fixed_radius_ratio: f64,
    pub poissons_ratio: f64,
    pub clearance: f64,
    pub law: Law,
}

/// Elements around half of the ring and through the wall.
const AROUND: usize = 100;
const THROUGH: usize = 20;

/// Nodes through the wall, fastest.
const LINE: usize = THROUGH + 1;
const UNKNOWNS: usize = 2 * LINE * (AROUND + 1);
const WIDTH: usize = 2 * (LINE + 2);

/// Over E: of the penalty, per length of the ring.
const PENALTY: f64 = 1e4;

type Tensor = [[f64; 2]; 2];

impl Scene {
    /// Forces of the whole joint for E = 1, at rising indentations, each reached from the one before.
    pub fn forces(&self, indentations: &[f64]) -> Vec<f64> {
        let (mut now, mut before) = (vec![0.0; UNKNOWNS], vec![0.0; UNKNOWNS]);
        let nodes = self.nodes();
        let reach = |indentation: &f64| {
            // On from where it was going.
            let guess = now.iter().zip(&before).map(|(now, before)| 2.0 * now - before).collect();
            before = std::mem::replace(&mut now, guess);
            self.solve(&nodes, &mut now, *indentation)
        };
        indentations.iter().map(reach).collect()
    }

    /// The centre of the soft body's ring is the hole's for a plate; a pin touches the hole at the bottom.
    fn nodes(&self) -> Vec<[f64; 2]> {
        let (radius, below) = match self.soft {
            Soft::Pin => (1.0 - self.clearance, self.clearance),
            Soft::Plate => (1.0, 0.0),
        };
        let depth = self.fixed_radius_ratio.ln();
        let node = |index: usize| {
            let (angle, layer) = (PI * (index / LINE) as f64 / AROUND as f64, index % LINE);
            // Finer at the ring.
            let share = (layer as f64 / THROUGH as f64).powf(1.5);
            let r = radius * (depth * share).exp();
            [r * angle.sin(), -r * angle.cos() - below]
        };
        (0..UNKNOWNS / 2).map(node).collect()
    }

    fn solve(&self, nodes: &[[f64; 2]], displacement: &mut [f64], indentation: f64) -> f64 {
        // The held circle of a pin goes down, that of a plate stays and the rigid pin goes down.
        for node in (THROUGH..nodes.len()).step_by(LINE) {
            displacement[2 * node] = 0.0;
            displacement[2 * node + 1] = if self.soft == Soft::Pin { -indentation } else { 0.0 };
        }
        for iteration in 0..120 {
            let mut band = Band::new();
            let mut residual = vec![0.0; UNKNOWNS];
            self.elements(nodes, displacement, &mut band, &mut residual);
            let force = self.contact(nodes, displacement, indentation, &mut band, &mut residual);
            for node in 0..nodes.len() {
                let on_axis = node / LINE == 0 || node / LINE == AROUND;
                for component in 0..2 {
                    if node % LINE == THROUGH || (on_axis && component == 0) {
                        band.hold(2 * node + component);
                        residual[2 * node + component] = 0.0;
                    }
                }
            }
            band.solve(&mut residual);
            let step = residual.iter().fold(0.0, |worst: f64, value| worst.max(value.abs()));
            assert!(step.is_finite());
            // Elements must not turn inside out, and the last node not touch and part for ever.
            let share = (0.02 / step).min(if iteration < 12 { 1.0 } else { 0.6 });
            displacement.iter_mut().zip(&residual).for_each(|(u, step)| *u += share * step);
            if step < 1e-9 {
                return force;
            }
        }
        panic!("Newton's method has not settled: {self:?} at {indentation}");
    }

    fn elements(&self, nodes: &[[f64; 2]], displacement: &[f64], band: &mut Band, residual: &mut [f64]) {
        let gauss = [-1.0, 1.0].map(|sign: f64| sign / 3.0_f64.sqrt());
        for element in 0..AROUND * THROUGH {
            let first = element / THROUGH * LINE + element % THROUGH;
            let corners = [first, first + 1, first + LINE + 1, first + LINE];
            for (x, y) in gauss.iter().flat_map(|x| gauss.iter().map(move |y| (*x, *y))) {
                let local = [
                    [-0.25 * (1.0 - y), -0.25 * (1.0 - x)],
                    [0.25 * (1.0 - y), -0.25 * (1.0 + x)],
                    [0.25 * (1.0 + y), 0.25 * (1.0 + x)],
                    [-0.25 * (1.0 + y), 0.25 * (1.0 - x)],
                ];
                let mut jacobian: Tensor = [[0.0; 2]; 2];
                for (corner, slope) in corners.iter().zip(&local) {
                    for i in 0..2 {
                        for j in 0..2 {
                            jacobian[i][j] += nodes[*corner][i] * slope[j];
                        }
                    }
                }
                let (inverse, determinant) = inverted(&jacobian);
                let weight = determinant.abs();
                let slopes = local.map(|slope| -> [f64; 2] {
                    std::array::from_fn(|j| slope[0] * inverse[0][j] + slope[1] * inverse[1][j])
                });
                let mut gradient: Tensor = [[0.0; 2]; 2];
                for (corner, slope) in corners.iter().zip(&slopes) {
                    for i in 0..2 {
                        for j in 0..2 {
                            gradient[i][j] += displacement[2 * corner + i] * slope[j];
                        }
                    }
                }
                let (stress, tangent) = self.stress(&gradient);
                for (a, of_a) in corners.iter().zip(&slopes) {
                    for i in 0..2 {
                        residual[2 * a + i] -= weight * (stress[i][0] * of_a[0] + stress[i][1] * of_a[1]);
                        for (b, of_b) in corners.iter().zip(&slopes) {
                            for k in 0..2 {
                                let mut value = 0.0;
                                for j in 0..2 {
                                    for l in 0..2 {
                                        value += of_a[j] * tangent[i][j][k][l] * of_b[l];
                                    }
                                }
                                band.add(2 * a + i, 2 * b + k, weight * value);
                            }
                        }
                    }
                }
            }
        }
    }

    /// The first Piola-Kirchhoff stress and its derivative by the gradient of the displacement.
    fn stress(&self, gradient: &Tensor) -> (Tensor, [[Tensor; 2]; 2]) {
        let nu = self.poissons_ratio;
        let (mu, lambda) = (0.5 / (1.0 + nu), nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
        let same = |i: usize, j: usize| f64::from(u8::from(i == j));
        let of = |value: &dyn Fn(usize, usize) -> f64| -> Tensor {
            std::array::from_fn(|i| std::array::from_fn(|j| value(i, j)))
        };
        let all = |value: &dyn Fn(usize, usize, usize, usize) -> f64| -> [[Tensor; 2]; 2] {
            std::array::from_fn(|i| std::array::from_fn(|j| of(&|k, l| value(i, j, k, l))))
        };
        let f = of(&|i, j| gradient[i][j] + same(i, j));
        match self.law {
            Law::Linear => {
                let trace = gradient[0][0] + gradient[1][1];
                (
                    of(&|i, j| lambda * trace * same(i, j) + mu * (gradient[i][j] + gradient[j][i])),
                    all(&|i, j, k, l| {
                        lambda * same(i, j) * same(k, l)
                            + mu * (same(i, k) * same(j, l) + same(i, l) * same(j, k))
                    }),
                )
            }
            Law::StVenantKirchhoff => {
                let strain = of(&|i, j| 0.5 * ((0..2).map(|k| f[k][i] * f[k][j]).sum::<f64>() - same(i, j)));
                let trace = strain[0][0] + strain[1][1];
                let second = of(&|i, j| lambda * trace * same(i, j) + 2.0 * mu * strain[i][j]);
                let left = of(&|i, k| (0..2).map(|m| f[i][m] * f[k][m]).sum());
                (
                    of(&|i, j| (0..2).map(|m| f[i][m] * second[m][j]).sum()),
                    all(&|i, j, k, l| {
                        same(i, k) * second[l][j]
                            + lambda * f[i][j] * f[k][l]
                            + mu * (left[i][k] * same(j, l) + f[i][l] * f[k][j])
                    }),
                )
            }
            Law::NeoHooke => {
                let (inverse, volume) = inverted(&f);
                let g = of(&|i, j| inverse[j][i]);
                let logarithm = volume.ln();
                (
                    of(&|i, j| mu * (f[i][j] - g[i][j]) + lambda * logarithm * g[i][j]),
                    all(&|i, j, k, l| {
                        mu * same(i, k) * same(j, l)
                            + (mu - lambda * logarithm) * g[i][l] * g[k][j]
                            + lambda * g[i][j] * g[k][l]
                    }),
                )
            }
        }
    }

    /// Adds what the rigid circle does to the nodes of the ring; the force of the whole joint.
    fn contact(
        &self,
        nodes: &[[f64; 2]],
        displacement: &[f64],
        indentation: f64,
        band: &mut Band,
        residual: &mut [f64],
    ) -> f64 {
        let mut force = 0.0;
        for line in 0..=AROUND {
            let node = line * LINE;
            let weight = PENALTY * PI / AROUND as f64 * if line == 0 || line == AROUND { 0.5 } else { 1.0 };
            let (start, moved) = (nodes[node], [displacement[2 * node], displacement[2 * node + 1]]);
            let now = [start[0] + moved[0], start[1] + moved[1]];
            // How deep the node is in the rigid body, along what it is pushed, and the curvature of that.
            let (depth, normal, bent) = match (self.law, self.soft) {
                // At first touch, on the ray from the hole's centre and along it.
                (Law::Linear, Soft::Plate) => {
                    let (sine, cosine) = (start[0], -start[1]);
                    let radius = 1.0 - self.clearance;
                    let touched =
                        self.clearance * cosine + (radius * radius - (self.clearance * sine).powi(2)).sqrt();
                    let depth = touched + indentation * cosine - 1.0 - (moved[0] * sine - moved[1] * cosine);
                    (depth, [sine, -cosine], 0.0)
                }
                (Law::Linear, Soft::Pin) => {
                    let length = start[0].hypot(start[1]);
                    let ray = start.map(|x| x / length);
                    (length - 1.0 + moved[0] * ray[0] + moved[1] * ray[1], ray.map(|x| -x), 0.0)
                }
                (_, Soft::Plate) => {
                    let apart = [now[0], now[1] + self.clearance + indentation];
                    let length = apart[0].hypot(apart[1]);
                    (1.0 - self.clearance - length, apart.map(|x| x / length), 1.0 / length)
                }
                (_, Soft::Pin) => {
                    let length = now[0].hypot(now[1]);
                    (length - 1.0, now.map(|x| -x / length), -1.0 / length)
                }
            };
            if depth <= 0.0 {
                continue;
            }
            let push = weight * depth;
            force += 2.0 * push * normal[1].abs();
            let along = [-normal[1], normal[0]];
            for i in 0..2 {
                residual[2 * node + i] += push * normal[i];
                for k in 0..2 {
                    let value = weight * normal[i] * normal[k] - push * bent * along[i] * along[k];
                    band.add(2 * node + i, 2 * node + k, value);
                }
            }
        }
        force
    }
}

fn inverted(tensor: &Tensor) -> (Tensor, f64) {
    let [[a, b], [c, d]] = *tensor;
    let determinant = a * d - b * c;
    ([[d / determinant, -b / determinant], [-c / determinant, a / determinant]], determinant)
}

/// The lower triangle of a symmetric matrix, `[row][column - row + WIDTH]`.
struct Band(Vec<[f64; WIDTH + 1]>);

impl Band {
    fn new() -> Band {
        Band(vec![[0.0; WIDTH + 1]; UNKNOWNS])
    }

    fn add(&mut self, row: usize, column: usize, value: f64) {
        if column <= row {
            self.0[row][column + WIDTH - row] += value;
        }
    }

    fn hold(&mut self, unknown: usize) {
        self.0[unknown] = [0.0; WIDTH + 1];
        self.0[unknown][WIDTH] = 1.0;
        for row in unknown + 1..UNKNOWNS.min(unknown + WIDTH + 1) {
            self.0[row][unknown + WIDTH - row] = 0.0;
        }
    }

    /// By L D L^T, in place.
    fn solve(&mut self, right: &mut [f64]) {
        for row in 0..UNKNOWNS {
            let first = row.saturating_sub(WIDTH);
            for column in first..row {
                let from = first.max(column.saturating_sub(WIDTH));
                let mut value = self.0[row][column + WIDTH - row];
                for k in from..column {
                    value -= self.0[row][k + WIDTH - row] * self.0[column][k + WIDTH - column];
                }
                // L D so far.
                self.0[row][column + WIDTH - row] = value;
            }
            let mut diagonal = self.0[row][WIDTH];
            for column in first..row {
                let value = self.0[row][column + WIDTH - row];
                let lower = value / self.0[column][WIDTH];
                diagonal -= lower * value;
                self.0[row][column + WIDTH - row] = lower;
            }
            self.0[row][WIDTH] = diagonal;
            for column in first..row {
                right[row] -= self.0[row][column + WIDTH - row] * right[column];
            }
        }
        for row in 0..UNKNOWNS {
            right[row] /= self.0[row][WIDTH];
        }
        for row in (0..UNKNOWNS).rev() {
            for column in row.saturating_sub(WIDTH)..row {
                right[column] -= self.0[row][column + WIDTH - row] * right[row];
            }
        }
    }
}
