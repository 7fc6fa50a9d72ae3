//! Whether a device would be through with a sweep sooner than the processor.
//!
//! Designs that are spread over the sweep tell what it needs, by `unit_costs`; how fast the processor and the device are is
//! measured (`backend::rates`). While the device condenses and solves joints, the processor does all else, so that the slower of both counts.

use foldhash::HashSet;

use crate::engine::backend::rates::Rates;
use crate::engine::cost::{DesignCost, DesignParts, Part};
use crate::engine::distinct::distinct_among;
use crate::engine::interpolation::drawn_on_device::Drawing;
use crate::engine::interpolation::fit_plan::{LOOKED_AT, picks};
use crate::engine::question::Question;
use crate::engine::unit_costs::{Pace, Time};
use crate::study::config::Study;

/// What the designs of a sweep need, on one thread of the processor, s by `unit_costs`; as in `DesignParts`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    pub bodies: Part,
    pub saved: f64,
    pub on_meshes: Part,
    pub interpolated: Part,
    pub others: Time,
    /// What of `others` a device does that solves joints on meshes, and interpolated ones: it counts their rows where none is written.
    pub counted: [f64; 2],
    /// Whether a device with f64 draws those designs itself: nothing is made for them here.
    pub drawn: bool,
}

/// How long a sweep takes, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    pub processor: f64,
    pub device: f64,
}

/// Sweeps whose condensation and contact take the processor less than this, s, are not worth opening a device and measuring it.
const WORTH: f64 = 3.0;

/// The same where the machine was measured before, of the time by its own pace.
const WORTH_KNOWN: f64 = 1.0;

/// Fewer designs do not fill a device, however long each takes.
const FEWEST: u64 = 256;

/// Designs that are looked at first.
const FIRST: usize = 16;

/// A device is taken where it needs less than this of the processor's time: a forecast is right to some tenths.
const CLEARLY: f64 = 0.8;

impl Demand {
    /// Of a sweep on so many threads of a processor whose pace was measured, if it was; `None` where no device is worth asking, or a design
    /// cannot be read, which is told where designs are drawn.
    pub fn worth_a_device(study: &Study, threads: usize, processor: Option<Pace>) -> Option<Demand> {
        if study.design_count() < FEWEST {
            return None;
        }
        let (pace, least) = processor.map_or((Pace::OF_UNIT_COSTS, WORTH), |pace| (pace, WORTH_KNOWN));
        let is_worth_it = |demand: &Demand| demand.for_devices().at(pace) >= least * threads as f64;
        let numbers = picks(study.design_count(), LOOKED_AT);
        let few = numbers.iter().copied().step_by(numbers.len().div_ceil(FIRST).max(1));
        let first = Demand::of(study, &DesignCost::without_interpolation(study), few)?;
        if !is_worth_it(&first) {
            return None;
        }
        Demand::of(study, &DesignCost::of_study(study), numbers.iter().copied()).filter(is_worth_it)
    }

    /// What a device may do of it.
    fn for_devices(&self) -> Time {
        let in_lanes = self.bodies.seconds - self.saved + self.on_meshes.seconds;
        Time { in_lanes, others: self.interpolated.seconds }
    }

    /// By designs that stand for all.
    fn of(study: &Study, cost: &DesignCost, numbers: impl Iterator<Item = u64>) -> Option<Demand> {
        let (mut pins, mut plates) = (HashSet::default(), HashSet::default());
        let (mut seen, mut on_meshes, mut sum) = (0.0, 0.0, DesignParts::default());
        for case in study.cases_at(numbers).ok()? {
            let case = case.ok()?;
            let parts = cost.parts(&case);
            sum.bodies += parts.bodies;
            sum.saved += parts.saved;
            sum.on_meshes += parts.on_meshes;
            sum.interpolated += parts.interpolated;
            sum.others += parts.others;
            sum.rows_on_meshes += parts.rows_on_meshes;
            sum.rows_of_interpolated += parts.rows_of_interpolated;
            seen += 1.0;
            if parts.bodies.count > 0.0 {
                on_meshes += 1.0;
                let joint = &case.joint;
                pins.insert(joint.body(&joint.pin));
                plates.insert(joint.body(&joint.plate));
            }
        }
        if seen == 0.0 {
            return None;
        }
        // Each different body is condensed once.
        let of_all = study.design_count() as f64 / seen;
        let question = Question::of(study);
        let designs = on_meshes * of_all;
        let distinct = [pins, plates].map(|found| distinct_among(designs, on_meshes, found.len() as f64));
        let once = distinct.iter().sum::<f64>() / (2.0 * on_meshes).max(1.0);
        Some(Demand {
            bodies: sum.bodies * once,
            saved: sum.saved * once,
            on_meshes: sum.on_meshes * of_all,
            interpolated: sum.interpolated * of_all,
            others: sum.others * of_all,
            counted: [sum.rows_on_meshes, sum.rows_of_interpolated]
                .map(|rows| if question.is_some() { rows * of_all } else { 0.0 }),
            drawn: question.is_some_and(|question| Drawing::of(study, &question).is_some()),
        })
    }

    /// On a device that may have no f64.
    pub fn on(self, has_f64: bool) -> Demand {
        Demand { drawn: self.drawn && has_f64, ..self }
    }

    /// With the rates of a machine and so many threads.
    pub fn forecast(&self, rates: &Rates, threads: usize) -> Forecast {
        let threads = threads as f64;
        let (mut on_threads, mut on_device) = (self.others, self.bodies.seconds * rates.device);
        let mut host = rates.host * self.bodies.count;
        let of_interpolated = Time::of_others(self.interpolated.seconds);
        for (joints, time, counted, is_on_meshes) in [
            (self.on_meshes, Time::in_lanes(self.on_meshes.seconds), self.counted[0], true),
            (self.interpolated, of_interpolated, self.counted[1], false),
        ] {
            match rates.joints.filter(|joints| joints.on_meshes || !is_on_meshes) {
                Some(rates) => {
                    on_device += rates.device * joints.seconds;
                    host += if self.drawn && !is_on_meshes { 0.0 } else { rates.host * joints.count };
                    on_threads.others -= counted;
                }
                None => on_threads += time,
            }
        }
        Forecast {
            processor: (self.for_devices() + self.others).at(rates.processor) / threads,
            device: rates.start + ((on_threads.at(rates.processor) + host) / threads).max(on_device),
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
    use crate::engine::backend::rates::JointRates;

    /// `configs/random.toml` with so many designs and another line for one of its own.
    fn study(count: u64, line: &str, other: &str) -> Study {
        let config = include_str!("../../configs/random.toml");
        assert!(config.contains(line) && config.contains("count  = 10000"), "{line}");
        let text = config.replace(line, other).replace("count  = 10000", &format!("count = {count}"));
        Study::from_text(Path::new("random.toml"), text).unwrap()
    }

    const RATES: Rates =
        Rates { processor: Pace::OF_UNIT_COSTS, device: 0.01, host: 1e-6, start: 1.0, joints: Some(JOINTS) };

    const JOINTS: JointRates = JointRates { device: 0.02, host: 2e-6, on_meshes: true };

    /// What is looked at stands for all: twice the designs need twice as much, and as `DesignCost` has it.
    #[test]
    fn a_sweep_needs_what_its_designs_need() {
        let all = study(800_000, "", "");
        let demand = Demand::worth_a_device(&all, 1, None).unwrap();
        let cost = DesignCost::of_study(&all);
        let sum: f64 = all.cases().unwrap().take(2000).map(|case| cost.seconds(&case.unwrap())).sum();
        let told = (demand.for_devices() + demand.others).seconds();
        assert!((told / (400.0 * sum) - 1.0).abs() < 0.05, "{told} {sum}");
        let twice = Demand::worth_a_device(&study(1_600_000, "", ""), 1, None).unwrap();
        for (twice, once) in [(twice.bodies, demand.bodies), (twice.on_meshes, demand.on_meshes)] {
            assert!((twice.seconds / once.seconds - 2.0).abs() < 0.1, "{twice:?} {once:?}");
            assert!((twice.count / once.count - 2.0).abs() < 0.1, "{twice:?} {once:?}");
        }
        // A joint has two bodies.
        assert!((demand.bodies.count / demand.on_meshes.count - 2.0).abs() < 0.1, "{demand:?}");
        assert_eq!(demand.interpolated, Part::default());
        assert!(demand.saved > 0.3 * demand.bodies.seconds, "{demand:?}");
        // More threads are through with it in no time.
        let for_devices = demand.for_devices().seconds();
        assert!(for_devices > WORTH);
        let many = (for_devices / WORTH) as usize + 1;
        assert_eq!(Demand::worth_a_device(&all, many, None), None);
        // But for a machine that was measured.
        let at = |in_lanes, others| Demand::worth_a_device(&all, many, Some(Pace { in_lanes, others }));
        assert!(at(0.5, 0.1).is_some());
        assert_eq!(at(0.3, 10.0), None);
    }

    /// Small ones; fewer that are interpolated have little to solve.
    #[test]
    fn sweeps_with_little_to_solve_ask_no_device() {
        assert_eq!(Demand::worth_a_device(&study(1000, "", ""), 1, None), None);
        let interpolated = |count| study(count, "interpolation = \"off\"", "interpolation = \"auto\"");
        assert!(Demand::worth_a_device(&study(800_000, "", ""), 1, None).is_some());
        assert_eq!(Demand::worth_a_device(&interpolated(800_000), 1, None), None);
        let demand = Demand::worth_a_device(&interpolated(3_000_000), 1, None).unwrap();
        assert!((demand.interpolated.count / 3e6 - 1.0).abs() < 0.05, "{demand:?}");
        assert!(demand.interpolated.seconds > 10.0 * demand.bodies.seconds, "{demand:?}");
        assert_eq!(demand.counted, [0.0; 2]);
    }

    /// Where answers are all that is asked for, rows of interpolated designs may be the device's; to the processor they are less than written ones.
    #[test]
    fn counted_rows_are_the_devices() {
        let of = |output: &str| {
            let all =
                study(3_000_000, "interpolation = \"off\"", &format!("interpolation = \"auto\"\n{output}"));
            Demand::worth_a_device(&all, 1, None).unwrap()
        };
        let [written, answered] = ["", "[reduce]\nstatistics = [\"force\"]"].map(of);
        assert_eq!(answered.interpolated, written.interpolated);
        assert_eq!(written.counted, [0.0; 2]);
        assert!(answered.counted[1] > 0.5 * answered.others.seconds(), "{answered:?}");
        assert!(answered.others.seconds() < written.others.seconds(), "{answered:?}");
        let on_meshes = study(
            3_000_000,
            "interpolation = \"off\"",
            "interpolation = \"off\"\n[reduce]\nstatistics = [\"force\"]",
        );
        let [of_meshes, of_interpolated] = Demand::worth_a_device(&on_meshes, 1, None).unwrap().counted;
        assert!((of_meshes / answered.counted[1] - 1.0).abs() < 0.05 && of_interpolated == 0.0);
        // A device with f64 draws interpolated ones, too, whose numbers are not made here then.
        assert!(answered.drawn && !written.drawn);
        let rates =
            Rates { device: 0.0, start: 0.0, joints: Some(JointRates { device: 0.0, ..JOINTS }), ..RATES };
        let of = |demand: Demand| demand.forecast(&rates, 2).device;
        let numbers = of(answered.on(false)) - of(answered.on(true));
        let expected = JOINTS.host * answered.interpolated.count / 2.0;
        assert!((numbers / expected - 1.0).abs() < 1e-9, "{numbers} {expected}");
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
            Demand::worth_a_device(&study, 1, None)
        };
        let [core, outer] = ["{ from = 0.2, to = 0.3 }", "{ from = 2.0, to = 3.0 }"];
        let both = of(core, outer).unwrap().bodies.seconds;
        for (core, outer) in [(core, "2.5"), ("0.25", outer)] {
            let one = of(core, outer).unwrap().bodies.seconds;
            assert!((one / both - 0.5).abs() < 0.1, "{core} {outer}: {one} {both}");
        }
        // Joints all the same.
        assert!(of("0.25", "2.5").unwrap().bodies.seconds < 1e-3 * both);
    }

    /// The slower of both threads and device counts, and what it takes to begin.
    #[test]
    fn the_device_is_taken_where_it_is_clearly_faster() {
        let part = |count, seconds| Part { count, seconds };
        let demand = Demand {
            bodies: part(2e6, 60.0),
            saved: 0.0,
            on_meshes: part(1e6, 0.0),
            interpolated: part(0.0, 0.0),
            others: Time::of_others(16.0),
            counted: [0.0; 2],
            drawn: false,
        };
        let Forecast { processor, device } = demand.forecast(&RATES, 2);
        assert_eq!((processor, device), (38.0, 1.0 + 10.0));
        // Single precision is the processor's.
        let saving = Demand { saved: 30.0, ..demand }.forecast(&RATES, 2);
        assert_eq!(saving, Forecast { processor: 23.0, device });
        let of = |rates: Rates, threads: usize| demand.forecast(&rates, threads).prefers_device();
        assert!(of(RATES, 2) && of(RATES, 16));
        for (is_taken, rates) in [
            // Where the device is the slower one.
            (true, Rates { device: 0.48, ..RATES }),
            (false, Rates { device: 0.5, ..RATES }),
            // What threads do for it.
            (false, Rates { host: 3e-5, ..RATES }),
            (false, Rates { start: 30.0, ..RATES }),
            // All threads are slower than was thought, the device is not.
            (
                true,
                Rates { processor: Pace { in_lanes: 10.0, others: 10.0 }, device: 1.0, host: 1e-4, ..RATES },
            ),
            // What is left to them is.
            (false, Rates { processor: Pace { in_lanes: 1.0, others: 20.0 }, ..RATES }),
        ] {
            assert_eq!(of(rates, 2), is_taken, "{rates:?}");
        }
        assert!(!of(Rates { device: 0.12, ..RATES }, 16));
    }

    /// Joints are the device's where it solves such joints, and else the threads'.
    #[test]
    fn joints_go_where_they_are_solved() {
        let part = |count, seconds| Part { count, seconds };
        let none = part(0.0, 0.0);
        let on_meshes = Demand {
            bodies: none,
            saved: 0.0,
            on_meshes: part(1e6, 40.0),
            interpolated: none,
            others: Time::of_others(4.0),
            counted: [0.0; 2],
            drawn: false,
        };
        let interpolated = Demand { on_meshes: none, interpolated: part(1e6, 40.0), ..on_meshes };
        let joints = |on_meshes| JointRates { device: 0.2, host: 2e-6, on_meshes };
        // On the device 8 s of contact, on threads 4 of all else and 2 for its joints; or all of it.
        for (joints, of_meshes, of_interpolated) in [
            (Some(joints(true)), 8.0, 8.0),
            (Some(joints(false)), 44.0, 8.0),
            (Some(JointRates { device: 0.1, ..joints(true) }), 6.0, 6.0),
            (None, 44.0, 44.0),
        ] {
            let rates = Rates { start: 0.0, joints, ..RATES };
            for (demand, expected) in [(on_meshes, of_meshes), (interpolated, of_interpolated)] {
                let Forecast { processor, device } = demand.forecast(&rates, 1);
                assert_eq!((processor, device), (44.0, expected), "{joints:?}");
            }
        }
        // Rows that the device counts with the joints that it solves are nothing to the threads.
        let counting = Demand { counted: [0.0, 3.0], ..interpolated };
        let on_meshes = Demand { counted: [3.0, 0.0], ..on_meshes };
        let swift = |are_on_meshes| Some(JointRates { device: 0.05, ..joints(are_on_meshes) });
        for (joints, of_meshes, of_interpolated) in
            [(swift(true), 3.0, 3.0), (swift(false), 44.0, 3.0), (None, 44.0, 44.0)]
        {
            let rates = Rates { start: 0.0, joints, ..RATES };
            for (demand, expected) in [(on_meshes, of_meshes), (counting, of_interpolated)] {
                assert_eq!(demand.forecast(&rates, 1).device, expected, "{joints:?}");
            }
        }
    }
}
