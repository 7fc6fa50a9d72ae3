//! The helper that other tests compare with refuses what it could be fooled by.

use crate::common::greatest::{difference, greatest};

#[test]
fn the_greatest_size_counts_whatever_its_sign_and_place() {
    assert_eq!(greatest([1.0, -3.0, 2.0]), 3.0);
    assert_eq!(greatest([0.0]), 0.0);
    assert_eq!(greatest([1.0, f64::NEG_INFINITY]), f64::INFINITY);
    assert_eq!(difference(&[1.0, -4.5], &[2.0, -4.0]), 0.25);
}

#[test]
#[should_panic(expected = "there are values")]
fn nothing_has_no_greatest() {
    greatest([]);
}

#[test]
#[should_panic(expected = "value 1 is NaN")]
fn no_number_has_no_greatest() {
    greatest([1.0, f64::NAN, 2.0]);
}

#[test]
#[should_panic(expected = "left: 1")]
fn lists_of_unequal_length_have_no_difference() {
    difference(&[1.0], &[1.0, 2.0]);
}
