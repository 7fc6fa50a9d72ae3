//! Trial pressures on arcs of several sizes: all that does not depend on the bodies, and the compliances of bodies to them.

use std::borrow::Cow;
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

use super::BodyCompliance;
use super::arc::{ArcMap, ContactArc, packed_count};
use super::arc_lanes::{ForEach, one_by_one};
use super::infinite_body::InfiniteKernels;
use super::ring_modes::RingModes;
use super::second_order::Bands;
use super::sine_arcs;
use super::thin_wall::bed_matrix;
use super::trial_moments::Moments;
use super::work_sums::Works;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
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
        PressureSpace::made(terms, arcs, &one_by_one)
    }

    /// The same with the arcs' shares of the work given out.
    pub fn made(terms: usize, arcs: Vec<ContactArc>, for_each: ForEach) -> PressureSpace {
        let count = arcs.len();
        let map = arcs.first().map_or(ArcMap::Tangent, |arc| arc.map);
        let kernels = match map {
            ArcMap::Tangent => InfiniteKernels::new(&arcs, terms, for_each),
            ArcMap::Sine => sine_arcs::infinite_kernels(&arcs, terms, for_each),
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

    /// Makes what the sum over so many modes of a concentric body needs.
    pub fn prepare_modes(&mut self, count: usize, for_each: ForEach) {
        if count > self.modes.count {
            self.modes = Moments::of_modes(&self.arcs, self.terms, count, for_each);
        }
    }

    /// Makes what bodies in these modes need.
    pub fn prepare_ring_modes(&mut self, modes: &RingModes, for_each: ForEach) {
        if !self.ring_modes.contains_key(modes) {
            let moments = Moments::of_ring_modes(&self.arcs, self.terms, modes, for_each);
            self.ring_modes.insert(*modes, moments);
        }
    }

    /// Makes what a body needs.
    pub fn prepare(&mut self, body: &BodyCompliance) {
        self.prepare_modes(body.mode_count(), &one_by_one);
        if let Some((modes, _)) = body.boundary.ring_modes() {
            self.prepare_ring_modes(modes, &one_by_one);
        }
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
                moments.add(self.terms, works, *share, of_works, values);
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
    /// `[function][k]`, as `work_sums` has them.
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
