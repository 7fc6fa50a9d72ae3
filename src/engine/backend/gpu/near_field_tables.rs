//! Near fields on a device, for joints whose works stay there. Each is uploaded once and kept while there is room.

use foldhash::HashMap;

use super::context::{GpuDevice, GpuError};
use super::joint_tables::add_words;
use crate::engine::backend::joints::NEAR_NODES;
use crate::mechanics::compliance::near_field::{NearField, NearFieldClass};

/// Near fields on a device, one after another in a buffer: of each the works of a node, then those of the next one, as many nodes as any has.
#[derive(Default)]
pub struct NearFieldArena {
    buffer: Option<wgpu::Buffer>,
    used_words: usize,
    places: HashMap<NearFieldClass, u32>,
}

/// Near fields are dropped rather than take more bytes.
const MOST_NEAR_BYTES: u64 = 64 << 20;

impl NearFieldArena {
    /// Uploads what is not there of some near fields. Tells where in the buffer each of them begins, and the bytes that went up; no places
    /// where there is no room for all of them.
    pub fn meet(
        &mut self,
        gpu: &GpuDevice,
        near_fields: &[(NearFieldClass, &NearField)],
    ) -> Result<(Option<Vec<u32>>, u64), GpuError> {
        let most_words = (MOST_NEAR_BYTES.min(gpu.facts.limits.binding_bytes) / 4) as usize;
        let size = |near_field: &NearField| NEAR_NODES * near_field.works()[0].len();
        let is_new = |(class, _): &&(NearFieldClass, &NearField)| !self.places.contains_key(class);
        let new: usize = near_fields.iter().filter(is_new).map(|(_, own)| size(own)).sum();
        if self.used_words + new > most_words {
            *self = NearFieldArena::default();
            if near_fields.iter().map(|(_, own)| size(own)).sum::<usize>() > most_words {
                return Ok((None, 0));
            }
        }
        let (first, mut words) = (self.used_words, Vec::new());
        let mut place = |(class, near_field): &(NearFieldClass, &NearField)| {
            *self.places.entry(*class).or_insert_with(|| {
                let at = words.len();
                for works in near_field.works() {
                    words.extend(works.iter().map(|work| (*work as f32).to_bits()));
                }
                words.resize(at + size(near_field), 0);
                (first + at) as u32
            })
        };
        let places = near_fields.iter().map(&mut place).collect();
        add_words(gpu, "near fields", &mut self.buffer, &mut self.used_words, &words)?;
        Ok((Some(places), 4 * words.len() as u64))
    }

    /// Those that were met; `None` where none was yet.
    pub fn buffer(&self) -> Option<&wgpu::Buffer> {
        self.buffer.as_ref()
    }
}
