//! Whether a device would be through with a sweep sooner than the processor.
//!
//! Designs that are spread over the sweep tell what it needs, by `unit_costs`; how fast the processor and the device are is
//! measured (`backend::rates`). While the device condenses, the processor does all else, so that the slower of both counts.

use foldhash::HashSet;

use crate::engine::backend::rates::Rates;
use crate::engine::cost::{DesignCost, DesignParts};
use crate::engine::distinct::distinct_among;
use crate::engine::interpolation::fit_plan::picks;
use crate::study::config::Study;

/// What the designs of a sweep need, on one thread of the processor, s by `unit_costs`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// Bodies that a device may condense.
    pub bodies: f64,
    /// Their condensation.
    pub condensation: f64,
    pub others: f64,
}

/// How long a sweep takes, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    pub processor: f64,
    pub device: f64,
}

/// Sweeps whose condensation takes the processor less than this, s, are not worth opening a device and measuring it.
const WORTH: f64 = 3.0;

/// Fewer designs do not fill a device, however long each takes.
const FEWEST: u64 = 256;

/// Designs that are looked at first.
const FIRST: usize = 16;

/// A device is taken where it needs less than this of the processor's time: a forecast is right to some tenths.
const CLEARLY: f64 = 0.8;

impl Demand {
    /// Of a sweep on so many threads; `None` where no device is worth asking, or a design cannot be read, which is told where
    /// designs are drawn.
    pub fn worth_a_device(study: &Study, threads: usize) -> Option<Demand> {
        if study.design_count() < FEWEST {
            return None;
        }
        let least = WORTH * threads as f64;
        let numbers = picks(study.design_count());
        let few = numbers.iter().copied().step_by(numbers.len().div_ceil(FIRST).max(1));
        let first = Demand::of(study, &DesignCost::without_interpolation(study), few)?;
        if first.condensation < least {
            return None;
        }
        let demand = Demand::of(study, &DesignCost::of_study(study), numbers.iter().copied())?;
        (demand.condensation >= least).then_some(demand)
    }

    /// By designs that stand for all.
    fn of(study: &Study, cost: &DesignCost, numbers: impl Iterator<Item = u64>) -> Option<Demand> {
        let (mut pins, mut plates) = (HashSet::default(), HashSet::default());
        let (mut seen, mut on_meshes, mut sum) = (0.0, 0.0, DesignParts::default());
        for case in study.cases_at(numbers).ok()? {
            let case = case.ok()?;
            let DesignParts { bodies, condensation, others } = cost.parts(&case);
            sum.bodies += bodies;
            sum.condensation += condensation;
            sum.others += others;
            seen += 1.0;
            if bodies > 0.0 {
                on_meshes += 1.0;
                let joint = &case.joint;
                pins.insert(joint.body(&joint.pin).key());
                plates.insert(joint.body(&joint.plate).key());
            }
        }
        if seen == 0.0 {
            return None;
        }
        // Each different body is condensed once.
        let of_all = study.design_count() as f64 / seen;
        let designs = on_meshes * of_all;
        let distinct = [pins, plates].map(|found| distinct_among(designs, on_meshes, found.len() as f64));
        let once = distinct.iter().sum::<f64>() / (2.0 * on_meshes).max(1.0);
        Some(Demand {
            bodies: sum.bodies * once,
            condensation: sum.condensation * once,
            others: sum.others * of_all,
        })
    }

    /// With the rates of a machine and so many threads.
    pub fn forecast(&self, rates: &Rates, threads: usize) -> Forecast {
        let threads = threads as f64;
        let of_threads = (rates.processor * self.others + rates.host * self.bodies) / threads;
        Forecast {
            processor: rates.processor * (self.condensation + self.others) / threads,
            device: rates.start + of_threads.max(rates.device * self.condensation),
        }
    }
}

impl Forecast {
    /// Whether the device is clearly faster.
    pub fn prefers_device(&self) -> bool {
        self.device < CLEARLY * self.processor
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// `configs/random.toml` with so many designs and another line for one of its own.
    fn study(count: u64, line: &str, other: &str) -> Study {
        let config = include_str!("../../configs/random.toml");
        assert!(config.contains(line) && config.contains("count  = 10000"), "{line}");
        let text = config.replace(line, other).replace("count  = 10000", &format!("count = {count}"));
        Study::from_text(Path::new("random.toml"), text).unwrap()
    }

    const RATES: Rates = Rates { processor: 1.0, device: 0.01, host: 1e-6, start: 1.0 };

    /// What is looked at stands for all: twice the designs need twice as much, and as `DesignCost` has it.
    #[test]
    fn a_sweep_needs_what_its_designs_need() {
        let all = study(200_000, "", "");
        let demand = Demand::worth_a_device(&all, 1).unwrap();
        let cost = DesignCost::of_study(&all);
        let sum: f64 = all.cases().unwrap().take(2000).map(|case| cost.seconds(&case.unwrap())).sum();
        let told = demand.condensation + demand.others;
        assert!((told / (100.0 * sum) - 1.0).abs() < 0.05, "{told} {sum}");
        let twice = Demand::worth_a_device(&study(400_000, "", ""), 1).unwrap();
        assert!((twice.condensation / demand.condensation - 2.0).abs() < 0.1, "{twice:?} {demand:?}");
        // More threads are through with it in no time.
        assert!(demand.condensation > WORTH);
        assert_eq!(Demand::worth_a_device(&all, (demand.condensation / WORTH) as usize + 1), None);
    }

    /// Small ones, and those that are interpolated.
    #[test]
    fn sweeps_with_little_to_condense_ask_no_device() {
        assert_eq!(Demand::worth_a_device(&study(1000, "", ""), 1), None);
        let interpolated = study(1_000_000, "interpolation = \"off\"", "interpolation = \"auto\"");
        assert_eq!(Demand::worth_a_device(&interpolated, 1), None);
    }

    /// Bodies that come again are condensed once, on either side of the joint.
    #[test]
    fn what_comes_again_is_needed_once() {
        let of = |core: &str, outer: &str| {
            let text = format!(
                r#"
                [joint]
                idealization = "plane-stress"
                hole_radius = "10 mm"
                radial_clearance = {{ from = "0.01 mm", to = "0.1 mm" }}
                thickness = "5 mm"
                [joint.pin]
                model = "rigid-core"
                core_radius_ratio = {core}
                youngs_modulus = "210 GPa"
                poissons_ratio = 0.3
                [joint.plate]
                model = "annulus"
                outer_radius_ratio = {outer}
                youngs_modulus = "70 GPa"
                poissons_ratio = 0.3
                [load]
                indentation = "0.01 mm"
                [sampling]
                method = "sobol"
                count = 1000000
                [solve]
                method = "fe"
                interpolation = "off"
                "#
            );
            let study = Study::from_text(Path::new("again.toml"), text).unwrap();
            Demand::worth_a_device(&study, 1)
        };
        let [core, outer] = ["{ from = 0.2, to = 0.3 }", "{ from = 2.0, to = 3.0 }"];
        let both = of(core, outer).unwrap().condensation;
        for (core, outer) in [(core, "2.5"), ("0.25", outer)] {
            let one = of(core, outer).unwrap().condensation;
            assert!((one / both - 0.5).abs() < 0.1, "{core} {outer}: {one} {both}");
        }
        assert_eq!(of("0.25", "2.5"), None);
    }

    /// The slower of both threads and device counts, and what it takes to begin.
    #[test]
    fn the_device_is_taken_where_it_is_clearly_faster() {
        let demand = Demand { bodies: 2e6, condensation: 60.0, others: 20.0 };
        let Forecast { processor, device } = demand.forecast(&RATES, 2);
        assert_eq!((processor, device), (40.0, 1.0 + 11.0));
        let of = |rates: Rates, threads: usize| demand.forecast(&rates, threads).prefers_device();
        assert!(of(RATES, 2) && of(RATES, 16));
        for (is_taken, rates) in [
            // Where the device is the slower one.
            (true, Rates { device: 0.5, ..RATES }),
            (false, Rates { device: 0.55, ..RATES }),
            // What threads do for it.
            (false, Rates { host: 3e-5, ..RATES }),
            (false, Rates { start: 30.0, ..RATES }),
            // All threads are slower than was thought, the device is not.
            (true, Rates { processor: 10.0, device: 1.0, host: 1e-4, ..RATES }),
        ] {
            assert_eq!(of(rates, 2), is_taken, "{rates:?}");
        }
        assert!(!of(Rates { device: 0.12, ..RATES }, 16));
    }
}
