//! The mappings at work, each at a place of its own.

use std::{collections::HashMap, sync::Arc, time::Duration};

use asi_model::DateTime;
use mapping::{FaultRecord, Mapping, MappingId, TargetKey, transform::Transform};
use script_protocol::ScriptId;
use shop_floor::InputKey;
use smallvec::SmallVec;

use crate::script::breaker::Breaker;

/// A mapping at work.
#[derive(Debug)]
pub(super) struct Entry {
    pub mapping: Arc<Mapping>,
    pub transform: Transform,
    /// Whose values it yields, in the consumer's words.
    pub target: TargetKey,
    pub inputs: SmallVec<[InputKey; 2]>,
    pub scripts: Box<[Script]>,
    /// It runs, and nothing of it leaves the engine.
    pub is_shadow: bool,
    /// When it is woken next.
    pub scheduled: Option<DateTime>,
    pub received: u64,
    pub yielded: u64,
    pub superseded: u64,
    pub faults: u64,
    pub last_fault: Option<Box<FaultRecord>>,
    pub spent: Duration,
    pub last_yielded_at: Option<DateTime>,
    /// The number of the batch of candidates that carried its state.
    pub state_carried_in: u64,
}

/// A script of a mapping.
#[derive(Debug)]
pub(super) struct Script {
    pub id: ScriptId,
    pub step: usize,
    pub lane: usize,
    pub breaker: Breaker,
}

impl Entry {
    pub fn new(
        mapping: Arc<Mapping>,
        transform: Transform,
        target: TargetKey,
        inputs: SmallVec<[InputKey; 2]>,
        scripts: Box<[Script]>,
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
            received: 0,
            yielded: 0,
            superseded: 0,
            faults: 0,
            last_fault: None,
            spent: Duration::ZERO,
            last_yielded_at: None,
            state_carried_in: 0,
        }
    }
}

/// All mappings. Places are used again.
#[derive(Debug, Default)]
pub(super) struct Inventory {
    /// Each at an address of its own: what grows is a list of addresses.
    entries: Vec<Option<Box<Entry>>>,
    free: Vec<usize>,
    places: HashMap<MappingId, usize>,
}

impl Inventory {
    pub fn len(&self) -> usize {
        self.places.len()
    }

    pub fn place_of(&self, id: &MappingId) -> Option<usize> {
        self.places.get(id).copied()
    }

    pub fn get(&self, place: usize) -> Option<&Entry> {
        self.entries.get(place)?.as_deref()
    }

    pub fn get_mut(&mut self, place: usize) -> Option<&mut Entry> {
        self.entries.get_mut(place)?.as_deref_mut()
    }

    /// The place that the next entry gets.
    pub fn next_place(&self) -> usize {
        self.free.last().copied().unwrap_or(self.entries.len())
    }

    /// Puts an entry at [`Self::next_place`].
    pub fn insert(&mut self, id: MappingId, entry: Entry) {
        let entry = Box::new(entry);
        let place = match self.free.pop() {
            Some(place) => {
                self.entries[place] = Some(entry);
                place
            }
            None => {
                self.entries.push(Some(entry));
                self.entries.len() - 1
            }
        };
        self.places.insert(id, place);
    }

    pub fn remove(&mut self, id: &MappingId) -> Option<(usize, Box<Entry>)> {
        let place = self.places.remove(id)?;
        let entry = self.entries.get_mut(place)?.take()?;
        self.free.push(place);
        Some((place, entry))
    }

    pub fn iter(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().filter_map(Option::as_deref)
    }
}
