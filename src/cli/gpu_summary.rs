//! What `jointsweep bench-gpu` says of its figures.

use jointsweep::internals::engine::backend::gpu::context::GpuDevice;
use jointsweep::internals::lab::gpu::figures::{GpuSweep, PrecisionRow, ScalingRow, Shares};
use jointsweep::internals::lab::gpu::measure::KernelTime;
use jointsweep::internals::lab::gpu::roofline::Peaks;

use super::report::{aligned, duration};

/// One sweep.
pub fn told(sweep: &GpuSweep) -> String {
    format!(
        "{} designs in {}, {:.0} designs/s",
        sweep.designs,
        duration(sweep.seconds),
        sweep.designs_per_second()
    )
}

/// All figures that there are.
pub fn summary(
    gpu: &GpuDevice,
    precisions: &[PrecisionRow],
    scaling: &[ScalingRow],
    kernels: &[KernelTime],
    peaks: &[Peaks],
) -> String {
    let mut text = format!("{}, {}\n", gpu.facts.name, gpu.facts.driver);
    let mut lines =
        vec![["precision", "designs", "wall", "designs/s", "solves/s", "worst difference"].map(String::from)];
    lines.extend(precisions.iter().map(|PrecisionRow { precision, sweep, worst_difference, .. }| {
        [
            precision.to_string(),
            sweep.designs.to_string(),
            duration(sweep.seconds),
            format!("{:.0}", sweep.designs_per_second()),
            format!("{:.0}", sweep.solves as f64 / sweep.seconds),
            format!("{worst_difference:.1e}"),
        ]
    }));
    append(&mut text, "", &lines);

    let precision = scaling.first().map_or("", |row| row.precision);
    let header = [
        "plates",
        "accuracy",
        "solver",
        "designs",
        "wall",
        "designs/s",
        "with table",
        "processor",
        "GPU/CPU",
        "interpolated",
        "on the GPU",
        "busy",
        "waits",
        "kernels",
    ];
    let mut lines = vec![header.map(String::from)];
    lines.extend(scaling.iter().map(|row| {
        let ScalingRow { measured, sweep, with_table, cpu_seconds, .. } = row;
        [
            measured.scene.to_string(),
            measured.accuracy.to_string(),
            measured.solver.name().to_string(),
            sweep.designs.to_string(),
            duration(sweep.seconds),
            format!("{:.0}", sweep.designs_per_second()),
            with_table.map_or(String::new(), |(seconds, _)| duration(seconds)),
            cpu_seconds.map_or(String::new(), duration),
            cpu_seconds.map_or(String::new(), |seconds| format!("{:.3}", seconds / sweep.seconds)),
            row.cpu_interpolated_seconds.map_or(String::new(), duration),
            row.gpu_interpolated_seconds.map_or(String::new(), duration),
            sweep.busy_share().map_or(String::new(), |share| format!("{:.1} %", 100.0 * share)),
            sweep.asked.waits.to_string(),
            duration(sweep.kernels_seconds),
        ]
    }));
    append(&mut text, &format!("in {precision}\n"), &lines);

    let header = [
        "kernel",
        "precision",
        "level",
        "items",
        "time",
        "GFLOP/s",
        "of peak",
        "GB/s",
        "of peak",
        "bound by",
        "of it",
    ]
    .map(String::from);
    let mut lines = vec![header];
    lines.extend(kernels.iter().map(|time| {
        let shares = Shares::of(time, peaks);
        let bound = shares.map(|shares| shares.bound());
        let giga = |count: u64| match count {
            0 => String::new(),
            count => format!("{:.1}", 1e-9 * count as f64 / time.seconds),
        };
        let percent =
            |share: Option<f64>| share.map_or(String::new(), |share| format!("{:.1} %", 100.0 * share));
        [
            time.kernel.to_string(),
            time.precision.name().to_string(),
            time.level.to_string(),
            time.items.to_string(),
            duration(time.seconds),
            giga(time.work.operations),
            percent(shares.and_then(|shares| shares.arithmetic).map(|(_, share)| share)),
            giga(time.work.bytes),
            percent(shares.map(|shares| shares.memory.1)),
            bound.map_or(String::new(), |(name, _)| name.to_string()),
            percent(bound.map(|(_, share)| share)),
        ]
    }));
    append(&mut text, "", &lines);
    text
}

/// A table under its title, if there is more of it than its header.
fn append<const COLUMNS: usize>(text: &mut String, title: &str, lines: &[[String; COLUMNS]]) {
    if lines.len() > 1 {
        *text += &format!("\n{title}{}", aligned(lines));
    }
}
