//! Whether two backends answer alike.

use crate::engine::outcome::DesignOutcome;

/// Why the answers of two backends are not alike.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Disagreement {
    #[error("there is no force to compare")]
    Nothing,
    #[error("{found} designs were answered, of {expected}")]
    Count { found: usize, expected: usize },
    #[error("design {design}, step {step}: `{found}`, where the processor says `{expected}`")]
    Answer { design: u64, step: usize, found: String, expected: String },
    #[error(
        "design {design}, step {step}: {found} N is off by {difference:.1e} of the processor's {expected} N; allowed is {allowed:.0e}"
    )]
    Force { design: u64, step: usize, found: f64, expected: f64, difference: f64, allowed: f64 },
}

/// The greatest relative difference of the forces of all steps, none of it above `allowed`. Steps must have an answer on
/// both sides or on none.
pub fn worst_difference(
    found: &[DesignOutcome],
    expected: &[DesignOutcome],
    allowed: f64,
) -> Result<f64, Disagreement> {
    if found.len() != expected.len()
        || found.iter().zip(expected).any(|(a, b)| a.steps.len() != b.steps.len())
    {
        return Err(Disagreement::Count { found: found.len(), expected: expected.len() });
    }
    let mut worst = None;
    for (found, expected) in found.iter().zip(expected) {
        let design = expected.case.index;
        for (step, (own, other)) in found.steps.iter().zip(&expected.steps).enumerate() {
            let (own_force, other_force) = match (own.response, other.response) {
                (Some(own), Some(other)) => (own.force, other.force),
                (None, None) => continue,
                _ => {
                    let (found, expected) = (own.status.to_string(), other.status.to_string());
                    return Err(Disagreement::Answer { design, step, found, expected });
                }
            };
            let difference =
                if own_force == other_force { 0.0 } else { (own_force / other_force - 1.0).abs() };
            // NaN is not within anything.
            if difference.is_nan() || difference > allowed {
                let (found, expected) = (own_force, other_force);
                return Err(Disagreement::Force { design, step, found, expected, difference, allowed });
            }
            worst = Some(difference.max(worst.unwrap_or(0.0)));
        }
    }
    worst.ok_or(Disagreement::Nothing)
}
