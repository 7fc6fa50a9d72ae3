//! Trial pressures on arcs of several sizes: all that does not depend on the bodies, and the compliances of bodies to them.

use std::borrow::Cow;
use std::collections::HashMap;
use std::f64::consts::{FRAC_1_PI, FRAC_2_PI, FRAC_PI_2};

use pulp::{Arch, Simd, WithSimd};

use super::BodyCompliance;
use super::arc::{ArcMap, ContactArc, MAX_TERMS, cosines, packed, packed_count};
use super::infinite_body::InfiniteKernels;
use super::ring_modes::RingModes;
use super::second_order::{self, Bands};
use super::sine_arcs;
use super::thin_wall::bed_matrix;
use crate::mechanics::compliance::lane_work::{LaneWork, TermWork, in_lanes, in_lanes_with_terms};
use crate::mechanics::real::{LANES, Lanes, Real};

/// Trial pressures on arcs.
#[derive(Clone)]
pub struct PressureSpace {
    pub terms: usize,
    /// As many as a multiple of `LANES`.
    pub arcs: Vec<ContactArc>,
    kernels: InfiniteKernels,
    /// The Galerkin matrix of a bed, `[packed entry][arc]`, which arcs of sines have none of.
    bed: Vec<f64>,
    /// Integrals of p_k cos(n phi), n = 0, 1, ...
    modes: Moments,
    ring_modes: HashMap<RingModes, Moments>,
    /// 2 cos(pi i/(2 terms)), i = 1 ... 2 terms: between the zeros of the highest trial pressure, the last where they all peak.
    pub turns: Vec<f64>,
}

/// Integrals of the trial pressures over functions of the angle, `[arc / LANES][function][k]`, an arc a lane.
#[derive(Clone, Default)]
struct Moments {
    values: Vec<[f64; LANES]>,
    count: usize,
}

/// The compliance of a joint to the trial pressures of a space, or the part of it that a body has.
#[derive(Clone, Debug)]
pub struct JointCompliance<'a> {
    /// c of both: the part -pi/2 c ln b of entry (0, 0) is left out of `values`.
    pub even: f64,
    /// That of beds.
    pub bed: f64,
    /// `[packed entry][arc]`.
    pub values: Cow<'a, [f64]>,
}

impl PressureSpace {
    /// `terms` trial pressures on arcs of one map, as many as a multiple of `LANES`.
    pub fn new(terms: usize, arcs: Vec<ContactArc>) -> PressureSpace {
        let count = arcs.len();
        let map = arcs.first().map_or(ArcMap::Tangent, |arc| arc.map);
        let kernels = match map {
            ArcMap::Tangent => InfiniteKernels::new(&arcs, terms),
            ArcMap::Sine => sine_arcs::infinite_kernels(&arcs, terms),
        };
        let mut bed = Vec::new();
        if map == ArcMap::Tangent {
            bed.resize(packed_count(terms) * count, 0.0);
            for (place, arc) in arcs.iter().enumerate() {
                for (entry, value) in bed_matrix(arc.b, terms).into_iter().enumerate() {
                    bed[entry * count + place] = value;
                }
            }
        }
        PressureSpace {
            terms,
            arcs,
            kernels,
            bed,
            modes: Moments::default(),
            ring_modes: HashMap::new(),
            turns: (1..=2 * terms).map(|i| 2.0 * (FRAC_PI_2 * i as f64 / terms as f64).cos()).collect(),
        }
    }

    /// Makes what the sum over so many modes of a concentric body needs, in whole blocks: a few modes more are no work.
    pub fn prepare_modes(&mut self, count: usize) {
        let count = count.next_multiple_of(BLOCK);
        if count > self.modes.count {
            self.modes = self.moments(count, |moments, arc, first| {
                Arch::new().dispatch(ModeMoments { arc, terms: self.terms, first, moments });
            });
        }
    }

    /// Makes what bodies in these modes need.
    pub fn prepare_ring_modes(&mut self, modes: &RingModes) {
        if !self.ring_modes.contains_key(modes) {
            let own = self.moments(modes.count, |moments, arc, first| {
                if first == 0 {
                    modes.moments(arc, self.terms, moments);
                }
            });
            self.ring_modes.insert(*modes, own);
        }
    }

    /// Makes what a body needs.
    pub fn prepare(&mut self, body: &BodyCompliance) {
        self.prepare_modes(body.mode_count());
        if let Some((modes, _)) = body.boundary.ring_modes() {
            self.prepare_ring_modes(modes);
        }
    }

    /// For each arc and each block of functions, from `first` on, `fill` adds their integrals: `[function in block][k]`.
    fn moments(&self, count: usize, fill: impl Fn(&mut [f64], &ContactArc, usize)) -> Moments {
        let terms = self.terms;
        let mut values = vec![[0.0; LANES]; count * terms * self.arcs.len() / LANES];
        let mut block = Vec::new();
        for (place, arc) in self.arcs.iter().enumerate() {
            let own = &mut values[place / LANES * count * terms..][..count * terms];
            for (number, to) in own.chunks_mut(BLOCK * terms).enumerate() {
                block.clear();
                block.resize(BLOCK * terms, 0.0);
                fill(&mut block, arc, number * BLOCK);
                to.iter_mut().zip(&block).for_each(|(to, value)| to[place % LANES] = *value);
            }
        }
        Moments { values, count }
    }

    /// The compliance of bodies with their shares: 1/E of one body of a joint, the negative for a difference; of pins under such a
    /// tilt. Every body was prepared for.
    pub fn joint(&self, bodies: &[(&BodyCompliance, f64)], tilt: Tilt) -> JointCompliance<'static> {
        let mut room = ComplianceRoom::default();
        let JointCompliance { even, bed, .. } = self.joint_in(bodies, tilt, &mut room);
        JointCompliance { even, bed, values: room.values.into() }
    }

    /// The same in the room of another one, which is overwritten.
    pub fn joint_in<'a>(
        &self,
        bodies: &[(&BodyCompliance, f64)],
        tilt: Tilt,
        ComplianceRoom { values, of_ring, of_works }: &'a mut ComplianceRoom,
    ) -> JointCompliance<'a> {
        let sum = |of: fn(&BodyCompliance) -> f64| bodies.iter().map(|(body, share)| share * of(body)).sum();
        let (even, odd, bed): (f64, f64, f64) =
            (sum(|body| body.even), sum(|body| body.odd), sum(|body| body.bed));
        values.resize(self.kernels.even.len(), 0.0);
        in_lanes(OfInfinite { space: self, even, odd, bed, tilt, values });
        for (body, share) in bodies {
            let bands;
            let mut second = if tilt.second == 0.0 { &[][..] } else { &body.second };
            let mut parts = [None, None, None];
            if let Some([normal, along]) = body.boundary.modes() {
                let works = if tilt == Tilt::NONE || along.is_empty() {
                    Works::Alone(normal)
                } else {
                    bands = all_bands(normal, along, std::mem::take(&mut second), tilt);
                    Works::Bands(&bands, 1.0)
                };
                parts[0] = Some((&self.modes, works));
            }
            if let Some((modes, works)) = body.boundary.ring_modes() {
                let (normal, added) = works.split_at(packed_count(modes.count));
                let works = if tilt.first == 0.0 {
                    normal
                } else {
                    of_ring.clear();
                    of_ring.extend(normal.iter().zip(added).map(|(own, added)| own + tilt.first * added));
                    &of_ring[..]
                };
                parts[1] = Some((&self.ring_modes[modes], Works::Packed(works)));
            }
            if !second.is_empty() {
                parts[2] = Some((&self.modes, Works::Bands(second, tilt.second)));
            }
            for (moments, works) in parts.into_iter().flatten() {
                in_lanes_with_terms(self.terms, Add { moments, works, share: *share, of_works, values });
            }
        }
        JointCompliance { even, bed, values: values[..].into() }
    }
}

/// What a compliance takes, to be taken again by that of another joint.
#[derive(Default)]
pub struct ComplianceRoom {
    values: Vec<f64>,
    /// Works of ring modes under a tilt, packed.
    of_ring: Vec<f64>,
    /// `[function][k]`, as `Works::on` has them.
    of_works: Vec<[f64; LANES]>,
}

/// What infinite bodies and beds add to the compliance of a joint, at all entries and arcs.
struct OfInfinite<'a> {
    space: &'a PressureSpace,
    even: f64,
    odd: f64,
    bed: f64,
    tilt: Tilt,
    /// What was there is overwritten.
    values: &'a mut [f64],
}

impl LaneWork for OfInfinite<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const WIDTH: usize>(self) {
        let OfInfinite { space: PressureSpace { kernels, bed: of_bed, .. }, even, odd, bed, tilt, values } =
            self;
        for (chunk, to) in values.chunks_exact_mut(LANES).enumerate() {
            let at = chunk * LANES;
            let mut value = pair::<WIDTH>((even, &kernels.even), (odd, &kernels.odd), at);
            if tilt.first != 0.0 {
                let (even, odd) = (tilt.first * even, tilt.first * odd);
                value += pair::<WIDTH>((even, &kernels.tilted_even), (odd, &kernels.tilted_odd), at);
            }
            if tilt.second != 0.0 {
                let (even, odd) = (tilt.second * even, tilt.second * odd);
                value += pair::<WIDTH>((even, &kernels.second_even), (odd, &kernels.second_odd), at);
            }
            if bed != 0.0 {
                value += Lanes::from_f64(bed) * Lanes::from_slice(&of_bed[at..]);
            }
            to.copy_from_slice(&value.0);
        }
    }
}

/// a x + b y, of the numbers from a place on.
#[inline(always)]
fn pair<const WIDTH: usize>((a, x): (f64, &[f64]), (b, y): (f64, &[f64]), at: usize) -> Lanes<WIDTH> {
    Lanes::from_f64(a) * Lanes::from_slice(&x[at..]) + Lanes::from_f64(b) * Lanes::from_slice(&y[at..])
}

/// How the pressure on a pin is tilted against its normal (`contact::outlines`): what is to first order in the clearance, per
/// sin(theta), and the clearance ratio squared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilt {
    pub first: f64,
    pub second: f64,
}

impl Tilt {
    pub const NONE: Tilt = Tilt { first: 0.0, second: 0.0 };
}

/// Those of a concentric pin under a tilt.
pub fn all_bands(normal: &[f64], along: &[f64], second: &[Bands], tilt: Tilt) -> Vec<Bands> {
    let mut bands: Vec<Bands> = normal.iter().map(|normal| [*normal, 0.0, 0.0]).collect();
    for (bands, along) in bands[1..].iter_mut().zip(along.windows(2)) {
        bands[1] = tilt.first * (along[1] - along[0]);
    }
    for (own, second) in bands.as_flattened_mut().iter_mut().zip(second.as_flattened()) {
        *own += tilt.second * second;
    }
    bands
}

/// Functions whose moments share a quadrature rule.
const BLOCK: usize = 64;

/// Integrals of the trial pressures of one arc over cos(n phi), for a block of modes from `first` on: `[mode][k]`. Blocks, so
/// that a moment does not depend on how many are asked for.
struct ModeMoments<'a> {
    arc: &'a ContactArc,
    terms: usize,
    first: usize,
    moments: &'a mut [f64],
}

impl WithSimd for ModeMoments<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let ModeMoments { arc, terms, first, moments } = self;
        let mut sums = [[0.0; BLOCK]; MAX_TERMS];
        let mut waves = [0.0; BLOCK];
        // The integrand is analytic and has period pi in tau, so the midpoint rule converges exponentially once it
        // resolves the fastest wave. A mode n has n eps/2 periods of phi in all, and where tan(phi/2) = b cos(tau) is steepest, at the edge
        // of the arc, as many as n b/2 in the place of that; and what is faster fades out.
        let fastest = (first + BLOCK) as f64;
        let points = 24 + terms + (0.5 * fastest * arc.half_angle.max(FADED * arc.b)) as usize;
        let weight = FRAC_PI_2 / points as f64;
        for i in 0..points {
            let tau = (i as f64 + 0.5) * weight;
            let trials = cosines((2.0 * tau).cos(), terms);
            let angle = arc.angle(tau);
            // cos(n phi) of the first modes one by one, then of as many together, by
            // cos((n + m) x) = 2 cos(m x) cos(n x) - cos((n - m) x).
            let turn = 2.0 * angle.cos();
            waves[0] = (first as f64 * angle).cos();
            waves[1] = ((first as f64 + 1.0) * angle).cos();
            for mode in 2..2 * TOGETHER {
                waves[mode] = turn * waves[mode - 1] - waves[mode - 2];
            }
            let turn = 2.0 * (TOGETHER as f64 * angle).cos();
            for group in (2 * TOGETHER..BLOCK).step_by(TOGETHER) {
                for mode in group..group + TOGETHER {
                    waves[mode] = turn * waves[mode - TOGETHER] - waves[mode - 2 * TOGETHER];
                }
            }
            for (sums, trial) in sums[..terms].iter_mut().zip(&trials) {
                let trial = simd.splat_f64s(weight * trial);
                let (sums, waves) = (S::as_mut_simd_f64s(sums).0, S::as_simd_f64s(&waves).0);
                for (sum, wave) in sums.iter_mut().zip(waves) {
                    *sum = simd.mul_add_e_f64s(trial, *wave, *sum);
                }
            }
        }
        for (mode, moments) in moments.chunks_exact_mut(terms).enumerate() {
            moments.iter_mut().zip(&sums).for_each(|(moment, sums)| *moment = sums[mode]);
        }
    }
}

/// Waves so much faster than the fastest have faded out.
const FADED: f64 = 1.1;

/// Modes whose waves follow from those as many before.
const TOGETHER: usize = 8;

/// Works of functions on functions.
enum Works<'a> {
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

/// values[jk] += share * sum over m, n of M_mj W_mn M_nk, for all arcs.
struct Add<'a> {
    moments: &'a Moments,
    works: Works<'a>,
    share: f64,
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
                        let entry = Entry { row, from, arcs, chunk };
                        match (row + 1 - from).min(COLUMNS) {
                            1 => entry.add::<WIDTH, TERMS, 1>(own, of_works, values),
                            2 => entry.add::<WIDTH, TERMS, 2>(own, of_works, values),
                            3 => entry.add::<WIDTH, TERMS, 3>(own, of_works, values),
                            4 => entry.add::<WIDTH, TERMS, 4>(own, of_works, values),
                            5 => entry.add::<WIDTH, TERMS, 5>(own, of_works, values),
                            _ => entry.add::<WIDTH, TERMS, COLUMNS>(own, of_works, values),
                        }
                    }
                }
            }
        }
    }
}

/// Columns of a row, from one on, at as many arcs as there are lanes.
struct Entry {
    row: usize,
    from: usize,
    arcs: usize,
    chunk: usize,
}

impl Entry {
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

    /// values[jk] = share * sum over m, n of M_mj W_mn M_nk, number by number.
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
                    let add = Add {
                        moments: &moments,
                        works,
                        share: SHARE,
                        of_works: &mut Vec::new(),
                        values: &mut values,
                    };
                    in_lanes_with_terms(terms, add);
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
