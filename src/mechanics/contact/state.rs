//! The state of contact of a joint under one load.

/// Of the whole joint (both halves), per unit thickness, hole radius 1, and per unit of the centres' offset e, of a press fit of
/// |dR|; forces in the unit of the moduli.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState {
    /// Of the hole, rad.
    pub half_angle: f64,
    /// delta/e: 0 without load, 1 for a neat fit; of a press fit delta/|dR| = 1 + e/|dR|.
    pub indentation: f64,
    /// F/e.
    pub force: f64,
    /// dF/d delta.
    pub tangent_stiffness: f64,
    /// Strain energy of both bodies over e^2.
    pub energy: f64,
    /// Contact pressure over e at the load line, per area of the hole; where it is greatest once that is known (`ContactCurve::peaked`).
    pub peak_pressure: f64,
    /// Where that is, at the hole's centre from the load line, rad.
    pub peak_angle: f64,
    /// What is left out of the trial pressures, as the last four tell: its square over the largest, or its share of the work. Of that
    /// order is what it costs in the force.
    pub truncation: f64,
    /// Whether there is no tension.
    pub pressure_is_positive: bool,
    /// Whether it is told by the whole ring (`whole_ring`), as that of a press fit is until its contact is one arc.
    pub on_whole_ring: bool,
}

impl ContactState {
    /// Whether the bodies push each other: a mesh far too coarse for its body may answer with a pull.
    pub fn is_a_push(&self) -> bool {
        let is_held = self.force > 0.0 || self.on_whole_ring;
        is_held && [self.tangent_stiffness, self.energy, self.peak_pressure].iter().all(|value| *value > 0.0)
    }
}
