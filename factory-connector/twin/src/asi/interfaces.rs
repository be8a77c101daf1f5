//! All interfaces of the twin, by id and in the order of their arrival.

use std::{
    collections::{BTreeMap, HashMap},
    sync::Arc,
};

use asi_model::OperationNetworkId;

use super::interface::Interface;
use crate::clock;

/// All interfaces. Locked only for moments: expensive work happens outside of the lock.
#[derive(Default)]
pub(super) struct Interfaces {
    by_id: HashMap<OperationNetworkId, Arc<Interface>>,
    by_sequence: BTreeMap<u64, OperationNetworkId>,
    last_sequence: u64,
    /// NodeVersion of the folder.
    version: u64,
}

impl Interfaces {
    pub(super) fn get(&self, id: &str) -> Option<Arc<Interface>> {
        self.by_id.get(id).cloned()
    }

    pub(super) fn len(&self) -> usize {
        self.by_id.len()
    }

    /// Returns the NodeVersion of the folder.
    pub(super) fn version(&self) -> u64 {
        self.version
    }

    /// Returns the sequence number of the next new interface.
    pub(super) fn next_sequence(&self) -> u64 {
        self.last_sequence + 1
    }

    /// Returns the first interface after a sequence number.
    pub(super) fn after(&self, sequence: u64) -> Option<(u64, OperationNetworkId)> {
        let (found, id) = self.by_sequence.range(sequence + 1..).next()?;
        Some((*found, id.clone()))
    }

    /// Adds an interface, or replaces the earlier state of one that has the same sequence number.
    pub(super) fn put(&mut self, id: OperationNetworkId, interface: &Arc<Interface>) {
        if self.by_sequence.insert(interface.sequence, id.clone()).is_none() {
            self.last_sequence = self.last_sequence.max(interface.sequence);
            self.version = next_version(self.version);
        }
        self.by_id.insert(id, Arc::clone(interface));
    }

    pub(super) fn remove(&mut self, id: &OperationNetworkId) -> Option<Arc<Interface>> {
        let interface = self.by_id.remove(id)?;
        self.by_sequence.remove(&interface.sequence);
        self.version = next_version(self.version);
        // A table that once was large would keep its memory for ever.
        if self.by_id.capacity() > 4 * self.by_id.len() + 64 {
            self.by_id.shrink_to_fit();
        }
        Some(interface)
    }
}

/// Returns a version that is greater than the last one, also after a restart.
fn next_version(version: u64) -> u64 {
    (version + 1).max(u64::from(clock::now().version_time()))
}
