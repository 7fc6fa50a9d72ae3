//! The stages of a sweep as kernels, for many bodies at once, on any device with a Vulkan driver.
//!
//! What is here so far: finding and opening a device, and splitting a sweep into dispatches. The sweep does not use it yet.

pub mod context;
pub mod batch;
