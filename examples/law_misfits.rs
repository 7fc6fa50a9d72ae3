//! Draws how far each law is from random joints: the picture of docs/laws.md.
//!
//! ```sh
//! cargo run --release --example law_misfits -- docs/laws.svg
//! ```

#[path = "../tests/common/law_joints.rs"]
mod law_joints;

use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::law_fit::add_laws;
use jointsweep::internals::mechanics::laws::calibrated::CALIBRATED_LAWS;
use jointsweep::internals::output::chart::axis::{Axis, Spacing};
use jointsweep::internals::output::chart::line_chart::{LineChart, Marking, Series};
use jointsweep::internals::output::whole_file::write_whole;
use jointsweep::{MethodChoice, Options};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Some(path) = std::env::args().nth(1) else { return Err("name the picture: law_misfits FILE".into()) };
    let cases = law_joints::of_every_kind();
    let mut ladder = Ladder::new(Options { accuracy: 0.01, method: MethodChoice::Auto });
    let mut outcomes = ladder.solve(&cases);
    add_laws(&mut ladder, &mut outcomes);
    let count = outcomes.len() as f64;
    let series = CALIBRATED_LAWS.iter().enumerate().map(|(place, law)| {
        let of_designs = outcomes.iter().filter_map(|outcome| outcome.laws.as_ref());
        let own = of_designs.flat_map(|laws| &laws.laws).filter(|fitted| fitted.law.name == law.name);
        let mut misfits: Vec<f64> = own.map(|fitted| 100.0 * fitted.force_misfit[0]).collect();
        misfits.sort_by(f64::total_cmp);
        let points = misfits.iter().zip(1..).map(|(misfit, rank)| (*misfit, 100.0 * f64::from(rank) / count));
        let marking = [Marking::Line, Marking::Dashed, Marking::Dotted][place / 3];
        // Every tenth joint, and the last.
        let last = misfits.len() - 1;
        let points =
            points.enumerate().filter(|(place, _)| place % 10 == 0 || *place == last).map(|(_, point)| point);
        Series::new(law.name, place % 3, marking, points.collect())
    });
    let chart = LineChart {
        title: "1,000 random joints: how many are fitted so well".into(),
        x: Axis {
            name: "worst misfit of the force, %".into(),
            spacing: Spacing::Log,
            low: 0.01,
            high: 100.0,
        },
        y: Axis { name: "joints, %".into(), spacing: Spacing::Linear, low: 0.0, high: 100.0 },
        series: series.collect(),
        limits: Vec::new(),
    };
    write_whole(std::path::Path::new(&path), chart.alone().as_bytes())?;
    println!("{path}");
    Ok(())
}
