//! How the way from the ring to the far boundary is divided into layers that grow.

use crate::mechanics::real::Bodies;

/// How the way from the ring to the far boundary is divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layers {
    /// Thickness of the layer at the ring, in the shape's measure of depth.
    pub first: f64,
    /// No layer is thicker than this.
    pub thickest: f64,
    pub count: usize,
    /// So many at the far boundary shrink towards it, where its corners make the stress singular.
    pub shrinking: usize,
}

/// What a layer that shrinks has of what its growth makes it, over the same of the one before.
pub const SHRINK: f64 = 0.4;

/// Steps of a search for a growth at most; it takes four to seven, and bisection alone would need some 60.
pub const MOST_STEPS: usize = 100;

/// Where a search ends: its last step over the growth. Each step is about the square of the one before, so that only rounding is left.
pub const TOLERANCE: f64 = 1e-8;

/// The same in single precision, where steps do not become so small.
pub const SINGLE_TOLERANCE: f64 = 1e-6;

/// No layers grow by more.
pub const STEEPEST: f64 = 1e9;

impl Layers {
    /// Thicknesses of layers that grow by a factor, but for those that shrink.
    pub fn thicknesses(self, growth: f64) -> impl Iterator<Item = f64> {
        let grown = layer_thicknesses(self.first, self.thickest, growth).take(self.count);
        grown.enumerate().map(move |(layer, grown)| self.part(layer) * grown)
    }

    /// Of what its growth makes it.
    pub fn part(self, layer: usize) -> f64 {
        let ahead = self.count - 1 - layer;
        SHRINK.powi(self.shrinking.saturating_sub(ahead) as i32)
    }

    /// Depth of all layers that grow by a factor.
    pub fn depth(self, growth: f64) -> f64 {
        self.thicknesses(growth).sum()
    }

    /// How many layers that grow by a factor reach a depth: as many as there are at least, and so many at most.
    pub fn fewest(self, depth: f64, growth: f64, most: usize) -> usize {
        let mut count = self.count;
        // One sum for all counts of those before the ones that shrink.
        let mut ahead = layer_thicknesses(self.first, self.thickest, growth);
        let mut whole: f64 = ahead.by_ref().take(count.saturating_sub(self.shrinking)).sum();
        while count < most {
            let shrinking = count.min(self.shrinking);
            let mut part = SHRINK.powi((self.shrinking - shrinking) as i32);
            let shrunk = ahead.clone().take(shrinking).map(|grown| {
                part *= SHRINK;
                part * grown
            });
            if shrunk.fold(whole, |sum, thickness| sum + thickness) >= depth {
                break;
            }
            count += 1;
            if count > self.shrinking {
                whole += ahead.next().unwrap_or(0.0);
            }
        }
        count
    }

    /// The one factor by which layers grow to be `depth` in all, searched from a guess (> 0).
    pub fn growth(self, depth: f64, guess: f64) -> f64 {
        self.growth_from(self.first, depth, guess)
    }

    /// The same of bodies abreast, each with its own thickness of the layer at the ring. Newton's steps in the
    /// logarithms, in which the depth is nearly a power of the factor, kept in a bracket; the root of that power is taken by
    /// a rational function, which every step makes as good as it must be.
    #[inline(always)]
    pub fn growth_from<T: Bodies>(self, first: T, depth: T, guess: T) -> T {
        self.search(first, depth, guess).0
    }

    /// The same with the steps it took.
    #[inline(always)]
    fn search<T: Bodies>(self, first: T, depth: T, guess: T) -> (T, usize) {
        let (zero, half, one, two) = (T::zero(), T::from_f64(0.5), T::from_f64(1.0), T::from_f64(2.0));
        let (steepest, tolerance, outside) =
            (T::from_f64(STEEPEST), T::from_f64(TOLERANCE), T::from_f64(-1.0));
        let (mut low, mut high) = (zero, steepest);
        let mut growth = guess;
        // 1 in the lanes that still search, else 0.
        let mut searching = one;
        for steps in 1..=MOST_STEPS {
            let (reached, power) = self.depth_and_power(first, growth);
            low = reached.if_less(depth, growth, low);
            high = reached.if_less(depth, high, growth);
            let ratio = depth / reached;
            let over = (power + one) * ratio + power - one;
            let under = (power - one) * ratio + power + one;
            let newton = zero.if_less(under, growth * over / under, outside);
            let is_far = (tolerance * growth).if_less((newton - growth).size(), one, zero);
            let inside = high.if_less(steepest, half * (low + high), two * growth);
            let kept = newton.if_less(low, inside, high.if_less(newton, inside, newton));
            // Rounding may take the last step out of the bracket, the far end of which is anywhere.
            let next = zero.if_less(is_far, kept, newton);
            growth = zero.if_less(searching, next, growth);
            // At an end of the bracket once more: no number is better.
            let is_between = low.if_less(next, next.if_less(high, one, zero), zero);
            searching = is_far * is_between * searching;
            if !searching.any_positive() {
                return (growth, steps);
            }
        }
        (growth, MOST_STEPS)
    }

    /// `depth` with d ln depth/d ln growth: only layers below the thickest grow with the factor.
    #[inline(always)]
    fn depth_and_power<T: Bodies>(self, first: T, growth: T) -> (T, T) {
        let (zero, thickest) = (T::zero(), T::from_f64(self.thickest));
        let (mut depth, mut moment) = (zero, zero);
        let (mut grown, mut part) = (first, 1.0);
        for layer in 0..self.count {
            if self.count - layer <= self.shrinking {
                part *= SHRINK;
            }
            depth += T::from_f64(part) * grown;
            let more = T::from_f64(layer as f64 * part) * grown;
            moment += grown.if_less(thickest, more, zero);
            grown = (grown * growth).at_most(thickest);
        }
        (depth, moment / depth)
    }
}

/// Thicknesses of layers that grow by `growth` from `first` up to `thickest`.
pub fn layer_thicknesses(first: f64, thickest: f64, growth: f64) -> impl Iterator<Item = f64> + Clone {
    std::iter::successors(Some(first), move |thickness| Some((thickness * growth).min(thickest)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the depth of all layers, for factors below and above one, with a thickest layer and without, shrinking or not.
    #[test]
    fn layers_grow_to_the_depth_asked() {
        for (thickest, count, shrinking) in
            [(0.5, 12, 3), (f64::INFINITY, 12, 0), (f64::INFINITY, 40, 5), (1.0, 1, 0)]
        {
            let layers = Layers { first: 0.01, thickest, count, shrinking };
            for factor in [0.3, 0.9, 1.0, 1.1, 1.5, 2.5, 8.0] {
                let depth = layers.depth(factor);
                for guess in [1e-3, 1.0, factor, 50.0] {
                    let found = layers.depth(layers.growth(depth, guess));
                    assert!((found / depth - 1.0).abs() < 1e-11, "{layers:?} {factor}: {found} for {depth}");
                }
            }
            // No factor reaches this where layers have a thickest.
            let beyond = layers.growth(1e3, 1.0);
            assert!(beyond > 1.0 && beyond.is_finite(), "{layers:?}: {beyond}");
        }
    }

    /// From one on, for factors as bodies have them: Newton's last step is the last, whichever way it is rounded.
    #[test]
    fn few_steps_lead_to_a_growth() {
        for (thickest, shrinking) in [(0.8, 0), (0.7, 2), (0.53, 3)] {
            let layers = Layers { first: 0.2, thickest, count: 7, shrinking };
            for place in 0..1000 {
                let factor = 0.7 + 1.5e-3 * f64::from(place);
                let (found, steps) = layers.search(0.2, layers.depth(factor), 1.0);
                assert!(steps <= 8, "{layers:?} {factor}: {found} in {steps} steps");
            }
        }
    }

    /// Of all counts that are allowed the least that is deep enough, or the greatest.
    #[test]
    fn as_many_layers_as_a_depth_asks() {
        for (thickest, count, shrinking) in [(0.5, 3, 0), (f64::INFINITY, 1, 0), (0.5, 4, 2), (0.02, 12, 5)] {
            let layers = Layers { first: 0.01, thickest, count, shrinking };
            for growth in [0.5, 1.0, 1.3, 2.0] {
                for (depth, most) in
                    [(1e-4, 30), (0.05, 30), (0.3, 30), (2.0, 30), (2.0, 5), (1e9, 30), (1e9, 2)]
                {
                    let is_deep = |count: &usize| Layers { count: *count, ..layers }.depth(growth) >= depth;
                    let expected = (count..most).find(is_deep).unwrap_or(most.max(count));
                    let found = layers.fewest(depth, growth, most);
                    assert_eq!(found, expected, "{layers:?} {growth} {depth} {most}");
                }
            }
        }
    }
}
