//! How fast a device condenses bodies and solves joints beside the processor of the same machine.

use serde::{Deserialize, Serialize};

use crate::engine::unit_costs::Pace;

/// What was measured on one machine. Rates are times over those that `unit_costs` says of the processor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rates {
    /// Of a thread of the processor while all are at work.
    pub processor: Pace,
    /// Of condensation on the device.
    pub device: f64,
    /// What one thread of the processor does for a body of the device, s.
    pub host: f64,
    /// Until the device has its kernels, s.
    pub start: f64,
    /// Of joints, where the device solves any.
    pub joints: Option<JointRates>,
}

/// The same of joints.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointRates {
    /// Of contact on the device.
    pub device: f64,
    /// What one thread of the processor does for a joint of the device, s.
    pub host: f64,
    /// Whether they are all those that are known by one mesh, or those of interpolated bodies alone.
    pub on_meshes: bool,
}

impl Rates {
    /// As many threads of the processor condense as fast as the device does.
    pub fn threads(&self) -> f64 {
        self.processor.in_lanes / self.device
    }

    /// The same of contact, where the device solves any.
    pub fn threads_of_contact(&self) -> Option<f64> {
        self.joints.map(|joints| self.processor.in_lanes / joints.device)
    }

    /// Whether these are rates at all, as what was kept in a file need not be.
    pub fn are_sound(&self) -> bool {
        let is_time = |time: f64| time.is_finite() && time > 0.0;
        let of_joints = self.joints.iter().flat_map(|joints| [joints.device, joints.host]);
        let Pace { in_lanes, others } = self.processor;
        [in_lanes, others, self.device, self.host, self.start].into_iter().chain(of_joints).all(is_time)
    }
}
