//! A device that runs out of memory in the middle of a sweep. Alone in its file, because it takes memory from the whole
//! process.

#[path = "../common"]
mod common {
    pub mod random;
    #[allow(dead_code, reason = "only concentric joints are drawn here")]
    pub mod draws;
}

use common::draws;
use jointsweep::internals::engine::backend::gpu::context::{AdapterChoice, Adapters, GpuError};
use jointsweep::internals::engine::backend::gpu::kernels::Precision;
use jointsweep::internals::engine::backend::gpu::solver::{GpuChoice, GpuCondenser};
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::BackendKind;
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use rlimit::Resource;

/// Software Vulkan takes its memory from the process: once that may have no more than it has and some, a large batch is
/// refused, the processor solves it, and no design is lost.
#[test]
#[cfg_attr(not(vulkan_driver), ignore = "no Vulkan driver here")]
fn without_memory_the_processor_takes_over() {
    let gpu = Adapters::enumerate().open(AdapterChoice::Named("llvmpipe")).unwrap();
    let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Fe };
    let few = draws::draw(31, 8, draws::concentric);
    // Of one topology on either side, which none of the first has met: batches as large as the first guess of their time
    // makes them.
    let mut many = draws::draw(32, 2000, draws::concentric);
    for (index, case) in many.iter_mut().enumerate() {
        let joint = &mut case.joint;
        joint.idealization = Idealization::PlaneStrain;
        joint.pin.parameters[0] = 0.28 + 1e-5 * index as f64;
        joint.plate.parameters[0] = 2.9 + 1e-4 * index as f64;
    }
    let condenser = GpuCondenser::new(GpuChoice { device: &gpu, precision: Precision::F64 }).unwrap();
    let mut ladder = Ladder::new(options).on(Box::new(condenser));
    // All kernels are made, all threads started.
    let before = ladder.solve(&few);
    assert_eq!(ladder.library.lost(), None);
    assert_eq!(before.len(), few.len());
    assert!(before.iter().all(|outcome| outcome.backend == BackendKind::Gpu));

    let allowed = virtual_memory() + MEMORY_LEFT;
    rlimit::setrlimit(Resource::AS, allowed, allowed).unwrap();
    let outcomes = ladder.solve(&many);
    let reason = ladder.library.lost();
    println!("{reason:?}");
    let Some(GpuError::Failed { what, problem, .. }) = reason else { panic!("{reason:?}") };
    assert!(problem.to_lowercase().contains("memory"), "{what}: {problem}");
    assert_eq!(outcomes.len(), many.len());
    for (outcome, case) in outcomes.iter().zip(&many) {
        assert_eq!((outcome.case.index, outcome.backend), (case.index, BackendKind::Cpu));
        assert!(outcome.steps.iter().all(|step| step.response.is_some()), "{outcome:?}");
    }
}

/// Enough for the processor, bytes, and less than the device asks for a batch of these bodies.
const MEMORY_LEFT: u64 = 100 << 20;

/// Bytes of address space that this process has.
fn virtual_memory() -> u64 {
    let sizes = std::fs::read_to_string("/proc/self/statm").unwrap();
    let pages: u64 = sizes.split_whitespace().next().unwrap().parse().unwrap();
    pages * 4096
}
