//! How far the states of a choice are from those of the oracle.

use crate::lab::tradeoff::answer::{State, States};

/// Of the errors of one quantity over all steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantiles {
    pub median: f64,
    /// The error that 95 % of the steps keep to.
    pub p95: f64,
    pub max: f64,
}

/// Errors over all steps the oracle has an answer to. `None` where the choice does not say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Relative.
    pub force: Option<Quantiles>,
    /// Relative.
    pub tangent_stiffness: Option<Quantiles>,
    /// deg.
    pub contact_half_angle: Option<Quantiles>,
    /// Relative.
    pub peak_pressure: Option<Quantiles>,
    /// Steps that the oracle has an answer to.
    pub steps: usize,
    /// Those of them that the choice has none to.
    pub unanswered: usize,
    /// Mean over the steps, where contact is iterated.
    pub iterations: Option<f64>,
}

impl Quantiles {
    /// `None` without values. The value at a share is the least that so many values keep to.
    pub fn of(mut values: Vec<f64>) -> Option<Quantiles> {
        values.sort_by(f64::total_cmp);
        let last = values.len().checked_sub(1)?;
        let at = |share: f64| values[((share * values.len() as f64).ceil() as usize).clamp(1, last + 1) - 1];
        Some(Quantiles { median: at(0.5), p95: at(0.95), max: values[last] })
    }
}

impl Errors {
    /// Of `found` against `exact`, step by step.
    pub fn new(found: &States, exact: &States) -> Errors {
        let (mut force, mut stiffness, mut angle, mut pressure) = (vec![], vec![], vec![], vec![]);
        let (mut iterations, mut steps) = (vec![], 0);
        let missing = Vec::new();
        for (design, exact) in exact.iter().enumerate() {
            let found = found.get(design).unwrap_or(&missing);
            for (step, exact) in exact.iter().enumerate() {
                let Some(exact) = exact else { continue };
                steps += 1;
                let Some(found) = found.get(step).copied().flatten().and_then(State::sound) else { continue };
                force.push(force_error(&found, exact));
                stiffness.push((found.tangent_stiffness / exact.tangent_stiffness - 1.0).abs());
                angle.extend(
                    both(found.contact_half_angle, exact.contact_half_angle)
                        .map(|(found, exact)| (found - exact).abs().to_degrees()),
                );
                pressure.extend(
                    both(found.peak_pressure, exact.peak_pressure)
                        .map(|(found, exact)| (found / exact - 1.0).abs()),
                );
                iterations.extend(found.iterations.map(|count| count as f64));
            }
        }
        let answered = force.len();
        let iterated = iterations.len() as f64;
        Errors {
            force: Quantiles::of(force),
            tangent_stiffness: Quantiles::of(stiffness),
            contact_half_angle: Quantiles::of(angle),
            peak_pressure: Quantiles::of(pressure),
            steps,
            unanswered: steps - answered,
            iterations: (iterated > 0.0).then(|| iterations.iter().sum::<f64>() / iterated),
        }
    }

    /// The share of the steps without an answer.
    pub fn unanswered_share(&self) -> f64 {
        if self.steps == 0 { 0.0 } else { self.unanswered as f64 / self.steps as f64 }
    }
}

/// |F - F*|/F* at the indentation of the oracle. Where the force is prescribed and the indentation is found, k_t turns the
/// error of the one into that of the other, to first order.
pub fn force_error(found: &State, exact: &State) -> f64 {
    let beside = exact.tangent_stiffness * (found.indentation - exact.indentation);
    ((found.force - exact.force - beside) / exact.force).abs()
}

fn both(found: Option<f64>, exact: Option<f64>) -> Option<(f64, f64)> {
    found.zip(exact)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(indentation: f64, force: f64) -> State {
        State {
            indentation,
            force,
            tangent_stiffness: 50.0,
            contact_half_angle: Some(0.5),
            peak_pressure: None,
            iterations: Some(3),
        }
    }

    #[test]
    fn quantiles_are_those_that_so_many_values_keep_to() {
        let values = (1..=41).rev().map(f64::from).collect();
        assert_eq!(Quantiles::of(values), Some(Quantiles { median: 21.0, p95: 39.0, max: 41.0 }));
        assert_eq!(Quantiles::of(vec![7.0]), Some(Quantiles { median: 7.0, p95: 7.0, max: 7.0 }));
        assert_eq!(Quantiles::of(Vec::new()), None);
    }

    /// A step without an answer, or with one that is no number, counts as unanswered; a step that the oracle has no
    /// answer to does not count.
    #[test]
    fn what_is_not_answered_is_counted_and_not_averaged() {
        let exact =
            vec![vec![Some(state(1.0, 10.0)), Some(state(1.0, 10.0)), None], vec![Some(state(1.0, 10.0))]];
        let found = vec![
            vec![Some(state(1.0, 11.0)), None, Some(state(1.0, 99.0))],
            vec![Some(state(1.0, f64::NAN))],
        ];
        let errors = Errors::new(&found, &exact);
        assert_eq!((errors.steps, errors.unanswered), (3, 2));
        assert!((errors.force.unwrap().max - 0.1).abs() < 1e-15);
        assert_eq!((errors.peak_pressure, errors.iterations), (None, Some(3.0)));
        assert_eq!(Errors::new(&Vec::new(), &exact).unanswered_share(), 1.0);
    }

    /// Under a prescribed force an indentation that is 1 % of F/k_t off is an error of 1 %.
    #[test]
    fn an_error_of_the_indentation_is_one_of_the_force() {
        let errors = Errors::new(&vec![vec![Some(state(1.002, 10.0))]], &vec![vec![Some(state(1.0, 10.0))]]);
        assert!((errors.force.unwrap().max - 0.01).abs() < 1e-12);
    }
}
