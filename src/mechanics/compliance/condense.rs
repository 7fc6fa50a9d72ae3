//! From a meshed body to the compliance of its ring.
