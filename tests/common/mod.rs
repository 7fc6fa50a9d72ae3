//! What several integration tests need.

// Each test file compiles this module for itself and uses a part of it.
#![allow(dead_code)]

pub mod greatest;
pub mod meshes;
pub mod rings;
