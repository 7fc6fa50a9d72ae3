//! Writes the texts of the kernels in f32 to a folder, as a browser's compiler takes them.
//!
//! ```text
//! cargo run --release --example kernel_texts -- target/kernel_texts
//! ```

use std::path::PathBuf;

use jointsweep::internals::engine::backend::gpu::batch::OnChip;
use jointsweep::internals::engine::backend::gpu::front::Front;
use jointsweep::internals::engine::backend::gpu::kernel_texts::{
    ANSWERING, ANSWERS, JOINTS, KERNEL_FILES, Sums, Variant,
};
use jointsweep::internals::engine::backend::gpu::kernels::Precision;
use jointsweep::internals::engine::backend::joints::{JointKind, MOST_NODES, TERMS};
use jointsweep::internals::engine::question::Question;
use jointsweep::internals::lab::gpu::measured_sweep::SWEEPS;

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args_os().nth(1).expect("a folder to write to"));
    std::fs::create_dir_all(&folder)?;
    for file in KERNEL_FILES {
        let plain = Variant::plain(Precision::F32, 64);
        for (name, sums, on_chip, is_on_chip) in [
            ("tree", Sums::Tree, OnChip::NOTHING, false),
            ("subgroups", Sums::Subgroups, OnChip { vectors: 4, capacity: 192 }, true),
        ] {
            let variant = Variant { on_chip, front: Front { rows: 16, is_on_chip }, sums, ..plain };
            std::fs::write(folder.join(format!("{}-{name}.wgsl", file.name)), file.variant(&variant))?;
        }
    }
    for (terms, together) in TERMS.into_iter().flat_map(|terms| [(terms, 1), (terms, 2)]) {
        let joints = JointKind { terms, together };
        let variant = Variant { joints, ..Variant::plain(Precision::F32, MOST_NODES as u32) };
        std::fs::write(folder.join(format!("joints-{terms}-{together}.wgsl")), JOINTS.variant(&variant))?;
    }
    let sweep = SWEEPS[0].answers(1000, true).expect("it is sound");
    let question = Question::of(&sweep).expect("a device knows what is asked");
    let answers = ANSWERS.variant(&Variant::plain(Precision::F32, ANSWERING)) + &question.text;
    std::fs::write(folder.join("answers.wgsl"), answers)
}
