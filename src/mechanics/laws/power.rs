//! The family of power laws, F = c delta^n, F per thickness.

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Power {
    /// c.
    pub coefficient: f64,
    /// n > 1.
    pub exponent: f64,
}

impl Power {
    pub fn force(&self, indentation: f64) -> f64 {
        self.coefficient * indentation.powf(self.exponent)
    }

    pub fn indentation(&self, force: f64) -> f64 {
        (force / self.coefficient).powf(1.0 / self.exponent)
    }

    pub fn tangent_stiffness(&self, indentation: f64) -> f64 {
        self.coefficient * self.exponent * indentation.powf(self.exponent - 1.0)
    }
}
