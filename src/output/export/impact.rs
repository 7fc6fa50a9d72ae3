//! Damping for a stated restitution: F (1 + c v), and the restitution that an impact with the table really has.

use crate::error::Error;
use crate::mechanics::laws::damping::Damping;
use crate::output::export::interpolation::{Interpolant, Interpolation};
use crate::output::export::table::Table;

/// What is asked: speed after over speed before, and the speed at first touch, mm/s.
#[derive(Clone, Copy, Debug)]
pub struct ImpactRequest {
    pub restitution: f64,
    pub speed: f64,
}

/// Damping of one kind of impact.
#[derive(Clone, Copy, Debug)]
pub struct Impact {
    pub asked: ImpactRequest,
    pub law: Damping,
    /// c = lambda/v0, s/mm.
    pub coefficient: f64,
    /// Of the impact that was integrated.
    pub restitution: f64,
    /// t; its elastic energy takes it to half of the table's.
    pub mass: f64,
}

impl Impact {
    /// The law of `Damping::ALL` whose impact with the table comes nearest to what is asked.
    pub fn of(table: &Table, asked: ImpactRequest) -> Result<Impact, Error> {
        let refuse = |what: &str, problem: String| Err(Error::Export { what: what.into(), problem });
        if !(asked.restitution > 0.0 && asked.restitution <= 1.0) {
            return refuse("restitution", format!("{}: must be above 0 and at most 1", asked.restitution));
        }
        if !(asked.speed > 0.0 && asked.speed.is_finite()) {
            return refuse("speed", format!("{} mm/s: must be above 0, and finite", asked.speed));
        }
        let forces = table.interpolants(Interpolation::Hermite);
        let force = &forces[forces.len() / 2];
        let end = table.indentations[table.indentations.len() - 1];
        let mass = energy(force, end) / (asked.speed * asked.speed);
        let impact = |law: Damping| {
            let coefficient = law.factor(asked.restitution).ok()? / asked.speed;
            let restitution = rebound(force, end, mass, coefficient, asked.speed);
            Some(Impact { asked, law, coefficient, restitution, mass })
        };
        let off = |impact: &Impact| (impact.restitution - asked.restitution).abs();
        let best = Damping::ALL.into_iter().filter_map(impact).min_by(|a, b| off(a).total_cmp(&off(b)));
        match best {
            Some(impact) if impact.coefficient.is_finite() => Ok(impact),
            _ => refuse("restitution", format!("{}: no damping law reaches it", asked.restitution)),
        }
    }
}

/// Elastic energy at the end of the table, mJ: by the trapezoidal rule at points denser than the table's.
fn energy(force: &Interpolant, end: f64) -> f64 {
    let count = 2000;
    let step = end / f64::from(count);
    (0..count).map(|i| step * force.at(step * (f64::from(i) + 0.5)).0).sum()
}

/// Speed after over speed before of a mass that meets the table: m x'' = -F(x) (1 + c x'), by Runge and Kutta's
/// rule of order four.
fn rebound(force: &Interpolant, end: f64, mass: f64, coefficient: f64, speed: f64) -> f64 {
    let pull = |x: f64, v: f64| {
        if x <= 0.0 { 0.0 } else { -force.at(x.min(end)).0 * (1.0 + coefficient * v) / mass }
    };
    let step = end / speed / STEPS_A_WAY;
    let (mut x, mut v) = (0.0, speed);
    for _ in 0..MOST_STEPS {
        let rate = |x: f64, v: f64| (v, pull(x, v));
        let k1 = rate(x, v);
        let k2 = rate(x + 0.5 * step * k1.0, v + 0.5 * step * k1.1);
        let k3 = rate(x + 0.5 * step * k2.0, v + 0.5 * step * k2.1);
        let k4 = rate(x + step * k3.0, v + step * k3.1);
        x += step / 6.0 * (k1.0 + 2.0 * (k2.0 + k3.0) + k4.0);
        v += step / 6.0 * (k1.1 + 2.0 * (k2.1 + k3.1) + k4.1);
        if x <= 0.0 {
            break;
        }
    }
    -v / speed
}

/// Steps in the time that the table's range takes at the first speed.
const STEPS_A_WAY: f64 = 2000.0;

/// A rebound a hundred times slower than the impact is followed to its end.
const MOST_STEPS: usize = 500_000;

#[cfg(test)]
mod tests {
    use super::*;

    fn line() -> Table {
        let x: Vec<f64> = (0..50).map(|i| 0.01 * f64::from(i)).collect();
        Table {
            clearances: vec![0.1],
            forces: vec![x.iter().map(|x| 1000.0 * x).collect()],
            stiffnesses: vec![vec![1000.0; 50]],
            indentations: x,
        }
    }

    /// The elastic law drops out: with u = v/v0, u - ln(1 + lambda u)/lambda is the same before and after.
    #[test]
    fn the_integrated_rebound_is_that_of_the_integral() {
        for restitution in [0.95, 0.7, 0.4, 0.2] {
            let asked = ImpactRequest { restitution, speed: 300.0 };
            let impact = Impact::of(&line(), asked).unwrap();
            let lambda = impact.coefficient * 300.0;
            let side = |u: f64| u - (lambda * u).ln_1p() / lambda;
            assert!((side(1.0) - side(-impact.restitution)).abs() < 1e-5, "{impact:?}");
            assert!((impact.restitution - restitution).abs() < 0.06, "{impact:?}");
        }
        let elastic = Impact::of(&line(), ImpactRequest { restitution: 1.0, speed: 1.0 }).unwrap();
        assert!(elastic.coefficient == 0.0 && (elastic.restitution - 1.0).abs() < 1e-7, "{elastic:?}");
    }

    #[test]
    fn what_cannot_be_is_refused() {
        for (restitution, speed) in
            [(0.0, 1.0), (1.1, 1.0), (f64::NAN, 1.0), (0.5, 0.0), (0.5, f64::INFINITY)]
        {
            assert!(Impact::of(&line(), ImpactRequest { restitution, speed }).is_err());
        }
    }
}
