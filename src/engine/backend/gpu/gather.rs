//! Where `assemble` finds the values of a matrix: of each pair of nodes four, by x and y of either, from the elements that have both nodes.
//! Pure arithmetic.
//!
//! ```text
//!   pair       row node, column node
//!     |
//!   sources    starts[pair] .. starts[pair + 1]    the same two nodes by their numbers in each element that has them
//!     |
//!   places     [value][pair]                       where the four values belong: xx, xy, yx, yy
//! ```

use std::array::from_fn;
use std::cmp::Reverse;
use std::iter::once;

use crate::mechanics::mesh::{RingTopology, SUPPORTED};

/// A value that is not kept: one of a supported node, or above the diagonal of a matrix of which the lower triangle is stored.
pub const NO_PLACE: u32 = u32::MAX;

/// Components of a node.
const AXES: usize = 2;

/// Values of a pair.
const VALUES: usize = AXES * AXES;

/// Row node and column node; and (element * 8 + number of the row node in it) * 8 + number of the column node.
type Source = ([u32; 2], u32);

/// Row and column of a value, by unknowns; `None` where one of them is supported.
type Value = Option<[usize; 2]>;

/// All pairs of nodes of a mesh that share an element, in either order and each with itself.
pub struct NodePairs<'a> {
    topology: &'a RingTopology,
    /// Ascending.
    sources: Vec<Source>,
}

/// The lists of `assemble` that say where values come from and where they go.
#[derive(Clone, Debug)]
pub struct Gather {
    /// `[pair]`, and the end of the last one.
    pub starts: Vec<u32>,
    pub sources: Vec<u32>,
    /// `[value of a pair][pair]`, so that neighbouring invocations read neighbouring places.
    pub places: Vec<u32>,
}

impl NodePairs<'_> {
    pub fn new(topology: &RingTopology) -> NodePairs<'_> {
        let count = topology.element.node_count();
        let mut sources = Vec::with_capacity(topology.element_count() * count * count);
        for (element, nodes) in topology.connectivity.chunks_exact(count).enumerate() {
            for (a, row) in nodes.iter().enumerate() {
                let source = |b: usize| ((element * count + a) * count + b) as u32;
                sources.extend(nodes.iter().enumerate().map(|(b, column)| ([*row, *column], source(b))));
            }
        }
        sources.sort_unstable();
        NodePairs { topology, sources }
    }

    /// Of each pair its sources and its four values.
    fn pairs(&self) -> impl Iterator<Item = (&[Source], [Value; VALUES])> {
        let unknown = |node: u32, axis: usize| {
            let unknown = self.topology.unknowns[AXES * node as usize + axis];
            (unknown != SUPPORTED).then_some(unknown as usize)
        };
        self.sources.chunk_by(|a, b| a.0 == b.0).map(move |same| {
            let [row, column] = same[0].0;
            let value = |value: usize| Some([unknown(row, value / AXES)?, unknown(column, value % AXES)?]);
            (same, from_fn(value))
        })
    }

    /// Rows and columns, by unknowns, of all values that may not be zero.
    pub fn values(&self) -> impl Iterator<Item = [usize; 2]> {
        self.pairs().flat_map(|(_, values)| values.into_iter().flatten())
    }

    /// * `place` -- where a value belongs, by the unknowns of its row and column; `None` where it is not kept
    /// * `place_count` -- places of a body: what has no value is a zero, four of which are a pair without sources
    pub fn gather(&self, place: impl Fn([usize; 2]) -> Option<usize>, place_count: usize) -> Gather {
        let mut is_zero = vec![true; place_count];
        let mut pairs = Vec::with_capacity(self.sources.len());
        for (same, values) in self.pairs() {
            let places = values.map(|value| value.and_then(&place));
            if places.iter().any(|place| place.is_some()) {
                places.iter().flatten().for_each(|place| is_zero[*place] = false);
                pairs.push((same, places.map(|place| place.map_or(NO_PLACE, |place| place as u32))));
            }
        }
        // As many sources side by side: invocations wait for the one that has most.
        pairs.sort_by_key(|(same, places)| (Reverse(same.len()), *places));
        let zeros: Vec<u32> = (0..place_count as u32).filter(|place| is_zero[*place as usize]).collect();
        for zeros in zeros.chunks(VALUES) {
            pairs.push((&[], from_fn(|value| zeros.get(value).copied().unwrap_or(NO_PLACE))));
        }
        let ends = pairs.iter().scan(0, |end, (same, _)| {
            *end += same.len() as u32;
            Some(*end)
        });
        let of_value = |value: usize| pairs.iter().map(move |(_, places)| places[value]);
        Gather {
            starts: once(0).chain(ends).collect(),
            sources: pairs.iter().flat_map(|(same, _)| same.iter().map(|(_, source)| *source)).collect(),
            places: (0..VALUES).flat_map(of_value).collect(),
        }
    }
}

impl Gather {
    pub fn pair_count(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn bytes(&self) -> usize {
        [&self.starts, &self.sources, &self.places].map(|list| size_of_val(&list[..])).iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::backend::gpu::layout::MeshLayout;
    use crate::mechanics::body::{Body, annulus, block};
    use crate::mechanics::element::ElementKind;
    use crate::mechanics::grading::GradingClass;
    use crate::mechanics::material::Idealization;

    /// Each place has one value or is one zero; a value is of the nodes of its row and column, in every element that has both.
    #[test]
    fn each_place_is_found_once_and_from_all_of_its_elements() {
        for (shape, parameters) in [(&annulus::SHAPE, [3.0, 0.0, 0.0]), (&block::SHAPE, [3.0, 4.0, 2.0])] {
            let body = Body::bare(shape, parameters, 0.3, Idealization::PlaneStress);
            let grading = GradingClass::of(&body, ElementKind::Quad8, 1).grading(body.shape.end_angle);
            let (topology, layout) =
                (RingTopology::new(&body, &grading), MeshLayout::new(&body, &grading).unwrap());
            let (systems, gather) = (&layout.systems, &layout.gather);
            let mut unknowns_at = vec![None; systems.sliced.columns.len()];
            for (row, ends) in systems.row_starts.windows(2).enumerate() {
                for value in ends[0] as usize..ends[1] as usize {
                    unknowns_at[systems.sliced.places[value] as usize] =
                        Some([row as u32, systems.columns[value]]);
                }
            }
            let (mut found, mut zeros) = (vec![0; unknowns_at.len()], 0);
            for pair in 0..gather.pair_count() {
                let own = gather.starts[pair] as usize..gather.starts[pair + 1] as usize;
                let sources = &gather.sources[own];
                for value in 0..VALUES {
                    let place = gather.places[value * gather.pair_count() + pair];
                    if place == NO_PLACE {
                        continue;
                    }
                    found[place as usize] += 1;
                    let Some(unknowns) = unknowns_at[place as usize] else {
                        assert!(sources.is_empty(), "{place}");
                        zeros += 1;
                        continue;
                    };
                    let node = |place: u32| topology.connectivity[place as usize];
                    let nodes = |source: u32| [node(source / 8), node(source / 64 * 8 + source % 8)];
                    let [row, column] = nodes(sources[0]);
                    let own = [(row, value / AXES), (column, value % AXES)];
                    assert_eq!(
                        own.map(|(node, axis)| topology.unknowns[AXES * node as usize + axis]),
                        unknowns
                    );
                    assert!(sources.iter().all(|source| nodes(*source) == [row, column]));
                    let has_both = |nodes: &&[u32]| nodes.contains(&row) && nodes.contains(&column);
                    let elements = topology.connectivity.chunks_exact(8).filter(has_both).count();
                    assert_eq!(sources.len(), elements, "{row} {column}");
                }
            }
            assert!(found.iter().all(|count| *count == 1));
            assert!(zeros > 0 && zeros < found.len() / 2, "{zeros} of {}", found.len());
        }
    }
}
