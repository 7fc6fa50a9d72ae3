//! A sweep cut into shares that take about as long as each other, told without solving any of it.

use std::ops::Range;

use crate::engine::cost::DesignCost;
use crate::error::Error;
use crate::study::config::Study;

/// Designs whose cost is looked at, evenly spaced over the sweep.
const LOOKED_AT: u64 = 4096;

/// Share number `share`, from 1, of `of`: the numbers of its designs. A share begins at a multiple of `cut`; where there are fewer such
/// places than shares, some are empty. The same for everybody who asks.
pub fn share(study: &Study, share: u64, of: u64, cut: u64) -> Result<Range<u64>, Error> {
    let count = study.design_count();
    let costs = costs(study, count)?;
    let place = |share: u64| place(&costs, count, share, of, cut);
    Ok(place(share - 1)..place(share))
}

/// What designs at even distances take, s.
fn costs(study: &Study, count: u64) -> Result<Vec<f64>, Error> {
    let cost = DesignCost::of_study(study);
    let looked_at = count.min(LOOKED_AT);
    // In the middle of its part of the sweep.
    let number = |sample: u64| (2 * sample + 1) * count / (2 * looked_at);
    study.cases_at((0..looked_at).map(number))?.map(|case| Ok(cost.seconds(&case?))).collect()
}

/// Where share number `share` ends, of sweeps whose parts have these costs.
fn place(costs: &[f64], count: u64, share: u64, of: u64, cut: u64) -> u64 {
    let pieces = count.div_ceil(cut);
    if share == 0 || share == of {
        return share.min(1) * count;
    }
    let all: f64 = costs.iter().sum();
    let mut wanted = all * share as f64 / of as f64;
    let mut part = 0;
    while part + 1 < costs.len() && wanted > costs[part] {
        wanted -= costs[part];
        part += 1;
    }
    let within = (wanted / costs[part]).clamp(0.0, 1.0);
    let designs = (part as f64 + within) / costs.len() as f64 * count as f64;
    let piece = (designs / cut as f64).round() as u64;
    // At least one piece for each, as long as there are enough.
    let piece = piece.clamp(share.min(pieces), pieces.saturating_sub(of - share).max(share.min(pieces)));
    (piece * cut).min(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(costs: &[f64], count: u64, of: u64, cut: u64) -> Vec<u64> {
        (0..=of).map(|share| place(costs, count, share, of, cut)).collect()
    }

    #[test]
    fn shares_take_about_as_long_as_each_other() {
        assert_eq!(places(&[1.0; 10], 100, 4, 1), [0, 25, 50, 75, 100]);
        // The first half takes three times as long.
        assert_eq!(places(&[3.0, 3.0, 1.0, 1.0], 1000, 4, 1), [0, 167, 333, 500, 1000]);
        assert_eq!(places(&[1.0; 10], 100, 4, 16), [0, 32, 48, 80, 100]);
    }

    #[test]
    fn every_design_is_in_one_share_and_none_is_empty_without_need() {
        for (count, of, cut) in [(7, 7, 1), (1000, 7, 1), (100, 30, 8), (5, 3, 64), (4097, 100, 1)] {
            for costs in [vec![1.0; 5], vec![1e-9, 1e-9, 1e9, 1e-9], vec![1e9, 1.0, 1.0]] {
                let places = places(&costs, count, of, cut);
                assert_eq!((places[0], places[of as usize]), (0, count));
                let sizes: Vec<u64> = places.windows(2).map(|pair| pair[1] - pair[0]).collect();
                assert!(places.iter().all(|place| place % cut == 0 || *place == count), "{places:?}");
                let empty = sizes.iter().filter(|size| **size == 0).count() as u64;
                assert_eq!(empty, of.saturating_sub(count.div_ceil(cut)), "{count} {of} {cut}: {places:?}");
            }
        }
    }
}
