//! The machines.

mod bank;
mod conveyor;
mod metal;
mod order;
mod robot;

use crate::{MachineConfig, MachineKind, blueprint::Blueprint};

/// Returns the blueprint of a configured machine.
#[must_use]
pub fn blueprint(config: &MachineConfig) -> Blueprint {
    match config.kind {
        MachineKind::MillingCell => metal::milling_cell(config),
        MachineKind::Press => metal::press(config),
        MachineKind::Conveyor => conveyor::conveyor(config),
        MachineKind::Robot => robot::robot(config),
        MachineKind::Bank => bank::bank(config),
    }
}
