//! Writes the texts of the kernels in f32 to a folder, as a browser's compiler takes them.
//!
//! ```text
//! cargo run --release --example kernel_texts -- target/kernel_texts
//! ```

use std::path::PathBuf;

use jointsweep::internals::engine::backend::gpu::batch::OnChip;
use jointsweep::internals::engine::backend::gpu::kernels::{KERNEL_FILES, Precision, Sums, Variant};

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args_os().nth(1).expect("a folder to write to"));
    std::fs::create_dir_all(&folder)?;
    for file in KERNEL_FILES {
        for (name, sums, on_chip) in [
            ("tree", Sums::Tree, OnChip::NOTHING),
            ("subgroups", Sums::Subgroups, OnChip { vectors: 4, capacity: 192 }),
        ] {
            let variant = Variant { precision: Precision::F32, invocations: 64, on_chip, sums };
            std::fs::write(folder.join(format!("{}-{name}.wgsl", file.name)), file.variant(&variant))?;
        }
    }
    Ok(())
}
