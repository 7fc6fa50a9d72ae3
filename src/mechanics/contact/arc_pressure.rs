//! The contact pressure along the arc of a state.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::mechanics::compliance::arc::ArcMap;

/// Places per trial pressure among which the greatest pressure is looked for: the fastest wave has a dozen a period.
const PLACES_PER_TERM: usize = 6;

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
        let places = PLACES_PER_TERM * terms;
        let at_place = |place: usize| {
            let angle = PI * place as f64 / places as f64;
            (angle, (0..terms).map(|k| 0.5 * (k as f64 * (PI - angle)).cos()).collect())
        };
        (0..=places).map(at_place).collect()
    }

    /// The greatest pressure and its angle; of equal ones that nearest to the load line.
    pub(super) fn greatest(&self) -> (f64, f64) {
        let places = PLACES_PER_TERM * self.coefficients.len();
        let step = FRAC_PI_2 / places as f64;
        // tau is pi/2 at the load line, where the places begin, and 0 at the edge, where the pressure ends.
        let (turn, ahead) = (step.sin(), step.cos());
        let (mut sine, mut cosine) = (1.0, 0.0);
        let mut around = [f64::NEG_INFINITY; 3];
        let (mut best, mut before) = (0, f64::NEG_INFINITY);
        for place in 0..places {
            let pressure = self.at_tau(sine, cosine);
            if pressure > around[1] {
                (best, around) = (place, [before, pressure, f64::NAN]);
            } else if place == best + 1 {
                around[2] = pressure;
            }
            before = pressure;
            (sine, cosine) = (sine * ahead - cosine * turn, cosine * ahead + sine * turn);
        }
        if best == 0 {
            return (0.0, self.at(0.0));
        }
        if self.is_closed() && self.at(PI) >= around[1] {
            return (PI, self.at(PI));
        }
        // The parabola through the places around, the last of which has a pressure of zero beyond it.
        let [before, most, after] = around.map(|pressure| if pressure.is_nan() { 0.0 } else { pressure });
        let curvature = before - 2.0 * most + after;
        let shift = if curvature < 0.0 { 0.5 * (before - after) / curvature } else { 0.0 };
        let near = [best as f64 + shift, best as f64];
        let [found, known] = near.map(|place| {
            let angle = self.map.angle(self.b * (place * step).sin());
            (angle, self.at(angle))
        });
        if found.1 > known.1 { found } else { known }
    }

    /// The same as `at`, but next to the edge, from the sine and the cosine of tau.
    fn at_tau(&self, sine: f64, cosine: f64) -> f64 {
        let turn = 2.0 * (2.0 * cosine * cosine - 1.0);
        let (mut current, mut previous) = (0.0, 0.0);
        for coefficient in self.coefficients[1..].iter().rev() {
            (current, previous) = (coefficient + turn * current - previous, current);
        }
        let sum = self.coefficients[0] + 0.5 * turn * current - previous;
        0.5 * sum / sine * self.map.slope(self.b * cosine) / self.b
    }

    /// Over e, in the unit of the moduli, per area of the hole, at an angle of the hole from the load line, rad; zero beyond
    /// the arc.
    ///
    /// p d(phi) = sum of c_k cos(2 k tau) d(tau) with cos(tau) = tan(phi/2)/b. The c_k sum to zero, so that
    /// sum of c_k cos(2 k tau) = -2 sum of c_k sin(k tau)^2, which is free of the singularity at the edge. Closed all around there is no
    /// edge.
    pub fn at(&self, angle: f64) -> f64 {
        let cosine = self.map.of_half(angle).abs() / self.b;
        let term = |(k, value): (usize, &f64), tau: f64| value * (k as f64 * tau).sin().powi(2);
        let sum = |tau| self.coefficients.iter().enumerate().map(|coefficient| term(coefficient, tau)).sum();
        if self.is_closed() {
            let (all, turned): (f64, f64) = (self.coefficients.iter().sum(), sum(cosine.min(1.0).acos()));
            return 0.5 * all - turned;
        }
        if cosine >= 1.0 {
            return 0.0;
        }
        let tau = cosine.acos();
        let turned: f64 = sum(tau);
        -turned / tau.sin() * self.map.slope(self.b * cosine) / self.b
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
