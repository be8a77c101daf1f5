//! Handle to a simulation.

use std::sync::Arc;

use indexmap::IndexMap;

use crate::host::MachineHandle;

/// Cloneable handle to a simulation.
#[derive(Clone)]
pub struct SimulatorHandle {
    machines: Arc<IndexMap<String, MachineHandle>>,
}

impl SimulatorHandle {
    pub(crate) fn new(machines: IndexMap<String, MachineHandle>) -> Self {
        Self { machines: Arc::new(machines) }
    }

    /// Returns a machine by its name.
    #[must_use]
    pub fn machine(&self, name: &str) -> Option<&MachineHandle> {
        self.machines.get(name)
    }

    /// Returns all machines, in the order of the configuration.
    pub fn machines(&self) -> impl Iterator<Item = &MachineHandle> {
        self.machines.values()
    }
}
