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
const REGISTER: usize = 16;

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

    /// Sums of the first rows, as many as there are weights, times these and a scale, but for those that add less than a share of what the
    /// first one adds. Each comes to the bits it has alone: rows are read once for as many sums as there are registers for.
    pub fn sums(&self, negligible: f32, sums: &mut [WeightedSum]) {
        for own in &mut *sums {
            debug_assert!(own.weights.len() <= self.sizes.len());
            // All of it is overwritten.
            own.sum.resize(self.stride, 0.0);
        }
        Arch::new().dispatch(Weighted { rows: self, negligible, sums });
        for own in sums {
            own.sum.truncate(self.length);
        }
    }
}

/// One sum of rows.
pub struct WeightedSum<'a> {
    /// Of the first rows.
    pub weights: &'a [f32],
    pub scale: f64,
    /// What was there is overwritten.
    pub sum: &'a mut Vec<f64>,
}

struct Weighted<'a, 'b> {
    rows: &'a Rows,
    negligible: f32,
    sums: &'a mut [WeightedSum<'b>],
}

/// Registers that are summed side by side, so that additions do not wait for each other. A compliance to 6 trial pressures at 16
/// nodes, of which there are most, is a multiple of it.
const ABREAST: usize = 7;

/// The same of what is left, of amplitudes all.
const FEWER: usize = 2;

/// The most rows that are summed at a time.
const TOGETHER: usize = 256;

/// Sums that are made abreast where there are 32 registers, and where there are 16.
pub const MANY: usize = 4;
const SOME: usize = 2;

impl WithSimd for Weighted<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Weighted { rows, negligible, mut sums } = self;
        while !sums.is_empty() {
            let abreast = match sums.len() {
                MANY.. if S::F32_LANES == REGISTER => MANY,
                SOME.. => SOME,
                _ => 1,
            };
            let (own, others) = sums.split_at_mut(abreast);
            match abreast {
                MANY => rows.run::<S, MANY>(simd, negligible, own),
                SOME => rows.run::<S, SOME>(simd, negligible, own),
                _ => rows.run::<S, 1>(simd, negligible, own),
            }
            sums = others;
        }
    }
}

impl Rows {
    /// Of so many sums.
    #[inline(always)]
    fn run<S: Simd, const SUMS: usize>(&self, simd: S, negligible: f32, sums: &mut [WeightedSum]) {
        let Rows { stride, sizes, .. } = self;
        let mut least = [0.0_f32; SUMS];
        let mut count = 0;
        for (least, own) in least.iter_mut().zip(&*sums) {
            if let Some(weight) = own.weights.first() {
                *least = negligible * weight.abs() * sizes[0];
            }
            count = own.weights.len().max(count);
        }
        let mut kept = [(0_u32, [0.0_f32; SUMS]); TOGETHER];
        for first in (0..count).step_by(TOGETHER) {
            // Written whether it is kept or not: nothing is to be foretold. A row that is kept for another sum weighs nothing.
            let mut kept_count = 0;
            for row in first..count.min(first + TOGETHER) {
                let (mut weights, mut is_kept) = ([0.0_f32; SUMS], false);
                for sum in 0..SUMS {
                    let weight = sums[sum].weights.get(row).copied().unwrap_or(0.0);
                    let is_own = weight.abs() * sizes[row] > least[sum];
                    weights[sum] = if is_own { weight } else { 0.0 };
                    is_kept |= is_own;
                }
                kept[kept_count] = ((row * stride) as u32, weights);
                kept_count += usize::from(is_kept);
            }
            let (kept, is_first) = (&kept[..kept_count], first == 0);
            let mut from = 0;
            while from + ABREAST * S::F32_LANES <= *stride {
                self.block::<S, SUMS, ABREAST>(simd, from, kept, is_first, sums);
                from += ABREAST * S::F32_LANES;
            }
            while from + FEWER * S::F32_LANES <= *stride {
                self.block::<S, SUMS, FEWER>(simd, from, kept, is_first, sums);
                from += FEWER * S::F32_LANES;
            }
            while from < *stride {
                self.block::<S, SUMS, 1>(simd, from, kept, is_first, sums);
                from += S::F32_LANES;
            }
        }
    }

    #[inline(always)]
    fn block<S: Simd, const SUMS: usize, const COUNT: usize>(
        &self,
        simd: S,
        from: usize,
        kept: &[(u32, [f32; SUMS])],
        is_first: bool,
        sums: &mut [WeightedSum],
    ) {
        let length = COUNT * S::F32_LANES;
        let mut registers = [[simd.splat_f32s(0.0); COUNT]; SUMS];
        for (row, weights) in kept {
            let (values, _) = S::as_simd_f32s(&self.values[*row as usize + from..][..length]);
            for place in 0..COUNT {
                for sum in 0..SUMS {
                    let weight = simd.splat_f32s(weights[sum]);
                    registers[sum][place] = simd.mul_add_e_f32s(weight, values[place], registers[sum][place]);
                }
            }
        }
        for (registers, WeightedSum { scale, sum, .. }) in registers.iter().zip(sums) {
            let mut own = [0.0_f32; ABREAST * REGISTER];
            S::as_mut_simd_f32s(&mut own[..length]).0.copy_from_slice(registers);
            for (sum, own) in sum[from..from + length].iter_mut().zip(&own) {
                let before = if is_first { 0.0 } else { *sum };
                *sum = before + *scale * f64::from(*own);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum_alone(rows: &Rows, weights: &[f32], negligible: f32, sum: &mut Vec<f64>) {
        rows.sums(negligible, &mut [WeightedSum { weights, scale: 0.5, sum }]);
    }

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
                sum_alone(&Rows::new(&more), &weights, negligible, &mut sum);
                assert_eq!(sum.len(), length);
                let left_out = weights.iter().filter(|weight| **weight < negligible).sum::<f32>();
                // Abreast with others that keep other rows, to the bit.
                let others: Vec<Vec<f32>> = (1..7)
                    .map(|k| weights[..count - count / (k + 1)].iter().map(|w| w.powi(k as i32)).collect())
                    .collect();
                let all: Vec<&[f32]> = others.iter().map(Vec::as_slice).chain([&weights[..]]).collect();
                let mut together = vec![vec![5.0; 3]; all.len()];
                let mut sums: Vec<WeightedSum> = (all.iter().zip(&mut together))
                    .map(|(weights, sum)| WeightedSum { weights, scale: 0.5, sum })
                    .collect();
                let rows_and_more = Rows::new(&more);
                rows_and_more.sums(negligible, &mut sums);
                let mut alone = Vec::new();
                for (weights, together) in all.iter().zip(&together) {
                    sum_alone(&rows_and_more, weights, negligible, &mut alone);
                    assert_eq!(*together, alone, "{count} rows of {length}");
                }
                assert_eq!(together[6], sum);
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
