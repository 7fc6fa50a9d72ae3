//! How simulators go between the points of a table: their own rules, from their documentation, so that points can
//! be chosen for them.

/// A rule between points of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight lines.
    Linear,
    /// Cubics with the values and slopes of the table: continuous stiffness.
    Hermite,
    /// H. Akima, J. ACM 17 (1970) 589-602: cubics with slopes from five neighbours.
    Akima,
    /// M. Steffen, Astronomy and Astrophysics 239 (1990) 443-450: cubics without overshoot.
    Steffen,
}

impl Interpolation {
    pub fn name(self) -> &'static str {
        match self {
            Interpolation::Linear => "straight lines",
            Interpolation::Hermite => "cubic Hermite, from values and slopes",
            Interpolation::Akima => "Akima's cubics",
            Interpolation::Steffen => "Steffen's monotone cubics",
        }
    }

    /// Whether the stiffness between points is continuous.
    pub fn is_smooth(self) -> bool {
        self != Interpolation::Linear
    }
}

/// A table with a rule between its points.
pub struct Interpolant<'a> {
    x: &'a [f64],
    y: &'a [f64],
    /// At each point; empty for straight lines.
    slopes: Vec<f64>,
}

impl<'a> Interpolant<'a> {
    /// Of at least three points, x ascending; `slopes` are those of the table, which only Hermite's rule uses.
    pub fn new(rule: Interpolation, x: &'a [f64], y: &'a [f64], slopes: &[f64]) -> Interpolant<'a> {
        let slopes = match rule {
            Interpolation::Linear => Vec::new(),
            Interpolation::Hermite => slopes.to_vec(),
            Interpolation::Akima => akima(x, y),
            Interpolation::Steffen => steffen(x, y),
        };
        Interpolant { x, y, slopes }
    }

    /// Value and derivative at a place, which lies between the first and the last point.
    pub fn at(&self, place: f64) -> (f64, f64) {
        let last = self.x.len() - 2;
        let i = self.x.partition_point(|x| *x <= place).saturating_sub(1).min(last);
        let width = self.x[i + 1] - self.x[i];
        let secant = (self.y[i + 1] - self.y[i]) / width;
        if self.slopes.is_empty() {
            return (self.y[i] + secant * (place - self.x[i]), secant);
        }
        let s = (place - self.x[i]) / width;
        let (left, right) = (self.slopes[i], self.slopes[i + 1]);
        let (square, cube) = (3.0 * secant - 2.0 * left - right, left + right - 2.0 * secant);
        let value = self.y[i] + width * s * (left + s * (square + s * cube));
        (value, left + s * (2.0 * square + 3.0 * s * cube))
    }
}

fn secants(x: &[f64], y: &[f64]) -> Vec<f64> {
    x.windows(2).zip(y.windows(2)).map(|(x, y)| (y[1] - y[0]) / (x[1] - x[0])).collect()
}

/// Two secants are added at either end, as Akima's paper has it.
fn akima(x: &[f64], y: &[f64]) -> Vec<f64> {
    let inner = secants(x, y);
    let n = inner.len();
    let before = [3.0 * inner[0] - 2.0 * inner[1], 2.0 * inner[0] - inner[1]];
    let after = [2.0 * inner[n - 1] - inner[n - 2], 3.0 * inner[n - 1] - 2.0 * inner[n - 2]];
    let all: Vec<f64> = before.into_iter().chain(inner).chain(after).collect();
    let slope = |m: &[f64]| {
        let (left, right) = ((m[1] - m[0]).abs(), (m[3] - m[2]).abs());
        if left + right == 0.0 { 0.5 * (m[1] + m[2]) } else { (right * m[1] + left * m[2]) / (left + right) }
    };
    all.windows(4).map(slope).collect()
}

fn steffen(x: &[f64], y: &[f64]) -> Vec<f64> {
    let secants = secants(x, y);
    let mut slopes = vec![secants[0]];
    for i in 1..secants.len() {
        let (left, right) = (secants[i - 1], secants[i]);
        let (before, after) = (x[i] - x[i - 1], x[i + 1] - x[i]);
        let parabola = (left * after + right * before) / (before + after);
        let least = left.abs().min(right.abs()).min(0.5 * parabola.abs());
        let sign = |value: f64| if value == 0.0 { 0.0 } else { value.signum() };
        slopes.push((sign(left) + sign(right)) * least);
    }
    slopes.push(secants[secants.len() - 1]);
    slopes
}

/// Weights of the values at `nodes` (ascending) for the polynomial through the four nearest, or through all where
/// there are fewer, at `place`: the first node and its weights. They do not hang on the values, so that a
/// derivative along another axis has the same weights.
pub fn cubic_weights(nodes: &[f64], place: f64) -> (usize, Vec<f64>) {
    let count = nodes.len().min(4);
    let above = nodes.partition_point(|node| *node <= place);
    let first = above.saturating_sub(2).min(nodes.len() - count);
    let own = &nodes[first..first + count];
    let weight = |i: usize| {
        let others = (0..count).filter(|j| *j != i);
        others.map(|j| (place - own[j]) / (own[i] - own[j])).product()
    };
    (first, (0..count).map(weight).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each rule is exact where its paper says so: lines, and parabolas for Akima's on even points.
    #[test]
    fn rules_reproduce_what_they_are_exact_for() {
        let x: Vec<f64> = (0..9).map(f64::from).collect();
        let line: Vec<f64> = x.iter().map(|x| 2.0 * x - 1.0).collect();
        let square: Vec<f64> = x.iter().map(|x| x * x).collect();
        let cube: Vec<f64> = x.iter().map(|x| x * x * x).collect();
        let slopes: Vec<f64> = x.iter().map(|x| 3.0 * x * x).collect();
        for rule in [Interpolation::Linear, Interpolation::Akima, Interpolation::Steffen] {
            let (value, slope) = Interpolant::new(rule, &x, &line, &[]).at(3.3);
            assert!((value - 5.6).abs() < 1e-12 && (slope - 2.0).abs() < 1e-12, "{rule:?}");
        }
        let (value, slope) = Interpolant::new(Interpolation::Akima, &x, &square, &[]).at(3.3);
        assert!((value - 10.89).abs() < 1e-12 && (slope - 6.6).abs() < 1e-12);
        let (value, slope) = Interpolant::new(Interpolation::Hermite, &x, &cube, &slopes).at(3.3);
        assert!((value - 35.937).abs() < 1e-12 && (slope - 32.67).abs() < 1e-12);
        // Where two secants are alike, Akima's slope is theirs, whatever comes on the other side.
        let kink = [0.0, 0.0, 0.0, 1.0, 3.0, 6.0, 10.0, 15.0, 21.0];
        assert_eq!(Interpolant::new(Interpolation::Akima, &x, &kink, &[]).at(2.0), (0.0, 0.0));
        // A table that rises is never left downwards, however it bends.
        let steps = [0.0, 0.0, 0.1, 0.1, 4.0, 4.1, 4.1, 9.0, 9.0];
        let steffen = Interpolant::new(Interpolation::Steffen, &x, &steps, &[]);
        assert!((0..=800).all(|i| steffen.at(0.01 * f64::from(i)).1 >= -1e-12));
    }

    #[test]
    fn weights_are_exact_for_cubics() {
        let nodes: [f64; 6] = [0.1, 0.2, 0.5, 1.0, 2.0, 4.0];
        for place in [0.1, 0.15, 0.7, 1.0, 3.0, 4.0] {
            let (first, weights) = cubic_weights(&nodes, place);
            let sum: f64 =
                weights.iter().zip(&nodes[first..]).map(|(weight, node)| weight * node.powi(3)).sum();
            assert!((sum / place.powi(3) - 1.0).abs() < 1e-12 && weights.len() == 4);
        }
        assert_eq!(cubic_weights(&nodes[..2], 0.15).1.len(), 2);
    }
}
