//! Sums over works of functions on functions: what they add to the compliance of a joint.

use std::f64::consts::{FRAC_1_PI, FRAC_2_PI};

use super::arc::{packed, packed_count};
use super::lane_work::{TermWork, in_lanes_with_terms};
use super::second_order::{self, Bands};
use super::trial_moments::Moments;
use crate::mechanics::real::{LANES, Lanes, Real};

/// Works of functions on functions.
pub enum Works<'a> {
    /// Of modes that do none on others.
    Alone(&'a [f64]),
    /// Of modes that do some on the next ones, times a factor.
    Bands(&'a [Bands], f64),
    /// Of all modes on each other, packed.
    Packed(&'a [f64]),
}

impl Works<'_> {
    /// How many functions do work, of those whose moments there are.
    #[inline(always)]
    fn count(&self, most: usize) -> usize {
        match self {
            Works::Alone(works) => works.len().min(most),
            Works::Bands(bands, _) => bands.len().min(most),
            Works::Packed(_) => most,
        }
    }

    /// -share times the sum over n of W_mn M_nk.
    #[inline(always)]
    fn on<const WIDTH: usize, const TERMS: usize>(
        &self,
        m: usize,
        share: f64,
        moments: &[[[f64; LANES]; TERMS]],
        to: &mut [[f64; LANES]; TERMS],
    ) {
        let mut sums = [Lanes::<WIDTH>::zero(); TERMS];
        match *self {
            Works::Alone(works) => less(&mut sums, share * FRAC_2_PI * works[m], &moments[m]),
            Works::Bands(bands, scale) => {
                let count = self.count(moments.len());
                for (back, band) in bands[m].iter().enumerate().take(m + 1) {
                    let factor = if back == 0 { FRAC_2_PI } else { FRAC_1_PI };
                    less(&mut sums, share * factor * scale * band, &moments[m - back]);
                }
                for n in m + 1..count.min(m + second_order::WIDTH) {
                    less(&mut sums, share * FRAC_1_PI * scale * bands[n][n - m], &moments[n]);
                }
            }
            Works::Packed(works) => {
                let (before, behind) = moments.split_at(m + 1);
                for (work, moments) in works[packed(m, 0)..].iter().zip(before) {
                    less(&mut sums, share * work, moments);
                }
                for (n, moments) in (m + 1..).zip(behind) {
                    less(&mut sums, share * works[packed(n, m)], moments);
                }
            }
        }
        for (to, sum) in to.iter_mut().zip(&sums) {
            *to = sum.0;
        }
    }
}

/// Takes as many times the moments off. A function, because closures are not always inlined.
#[inline(always)]
fn less<const WIDTH: usize, const TERMS: usize>(
    sums: &mut [Lanes<WIDTH>; TERMS],
    factor: f64,
    moments: &[[f64; LANES]; TERMS],
) {
    let factor = Lanes::from_f64(factor);
    for (sum, moment) in sums.iter_mut().zip(moments) {
        *sum = sum.minus_product(factor, Lanes(*moment));
    }
}

impl Moments {
    /// `values[jk] += share * sum over m, n of M_mj W_mn M_nk`, for so many trial pressures and all arcs. What `room` holds is overwritten.
    pub fn add(
        &self,
        terms: usize,
        works: Works,
        share: f64,
        room: &mut Vec<[f64; LANES]>,
        values: &mut [f64],
    ) {
        in_lanes_with_terms(terms, Add { moments: self, works, share, of_works: room, values });
    }
}

struct Add<'a> {
    moments: &'a Moments,
    works: Works<'a>,
    share: f64,
    /// `[function][k]`, as `Works::on` has them.
    of_works: &'a mut Vec<[f64; LANES]>,
    values: &'a mut [f64],
}

/// Functions that are added together, and columns of a row that are: as many as stay in registers.
const FUNCTIONS: usize = 16;
const COLUMNS: usize = 6;

impl TermWork for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const WIDTH: usize, const TERMS: usize>(self) {
        let Add { moments, works, share, of_works, values } = self;
        let arcs = values.len() / packed_count(TERMS);
        // What is there is overwritten.
        of_works.resize(FUNCTIONS * TERMS, [0.0; LANES]);
        let of_works = of_works.as_chunks_mut::<TERMS>().0;
        for (chunk, moments) in moments.values.chunks_exact(moments.count * TERMS).enumerate() {
            let moments = moments.as_chunks::<TERMS>().0;
            let count = works.count(moments.len());
            for first in (0..count).step_by(FUNCTIONS) {
                let own = &moments[first..count.min(first + FUNCTIONS)];
                for (m, of_works) in (first..).zip(&mut of_works[..own.len()]) {
                    works.on::<WIDTH, TERMS>(m, share, moments, of_works);
                }
                for row in 0..TERMS {
                    for from in (0..=row).step_by(COLUMNS) {
                        let part = RowPart { row, from, arcs, chunk };
                        match (row + 1 - from).min(COLUMNS) {
                            1 => part.add::<WIDTH, TERMS, 1>(own, of_works, values),
                            2 => part.add::<WIDTH, TERMS, 2>(own, of_works, values),
                            3 => part.add::<WIDTH, TERMS, 3>(own, of_works, values),
                            4 => part.add::<WIDTH, TERMS, 4>(own, of_works, values),
                            5 => part.add::<WIDTH, TERMS, 5>(own, of_works, values),
                            _ => part.add::<WIDTH, TERMS, COLUMNS>(own, of_works, values),
                        }
                    }
                }
            }
        }
    }
}

/// Columns of a row, from one on, at as many arcs as there are lanes.
struct RowPart {
    row: usize,
    from: usize,
    arcs: usize,
    chunk: usize,
}

impl RowPart {
    /// Adds the products of moments with what works make of them. The count of columns is told to the compiler, so that their sums stay in registers.
    #[inline(always)]
    fn add<const WIDTH: usize, const TERMS: usize, const COUNT: usize>(
        &self,
        moments: &[[[f64; LANES]; TERMS]],
        of_works: &[[[f64; LANES]; TERMS]],
        values: &mut [f64],
    ) {
        let mut sums = [Lanes::<WIDTH>::zero(); COUNT];
        for (own, other) in moments.iter().zip(of_works) {
            for column in 0..COUNT {
                sums[column] =
                    sums[column].minus_product(Lanes(own[self.row]), Lanes(other[self.from + column]));
            }
        }
        for column in 0..COUNT {
            let at = packed(self.row, self.from + column) * self.arcs + self.chunk * LANES;
            let to = &mut values[at..at + LANES];
            to.copy_from_slice(&(Lanes::<WIDTH>::from_slice(to) + sums[column]).0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::compliance::arc::TERM_CHOICES;

    /// From -0.5 to 0.5, each another one.
    fn number(place: usize) -> f64 {
        (place as f64 * 0.618_033_988_75).fract() - 0.5
    }

    /// W_mn.
    type WorkOf<'a> = &'a dyn Fn(usize, usize) -> f64;

    fn numbers(count: usize) -> Vec<f64> {
        (0..count).map(number).collect()
    }

    /// `values[jk] = share * sum over m, n of M_mj W_mn M_nk`, number by number.
    fn by_the_formula(moments: &Moments, terms: usize, work: WorkOf, share: f64) -> Vec<f64> {
        let chunks = moments.values.len() / moments.count / terms;
        let mut values = Vec::new();
        for (j, k) in (0..terms).flat_map(|j| (0..=j).map(move |k| (j, k))) {
            for (chunk, lane) in (0..chunks).flat_map(|chunk| (0..LANES).map(move |lane| (chunk, lane))) {
                let moment =
                    |m: usize, k: usize| moments.values[(chunk * moments.count + m) * terms + k][lane];
                let of_row = |m: usize| -> f64 {
                    (0..moments.count).map(|n| moment(m, j) * work(m, n) * moment(n, k)).sum()
                };
                values.push(share * (0..moments.count).map(of_row).sum::<f64>());
            }
        }
        values
    }

    #[test]
    fn works_of_all_kinds_are_summed_up() {
        const SHARE: f64 = 0.7;
        const CHUNKS: usize = 3;
        let mut compared = 0;
        for terms in TERM_CHOICES {
            // One, a part of a block, and more than two.
            for count in [1, 3, 2 * FUNCTIONS + 3] {
                let values = (0..CHUNKS * count * terms)
                    .map(|place| std::array::from_fn(|lane| number(place * LANES + lane)))
                    .collect();
                let moments = Moments { values, count };
                let (alone, packed_works) = (numbers(count), numbers(packed_count(count)));
                let bands: Vec<Bands> = numbers(second_order::WIDTH * count).as_chunks().0.to_vec();
                // Of modes and bands there may be fewer.
                let few = &bands[..count.div_ceil(2)];
                let of_alone = |m: usize, n: usize| if m == n { FRAC_2_PI * alone[m] } else { 0.0 };
                let of_bands = |m: usize, n: usize| {
                    let (own, back) = (m.max(n), m.abs_diff(n));
                    let factor = if back == 0 { FRAC_2_PI } else { FRAC_1_PI };
                    let band = few.get(own).and_then(|bands| bands.get(back));
                    band.map_or(0.0, |band| 0.3 * factor * band)
                };
                let of_packed = |m: usize, n: usize| packed_works[packed(m.max(n), m.min(n))];
                let kinds: [(Works, WorkOf); 3] = [
                    (Works::Alone(&alone), &of_alone),
                    (Works::Bands(few, 0.3), &of_bands),
                    (Works::Packed(&packed_works), &of_packed),
                ];
                for (works, work) in kinds {
                    let expected = by_the_formula(&moments, terms, work, SHARE);
                    let before = numbers(expected.len());
                    let mut values = before.clone();
                    moments.add(terms, works, SHARE, &mut Vec::new(), &mut values);
                    for ((found, expected), before) in values.iter().zip(&expected).zip(&before) {
                        let rounding = 1e-14 * count as f64 * (1.0 + count as f64);
                        assert!(
                            (found - before - expected).abs() < rounding,
                            "{terms} {count}: {found} {expected}"
                        );
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared > 10_000);
    }
}
