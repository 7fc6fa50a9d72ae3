//! The contact pressure along the arc of a state.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::mechanics::compliance::arc::ArcMap;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::real::{LANES, Lanes, Real};

/// Places per trial pressure among which the greatest pressure is looked for: the fastest wave has a dozen a period.
const PLACES_PER_TERM: usize = 6;

/// The same where gaps open on the whole ring: edges move from place to place with the load, and forces with them.
const RING_PLACES_PER_TERM: usize = 24;

/// The pressure of one state.
pub struct ArcPressure {
    map: ArcMap,
    /// tan(eps/2) of the hole; of press fits sin(eps/2).
    b: f64,
    /// Coefficients of the trial pressures; their sum is zero unless the contact is closed all around.
    coefficients: Vec<f64>,
}

impl ArcPressure {
    /// Of a contact that is closed all around, by its trial pressures.
    pub(super) fn of_whole_ring(coefficients: Vec<f64>) -> ArcPressure {
        ArcPressure { map: ArcMap::Sine, b: 1.0, coefficients }
    }

    /// Of a contact that ends at `b`, by the pressure at the load line and the trial pressures up to a factor.
    pub(super) fn with_peak(map: ArcMap, b: f64, coefficients: Vec<f64>, peak: f64) -> ArcPressure {
        let mut pressure = ArcPressure { map, b, coefficients };
        let scale = peak / pressure.at(0.0);
        pressure.coefficients.iter_mut().for_each(|value| *value *= scale);
        pressure
    }

    /// Angles all around the ring, the load line and the far side among them, as many as tell a pressure between them, with what each trial
    /// pressure on the whole ring is there.
    pub(super) fn around(terms: usize) -> Vec<(f64, Vec<f64>)> {
        let places = RING_PLACES_PER_TERM * terms;
        let at_place = |place: usize| {
            let angle = PI * place as f64 / places as f64;
            (angle, (0..terms).map(|k| 0.5 * (k as f64 * (PI - angle)).cos()).collect())
        };
        (0..=places).map(at_place).collect()
    }

    /// The greatest pressure and its angle; of equal ones that nearest to the load line.
    pub(super) fn greatest(&self) -> (f64, f64) {
        // tau is pi/2 at the load line, where the places begin, and 0 at the edge, where the pressure ends.
        let places = PLACES_PER_TERM * self.coefficients.len();
        let step = FRAC_PI_2 / places as f64;
        let pressures = in_lanes(AtPlaces { pressure: self, places, step });
        let (mut best, mut most) = (0, pressures[0]);
        for (place, pressure) in pressures.iter().enumerate() {
            if *pressure > most {
                (best, most) = (place, *pressure);
            }
        }
        if best == 0 {
            return (0.0, most);
        }
        if self.is_closed() && self.at(PI) >= most {
            return (PI, self.at(PI));
        }
        // The parabola through the places around, the last of which has a pressure of zero beyond it.
        let (before, after) = (pressures[best - 1], pressures.get(best + 1).map_or(0.0, |after| *after));
        let curvature = before - 2.0 * most + after;
        let shift = if curvature < 0.0 { 0.5 * (before - after) / curvature } else { 0.0 };
        let (sine, cosine) = ((best as f64 + shift) * step).sin_cos();
        let found = self.at_tau(cosine, sine);
        if found > most {
            (self.map.angle(self.b * sine), found)
        } else {
            (self.map.angle(self.b * (best as f64 * step).sin()), most)
        }
    }

    /// `at` from the sine and the cosine of tau. With sin((k + 1) tau) = 2 cos(tau) sin(k tau) - sin((k - 1) tau).
    #[inline(always)]
    fn at_tau<T: Real>(&self, sine: T, cosine: T) -> T {
        let turn = cosine + cosine;
        let (mut before, mut current, mut turned) = (T::zero(), sine, T::zero());
        for coefficient in &self.coefficients[1..] {
            turned = turned.minus_product(T::from_f64(-coefficient) * current, current);
            (before, current) = (current, -before.minus_product(turn, current));
        }
        if self.is_closed() {
            return T::from_f64(0.5 * self.coefficients.iter().sum::<f64>()) - turned;
        }
        let b = T::from_f64(self.b);
        -turned * self.map.slope(b * cosine) / (b * sine)
    }

    /// Over e, in the unit of the moduli, per area of the hole, at an angle of the hole from the load line, rad; zero beyond
    /// the arc.
    ///
    /// p d(phi) = sum of c_k cos(2 k tau) d(tau) with cos(tau) = tan(phi/2)/b. The c_k sum to zero, so that
    /// sum of c_k cos(2 k tau) = -2 sum of c_k sin(k tau)^2, which is free of the singularity at the edge. Closed all around there is no
    /// edge.
    pub fn at(&self, angle: f64) -> f64 {
        let cosine = self.map.of_half(angle).abs() / self.b;
        if cosine >= 1.0 && !self.is_closed() {
            return 0.0;
        }
        let cosine = cosine.min(1.0);
        self.at_tau(((1.0 - cosine) * (1.0 + cosine)).sqrt(), cosine)
    }

    /// The same on the pin, per area of the pin and over its own angles: m times as dense, on an arc of m times the tangent
    /// (`outlines`). Without what tilts it against the pin's normal, which is of the order of the clearance ratio.
    pub fn on_pin(&self, ratio: f64) -> ArcPressure {
        let coefficients = self.coefficients.iter().map(|value| ratio * value).collect();
        ArcPressure { map: self.map, b: ratio * self.b, coefficients }
    }

    /// Amplitudes of cos(n phi), n from 0, so many: p = sum of p_n cos(n phi).
    pub fn modes(&self, count: usize) -> Vec<f64> {
        // The midpoints of tau see no wave faster than this; cos(n phi) is one of n times the arc at most.
        let half_angle = self.map.angle(self.b);
        let places = (0.5 * half_angle * count as f64) as usize + 4 * self.coefficients.len() + 32;
        let mut modes = vec![0.0; count];
        for (angle, pressed) in self.pieces(places) {
            let weight = 2.0 / PI * pressed;
            let twice = 2.0 * angle.cos();
            let (mut cosine, mut before) = (1.0, 0.5 * twice);
            for mode in &mut modes {
                *mode += weight * cosine;
                (cosine, before) = (twice * cosine - before, cosine);
            }
        }
        if let Some(mean) = modes.first_mut() {
            *mean *= 0.5;
        }
        modes
    }

    /// So many pieces of the half of the arc: their angles from the load line, rad, and the pressure times the width of each.
    pub fn pieces(&self, count: usize) -> impl Iterator<Item = (f64, f64)> {
        let step = FRAC_PI_2 / count as f64;
        (0..count).map(move |place| {
            let tau = (place as f64 + 0.5) * step;
            let terms = (0..).zip(&self.coefficients);
            let sum: f64 = terms.map(|(k, value)| value * (2.0 * f64::from(k) * tau).cos()).sum();
            (self.map.angle(self.b * tau.cos()), step * sum)
        })
    }

    fn is_closed(&self) -> bool {
        self.map == ArcMap::Sine && self.b == 1.0
    }
}

/// The pressure at places from the load line on, steps of tau apart, as many abreast as there are lanes.
struct AtPlaces<'a> {
    pressure: &'a ArcPressure,
    places: usize,
    step: f64,
}

impl LaneWork for AtPlaces<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> Vec<f64> {
        let AtPlaces { pressure, places, step } = self;
        let (turn, ahead) = step.sin_cos();
        let (mut sines, mut cosines) = ([1.0; LANES], [0.0; LANES]);
        for lane in 1..LANES {
            let (sine, cosine) = (sines[lane - 1], cosines[lane - 1]);
            sines[lane] = sine * ahead - cosine * turn;
            cosines[lane] = cosine * ahead + sine * turn;
        }
        let (mut sines, mut cosines) = (Lanes::<WIDTH>(sines), Lanes(cosines));
        let (turn, ahead) = (LANES as f64 * step).sin_cos();
        let (turn, ahead) = (Lanes::from_f64(turn), Lanes::from_f64(ahead));
        let mut pressures = Vec::with_capacity(places + LANES);
        while pressures.len() < places {
            pressures.extend(pressure.at_tau(sines, cosines).0);
            (sines, cosines) = (sines * ahead - cosines * turn, cosines * ahead + sines * turn);
        }
        pressures.truncate(places);
        pressures
    }
}
