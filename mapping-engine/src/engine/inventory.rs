//! Running mappings by slot: an index that stays the same while a mapping runs.

use std::{collections::HashMap, sync::Arc, time::Duration};

use asi_model::DateTime;
use mapping::{FaultRecord, Mapping, MappingId, TargetKey, transform::Transform};
use script_protocol::ScriptId;
use shop_floor::InputKey;
use smallvec::SmallVec;

use crate::script::breaker::Breaker;

/// Running mapping with its counters.
#[derive(Debug)]
pub(super) struct RunningMapping {
    pub mapping: Arc<Mapping>,
    pub transform: Transform,
    /// Consumer's key of its field.
    pub target: TargetKey,
    pub inputs: SmallVec<[InputKey; 2]>,
    pub scripts: Box<[ScriptStep]>,
    /// A shadow mapping runs, and nothing of it leaves the engine.
    pub is_shadow: bool,
    /// Time of its next timer, by the local clock.
    pub scheduled: Option<DateTime>,
    pub counters: MappingCounters,
    /// The number of the batch of candidates that carried its state.
    pub state_carried_in: u64,
}

/// Work of a mapping since it was published.
#[derive(Debug, Default)]
pub(super) struct MappingCounters {
    pub received: u64,
    pub yielded: u64,
    pub superseded: u64,
    pub faults: u64,
    pub last_fault: Option<Box<FaultRecord>>,
    pub spent: Duration,
    pub last_yielded_at: Option<DateTime>,
}

/// A script as a step of a mapping.
#[derive(Debug)]
pub(super) struct ScriptStep {
    pub id: ScriptId,
    pub step: usize,
    /// Index of the worker that runs it.
    pub worker: usize,
    pub breaker: Breaker,
}

impl RunningMapping {
    /// Starts all counters at zero.
    pub fn new(
        mapping: Arc<Mapping>,
        transform: Transform,
        target: TargetKey,
        inputs: SmallVec<[InputKey; 2]>,
        scripts: Box<[ScriptStep]>,
        is_shadow: bool,
    ) -> Self {
        Self {
            mapping,
            transform,
            target,
            inputs,
            scripts,
            is_shadow,
            scheduled: None,
            counters: MappingCounters::default(),
            state_carried_in: 0,
        }
    }
}

/// All mappings. Slots are used again.
#[derive(Debug, Default)]
pub(super) struct Inventory {
    /// Boxed, so that growing moves pointers only.
    entries: Vec<Option<Box<RunningMapping>>>,
    free: Vec<usize>,
    slots: HashMap<MappingId, usize>,
}

impl Inventory {
    /// Returns the number of mappings.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Returns the slot of a mapping.
    pub fn slot_of(&self, id: &MappingId) -> Option<usize> {
        self.slots.get(id).copied()
    }

    /// Returns the mapping in a slot.
    pub fn get(&self, slot: usize) -> Option<&RunningMapping> {
        self.entries.get(slot)?.as_deref()
    }

    /// Returns the mapping in a slot.
    pub fn get_mut(&mut self, slot: usize) -> Option<&mut RunningMapping> {
        self.entries.get_mut(slot)?.as_deref_mut()
    }

    /// Returns the slot of the next [`Self::insert`].
    pub fn next_slot(&self) -> usize {
        self.free.last().copied().unwrap_or(self.entries.len())
    }

    /// Stores a mapping at [`Self::next_slot`].
    pub fn insert(&mut self, id: MappingId, running: RunningMapping) {
        let running = Box::new(running);
        let slot = match self.free.pop() {
            Some(slot) => {
                self.entries[slot] = Some(running);
                slot
            }
            None => {
                self.entries.push(Some(running));
                self.entries.len() - 1
            }
        };
        self.slots.insert(id, slot);
    }

    /// Removes a mapping and frees its slot.
    pub fn remove(&mut self, id: &MappingId) -> Option<(usize, Box<RunningMapping>)> {
        let slot = self.slots.remove(id)?;
        let running = self.entries.get_mut(slot)?.take()?;
        self.free.push(slot);
        Some((slot, running))
    }

    /// Iterates over all mappings, in no particular order.
    pub fn iter(&self) -> impl Iterator<Item = &RunningMapping> {
        self.entries.iter().filter_map(Option::as_deref)
    }
}
