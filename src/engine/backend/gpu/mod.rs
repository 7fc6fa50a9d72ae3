//! The condensation of bodies as kernels, for many bodies at once, on any device with a Vulkan driver: from a few numbers of each
//! body to the works of its ring's modes, with nothing read back between. docs/gpu.md has the whole.

pub mod batch;
pub mod system_layout;
pub mod gather;
pub mod layout;
pub mod front;
pub mod layouts;
pub mod context;
pub mod shared_data;
pub mod kernel_texts;
pub mod kernels;
pub mod dispatch;
pub mod stages;
pub mod works;
pub mod front_topology;
pub mod elimination_plan;
pub mod elimination;
pub mod joint_tables;
pub mod near_field_tables;
pub mod joint_load;
mod joint_passes;
pub mod joint_kernel;
pub mod drawn_joints;
pub mod solver;
pub mod calibration;
