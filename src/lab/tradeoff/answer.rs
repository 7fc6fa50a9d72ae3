//! The answer to one load step of one design.

use crate::engine::outcome::Response;

/// Of the whole joint; N, mm, MPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    pub indentation: f64,
    pub force: f64,
    /// dF/d delta.
    pub tangent_stiffness: f64,
    /// rad; `None` where the choice does not say.
    pub contact_half_angle: Option<f64>,
    /// `None` where the choice does not say.
    pub peak_pressure: Option<f64>,
    /// Solutions of the contact's linear equations, where contact is iterated.
    pub iterations: Option<usize>,
}

/// Of each design, for each of its steps; `None` where there is no answer, or where nothing touches.
pub type States = Vec<Vec<Option<State>>>;

impl State {
    /// Of what a sweep has found; `None` where nothing touches yet.
    pub fn of(response: &Response) -> Option<State> {
        let Response { indentation, force, tangent_stiffness, contact_half_angle, peak_pressure, .. } =
            *response;
        let state = State {
            indentation,
            force,
            tangent_stiffness,
            contact_half_angle,
            peak_pressure,
            iterations: None,
        };
        if force > 0.0 { state.sound() } else { None }
    }

    /// Itself if every number in it is one.
    pub fn sound(self) -> Option<State> {
        let State { indentation, force, tangent_stiffness, contact_half_angle, peak_pressure, .. } = self;
        let told = [contact_half_angle, peak_pressure].into_iter().flatten();
        let sound =
            [indentation, force, tangent_stiffness].into_iter().chain(told).all(|number| number.is_finite());
        sound.then_some(self)
    }
}
