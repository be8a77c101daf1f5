//! All requested fields, found by key as messages and people name them, and by number as candidates
//! do.

mod deadlines;
mod dependents;
mod disclosure_rate;
mod entry;
mod field;
mod field_mut;
mod index;
mod interner;
mod mapping_versions;
mod policy_index;
mod validity;
mod variable_index;

use std::{
    collections::HashMap,
    hash::{BuildHasher as _, RandomState},
    sync::Arc,
};

use asi_model::{DateTime, FieldKey, FieldName};
use dependents::Dependents;
pub(crate) use dependents::{is_withheld_by, is_withheld_in};
use disclosure::{DisclosurePolicy, DocumentId, Gate, VariableKey};
pub use disclosure_rate::DisclosureRate;
use entry::FieldEntry;
pub use field::{Field, FieldDecision};
pub(crate) use field::{StoredField, basis_json, mapping_json, policy_json};
use field_mut::FieldMut;
use hashbrown::HashTable;
use index::Index;
use interner::Interner;
use mapping::Mapping;
pub use mapping_versions::{MappingVersions, ShadowMapping};
pub use validity::Validity;

use crate::WriterRegistry;

/// Owner of all requested fields and of what is known about them as a whole: deadlines, policies,
/// dependents, and what the next transaction writes.
#[derive(Default)]
pub struct FieldRegistry {
    /// Fields by number, so that a candidate's field is found without hashing a text.
    entries: HashMap<i64, Box<FieldEntry>, foldhash::fast::RandomState>,
    /// The numbers, by key. Partners choose the keys, so this hasher must withstand chosen ones: it
    /// draws a key of its own, as that of the entries does. Nothing is published in their order.
    numbers: HashTable<i64>,
    hasher: RandomState,
    last_id: i64,
    index: Index,
    dependents: Dependents,
    interner: Interner,
}

impl FieldRegistry {
    /// Makes an empty registry, whose next field gets a number after this one.
    pub(crate) fn after(last_id: i64) -> Self {
        Self { last_id, ..Self::default() }
    }

    /// Returns the greatest number that was given to a field.
    #[must_use]
    pub const fn last_id(&self) -> i64 {
        self.last_id
    }

    /// Returns the field with this key.
    #[must_use]
    pub fn get(&self, key: &FieldKey) -> Option<&Field> {
        self.by_id(self.id_of(key)?)
    }

    /// Returns the field with this number.
    #[must_use]
    pub fn by_id(&self, id: i64) -> Option<&Field> {
        self.entries.get(&id).map(|entry| &entry.field)
    }

    /// Returns all fields, in no order.
    pub fn iter(&self) -> impl Iterator<Item = &Field> {
        self.entries.values().map(|entry| &entry.field)
    }

    /// Returns true where a field has this key.
    #[must_use]
    pub fn contains(&self, key: &FieldKey) -> bool {
        self.id_of(key).is_some()
    }

    /// Returns the time at which a gate wants to be asked again or a request begins or ends.
    #[must_use]
    pub fn next_deadline(&self) -> Option<DateTime> {
        self.index.deadlines.next()
    }

    fn id_of(&self, key: &FieldKey) -> Option<i64> {
        let is_it = |id: &i64| self.entries.get(id).is_some_and(|entry| entry.field.key() == key);
        self.numbers.find(self.hasher.hash_one(key), is_it).copied()
    }

    /// Returns the number for a new field.
    pub(crate) const fn next_id(&mut self) -> i64 {
        self.last_id += 1;
        self.last_id
    }

    /// Adds a field. Its key must be new.
    pub(crate) fn insert(&mut self, field: Field) {
        let Self { entries, numbers, hasher, index, .. } = self;
        let (id, hash) = (field.id(), hasher.hash_one(field.key()));
        self.last_id = self.last_id.max(id);
        let mut entry = FieldEntry::new(field);
        index.add(&mut entry);
        entries.insert(id, Box::new(entry));
        let rehash =
            |id: &i64| entries.get(id).map_or(0, |entry| hasher.hash_one(entry.field.key()));
        numbers.insert_unique(hash, id, rehash);
    }

    /// Removes a field with its deadlines and what it depends on.
    pub(crate) fn remove(&mut self, key: &FieldKey) -> Option<Field> {
        let id = self.id_of(key)?;
        if let Ok(found) = self.numbers.find_entry(self.hasher.hash_one(key), |other| *other == id)
        {
            found.remove();
        }
        let mut entry = self.entries.remove(&id)?;
        self.index.forget(&mut entry);
        self.dependents.remove(key);
        Some(entry.field)
    }

    /// Opens the field with this key for changes.
    pub(crate) fn get_mut(&mut self, key: &FieldKey) -> Option<FieldMut<'_>> {
        let id = self.id_of(key)?;
        self.by_id_mut(id)
    }

    /// Opens the field with this number for changes.
    pub(crate) fn by_id_mut(&mut self, id: i64) -> Option<FieldMut<'_>> {
        let Self { entries, index, .. } = self;
        Some(FieldMut { entry: entries.get_mut(&id)?, index })
    }

    /// Changes the gate of the field with this number. This is the only way by which a gate
    /// releases a value: the field's writer has something to report from then on.
    pub(crate) fn through_gate<T>(
        &mut self,
        writers: &mut WriterRegistry,
        id: i64,
        now: DateTime,
        change: impl FnOnce(&mut Gate) -> T,
    ) -> Option<T> {
        let Self { entries, index, .. } = self;
        let entry = entries.get_mut(&id)?;
        let conditions = |entry: &FieldEntry| entry.field.gate.policy().withhold_while.clone();
        let former = entry.field.kept.is_some().then(|| conditions(entry));
        let result = change(&mut entry.field.gate);
        // The states that came with what is kept are not known any more.
        if former.is_some_and(|former| former != conditions(entry)) {
            entry.field.kept = None;
        }
        index.mark_dirty(entry);
        index.note_release(entry);
        if entry.field.gate.take_released() {
            entry.field.rate.count_released(now);
            if !std::mem::replace(&mut entry.has_released, true) {
                writers.mark_unreported(entry.field.writer());
            }
        }
        Some(result)
    }

    /// Returns the mapped fields whose decisions name this policy.
    pub(crate) fn under_policy(&self, id: &DocumentId) -> impl Iterator<Item = &Field> {
        self.index.policies.of(id).filter_map(move |id| self.by_id(id))
    }

    /// Returns the mapped fields whose mappings read this variable.
    pub(crate) fn reading(&self, variable: &VariableKey) -> impl Iterator<Item = &Field> {
        let candidates = self.index.variables.readers(variable);
        let fields = candidates.filter_map(move |id| self.by_id(id));
        fields.filter(|field| variable_index::reads(field, variable))
    }

    /// Hands out every field whose gate or transform changed since the last call, and whether its
    /// gate released a value, each once.
    pub(crate) fn take_dirty(&mut self, mut take: impl FnMut(&Field, bool)) {
        for id in std::mem::take(&mut self.index.dirty) {
            let Some(entry) = self.entries.get_mut(&id) else { continue };
            entry.is_dirty = false;
            let has_released = std::mem::take(&mut entry.has_released);
            take(&entry.field, has_released);
        }
    }

    /// Removes and returns the number of a field whose gate wanted to be asked by `now`.
    pub(crate) fn pop_release(&mut self, now: DateTime) -> Option<i64> {
        let id = self.index.deadlines.pop_release(now)?;
        if let Some(entry) = self.entries.get_mut(&id) {
            entry.deadlines.release = None;
        }
        Some(id)
    }

    /// Removes and returns the number of a field whose request began by `now` and that has a value
    /// from before.
    pub(crate) fn pop_beginning(&mut self, now: DateTime) -> Option<i64> {
        self.index.deadlines.pop_beginning(now)
    }

    /// Returns the mapped fields whose request ended by `now`, sorted by key.
    pub(crate) fn ended(&self, now: DateTime) -> Vec<FieldKey> {
        let ids = self.index.deadlines.ended(now);
        let mut keys: Vec<FieldKey> =
            ids.filter_map(|id| self.by_id(id)).map(|field| field.key().clone()).collect();
        keys.sort();
        keys
    }

    /// Follows the machine's clock where it was set back to `now`. Visits all fields: each gate that
    /// ever released a value knows the time of it, with or without a deadline, and would let no
    /// value out before that time comes again. A clock is set back too rarely for an index of these
    /// times, which every single release would have to keep.
    pub(crate) fn set_clock_back(&mut self, now: DateTime) {
        let Self { entries, index, .. } = self;
        for entry in entries.values_mut() {
            entry.field.gate.set_clock_back(now);
            index.note_release(entry);
        }
    }

    /// Returns the keys of the fields whose gates look at this field's state.
    pub(crate) fn dependents_of(&self, key: &FieldKey) -> Vec<FieldKey> {
        self.dependents.of(key)
    }

    /// Returns the key of the field with this number where another field's gate looks at its state.
    pub(crate) fn key_with_dependents(&self, id: i64) -> Option<FieldKey> {
        let key = self.entries.get(&id)?.field.key();
        self.dependents.has(key).then(|| key.clone())
    }

    /// Replaces the fields whose states this field's gate looks at.
    pub(crate) fn depend_on(&mut self, key: &FieldKey, others: impl Iterator<Item = FieldName>) {
        self.dependents.set(key, others.map(|other| key.request.field(other)).collect());
    }

    /// Shares the parts of a mapping that other mappings have, too.
    pub(crate) fn share_mapping(&mut self, mapping: &mut Mapping, key: &FieldKey) {
        self.interner.share_mapping(mapping, key);
    }

    /// Parses a stored policy.
    ///
    /// # Errors
    /// Text that is no policy.
    pub(crate) fn parse_policy(
        &mut self,
        json: String,
    ) -> serde_json::Result<Arc<DisclosurePolicy>> {
        self.interner.parse_policy(json)
    }

    /// Shares a policy that other fields have, too; `own` is the field's own policy.
    pub(crate) fn share_policy(
        &mut self,
        policy: Arc<DisclosurePolicy>,
        own: &Arc<DisclosurePolicy>,
    ) -> Arc<DisclosurePolicy> {
        self.interner.share_policy(policy, own)
    }
}
