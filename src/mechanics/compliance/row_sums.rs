//! Sums of rows with weights, in single precision.

use pulp::{Arch, Simd, WithSimd};

/// Rows of one length.
#[derive(Clone, Debug)]
pub struct Rows {
    /// Each as long as whole registers.
    values: Vec<f32>,
    length: usize,
    stride: usize,
    /// The greatest number of each.
    sizes: Vec<f32>,
}

/// Numbers of the widest register.
pub const REGISTER: usize = 16;

impl Rows {
    pub fn new(rows: &[Vec<f64>]) -> Rows {
        let length = rows.first().map_or(0, Vec::len);
        let stride = length.next_multiple_of(REGISTER);
        let mut values = vec![0.0; rows.len() * stride];
        for (to, row) in values.chunks_exact_mut(stride.max(1)).zip(rows) {
            to.iter_mut().zip(row).for_each(|(to, value)| *to = *value as f32);
        }
        let size = |row: &Vec<f64>| row.iter().fold(0.0, |most: f32, value| most.max(value.abs() as f32));
        Rows { values, length, stride, sizes: rows.iter().map(size).collect() }
    }

    /// All numbers, row by row, each row `stride` after the one before.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The greatest number of each row.
    pub fn sizes(&self) -> &[f32] {
        &self.sizes
    }

    /// The sum of the first rows, as many as there are weights, times these and a scale, but for those that add less than a share of what
    /// the first one adds.
    pub fn sum(&self, weights: &[f32], negligible: f32, scale: f64, sum: &mut Vec<f64>) {
        debug_assert!(weights.len() <= self.sizes.len());
        // All of it is overwritten.
        sum.resize(self.stride, 0.0);
        Arch::new().dispatch(Weighted { rows: self, weights, negligible, scale, sum });
        sum.truncate(self.length);
    }
}

struct Weighted<'a> {
    rows: &'a Rows,
    weights: &'a [f32],
    negligible: f32,
    scale: f64,
    sum: &'a mut [f64],
}

/// Registers that are summed side by side, so that additions do not wait for each other. A compliance to 6 trial pressures at 16
/// nodes, of which there are most, is a multiple of it.
const ABREAST: usize = 7;

/// The same of what is left, of amplitudes all.
const FEWER: usize = 2;

/// The most rows that are summed at a time.
const TOGETHER: usize = 256;

impl WithSimd for Weighted<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let (Rows { stride, sizes, .. }, weights) = (self.rows, self.weights);
        let size = |row: usize| weights[row].abs() * sizes[row];
        let least = if weights.is_empty() { 0.0 } else { self.negligible * size(0) };
        let mut kept = [(0_u32, 0.0_f32); TOGETHER];
        for first in (0..weights.len()).step_by(TOGETHER) {
            // Written whether it is kept or not: nothing is to be foretold.
            let mut count = 0;
            for row in first..weights.len().min(first + TOGETHER) {
                kept[count] = ((row * stride) as u32, weights[row]);
                count += usize::from(size(row) > least);
            }
            let (kept, is_first) = (&kept[..count], first == 0);
            let mut from = 0;
            while from + ABREAST * S::F32_LANES <= *stride {
                self.block::<S, ABREAST>(simd, from, kept, is_first);
                from += ABREAST * S::F32_LANES;
            }
            while from + FEWER * S::F32_LANES <= *stride {
                self.block::<S, FEWER>(simd, from, kept, is_first);
                from += FEWER * S::F32_LANES;
            }
            while from < *stride {
                self.block::<S, 1>(simd, from, kept, is_first);
                from += S::F32_LANES;
            }
        }
    }
}

impl Weighted<'_> {
    #[inline(always)]
    fn block<S: Simd, const COUNT: usize>(
        &mut self,
        simd: S,
        from: usize,
        kept: &[(u32, f32)],
        is_first: bool,
    ) {
        let length = COUNT * S::F32_LANES;
        let mut registers = [simd.splat_f32s(0.0); COUNT];
        for (row, weight) in kept {
            let (values, _) = S::as_simd_f32s(&self.rows.values[*row as usize + from..][..length]);
            let weight = simd.splat_f32s(*weight);
            for place in 0..COUNT {
                registers[place] = simd.mul_add_e_f32s(weight, values[place], registers[place]);
            }
        }
        let mut own = [0.0_f32; ABREAST * REGISTER];
        S::as_mut_simd_f32s(&mut own[..length]).0.copy_from_slice(&registers);
        for (sum, own) in self.sum[from..from + length].iter_mut().zip(&own) {
            let before = if is_first { 0.0 } else { *sum };
            *sum = before + self.scale * f64::from(*own);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of any length and count, against a plain sum; what is left out is below its share.
    #[test]
    fn sums_are_those_of_their_rows() {
        let mut sum = Vec::new();
        for (count, length) in [(1, 1), (5, 8), (66, 336), (300, 505)] {
            let row = |i: usize| (0..length).map(|j| (i as f64 + 0.1 * j as f64).sin()).collect::<Vec<f64>>();
            let rows: Vec<Vec<f64>> = (0..count).map(row).collect();
            let weights: Vec<f32> = (0..count).map(|i| 0.9_f32.powi(i as i32)).collect();
            for negligible in [0.0, 1e-2] {
                // Rows behind them have no weight.
                let more = [&rows[..], &[vec![7.0; length]]].concat();
                Rows::new(&more).sum(&weights, negligible, 0.5, &mut sum);
                assert_eq!(sum.len(), length);
                let left_out = weights.iter().filter(|weight| **weight < negligible).sum::<f32>();
                for (place, sum) in sum.iter().enumerate() {
                    let plain: f64 =
                        rows.iter().zip(&weights).map(|(row, w)| row[place] * f64::from(*w)).sum();
                    let error = (2.0 * sum - plain).abs();
                    assert!(error < 1e-5 + 1.1 * f64::from(left_out), "{count} {length}: {error}");
                    assert!(negligible > 0.0 || error < 1e-5);
                }
            }
        }
    }
}
