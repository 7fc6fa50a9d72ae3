//! The stages of a sweep as kernels, for many bodies at once, on any device with a Vulkan driver.
//!
//! What is here so far: finding and opening a device, splitting a sweep into dispatches, and the bodies' stages from
//! a few numbers to the compliance of the ring. The sweep does not use it yet.

pub mod context;
pub mod batch;
pub mod layout;
pub mod kernels;
pub mod dispatch;
pub mod stages;
pub mod trial;
pub mod slots;
pub mod contact;
pub mod solver;
