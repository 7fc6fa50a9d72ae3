//! How kernels are made of their texts.

/// How the text of a file becomes pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Making {
    /// As it is.
    Trusted,
    /// Every index and every loop is watched at run time, and memory begins with zeros: slower, for tests.
    Checked,
    /// Its entry points do nothing, and no body has works: what is left is what a processor does around them.
    Empty,
}
