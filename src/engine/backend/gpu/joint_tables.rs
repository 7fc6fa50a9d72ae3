//! What joints have in common, on the device: the rows of bodies, the fits they may lie in, and the nodes of spaces. Each is uploaded once
//! and kept while there is room.

use std::f64::consts::FRAC_PI_2;

use bytemuck::{Pod, Zeroable};
use foldhash::{HashMap, HashSet};
use rayon::prelude::*;

use super::context::{GpuDevice, GpuError};
use crate::engine::backend::joints::{BodyTables, JointTables, TablesKey};
use crate::engine::spaces::SpaceKey;
use crate::mechanics::compliance::arc::packed_count;
use crate::mechanics::compliance::body_fit::NEGLIGIBLE;
use crate::mechanics::compliance::row_sums::Rows;
use crate::mechanics::contact::curve_space::CurveSpace;

/// As the kernel is told of a body's rows.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct RowParameters {
    pub product_count: u32,
    pub degree_count: u32,
    pub member_count: u32,
    pub coefficient_stride: u32,
    pub row_stride: u32,
    pub order_count: u32,
    pub products_at: u32,
    pub coefficients_at: u32,
    pub sizes_at: u32,
    pub rows_at: u32,
    pub before_ring: u32,
    pub padding: u32,
}

/// And of all that a joint has in common with others.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct JointParameters {
    pub bodies: [RowParameters; 2],
    pub node_count: u32,
    pub space_at: u32,
    pub turns_at: u32,
    pub cosines_at: u32,
    pub widest: f32,
    pub negligible: f32,
    pub together: u32,
    pub padding: u32,
}

/// Tables are dropped rather than take more bytes.
const MOST_BYTES: u64 = 120 << 20;

/// The first ones have room for more.
const FIRST_BYTES: u64 = 4 << 20;

/// The tables on a device, one after another in a buffer.
#[derive(Default)]
pub struct TableArena {
    buffer: Option<wgpu::Buffer>,
    used_words: usize,
    bodies: HashMap<TablesKey, RowParameters>,
    /// Without bodies, and what follows from them.
    spaces: HashMap<SpaceKey, JointParameters>,
}

/// Adds words to those that are in a buffer, which is made larger where it must be.
pub(super) fn add_words(
    gpu: &GpuDevice,
    label: &'static str,
    buffer: &mut Option<wgpu::Buffer>,
    used_words: &mut usize,
    words: &[u32],
) -> Result<(), GpuError> {
    let used = 4 * *used_words as u64;
    let needed = used + 4 * words.len() as u64;
    let limits = &gpu.facts.limits;
    if buffer.as_ref().is_none_or(|buffer| buffer.size() < needed) {
        let roomy = (2 * needed).max(FIRST_BYTES).min(limits.buffer_bytes.min(limits.binding_bytes));
        let larger = gpu.checked(label, || gpu.empty(label, roomy.max(needed)))?;
        if let Some(before) = buffer.take().filter(|_| used > 0) {
            gpu.checked(label, || gpu.copy(&before, &larger, used))?;
        }
        *buffer = Some(larger);
    }
    if let Some(buffer) = buffer {
        gpu.checked(label, || gpu.queue.write_buffer(buffer, used, bytemuck::cast_slice(words)))?;
    }
    *used_words += words.len();
    Ok(())
}

/// Tables that are not there yet.
struct Missing<'a> {
    bodies: Vec<(TablesKey, BodyTables<'a>, &'a CurveSpace)>,
    spaces: Vec<(SpaceKey, &'a CurveSpace)>,
    /// Of the tables asked for, in their order, how many these and those that are there make up.
    count: usize,
}

impl TableArena {
    /// Uploads what is not there of some tables; where there is no room for all of them, without the last ones. Tells how many there are, none
    /// where the first ones alone are too large for the device, and the bytes that went up.
    pub fn meet(&mut self, gpu: &GpuDevice, tables: &[&JointTables]) -> Result<(usize, u64), GpuError> {
        let most_words = (MOST_BYTES.min(gpu.facts.limits.binding_bytes) / 4) as usize;
        let mut missing = self.missing(tables, most_words);
        if missing.count < tables.len() && self.used_words > 0 {
            *self = TableArena::default();
            missing = self.missing(tables, most_words);
        }
        let of_body = |(key, body, space): (TablesKey, BodyTables, &CurveSpace)| {
            let mut words = Vec::new();
            let rows = body_words(&body, space, &mut words);
            (key, rows, words)
        };
        let bodies: Vec<_> = missing.bodies.into_par_iter().map(of_body).collect();
        let first = self.used_words;
        let mut words: Vec<u32> = Vec::new();
        for (key, rows, own) in bodies {
            let at = (first + words.len()) as u32;
            let RowParameters { products_at, coefficients_at, sizes_at, rows_at, .. } = rows;
            let moved = RowParameters {
                products_at: products_at + at,
                coefficients_at: coefficients_at + at,
                sizes_at: sizes_at + at,
                // Words are whole fours.
                rows_at: rows_at + at / 4,
                ..rows
            };
            self.bodies.insert(key, moved);
            words.extend(own);
        }
        for (key, space) in missing.spaces {
            self.spaces.insert(key, space_words(space, first, &mut words));
        }
        add_words(gpu, "tables of joints", &mut self.buffer, &mut self.used_words, &words)?;
        Ok((missing.count, 4 * words.len() as u64))
    }

    fn missing<'a>(&self, tables: &[&JointTables<'a>], most_words: usize) -> Missing<'a> {
        let mut missing = Missing { bodies: Vec::new(), spaces: Vec::new(), count: 0 };
        let mut met: HashSet<TablesKey> = HashSet::default();
        let mut words = self.used_words;
        for JointTables { bodies, space: (key, space) } in tables.iter().copied() {
            let mut own = Missing { bodies: Vec::new(), spaces: Vec::new(), count: 0 };
            if !self.spaces.contains_key(key) && met.insert(TablesKey::Space(*key)) {
                words += SPACE_WORDS;
                own.spaces.push((*key, *space));
            }
            for body in bodies {
                let key = body.key(*key);
                if !self.bodies.contains_key(&key) && met.insert(key) {
                    words += most_body_words(body, space);
                    own.bodies.push((key, *body, *space));
                }
            }
            if words > most_words {
                break;
            }
            missing.bodies.extend(own.bodies);
            missing.spaces.extend(own.spaces);
            missing.count += 1;
        }
        missing
    }

    /// Those that were met; some were.
    pub fn buffer(&self) -> &wgpu::Buffer {
        self.buffer.as_ref().unwrap_or_else(|| unreachable!("tables are met before they are bound"))
    }

    /// Of tables that are there.
    pub fn parameters(&self, tables: &JointTables) -> JointParameters {
        let (key, _) = tables.space;
        let bodies = tables.key().map(|key| self.bodies[&key]);
        let together = tables.kind().together as u32;
        JointParameters { bodies, together, ..self.spaces[&key] }
    }
}

/// At least as many as `body_words` makes.
fn most_body_words(body: &BodyTables, space: &CurveSpace) -> usize {
    let rows: usize = body.rows().into_iter().product();
    let of_fit = match body {
        BodyTables::Fit(_, fit, _) => fit.polynomials.count() + fit.coefficients().values().len(),
        BodyTables::Modes(_) => 0,
    };
    // Rows begin at a whole four.
    of_fit + rows * (1 + 4 * row_fours(space)) + 3
}

/// Adds what is known of bodies of a kind; places are among these words, which are whole fours.
fn body_words(body: &BodyTables, space: &CurveSpace, words: &mut Vec<u32>) -> RowParameters {
    let made;
    let (rows, mut parameters) = match body {
        BodyTables::Fit(_, fit, rows) => {
            let degrees = fit.polynomials.degrees();
            words.extend(degrees.iter().map(|degrees| u32::from_le_bytes(*degrees)));
            let coefficients_at = add(fit.coefficients().values(), words);
            let highest = degrees.iter().flatten().copied().max().unwrap_or(0);
            let parameters = RowParameters {
                product_count: degrees.len() as u32,
                degree_count: 1 + u32::from(highest),
                coefficient_stride: fit.coefficients().stride() as u32,
                coefficients_at,
                ..RowParameters::default()
            };
            (*rows, parameters)
        }
        BodyTables::Modes(members) => {
            made = members.rows(space);
            (&made, RowParameters { before_ring: members.before_ring() as u32, ..RowParameters::default() })
        }
    };
    let [of_one, orders] = body.rows();
    parameters.member_count = of_one as u32 - 2;
    parameters.order_count = orders as u32;
    parameters.row_stride = row_fours(space) as u32;
    parameters.sizes_at = add(rows.sizes(), words);
    words.resize(words.len().next_multiple_of(4), 0);
    parameters.rows_at = words.len() as u32 / 4;
    add_in_fours(rows, space, words);
    parameters
}

/// Fours of numbers that a row takes.
fn row_fours(space: &CurveSpace) -> usize {
    packed_count(space.pressures.terms).div_ceil(4) * space.arcs().len()
}

/// Rows, `[packed entry][node]`, as `[packed entry / 4][node]` of four entries each: so an invocation, which has a node, takes four at a time.
fn add_in_fours(rows: &Rows, space: &CurveSpace, words: &mut Vec<u32>) {
    let nodes = space.arcs().len();
    let length = packed_count(space.pressures.terms) * nodes;
    for row in rows.values().chunks_exact(rows.stride().max(1)) {
        for of_four in row[..length].chunks(4 * nodes) {
            for node in 0..nodes {
                let entry = |place: usize| of_four.get(place * nodes + node).copied().unwrap_or(0.0);
                words.extend((0..4).map(|place| entry(place).to_bits()));
            }
        }
    }
}

fn add(numbers: &[f32], words: &mut Vec<u32>) -> u32 {
    let at = words.len() as u32;
    words.extend(numbers.iter().map(|number| number.to_bits()));
    at
}

/// At least as many as `space_words` makes.
const SPACE_WORDS: usize = 1024;

/// Adds what is known of a space to words of which others are before.
fn space_words(space: &CurveSpace, before: usize, words: &mut Vec<u32>) -> JointParameters {
    let node_count = space.arcs().len();
    let mut add = |numbers: &mut dyn Iterator<Item = f64>| {
        let at = (before + words.len()) as u32;
        words.extend(numbers.map(|number| (number as f32).to_bits()));
        at
    };
    let cosine = |step: usize| (FRAC_PI_2 * step as f64 / node_count as f64).cos();
    let parameters = JointParameters {
        bodies: Default::default(),
        node_count: node_count as u32,
        space_at: add(&mut space.node_numbers().flatten()),
        turns_at: add(&mut space.pressures.turns.iter().copied()),
        cosines_at: add(&mut (0..4 * node_count).map(cosine)),
        widest: space.widest() as f32,
        negligible: NEGLIGIBLE,
        together: 1,
        padding: 0,
    };
    // Others in fours may follow.
    words.resize((before + words.len()).next_multiple_of(4) - before, 0);
    parameters
}
