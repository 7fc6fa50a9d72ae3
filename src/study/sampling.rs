//! Which values design number i takes: grid, zip, latin hypercube, sobol, saltelli. Everything is computed from the number
//! of the design alone, so a sweep of any length needs no memory and can start anywhere.

use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::study::values::{Pick, Picks};

/// One quantity that sweeps. Axes are ordered as they are listed in the config.
#[derive(Clone, Debug)]
pub struct Axis {
    /// The dotted key, for complaints.
    pub key: String,
    pub line: u64,
    /// Position in the config: the order of the axes.
    pub start: usize,
    /// The number of values; `None` for a range without a count.
    pub count: Option<u64>,
}

/// How the axes are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Every combination; the last axis varies fastest.
    Grid,
    /// The first values of all axes, then the second ones ...
    Zip,
    /// `count` designs; each axis is cut into `count` slices and each slice is used once.
    LatinHypercube { count: u64, seed: u64 },
    /// `count` designs of an Owen-scrambled Sobol sequence.
    Sobol { count: u64, seed: u64 },
    /// For sensitivity indices, never named by a config: `rows` of `row_length` designs. A point of an Owen-scrambled Sobol
    /// sequence of twice as many dimensions as axes is two designs, A and B; then comes A with the first axis of B, A with
    /// the second axis of B ... (Saltelli et al., Computer Physics Communications 181, 2010, section 3).
    Saltelli { rows: u64, seed: u64 },
}

impl Scheme {
    /// The names in configs, in the order of the variants that configs can name.
    pub const NAMES: [&str; 4] = ["grid", "zip", "latin-hypercube", "sobol"];

    pub fn name(self) -> &'static str {
        match self {
            Scheme::Grid => Scheme::NAMES[0],
            Scheme::Zip => Scheme::NAMES[1],
            Scheme::LatinHypercube { .. } => Scheme::NAMES[2],
            Scheme::Sobol { .. } => Scheme::NAMES[3],
            Scheme::Saltelli { .. } => "saltelli",
        }
    }
}

/// The most designs of a study; more is taken for a slip of the pen.
pub const MAX_DESIGNS: u64 = 1_000_000_000;

/// From the number of a design to its values.
#[derive(Clone, Debug)]
pub struct Sampler {
    scheme: Scheme,
    design_count: u64,
    /// By axis.
    roles: Vec<Role>,
}

/// What the scheme needs to know of one axis.
#[derive(Clone, Copy, Debug)]
struct Role {
    /// Position among the axes as listed.
    rank: u32,
    /// Grid: how many designs go by before the axis moves on, and its number of values.
    stride: u64,
    count: u64,
    /// Latin hypercube: of the axis's random numbers.
    key: u64,
}

/// How what a design takes of an axis follows from its number.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// There is one value.
    Nothing,
    Grid,
    Zip,
    Slices,
    Sobol,
}

/// What a device needs to know of an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisDraw {
    pub(super) source: Source,
    pub(super) stride: u64,
    pub(super) count: u64,
    pub(super) key: u64,
    pub(super) rank: u32,
}

impl AxisDraw {
    /// Of what does not sweep.
    pub(super) const NOTHING: AxisDraw =
        AxisDraw { source: Source::Nothing, stride: 1, count: 1, key: 0, rank: 0 };
}

impl Sampler {
    /// `axes` in any order; `pick` takes positions in it. On failure, the axis at fault and what is wrong.
    pub fn new(scheme: Scheme, axes: &[Axis]) -> Result<Sampler, (usize, String)> {
        let mut order: Vec<usize> = (0..axes.len()).collect();
        order.sort_by_key(|&axis| axes[axis].start);
        let mut roles = vec![Role { rank: 0, stride: 1, count: 1, key: 0 }; axes.len()];
        for (rank, &axis) in order.iter().enumerate() {
            roles[axis].rank = rank as u32;
            roles[axis].count = axes[axis].count.unwrap_or(1).max(1);
            if let Scheme::LatinHypercube { seed, .. } = scheme {
                roles[axis].key = key(rank as u32, seed);
            }
        }
        let design_count = match scheme {
            Scheme::Grid => {
                let mut product = 1u64;
                for &axis in order.iter().rev() {
                    roles[axis].stride = product;
                    let next = product.checked_mul(roles[axis].count).filter(|&all| all <= MAX_DESIGNS);
                    product = next.ok_or_else(|| (axis, too_many(&order, axes)))?;
                }
                product
            }
            Scheme::Zip => {
                if let Some(&first) = order.first() {
                    let differs = |&&axis: &&usize| roles[axis].count != roles[first].count;
                    if let Some(&axis) = order.iter().find(differs) {
                        let (key, line) = (&axes[first].key, axes[first].line);
                        let (one, other) = (roles[axis].count, roles[first].count);
                        let problem = format!(
                            "zip needs equal counts: here {one}, but {other} in `{key}` on line {line}"
                        );
                        return Err((axis, problem));
                    }
                }
                order.first().map_or(1, |&first| roles[first].count)
            }
            Scheme::LatinHypercube { count, .. } | Scheme::Sobol { count, .. } => count,
            Scheme::Saltelli { rows, .. } => {
                saltelli_count(rows, axes.len()).map_err(|problem| (0, problem))?
            }
        };
        Ok(Sampler { scheme, design_count, roles })
    }

    pub fn design_count(&self) -> u64 {
        self.design_count
    }

    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    pub(super) fn axis_draw(&self, axis: usize) -> AxisDraw {
        let Role { rank, stride, count, key } = self.roles[axis];
        let source = match self.scheme {
            Scheme::Grid => Source::Grid,
            Scheme::Zip => Source::Zip,
            Scheme::LatinHypercube { .. } => Source::Slices,
            Scheme::Sobol { .. } | Scheme::Saltelli { .. } => Source::Sobol,
        };
        AxisDraw { source, stride, count, key, rank: rank % sobol_burley::NUM_DIMENSIONS }
    }

    /// What design number `design` takes of axis number `axis`.
    pub fn pick(&self, design: u64, axis: usize) -> Pick {
        self.picks(&[design], axis).of(0)
    }

    /// What designs of these numbers take of axis number `axis`.
    pub fn picks<const N: usize>(&self, designs: &[u64; N], axis: usize) -> Picks<N> {
        let role = self.roles[axis];
        match self.scheme {
            Scheme::Grid => Picks::Index(designs.map(|design| design / role.stride % role.count)),
            Scheme::Zip => Picks::Index(*designs),
            Scheme::LatinHypercube { count, .. } => {
                Picks::Fraction(in_lanes(Slices { designs, count, key: role.key }))
            }
            Scheme::Sobol { seed, .. } => {
                Picks::Fraction(designs.map(|design| sobol(design, role.rank, seed)))
            }
            Scheme::Saltelli { seed, .. } => {
                let axes = self.roles.len();
                Picks::Fraction(designs.map(|design| {
                    let (row, member) = (design / row_length(axes), design % row_length(axes));
                    let is_of_b = member == 1 || member == u64::from(role.rank) + 2;
                    let dimension = role.rank + if is_of_b { axes as u32 } else { 0 };
                    sobol(row, dimension, seed)
                }))
            }
        }
    }
}

/// Designs of a row of Saltelli's scheme: A, B, and one for each axis.
pub fn row_length(axes: usize) -> u64 {
    axes as u64 + 2
}

/// All designs of Saltelli's scheme.
fn saltelli_count(rows: u64, axes: usize) -> Result<u64, String> {
    let most_axes = sobol_burley::NUM_DIMENSIONS as usize / 2;
    if axes > most_axes {
        return Err(format!(
            "{axes} factors need a Sobol sequence of {} dimensions; at most {most_axes} factors are possible",
            2 * axes
        ));
    }
    let count = rows.checked_mul(row_length(axes)).filter(|&count| count <= MAX_DESIGNS);
    count.ok_or_else(|| {
        format!("{rows} samples of {axes} factors are too many designs; at most {MAX_DESIGNS} are allowed")
    })
}

fn too_many(order: &[usize], axes: &[Axis]) -> String {
    let counts: Vec<String> = order.iter().map(|&axis| axes[axis].count.unwrap_or(1).to_string()).collect();
    format!("the grid has {} designs; at most {MAX_DESIGNS} are allowed", counts.join(" x "))
}

/// What the random numbers of axis `rank` begin with.
fn key(rank: u32, seed: u64) -> u64 {
    mix(mix(seed) ^ u64::from(rank))
}

/// Random points of the slices that designs have on an axis with a key.
struct Slices<'a, const N: usize> {
    designs: &'a [u64; N],
    count: u64,
    key: u64,
}

impl<const N: usize> LaneWork for Slices<'_, N> {
    type Output = [f64; N];

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> [f64; N] {
        let Slices { designs, count, key } = self;
        let mut points = [0.0; N];
        for (point, position) in points.iter_mut().zip(permuted(designs, count, key)) {
            *point = position as f64;
        }
        for (point, design) in points.iter_mut().zip(designs) {
            let jitter = (mix(key ^ mix(!design)) >> 11) as f64 / (1u64 << 53) as f64;
            *point = (*point + jitter) / count as f64;
        }
        points
    }
}

/// Where a random permutation of 0..count takes positions: a Feistel network over the next even number of bits,
/// walked until it lands inside (Black & Rogaway, Ciphers with arbitrary finite domains, 2002).
#[inline(always)]
fn permuted<const N: usize>(positions: &[u64; N], count: u64, key: u64) -> [u64; N] {
    // At least 8 bits: smaller networks have few permutations to choose from.
    let half = (u64::BITS - count.leading_zeros()).div_ceil(2).max(4);
    let mask = (1u64 << half) - 1;
    let mut current = *positions;
    let mut landed = [u64::MAX; N];
    loop {
        let [mut left, mut right] = [[0; N]; 2];
        for lane in 0..N {
            (left[lane], right[lane]) = (current[lane] >> half, current[lane] & mask);
        }
        for round in 0..6u64 {
            for lane in 0..N {
                (left[lane], right[lane]) =
                    (right[lane], left[lane] ^ (mix(key ^ (round << 56) ^ right[lane]) & mask));
            }
        }
        let mut is_open = false;
        for lane in 0..N {
            current[lane] = left[lane] << half | right[lane];
            if landed[lane] == u64::MAX && current[lane] < count {
                landed[lane] = current[lane];
            }
            is_open |= landed[lane] == u64::MAX;
        }
        if !is_open {
            return landed;
        }
    }
}

/// Of the number of a point in the library's sequence.
pub const SOBOL_BITS: u32 = 16;

/// Point `design` of the sequence, on axis `rank`. The library's sequence ends after 2^16 points; longer sweeps
/// are made of blocks of that length, each scrambled on its own, which keeps every block as even as the first.
fn sobol(design: u64, rank: u32, seed: u64) -> f64 {
    let block = design >> SOBOL_BITS;
    let index = (design & ((1 << SOBOL_BITS) - 1)) as u32;
    let block_seed = (mix(mix(seed) ^ block) >> 32) as u32;
    // The library has 256 dimensions; a joint has an order of magnitude fewer quantities.
    f64::from(sobol_burley::sample(index, rank % sobol_burley::NUM_DIMENSIONS, block_seed))
}

/// A hash of 64 bits to 64 bits: one step of SplitMix64 (Steele, Lea & Flood, 2014).
#[inline(always)]
pub fn mix(state: u64) -> u64 {
    let mut z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slice(design: u64, count: u64, key: u64) -> f64 {
        in_lanes(Slices { designs: &[design], count, key })[0]
    }

    fn axis(start: usize, count: Option<u64>) -> Axis {
        Axis { key: format!("axis {start}"), line: 1, start, count }
    }

    #[test]
    fn permutations_are_permutations() {
        for count in [1u64, 2, 3, 17, 255, 256, 257, 5000] {
            let mut seen: Vec<u64> =
                (0..count).map(|position| permuted(&[position], count, mix(count))[0]).collect();
            seen.sort_unstable();
            assert!(seen.into_iter().eq(0..count), "{count}");
        }
    }

    #[test]
    fn grid_moves_the_last_listed_axis_fastest() {
        // Handed over in another order than listed.
        let sampler = Sampler::new(Scheme::Grid, &[axis(9, Some(3)), axis(4, Some(2))]).unwrap();
        assert_eq!(sampler.design_count(), 6);
        let picks: Vec<_> = (0..6).map(|design| [1, 0].map(|axis| sampler.pick(design, axis))).collect();
        let expected: Vec<_> = (0..2).flat_map(|a| (0..3).map(move |b| [a, b].map(Pick::Index))).collect();
        assert_eq!(picks, expected);
    }

    /// One value per slice on every axis, and no two axes alike.
    #[test]
    fn latin_hypercube_uses_each_slice_once() {
        let count = 1000;
        let column = |rank| -> Vec<u64> {
            (0..count).map(|design| (slice(design, count, key(rank, 5)) * count as f64) as u64).collect()
        };
        let (first, second) = (column(0), column(1));
        for slices in [&first, &second] {
            let mut sorted = slices.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..count));
        }
        // Independent axes: the correlation of ranks is of the order 1/sqrt(1000) = 0.03.
        let mean = (count - 1) as f64 / 2.0;
        let products = first.iter().zip(&second).map(|(&a, &b)| (a as f64 - mean) * (b as f64 - mean));
        let variance = (count * count - 1) as f64 / 12.0;
        let correlation = products.sum::<f64>() / (count as f64 * variance);
        assert!(correlation.abs() < 0.1, "{correlation}");
    }

    /// Every aligned block of 2^k points has one in each of 2^k slices, beyond the length of the library's
    /// sequence as well.
    #[test]
    fn sobol_is_even_in_every_block() {
        for start in [0u64, 1 << 16, (1 << 16) + 512, 7 << 16] {
            for rank in [0, 5, 15] {
                let mut slices: Vec<u64> =
                    (start..start + 256).map(|design| (sobol(design, rank, 3) * 256.0) as u64).collect();
                slices.sort_unstable();
                assert!(slices.into_iter().eq(0..256), "{start} {rank}");
            }
        }
        assert_ne!(sobol(0, 0, 3), sobol(1 << 16, 0, 3), "blocks repeat");
    }

    /// A row's designs differ from A on one axis each, where they are B; axes are counted as listed, not as handed over.
    #[test]
    fn saltelli_rows_are_two_points_and_their_crossings() {
        let axes = [axis(30, None), axis(10, Some(4)), axis(20, None)];
        let sampler = Sampler::new(Scheme::Saltelli { rows: 4, seed: 9 }, &axes).unwrap();
        assert_eq!(sampler.design_count(), 20);
        for row in 0..4u64 {
            let point = |member: u64| [1, 2, 0].map(|axis| sampler.pick(5 * row + member, axis));
            let (a, b) = (point(0), point(1));
            assert_eq!(a, [0, 1, 2].map(|dimension| Pick::Fraction(sobol(row, dimension, 9))));
            assert_eq!(b, [3, 4, 5].map(|dimension| Pick::Fraction(sobol(row, dimension, 9))));
            for i in 0..3 {
                let mut crossed = a;
                crossed[i] = b[i];
                assert_eq!(point(i as u64 + 2), crossed);
            }
        }
    }

    #[test]
    fn saltelli_is_refused_beyond_its_sequence_and_beyond_all_bounds() {
        let refused = |rows: u64, count: usize| {
            let axes: Vec<Axis> = (0..count).map(|start| axis(start, None)).collect();
            Sampler::new(Scheme::Saltelli { rows, seed: 0 }, &axes).map(|sampler| sampler.design_count())
        };
        assert_eq!(refused(16, 128), Ok(16 * 130));
        assert!(refused(16, 129).unwrap_err().1.contains("at most 128 factors"));
        assert!(refused(u64::MAX, 3).unwrap_err().1.contains("too many designs"));
        assert!(refused(200_000_001, 3).unwrap_err().1.contains("too many designs"));
    }

    /// Designs of a seed must stay what they are: results are compared across machines and versions.
    #[test]
    fn seeds_are_repeatable() {
        let lhs: Vec<f64> = (0..3).map(|design| slice(design, 10, key(1, 42))).collect();
        let points: Vec<f64> = (0..3).map(|design| sobol(design, 1, 42)).collect();
        assert_eq!(lhs, [0.42367826434415967, 0.751426082340774, 0.5506829722340166]);
        assert_eq!(points, [0.3734736442565918, 0.9232496023178101, 0.056551456451416016]);
        assert_ne!(slice(0, 10, key(1, 42)), slice(0, 10, key(1, 43)));
    }
}
