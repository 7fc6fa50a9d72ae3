//! The stages of a sweep as kernels, for many bodies and joints at once, on any device with a Vulkan driver: from a few
//! numbers of each body to the answer of each load, with nothing read back between. docs/gpu.md has the whole.

pub mod context;
pub mod batch;
pub mod layout;
pub mod kernels;
pub mod dispatch;
pub mod stages;
pub mod trial;
pub mod slots;
pub mod contact;
mod grouping;
pub mod work;
pub mod solver;
pub mod roofline;
pub mod measure;
