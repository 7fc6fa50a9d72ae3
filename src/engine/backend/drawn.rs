//! Designs that a device draws itself, as it is given them: how values follow from their numbers, and the fits in which their bodies are found.

use std::ops::Range;

use crate::engine::backend::joints::{AskedOfJoints, JOINT_NUMBERS, JointTables, STATE_NUMBERS};
use crate::engine::question::tables::DESIGN_NUMBERS;

/// As `shaders/draw.wgsl` has it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub struct DrawSettings {
    /// The first design of a flight, and how many there are.
    pub first: u32,
    pub design_count: u32,
    /// Of the sampler, and the mixed seed of its Sobol sequence, the low half first.
    pub count: u32,
    pub load_count: u32,
    pub seed: [u32; 2],
    /// Numbers of a design, and of what is found of it.
    pub stride: u32,
    pub found_stride: u32,
    pub given_of_design: u32,
    pub given_of_row: u32,
    /// Numbers of a row behind what is given of it.
    pub behind_row: u32,
    pub plate_fit_count: u32,
    /// Where the tables of pin and plate begin, in words.
    pub sides_at: [u32; 2],
    /// Kinds of the loads, in words, and their values, in numbers.
    pub loads_at: [u32; 2],
    /// Where parameters of joints are.
    pub pairs_at: u32,
    pub padding: u32,
    pub more_padding: [u32; 2],
}

impl DrawSettings {
    /// With what a design takes up.
    pub fn sized(self) -> DrawSettings {
        let of_row = 2 + self.given_of_row + self.behind_row;
        let stride = JOINT_NUMBERS as u32
            + 2 * self.load_count
            + DESIGN_NUMBERS as u32
            + self.given_of_design
            + self.load_count * of_row;
        DrawSettings { stride, found_stride: 1 + STATE_NUMBERS as u32 * self.load_count, ..self }
    }
}

/// In place of what there is not.
pub const NOWHERE: u32 = u32::MAX;

/// In place of a place among numbers.
pub const UNKNOWN: f64 = -1.0;

/// Of the table of a side: words before its rows, kinds of bodies by Poisson's ratio at most, and words of a fit.
pub const SIDE_WORDS: usize = 8;
pub const MOST_KINDS: usize = 12;
pub const FIT_WORDS: usize = 2;

/// What bodies of a shape are, to a device.
#[derive(Clone, Copy, Debug)]
pub enum DrawnShape {
    /// All as deep.
    Plain,
    Concentric,
    Block,
}

/// Kinds of loads.
#[derive(Clone, Copy, Debug)]
pub enum LoadKind {
    Indentation,
    Offset,
    Force,
}

/// From this place on a word of pairs has the count of trial pressures.
pub const TERMS_SHIFT: u32 = 24;

/// Designs to be drawn and counted.
pub struct DrawnDesigns<'a> {
    pub designs: Range<u32>,
    pub settings: DrawSettings,
    pub words: Vec<u32>,
    pub numbers: Vec<f64>,
    /// `given_of_design` and `given_of_row` of the kernel.
    pub functions: &'a str,
    /// Those that designs may have, numbered as `words` has them.
    pub tables: Vec<JointTables<'a>>,
    pub asked: AskedOfJoints<'a>,
}
