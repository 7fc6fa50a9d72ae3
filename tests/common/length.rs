//! Short forms of tests for everyone, long ones for those who set JOINTSWEEP_LONG.

/// So many designs or bodies: `short`, or `long` where JOINTSWEEP_LONG is set.
pub fn count(short: u64, long: u64) -> u64 {
    if is_long() { long } else { short }
}

pub fn is_long() -> bool {
    std::env::var_os("JOINTSWEEP_LONG").is_some()
}
