//! Closed forms: typed, cited, each with its range of validity.
