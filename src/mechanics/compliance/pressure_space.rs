//! Trial pressures on arcs of several sizes: all that does not depend on the bodies, and the compliances of bodies to them.

use std::borrow::Cow;
use std::collections::HashMap;
use std::f64::consts::{FRAC_1_PI, FRAC_2_PI, FRAC_PI_2};

use pulp::{Arch, Simd, WithSimd};

use super::BodyCompliance;
use super::arc::{ArcMap, ContactArc, MAX_TERMS, cosines, packed, packed_count};
use super::infinite_body::InfiniteKernels;
use super::ring_modes::RingModes;
use super::second_order::Bands;
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
        let mut values = Vec::new();
        let JointCompliance { even, bed, .. } = self.joint_in(bodies, tilt, &mut values);
        JointCompliance { even, bed, values: values.into() }
    }

    /// The same in the room of another one, which is overwritten.
    pub fn joint_in<'a>(
        &self,
        bodies: &[(&BodyCompliance, f64)],
        tilt: Tilt,
        values: &'a mut Vec<f64>,
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
                let added = if tilt.first == 0.0 { None } else { Some((tilt.first, added)) };
                parts[1] = Some((&self.ring_modes[modes], Works::Packed(normal, added)));
            }
            if !second.is_empty() {
                parts[2] = Some((&self.modes, Works::Bands(second, tilt.second)));
            }
            for (moments, works) in parts.into_iter().flatten() {
                in_lanes_with_terms(self.terms, Add { moments, works, share: *share, values });
            }
        }
        JointCompliance { even, bed, values: values[..].into() }
    }
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
    /// Packed; with as many that are added, times a factor.
    Packed(&'a [f64], Option<(f64, &'a [f64])>),
}

/// values[jk] += share * sum over m, n of M_mj W_mn M_nk, for all arcs.
struct Add<'a> {
    moments: &'a Moments,
    works: Works<'a>,
    share: f64,
    values: &'a mut [f64],
}

impl TermWork for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const WIDTH: usize, const TERMS: usize>(self) {
        let Add { moments, works, share, values } = self;
        let arcs = values.len() / packed_count(TERMS);
        for (chunk, moments) in moments.values.chunks_exact(moments.count * TERMS).enumerate() {
            let moments = moments.as_chunks::<TERMS>().0;
            let mut matrix = [[Lanes::<WIDTH>::zero(); TERMS]; TERMS];
            match works {
                Works::Alone(works) => {
                    for (own, work) in moments.iter().zip(works) {
                        let factor = Lanes::from_f64(-share * FRAC_2_PI * work);
                        for j in 0..TERMS {
                            let scaled = factor * Lanes(own[j]);
                            // Rows as slices: entry by entry they would not stay in registers.
                            for (sum, other) in matrix[j][..=j].iter_mut().zip(own) {
                                *sum = sum.minus_product(scaled, Lanes(*other));
                            }
                        }
                    }
                }
                Works::Bands(bands, scale) => {
                    for (n, (own, bands)) in moments.iter().zip(bands).enumerate() {
                        let mut half = [Lanes::<WIDTH>::zero(); TERMS];
                        for (back, band) in bands.iter().enumerate().take(n + 1) {
                            let factor = Lanes::from_f64(-share * FRAC_1_PI * scale * band);
                            for k in 0..TERMS {
                                half[k] = half[k].minus_product(factor, Lanes(moments[n - back][k]));
                            }
                        }
                        add_symmetric(&mut matrix, own, &half);
                    }
                }
                Works::Packed(works, added) => {
                    for (m, own) in moments.iter().enumerate() {
                        // Half of the diagonal and all before it: the sum with its transpose is whole.
                        let mut half = [Lanes::<WIDTH>::zero(); TERMS];
                        let row = packed(m, 0)..=packed(m, m);
                        for (n, (at, other)) in row.zip(moments).enumerate() {
                            let mut work = works[at];
                            if let Some((tilt, added)) = added {
                                work += tilt * added[at];
                            }
                            let factor = Lanes::from_f64(if n == m { -0.5 * share } else { -share } * work);
                            for k in 0..TERMS {
                                half[k] = half[k].minus_product(factor, Lanes(other[k]));
                            }
                        }
                        add_symmetric(&mut matrix, own, &half);
                    }
                }
            }
            for j in 0..TERMS {
                for k in 0..=j {
                    let to = &mut values[packed(j, k) * arcs + chunk * LANES..][..LANES];
                    to.iter_mut().zip(&matrix[j][k].0).for_each(|(to, value)| *to += value);
                }
            }
        }
    }
}

/// Adds the product of one with the other and of the other with one.
#[inline(always)]
fn add_symmetric<const WIDTH: usize, const TERMS: usize>(
    matrix: &mut [[Lanes<WIDTH>; TERMS]; TERMS],
    one: &[[f64; LANES]; TERMS],
    other: &[Lanes<WIDTH>; TERMS],
) {
    for j in 0..TERMS {
        let (one_j, other_j) = (Lanes::<WIDTH>(one[j].map(|value| -value)), -other[j]);
        for (sum, (one, other)) in matrix[j][..=j].iter_mut().zip(one.iter().zip(other)) {
            *sum = sum.minus_product(one_j, *other).minus_product(other_j, Lanes(*one));
        }
    }
}
