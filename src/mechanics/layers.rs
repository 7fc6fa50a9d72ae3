//! How the way from the ring to the far boundary is divided into layers that grow.

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

/// Steps of a search for a growth at most; it takes five to ten, and bisection alone would need some 60.
pub const MOST_STEPS: usize = 100;

/// Where a search ends: its last step over the growth.
pub const TOLERANCE: f64 = 1e-12;

/// No layers grow by more.
pub const STEEPEST: f64 = 1e9;

impl Layers {
    /// Thicknesses of layers that grow by a factor, but for those that shrink.
    pub fn thicknesses(self, growth: f64) -> impl Iterator<Item = f64> {
        let grown = layer_thicknesses(self.first, self.thickest, growth).take(self.count);
        grown.enumerate().map(move |(layer, grown)| self.part(layer) * grown)
    }

    /// Of what its growth makes it.
    fn part(self, layer: usize) -> f64 {
        let ahead = self.count - 1 - layer;
        SHRINK.powi(self.shrinking.saturating_sub(ahead) as i32)
    }

    /// Depth of all layers that grow by a factor.
    pub fn depth(self, growth: f64) -> f64 {
        self.thicknesses(growth).sum()
    }

    /// The one factor by which layers grow to be `depth` in all, searched from a guess (> 0). Newton's steps in the
    /// logarithms, in which the depth is nearly a power of the factor, kept in a bracket; the root of that power is taken by
    /// a rational function, which every step makes as good as it must be.
    pub fn growth(self, depth: f64, guess: f64) -> f64 {
        let (mut low, mut high) = (0.0, STEEPEST);
        let mut growth = guess;
        for _ in 0..MOST_STEPS {
            let (reached, power) = self.depth_and_power(growth);
            if reached < depth {
                low = growth
            } else {
                high = growth
            }
            let ratio = depth / reached;
            let over = (power + 1.0) * ratio + power - 1.0;
            let under = (power - 1.0) * ratio + power + 1.0;
            let mut next = if under > 0.0 { growth * over / under } else { -1.0 };
            if next < low || next > high {
                next = if high < STEEPEST { 0.5 * (low + high) } else { 2.0 * growth };
            }
            let step = (next - growth).abs();
            growth = next;
            // At an end of the bracket once more: no number is better.
            if step <= TOLERANCE * growth || next == low || next == high {
                break;
            }
        }
        growth
    }

    /// `depth` with d ln depth/d ln growth: only layers below the thickest grow with the factor.
    fn depth_and_power(self, growth: f64) -> (f64, f64) {
        let (mut depth, mut moment) = (0.0, 0.0);
        let (mut grown, mut part) = (self.first, 1.0);
        for layer in 0..self.count {
            if self.count - layer <= self.shrinking {
                part *= SHRINK;
            }
            depth += part * grown;
            if grown < self.thickest {
                moment += layer as f64 * part * grown;
            }
            grown = (grown * growth).min(self.thickest);
        }
        (depth, moment / depth)
    }
}

/// Thicknesses of layers that grow by `growth` from `first` up to `thickest`.
pub fn layer_thicknesses(first: f64, thickest: f64, growth: f64) -> impl Iterator<Item = f64> {
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
}
