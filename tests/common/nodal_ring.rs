//! Contact of two concentric bodies without any of the library's own mechanics: their modes (`stepped_ring`), pressure piece
//! by piece on panels of the arc, which pieces press by elimination.
//!
//! Lengths over the hole's radius; whole joint, per unit thickness.

use super::stepped_ring::Ring;

/// Force and contact half angle (rad) under an offset of the centres, e = dR + delta.
#[derive(Clone, Copy, Debug)]
pub struct NodalState {
    pub force: f64,
    pub half_angle: f64,
}

/// The joint of a pin and a plate with a radial clearance, its centres apart by `offset`, on so many panels of the half arc up
/// to `reach`, which must be wider than the contact.
pub fn nodal_state(bodies: [Ring; 2], clearance: f64, offset: f64, reach: f64, panels: usize) -> NodalState {
    let width = reach / panels as f64;
    let influence = influence(bodies, width, 2 * panels);
    let gap: Vec<f64> = (0..panels).map(|i| offset * ((i as f64 + 0.5) * width).cos() - clearance).collect();
    // Symmetry: the panel beyond the load line presses as well.
    let entry = |i: usize, j: usize| influence[i.abs_diff(j)] + influence[i + j + 1];
    let mut pressing = gap[1..].iter().take_while(|gap| **gap > 0.0).count();
    loop {
        let rows: Vec<Vec<f64>> =
            (0..pressing).map(|i| (0..pressing).map(|j| entry(i, j)).collect()).collect();
        let pressure = solve(rows, gap[..pressing].to_vec());
        let positive = pressure.iter().take_while(|pressure| **pressure > 0.0).count();
        let is_open = |i: usize| {
            let yielded: f64 = pressure.iter().enumerate().map(|(j, pressure)| entry(i, j) * pressure).sum();
            yielded > gap[i]
        };
        if positive < pressing {
            pressing = positive;
        } else if !is_open(pressing) {
            pressing += 1;
            assert!(pressing < panels, "the contact is wider than {reach} rad");
        } else {
            let force = |(i, pressure): (usize, &f64)| pressure * ((i as f64 + 0.5) * width).cos();
            return NodalState {
                force: 2.0 * width * pressure.iter().enumerate().map(force).sum::<f64>(),
                half_angle: pressing as f64 * width,
            };
        }
    }
}

/// What a unit pressure on one panel displaces the middle of those 0, 1, ... panels away, both bodies together.
fn influence(bodies: [Ring; 2], width: f64, count: usize) -> Vec<f64> {
    let highest = (100.0 / width) as usize;
    let mode = |n: usize| bodies.iter().map(|body| body.mode(n)).sum::<f64>();
    let weights: Vec<f64> = (0..=highest)
        .map(|n| match n {
            0 => mode(0) * 0.5 * width,
            _ => mode(n) * 2.0 / n as f64 * (0.5 * n as f64 * width).sin(),
        })
        .collect();
    let at = |place: usize| {
        // Clenshaw's sum of the cosines.
        let turn = 2.0 * (place as f64 * width).cos();
        let (mut sum, mut before) = (0.0, 0.0);
        for weight in weights[1..].iter().rev() {
            (sum, before) = (weight + turn * sum - before, sum);
        }
        (weights[0] + 0.5 * turn * sum - before) / std::f64::consts::PI
    };
    (0..count).map(at).collect()
}

/// Gauss, without pivoting: the matrices are positive definite.
fn solve(mut rows: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let count = right.len();
    for pivot in 0..count {
        let (above, below) = rows.split_at_mut(pivot + 1);
        for (offset, row) in below.iter_mut().enumerate() {
            let factor = row[pivot] / above[pivot][pivot];
            for column in pivot..count {
                row[column] -= factor * above[pivot][column];
            }
            right[pivot + 1 + offset] -= factor * right[pivot];
        }
    }
    for row in (0..count).rev() {
        let known: f64 = (row + 1..count).map(|column| rows[row][column] * right[column]).sum();
        right[row] = (right[row] - known) / rows[row][row];
    }
    right
}
