//! What a program that uses the library needs of a sweep: a config, and what comes of its designs.

use std::ops::ControlFlow;
use std::path::Path;

use crate::engine::outcome::DesignOutcome;
use crate::engine::sweep::{self, SweepOptions};
use crate::error::Error;
use crate::study::config::Study;
use crate::study::design::DesignCase;

/// The designs of a config, as `jointsweep run` has them.
///
/// ```
/// use std::ops::ControlFlow;
///
/// let sweep = jointsweep::Sweep::from_text(r#"
///     [joint]
///     idealization     = "plane-stress"
///     hole_radius      = "10 mm"
///     radial_clearance = ["0.02 mm", "0.05 mm", "0.1 mm"]
///     thickness        = "8 mm"
///     pin   = { model = "rigid-core", youngs_modulus = "210 GPa", poissons_ratio = 0.3 }
///     plate = { model = "annulus", outer_radius_ratio = 3, youngs_modulus = "210 GPa", poissons_ratio = 0.3 }
///     [load]
///     force = ["5 kN", "20 kN"]
/// "#)?;
/// assert_eq!(sweep.design_count(), 3);
/// let mut stiffnesses = Vec::new();
/// sweep.run(|design| {
///     let response = design.steps[1].response.expect("a small load has an answer");
///     stiffnesses.push(response.tangent_stiffness);
///     ControlFlow::Continue(())
/// })?;
/// // The smaller the clearance, the stiffer the joint.
/// assert!(stiffnesses.len() == 3 && stiffnesses.is_sorted_by(|a, b| a > b));
/// # Ok::<(), jointsweep::Error>(())
/// ```
#[derive(Debug)]
pub struct Sweep(Study);

impl Sweep {
    /// Reads and checks a config, and the list of designs it may name.
    pub fn load(path: impl AsRef<Path>) -> Result<Sweep, Error> {
        Study::load(path.as_ref()).map(Sweep)
    }

    /// Checks a config whose text is at hand; complaints call it `config`.
    pub fn from_text(text: &str) -> Result<Sweep, Error> {
        Study::from_text(Path::new("config"), text.to_string()).map(Sweep)
    }

    pub fn design_count(&self) -> u64 {
        self.0.design_count()
    }

    /// The designs in their order, unsolved.
    pub fn designs(&self) -> Result<impl Iterator<Item = Result<DesignCase, Error>> + '_, Error> {
        self.0.cases()
    }

    /// Solves the designs on all cores and hands them over in their order, as they come, until `receive` breaks. A design that
    /// cannot be solved is handed over, too: its load steps say why.
    pub fn run(&self, mut receive: impl FnMut(DesignOutcome) -> ControlFlow<()>) -> Result<(), Error> {
        sweep::run(&self.0, &SweepOptions::default(), &mut |outcome| Ok(receive(outcome)))?;
        Ok(())
    }
}
