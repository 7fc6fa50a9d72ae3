//! What a flight of joints takes up: as many as there is room for, and where what the kernel needs of each is.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};

use super::context::{GpuDevice, GpuError};
use super::dispatch::ALIGNMENT;
use super::elimination::KeptWorks;
use super::joint_tables::{JointParameters, TableArena};
use super::near_field_tables::NearFieldArena;
use crate::engine::backend::joints::{
    BatchedJoint, ELSEWHERE, JointBatch, JointKind, JointTables, MISSING, STATE_NUMBERS,
};
use crate::engine::question::counted::MOST_ROWS;

/// A joint as the kernel has it: where its parameters are, its numbers and what is found of it begin, and how many loads it has; where the
/// works of pin and plate begin, or `ELSEWHERE` or `MISSING`; its trial pressures, and the near fields of either body.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Placed {
    pub parameters: u32,
    pub numbers_at: u32,
    pub found_at: u32,
    pub load_count: u32,
    pub works_at: [u32; 2],
    pub terms: u32,
    pub padding: u32,
    pub near_fields_at: [[u32; 2]; 2],
}

/// What a flight takes up.
pub(super) struct Load {
    /// Of joints.
    pub count: usize,
    pub parameters: Vec<JointParameters>,
    /// Of each kind.
    pub places: Vec<(JointKind, Vec<Placed>)>,
    /// Of each joint where its numbers and what is found of it begin, its loads and amplitudes; where rows are counted.
    pub designs: Vec<[u32; 4]>,
    /// Their numbers, among those of the batch.
    pub numbers: Range<usize>,
    pub found_bytes: u64,
    /// Bytes of tables that went up for them.
    pub of_tables: u64,
}

/// What joints have in common, on a device.
#[derive(Default)]
pub(super) struct Arenas {
    pub tables: TableArena,
    pub near_fields: NearFieldArena,
}

impl Arenas {
    /// What there is room for, in so many bytes up and as many down, of the joints of a batch from one on, whose tables are there then; none where those of
    /// the first are too large.
    pub(super) fn load(
        &mut self,
        gpu: &GpuDevice,
        (batch, first): (&JointBatch, usize),
        works: Option<&KeptWorks>,
        most_bytes: u64,
    ) -> Result<Load, GpuError> {
        let (near_fields, of_near_fields) = self.near_fields.meet(gpu, &batch.near_fields)?;
        let most = (most_bytes.min(gpu.facts.limits.binding_bytes) / 4) as usize;
        let start = numbers_of(batch, first).start;
        // Tables in the order in which joints ask for them, and their places in it.
        let mut tables: Vec<&JointTables> = Vec::new();
        let mut order: Vec<Option<u32>> = vec![None; batch.tables.len()];
        let (mut count, mut found) = (0, 0);
        let most_found = if batch.asked.is_some() { most.min(STATE_NUMBERS * MOST_ROWS) } else { most };
        for (place, joint) in batch.joints.iter().enumerate().skip(first) {
            if count > 0
                && (numbers_of(batch, place).end - start > most || found + joint.found() > most_found)
            {
                break;
            }
            found += joint.found();
            count += 1;
            order[joint.tables as usize].get_or_insert_with(|| {
                tables.push(&batch.tables[joint.tables as usize]);
                tables.len() as u32 - 1
            });
        }
        let (met, bytes) = self.tables.meet(gpu, &tables)?;
        let tables = &tables[..met];
        let kinds: Vec<JointKind> = tables.iter().map(|tables| tables.kind()).collect();
        let mut load = Load {
            count: 0,
            parameters: tables.iter().map(|tables| self.tables.parameters(tables)).collect(),
            places: Vec::new(),
            designs: Vec::new(),
            numbers: start..start,
            found_bytes: 0,
            of_tables: bytes + of_near_fields,
        };
        for joint in &batch.joints[first..first + count] {
            let Some(own) = order[joint.tables as usize].filter(|own| (*own as usize) < met) else { break };
            let kind = kinds[own as usize];
            let (numbers_at, found_at) = (joint.numbers_at - start as u32, (load.found_bytes / 4) as u32);
            let works_at = joint.condensed.map(|body| match body {
                None => ELSEWHERE,
                Some(body) => works.map_or(MISSING, |works| works.places[body.place as usize]),
            });
            let near_fields_at = joint.condensed.map(|body| {
                let places = body.and_then(|body| Some((body, near_fields.as_ref()?)));
                places.map_or([0; 2], |(body, places)| body.near_fields.map(|own| places[own as usize]))
            });
            let placed = Placed {
                parameters: own,
                numbers_at,
                found_at,
                load_count: joint.load_count,
                // Without near fields works are no good.
                works_at: if near_fields.is_some() { works_at } else { [MISSING; 2] },
                terms: kind.terms as u32,
                padding: 0,
                near_fields_at,
            };
            if batch.asked.is_some() {
                load.designs.push([numbers_at, found_at, joint.load_count, joint.amplitude_count]);
            }
            match load.places.iter_mut().find(|(own, _)| *own == kind) {
                Some((_, places)) => places.push(placed),
                None => load.places.push((kind, vec![placed])),
            }
            load.numbers.end = numbers_of(batch, first + load.count).end;
            load.count += 1;
            load.found_bytes += 4 * joint.found() as u64;
        }
        Ok(load)
    }
}

/// Bytes of places, as parts of a buffer that others follow in.
pub(super) fn whole_parts(places: &[Placed]) -> u64 {
    (size_of_val(places) as u64).next_multiple_of(ALIGNMENT)
}

/// Of a joint, among those of its batch.
fn numbers_of(batch: &JointBatch, joint: usize) -> Range<usize> {
    let at = |joint: &BatchedJoint| joint.numbers_at as usize;
    at(&batch.joints[joint])..batch.joints.get(joint + 1).map_or(batch.numbers.count(), at)
}
