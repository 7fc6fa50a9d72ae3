//! The rows of a GPU's benchmark, and the tables they are written as.

use crate::engine::backend::Counts;
use crate::lab::gpu::measure::KernelTime;
use crate::lab::gpu::measured_sweep::MeasuredSweep;
use crate::lab::gpu::roofline::Peaks;

/// A whole sweep on the GPU.
#[derive(Clone, Debug)]
pub struct GpuSweep {
    pub designs: u64,
    /// Wall time, from the plans to the last outcome, s.
    pub seconds: f64,
    /// Columns that conjugate gradients solved for.
    pub solves: u64,
    /// Designs that the processor solved all the same.
    pub designs_on_cpu: u64,
    /// The greatest |b - K x|/|b| that an outcome rests on.
    pub worst_residual: f64,
    /// What elimination and joints have asked of the device.
    pub asked: Counts,
    /// Time spent on making kernels, s.
    pub kernels_seconds: f64,
    /// Whether passes were timed.
    pub is_timed: bool,
    /// Wall time of each stage, s, in the order they run.
    pub stages: Vec<(String, f64)>,
}

/// A precision, checked against the processor and timed.
#[derive(Clone, Debug)]
pub struct PrecisionRow {
    pub precision: &'static str,
    /// The sweep of the median time.
    pub sweep: GpuSweep,
    /// Designs of the check, and the worst relative difference of their forces from the processor's.
    pub checked: u64,
    pub worst_difference: f64,
}

/// A size of a sweep.
#[derive(Clone, Debug)]
pub struct ScalingRow {
    pub measured: MeasuredSweep,
    pub precision: &'static str,
    pub sweep: GpuSweep,
    /// With the table written as well, s, and its bytes; `None` where there was no room for it.
    pub with_table: Option<(f64, u64)>,
    /// On the processor of the same machine, without a table, s.
    pub cpu_seconds: Option<f64>,
    /// The same with bodies interpolated, s.
    pub cpu_interpolated_seconds: Option<f64>,
    /// And on the GPU, if that solves their contact, s.
    pub gpu_interpolated_seconds: Option<f64>,
}

/// A sweep with answers instead of a table: wall times of the whole, s.
#[derive(Clone, Copy, Debug)]
pub struct AnswersRow {
    /// Whether its bodies are interpolated; all are condensed otherwise.
    pub is_interpolated: bool,
    pub designs: u64,
    pub gpu_seconds: f64,
    pub cpu_seconds: Option<f64>,
    /// Of the device, and whether that tells how long its work took.
    pub asked: Counts,
    pub is_timed: bool,
}

impl GpuSweep {
    pub fn designs_per_second(&self) -> f64 {
        self.designs as f64 / self.seconds
    }

    /// Share of the wall time in which the device was at work on elimination and joints.
    pub fn busy_share(&self) -> Option<f64> {
        (self.is_timed && self.asked.dispatches > 0).then(|| self.asked.busy.as_secs_f64() / self.seconds)
    }
}

/// A kernel's time against the peaks of its device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// Time that the operations alone would take at the arithmetic peak, s, and the share of it in the time measured;
    /// `None` for a kernel without operations. Of `pcg` this is the floor on the chip.
    pub arithmetic: Option<(f64, f64)>,
    /// The same for the bytes at the peak of the memory.
    pub memory: (f64, f64),
    /// And for those between workgroups and the cache of all, and within workgroups' own memories; `None` where they are not counted.
    pub cache: Option<(f64, f64)>,
    pub workgroup: Option<(f64, f64)>,
    /// And for the fewest instructions at the rate of multiply-adds in the numbers that the device is fastest in, each of which is one.
    pub issue: Option<(f64, f64)>,
}

impl Shares {
    /// `None` where the peak of the kernel's numbers was not measured.
    pub fn of(time: &KernelTime, peaks: &[Peaks]) -> Option<Shares> {
        let own = peaks.iter().find(|peaks| peaks.precision.wide_bytes() == time.number_bytes)?;
        // One memory, whatever the numbers.
        let best = |of: fn(&Peaks) -> f64| peaks.iter().map(of).fold(0.0, f64::max);
        let share = |work: u64, peak: f64| {
            let floor = work as f64 / peak;
            (floor, floor / time.seconds)
        };
        let operations = time.work.operations;
        Some(Shares {
            arithmetic: (operations > 0).then(|| share(operations, own.operations)),
            memory: share(time.work.bytes, best(|peaks| peaks.bytes)),
            cache: time.inner.map(|inner| share(inner.cached, best(|peaks| peaks.cached_bytes))),
            workgroup: time
                .inner
                .and_then(|inner| inner.workgroup)
                .map(|bytes| share(bytes, best(|peaks| peaks.workgroup_bytes))),
            issue: time.inner.map(|inner| {
                share(inner.fewest_instructions(operations), best(|peaks| 0.5 * peaks.operations))
            }),
        })
    }

    /// Which of those that are known binds it, and the share of that.
    pub fn bound(&self) -> (&'static str, f64) {
        let others = [
            ("arithmetic", self.arithmetic),
            ("cache", self.cache),
            ("workgroup", self.workgroup),
            ("issue", self.issue),
        ];
        others.into_iter().fold(("memory", self.memory.1), |most, (name, own)| match own {
            Some((_, share)) if share > most.1 => (name, share),
            _ => most,
        })
    }
}

/// Six digits, as many as a time is good for.
fn number(value: f64) -> String {
    format!("{value:.5e}")
}

fn optional(value: Option<f64>) -> String {
    value.map_or(String::new(), number)
}

fn line(cells: &[String]) -> String {
    cells.join(",") + "\n"
}

/// Names of the stages of the first sweep as columns.
fn stage_columns(sweep: Option<&GpuSweep>) -> Vec<String> {
    sweep.map_or(Vec::new(), |sweep| sweep.stages.iter().map(|(name, _)| name.clone()).collect())
}

fn stage_header(stages: &[String]) -> String {
    stages.iter().map(|stage| format!(",{}_s", stage.to_lowercase().replace(' ', "_"))).collect()
}

fn stage_cells(stages: &[String], sweep: &GpuSweep) -> Vec<String> {
    let time = |stage: &String| sweep.stages.iter().find(|(name, _)| name == stage).map(|(_, time)| *time);
    stages.iter().map(|stage| optional(time(stage))).collect()
}

/// `precisions.csv`.
pub fn precisions(rows: &[PrecisionRow]) -> String {
    let stages = stage_columns(rows.first().map(|row| &row.sweep));
    let mut text = "precision,designs,wall_s,designs_per_s,solves,solves_per_s,designs_on_cpu,worst_residual,\
                    checked_designs,worst_difference"
        .to_string()
        + &stage_header(&stages) + "\n";
    for PrecisionRow { precision, sweep, checked, worst_difference } in rows {
        let own = [
            precision.to_string(),
            sweep.designs.to_string(),
            number(sweep.seconds),
            number(sweep.designs_per_second()),
            sweep.solves.to_string(),
            number(sweep.solves as f64 / sweep.seconds),
            sweep.designs_on_cpu.to_string(),
            number(sweep.worst_residual),
            checked.to_string(),
            number(*worst_difference),
        ];
        text += &line(&[&own[..], &stage_cells(&stages, sweep)].concat());
    }
    text
}

/// `scaling.csv`.
pub fn scaling(rows: &[ScalingRow]) -> String {
    let stages = stage_columns(rows.first().map(|row| &row.sweep));
    let mut text =
        "scene,accuracy,solver,designs,precision,wall_s,designs_per_s,solves,designs_on_cpu,with_table_s,\
                    table_bytes,cpu_wall_s,cpu_designs_per_s,gpu_over_cpu,cpu_interpolated_wall_s,gpu_interpolated_wall_s,\
                    dispatches,submits,waits,bytes_up,bytes_down,kernels_s,busy_share"
            .to_string()
            + &stage_header(&stages)
            + "\n";
    for row in rows {
        let ScalingRow { measured, precision, sweep, with_table, cpu_seconds, .. } = row;
        let own = [
            measured.scene.to_string(),
            measured.accuracy.to_string(),
            measured.solver.name().to_string(),
            sweep.designs.to_string(),
            precision.to_string(),
            number(sweep.seconds),
            number(sweep.designs_per_second()),
            sweep.solves.to_string(),
            sweep.designs_on_cpu.to_string(),
            optional(with_table.map(|(seconds, _)| seconds)),
            with_table.map_or(String::new(), |(_, bytes)| bytes.to_string()),
            optional(*cpu_seconds),
            optional(cpu_seconds.map(|seconds| sweep.designs as f64 / seconds)),
            optional(cpu_seconds.map(|seconds| seconds / sweep.seconds)),
            optional(row.cpu_interpolated_seconds),
            optional(row.gpu_interpolated_seconds),
            sweep.asked.dispatches.to_string(),
            sweep.asked.submits.to_string(),
            sweep.asked.waits.to_string(),
            sweep.asked.bytes_up.to_string(),
            sweep.asked.bytes_down.to_string(),
            number(sweep.kernels_seconds),
            optional(sweep.busy_share()),
        ];
        text += &line(&[&own[..], &stage_cells(&stages, sweep)].concat());
    }
    text
}

/// `answers.csv`.
pub fn answers(rows: &[AnswersRow]) -> String {
    let mut text = "bodies,designs,gpu_wall_s,gpu_designs_per_s,cpu_wall_s,cpu_designs_per_s,gpu_busy_s,waits,bytes_up,bytes_down\n".to_string();
    for AnswersRow { is_interpolated, designs, gpu_seconds, cpu_seconds, asked, is_timed } in rows {
        let rate = |seconds: f64| *designs as f64 / seconds;
        text += &line(&[
            (if *is_interpolated { "interpolated" } else { "condensed" }).to_string(),
            designs.to_string(),
            number(*gpu_seconds),
            number(rate(*gpu_seconds)),
            optional(*cpu_seconds),
            optional(cpu_seconds.map(rate)),
            optional(is_timed.then(|| asked.busy.as_secs_f64())),
            asked.waits.to_string(),
            asked.bytes_up.to_string(),
            asked.bytes_down.to_string(),
        ]);
    }
    text
}

/// `kernels.csv`.
pub fn kernels(times: &[KernelTime], peaks: &[Peaks]) -> String {
    let mut text = "kernel,precision,number_bytes,level,unknowns,items,seconds,iterations,operations,bytes,\
                    gflop_per_s,gb_per_s,arithmetic_floor_s,arithmetic_share,memory_floor_s,memory_share,\
                    cached_bytes,cache_share,workgroup_bytes,workgroup_share,instructions,issue_share,bound,bound_share\n"
        .to_string();
    for time in times {
        let shares = Shares::of(time, peaks);
        let arithmetic = shares.and_then(|shares| shares.arithmetic);
        let memory = shares.map(|shares| shares.memory);
        let giga = |count: u64| number(1e-9 * count as f64 / time.seconds);
        let count = |count: Option<u64>| count.map_or(String::new(), |count| count.to_string());
        let share = |own: Option<(f64, f64)>| optional(own.map(|(_, share)| share));
        text += &line(&[
            time.kernel.to_string(),
            time.precision.name().to_string(),
            time.number_bytes.to_string(),
            time.level.to_string(),
            time.unknowns.to_string(),
            time.items.to_string(),
            number(time.seconds),
            count(time.iterations),
            time.work.operations.to_string(),
            time.work.bytes.to_string(),
            if time.work.operations > 0 { giga(time.work.operations) } else { String::new() },
            giga(time.work.bytes),
            optional(arithmetic.map(|(floor, _)| floor)),
            optional(arithmetic.map(|(_, share)| share)),
            optional(memory.map(|(floor, _)| floor)),
            optional(memory.map(|(_, share)| share)),
            count(time.inner.map(|inner| inner.cached)),
            share(shares.and_then(|shares| shares.cache)),
            count(time.inner.and_then(|inner| inner.workgroup)),
            share(shares.and_then(|shares| shares.workgroup)),
            count(time.inner.map(|inner| inner.fewest_instructions(time.work.operations))),
            share(shares.and_then(|shares| shares.issue)),
            shares.map_or(String::new(), |shares| shares.bound().0.to_string()),
            optional(shares.map(|shares| shares.bound().1)),
        ]);
    }
    text
}

/// `peaks.csv`.
pub fn peaks(rows: &[Peaks]) -> String {
    let mut text = "numbers,multiply_add_gflop_per_s,copy_gb_per_s,copy_buffer_bytes,cached_gb_per_s,cached_region_bytes,\
                    workgroup_gb_per_s\n"
        .to_string();
    for peaks in rows {
        text += &line(&[
            peaks.precision.name().to_string(),
            number(1e-9 * peaks.operations),
            number(1e-9 * peaks.bytes),
            peaks.buffer_bytes.to_string(),
            number(1e-9 * peaks.cached_bytes),
            peaks.cached_region_bytes.to_string(),
            number(1e-9 * peaks.workgroup_bytes),
        ]);
    }
    text
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::engine::backend::gpu::kernels::Precision;
    use crate::lab::gpu::measured_sweep::SWEEPS;
    use crate::lab::gpu::work::{Inner, Work};

    fn time(operations: u64, bytes: u64) -> KernelTime {
        KernelTime {
            kernel: "pcg",
            precision: Precision::Mixed,
            number_bytes: 4,
            level: 1,
            unknowns: 100,
            items: 7,
            seconds: 2.0,
            work: Work { operations, bytes },
            inner: None,
            iterations: Some(3),
        }
    }

    const PEAKS_OF_F32: Peaks = Peaks {
        precision: Precision::F32,
        operations: 1e12,
        bytes: 1e11,
        buffer_bytes: 64,
        cached_bytes: 4e11,
        cached_region_bytes: 8,
        workgroup_bytes: 1e12,
    };

    const PEAKS_OF_BOTH: [Peaks; 2] = [
        PEAKS_OF_F32,
        Peaks {
            precision: Precision::F64,
            operations: 1e11,
            bytes: 2e11,
            cached_bytes: 3e11,
            workgroup_bytes: 2e12,
            ..PEAKS_OF_F32
        },
    ];

    /// 1e12 operations of f32 take a second, 2e11 bytes one too: the memory's peak is the better of both copies.
    #[test]
    fn shares_are_of_the_peaks_of_the_own_numbers() {
        let shares = Shares::of(&time(1_000_000_000_000, 100_000_000_000), &PEAKS_OF_BOTH).unwrap();
        let without_inner = Shares {
            arithmetic: Some((1.0, 0.5)),
            memory: (0.5, 0.25),
            cache: None,
            workgroup: None,
            issue: None,
        };
        assert_eq!(shares, without_inner);
        assert_eq!(shares.bound(), ("arithmetic", 0.5));
        let wide = KernelTime { number_bytes: 8, ..time(100_000_000_000, 0) };
        assert_eq!(Shares::of(&wide, &PEAKS_OF_BOTH).unwrap().arithmetic, Some((1.0, 0.5)));
        assert_eq!(Shares::of(&wide, &PEAKS_OF_BOTH[..1]), None);
        assert_eq!(Shares::of(&time(0, 8), &PEAKS_OF_BOTH).unwrap().arithmetic, None);
    }

    /// In 2 s, 6e11 bytes of 4e11 a second, and 3e12 of 2e12; 5e11 multiply-adds and 2.25e11 accesses of 5e11 a second.
    #[test]
    fn what_binds_most_is_the_bound() {
        let inner = Inner { cached: 600_000_000_000, workgroup: Some(3_000_000_000_000) };
        let of = |inner| KernelTime { inner: Some(inner), ..time(1_000_000_000_000, 100_000_000_000) };
        let shares = Shares::of(&of(inner), &PEAKS_OF_BOTH).unwrap();
        assert_eq!((shares.cache, shares.workgroup), (Some((1.5, 0.75)), Some((1.5, 0.75))));
        assert_eq!(shares.issue, Some((1.45, 0.725)));
        assert_eq!(shares.bound(), ("cache", 0.75));
        let busy = KernelTime { work: Work { operations: 1_200_000_000_000, bytes: 0 }, ..of(inner) };
        assert_eq!(Shares::of(&busy, &PEAKS_OF_BOTH).unwrap().bound(), ("issue", 0.825));
        let more = Inner { workgroup: Some(3_200_000_000_000), ..inner };
        assert_eq!(Shares::of(&of(more), &PEAKS_OF_BOTH).unwrap().bound(), ("workgroup", 0.8));
        let text = kernels(&[of(more)], &PEAKS_OF_BOTH);
        let end =
            "600000000000,7.50000e-1,3200000000000,8.00000e-1,737500000000,7.37500e-1,workgroup,8.00000e-1\n";
        assert!(text.ends_with(end), "{text}");
    }

    #[test]
    fn figures_that_are_not_there_are_empty_cells() {
        let text = kernels(&[time(0, 200_000_000_000)], &PEAKS_OF_BOTH);
        let row = text.lines().nth(1).unwrap();
        assert_eq!(
            row,
            "pcg,mixed,4,1,100,7,2.00000e0,3,0,200000000000,,1.00000e2,,,1.00000e0,5.00000e-1,,,,,,,memory,5.00000e-1"
        );
    }

    #[test]
    fn answers_have_rates_of_both() {
        let asked = Counts {
            busy: Duration::from_millis(500),
            waits: 3,
            bytes_up: 7,
            bytes_down: 9,
            ..Counts::default()
        };
        let row = AnswersRow {
            is_interpolated: true,
            designs: 100,
            gpu_seconds: 2.0,
            cpu_seconds: Some(4.0),
            asked,
            is_timed: true,
        };
        let without = AnswersRow { is_interpolated: false, cpu_seconds: None, is_timed: false, ..row };
        let text = answers(&[row, without]);
        let lines: Vec<&str> = text.lines().skip(1).collect();
        let expected = [
            "interpolated,100,2.00000e0,5.00000e1,4.00000e0,2.50000e1,5.00000e-1,3,7,9",
            "condensed,100,2.00000e0,5.00000e1,,,,3,7,9",
        ];
        assert_eq!(lines, expected);
    }

    #[test]
    fn rates_are_those_of_the_sweep() {
        let sweep = GpuSweep {
            designs: 100,
            seconds: 4.0,
            solves: 800,
            designs_on_cpu: 1,
            worst_residual: 1e-4,
            asked: Counts {
                dispatches: 9,
                submits: 8,
                waits: 7,
                bytes_up: 6,
                bytes_down: 5,
                busy: Duration::from_secs(1),
                ..Counts::default()
            },
            kernels_seconds: 0.75,
            is_timed: true,
            stages: vec![("condensation on the GPU".into(), 0.5)],
        };
        let row = ScalingRow {
            measured: SWEEPS[1],
            precision: "f32",
            sweep,
            with_table: Some((5.0, 99)),
            cpu_seconds: Some(8.0),
            cpu_interpolated_seconds: Some(2.5),
            gpu_interpolated_seconds: Some(0.25),
        };
        let empty = ScalingRow {
            cpu_seconds: None,
            cpu_interpolated_seconds: None,
            gpu_interpolated_seconds: None,
            sweep: GpuSweep { is_timed: false, ..row.sweep.clone() },
            ..row.clone()
        };
        let text = scaling(&[row, empty]);
        let lines: Vec<&str> = text.lines().collect();
        assert!(
            lines[0].ends_with("bytes_down,kernels_s,busy_share,condensation_on_the_gpu_s"),
            "{}",
            lines[0]
        );
        let asked = "9,8,7,6,5,7.50000e-1";
        let start = "concentric,0.1 %,auto,100,f32,4.00000e0,2.50000e1,800,1,5.00000e0,99,";
        let times = "8.00000e0,1.25000e1,2.00000e0,2.50000e0,2.50000e-1";
        assert_eq!(lines[1], format!("{start}{times},{asked},2.50000e-1,5.00000e-1"));
        assert_eq!(lines[2], format!("{start},,,,,{asked},,5.00000e-1"));
    }
}
