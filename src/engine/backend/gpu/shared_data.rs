//! What the bodies of topologies share, of many topologies in the same two buffers, so that one dispatch reaches them all.

use wgpu::BufferUsages;

use super::context::{GpuDevice, GpuError};

/// Two buffers, each with what many topologies share, one behind the other.
#[derive(Clone, PartialEq)]
pub struct SharedBuffers {
    /// Of those of a device, in the order they were made.
    pub number: usize,
    /// Of u32.
    pub lists: wgpu::Buffer,
    /// Wide numbers.
    pub numbers: wgpu::Buffer,
}

/// Where that of one topology is.
pub struct SharedPlace {
    pub buffers: SharedBuffers,
    /// Elements before its own.
    pub lists_at: u32,
    pub numbers_at: u32,
}

/// The buffers that have room left. Older ones live as long as their topologies.
#[derive(Default)]
pub struct SharedData {
    open: Option<(SharedBuffers, [u64; 2])>,
    made: usize,
}

/// Bytes of lists and of numbers: those of some hundred topologies of coarse meshes.
const CAPACITY: [u64; 2] = [16 << 20, 2 << 20];

/// Numbers are read in vectors of as many.
const VECTOR: usize = 4;

impl SharedData {
    /// Uploads the lists and the encoded numbers, of `wide` bytes each, of a topology; a new pair of buffers is made where they have no
    /// room. Each must fit a binding.
    pub fn place(
        &mut self,
        gpu: &GpuDevice,
        lists: &[u32],
        numbers: &[u8],
        wide: u64,
    ) -> Result<SharedPlace, GpuError> {
        let vector = VECTOR as u64 * wide;
        let needed = [size_of_val(lists) as u64, (numbers.len() as u64).next_multiple_of(vector)];
        gpu.checked("a topology", || {
            let has_room = |(buffers, used): &(SharedBuffers, [u64; 2])| {
                used[0] + needed[0] <= buffers.lists.size() && used[1] + needed[1] <= buffers.numbers.size()
            };
            let (buffers, used) = match self.open.take().filter(has_room) {
                Some(open) => open,
                None => (self.buffers(gpu, needed), [0; 2]),
            };
            gpu.queue.write_buffer(&buffers.lists, used[0], bytemuck::cast_slice(lists));
            gpu.queue.write_buffer(&buffers.numbers, used[1], numbers);
            self.open = Some((buffers.clone(), [used[0] + needed[0], used[1] + needed[1]]));
            SharedPlace { buffers, lists_at: (used[0] / 4) as u32, numbers_at: (used[1] / wide) as u32 }
        })
    }

    fn buffers(&mut self, gpu: &GpuDevice, needed: [u64; 2]) -> SharedBuffers {
        let most = gpu.facts.limits.bound_buffer();
        let buffer = |label, part: usize| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: CAPACITY[part].min(most).max(needed[part]),
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        self.made += 1;
        SharedBuffers { number: self.made, lists: buffer("lists", 0), numbers: buffer("shared numbers", 1) }
    }
}
