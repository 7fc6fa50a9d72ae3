//! The sweeps that a GPU is measured with, the most important one first.

use std::path::Path;

use crate::engine::backend::device_solver::DeviceSolver;
use crate::error::Error;
use crate::study::config::Study;
use crate::study::setting::Setting;

/// Designs that are all different, ten loads each, by finite elements.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredSweep {
    /// The plates.
    pub scene: &'static str,
    path: &'static str,
    text: &'static str,
    /// As in a config.
    pub accuracy: &'static str,
    pub solver: DeviceSolver,
}

const CONCENTRIC: MeasuredSweep = MeasuredSweep {
    scene: "concentric",
    path: "configs/random.toml",
    text: include_str!("../../../configs/random.toml"),
    accuracy: "1 %",
    solver: DeviceSolver::Auto,
};

const BLOCKS: MeasuredSweep = MeasuredSweep {
    scene: "blocks",
    path: "configs/hypercube-block.toml",
    text: include_str!("../../../configs/hypercube-block.toml"),
    ..CONCENTRIC
};

pub const SWEEPS: [MeasuredSweep; 5] = [
    CONCENTRIC,
    MeasuredSweep { accuracy: "0.1 %", ..CONCENTRIC },
    BLOCKS,
    MeasuredSweep { accuracy: "0.1 %", ..BLOCKS },
    MeasuredSweep { solver: DeviceSolver::Pcg, ..CONCENTRIC },
];

/// Of `MeasuredSweep::answers`.
const ANSWERS: [&str; 5] = [
    "select.keep=\"peak_pressure < 400 MPa and tangent_stiffness > 2e5 N/mm\"",
    "reduce.statistics=[\"force\", \"peak_pressure\"]",
    "reduce.quantiles=[0.05, 0.5, 0.95]",
    "reduce.best={ count = 10, by = \"tangent_stiffness / peak_pressure\" }",
    "output.laws=false",
];

impl MeasuredSweep {
    /// With so many designs, every body condensed or, where that is cheaper, interpolated.
    pub fn study(&self, designs: u64, is_interpolated: bool) -> Result<Study, Error> {
        self.with(designs, is_interpolated, &[])
    }

    /// With answers instead of a table: which designs meet a requirement, statistics of them, and the best.
    pub fn answers(&self, designs: u64, is_interpolated: bool) -> Result<Study, Error> {
        self.with(designs, is_interpolated, &ANSWERS)
    }

    fn with(&self, designs: u64, is_interpolated: bool, more: &[&str]) -> Result<Study, Error> {
        let mut settings = vec![
            format!("sampling.count={designs}"),
            "solve.method=fe".into(),
            format!("solve.accuracy={}", self.accuracy),
            format!("solve.interpolation={}", if is_interpolated { "auto" } else { "off" }),
        ];
        settings.extend(more.iter().map(|text| text.to_string()));
        let settings =
            settings.iter().map(|text| Setting::parse(text, "bench-gpu")).collect::<Result<Vec<_>, _>>()?;
        Study::from_text_with(Path::new(self.path), self.text.to_string(), &settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sweeps_are_what_they_are_called() {
        for sweep in SWEEPS {
            for (designs, is_interpolated) in [(1, false), (1_000_000, true)] {
                let study = sweep.study(designs, is_interpolated).unwrap();
                assert_eq!(study.design_count(), designs);
                assert_eq!(study.solve.accuracy, if sweep.accuracy == "1 %" { 0.01 } else { 0.001 });
                let case = study.cases().unwrap().next().unwrap().unwrap();
                assert_eq!(case.joint.plate.shape.name == "block", sweep.scene == "blocks");
                assert_eq!(study.solve.method.name(), "fe");
                let answers = sweep.answers(designs, is_interpolated).unwrap();
                assert_eq!((answers.design_count(), answers.interpolation), (designs, is_interpolated));
            }
        }
    }
}
