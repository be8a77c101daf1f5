//! All requested fields, found by key as messages and people name them, and by number as candidates
//! do.

mod deadlines;
mod dependents;
mod disclosure_rate;
mod field;
mod interner;
mod mapping_versions;
mod validity;

use std::{
    collections::HashMap,
    hash::{BuildHasher as _, RandomState},
    ops::{Deref, DerefMut},
    sync::Arc,
};

use asi_model::{DateTime, FieldKey, FieldName};
use deadlines::Deadlines;
use dependents::Dependents;
pub(crate) use dependents::is_withheld_by;
use disclosure::{DisclosurePolicy, Gate};
pub use disclosure_rate::DisclosureRate;
pub use field::{Field, FieldDecision};
pub(crate) use field::{basis_json, mapping_json, policy_json};
use hashbrown::HashTable;
use interner::Interner;
use mapping::Mapping;
pub use mapping_versions::{MappingVersions, ShadowMapping};
pub use validity::Validity;

/// Owner of all requested fields and of what is known about them as a whole: deadlines, dependents,
/// and what the next transaction writes.
#[derive(Default)]
pub struct FieldRegistry {
    /// Fields by number, so that a candidate's field is found without hashing a text.
    entries: HashMap<i64, Box<Entry>, foldhash::fast::RandomState>,
    /// The numbers, by key. Partners choose the keys, so this hasher must withstand chosen ones.
    numbers: HashTable<i64>,
    hasher: RandomState,
    last_id: i64,
    deadlines: Deadlines,
    dependents: Dependents,
    /// Numbers of fields whose gate or transform state the next transaction writes.
    dirty: Vec<i64>,
    interner: Interner,
}

/// A field with the registry's own notes about it.
struct Entry {
    field: Field,
    /// Stands in [`FieldRegistry::dirty`].
    is_dirty: bool,
    /// Its gate released a value that no report carries yet.
    has_released: bool,
    deadlines: deadlines::Noted,
}

impl FieldRegistry {
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
        self.deadlines.next()
    }

    fn id_of(&self, key: &FieldKey) -> Option<i64> {
        let is_it = |id: &i64| self.entries.get(id).is_some_and(|entry| entry.field.key == *key);
        self.numbers.find(self.hasher.hash_one(key), is_it).copied()
    }

    /// Returns the number for a new field.
    pub(crate) const fn next_id(&mut self) -> i64 {
        self.last_id += 1;
        self.last_id
    }

    /// Adds a field. Its key must be new.
    pub(crate) fn insert(&mut self, field: Field) {
        let Self { entries, numbers, hasher, .. } = self;
        let (id, hash) = (field.id, hasher.hash_one(&field.key));
        self.last_id = self.last_id.max(id);
        let deadlines = deadlines::Noted::default();
        let entry = Entry { field, is_dirty: false, has_released: false, deadlines };
        entries.insert(id, Box::new(entry));
        let rehash =
            |id: &i64| entries.get(id).map_or(0, |entry| hasher.hash_one(&entry.field.key));
        numbers.insert_unique(hash, id, rehash);
        self.note_deadlines(id);
    }

    /// Removes a field with its deadlines and what it depends on.
    pub(crate) fn remove(&mut self, key: &FieldKey) -> Option<Field> {
        let id = self.id_of(key)?;
        if let Ok(found) = self.numbers.find_entry(self.hasher.hash_one(key), |other| *other == id)
        {
            found.remove();
        }
        let mut entry = self.entries.remove(&id)?;
        self.deadlines.forget(id, &mut entry.deadlines);
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
        let Self { entries, deadlines, dirty, .. } = self;
        let entry = entries.get_mut(&id)?;
        Some(FieldMut { entry, deadlines, dirty })
    }

    /// Marks that the next transaction writes the field's gate and transform.
    pub(crate) fn mark_dirty(&mut self, key: &FieldKey) {
        if let Some(mut field) = self.get_mut(key) {
            field.mark_dirty();
        }
    }

    /// Brings the field's deadlines up to date.
    fn note_deadlines(&mut self, id: i64) {
        if let Some(mut field) = self.by_id_mut(id) {
            field.note_deadlines();
        }
    }

    /// Hands out every field whose gate or transform changed since the last call, and whether its
    /// gate released a value, each once.
    pub(crate) fn take_dirty(&mut self, mut take: impl FnMut(&Field, bool)) {
        for id in std::mem::take(&mut self.dirty) {
            let Some(entry) = self.entries.get_mut(&id) else { continue };
            entry.is_dirty = false;
            let has_released = std::mem::take(&mut entry.has_released);
            take(&entry.field, has_released);
        }
    }

    /// Removes and returns the number of a field whose gate wanted to be asked by `now`.
    pub(crate) fn pop_release(&mut self, now: DateTime) -> Option<i64> {
        let id = self.deadlines.pop_release(now)?;
        if let Some(entry) = self.entries.get_mut(&id) {
            entry.deadlines.release = None;
        }
        Some(id)
    }

    /// Removes and returns the number of a field whose request began by `now` and that has a value
    /// from before.
    pub(crate) fn pop_beginning(&mut self, now: DateTime) -> Option<i64> {
        self.deadlines.pop_beginning(now)
    }

    /// Notes a value that came before its request asks for it.
    pub(crate) fn note_beginning(&mut self, id: i64, from: DateTime) {
        self.deadlines.note_beginning(id, from);
    }

    /// Returns the mapped fields whose request ended by `now`, sorted by key.
    pub(crate) fn ended(&self, now: DateTime) -> Vec<FieldKey> {
        let ids = self.deadlines.ended(now);
        let mut keys: Vec<FieldKey> =
            ids.filter_map(|id| self.by_id(id)).map(|field| field.key.clone()).collect();
        keys.sort();
        keys
    }

    /// Follows the machine's clock where it was set back to `now`.
    pub(crate) fn set_clock_back(&mut self, now: DateTime) {
        let Self { entries, deadlines, .. } = self;
        for (id, entry) in entries {
            entry.field.gate.set_clock_back(now);
            deadlines.note_release(*id, entry.field.gate.due(), &mut entry.deadlines);
        }
    }

    /// Returns the keys of the fields whose gates look at this field's state.
    pub(crate) fn dependents_of(&self, key: &FieldKey) -> Vec<FieldKey> {
        self.dependents.of(key)
    }

    /// Returns the key of the field with this number where another field's gate looks at its state.
    pub(crate) fn key_with_dependents(&self, id: i64) -> Option<FieldKey> {
        let key = &self.entries.get(&id)?.field.key;
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

/// A field that is being changed.
pub(crate) struct FieldMut<'r> {
    entry: &'r mut Entry,
    deadlines: &'r mut Deadlines,
    dirty: &'r mut Vec<i64>,
}

impl FieldMut<'_> {
    /// Changes the gate, and notes its deadline and that it is to be written. The flag is true
    /// where the gate released a value and no earlier one waits for a report.
    pub(crate) fn through_gate<T>(
        &mut self,
        now: DateTime,
        change: impl FnOnce(&mut Gate) -> T,
    ) -> (T, bool) {
        let result = change(&mut self.entry.field.gate);
        self.mark_dirty();
        self.note_release();
        let mut is_first = false;
        if self.entry.field.gate.take_released() {
            self.entry.field.rate.count_released(now);
            is_first = !std::mem::replace(&mut self.entry.has_released, true);
        }
        (result, is_first)
    }

    /// Marks that the next transaction writes the field's gate and transform.
    pub(crate) fn mark_dirty(&mut self) {
        if !std::mem::replace(&mut self.entry.is_dirty, true) {
            self.dirty.push(self.entry.field.id);
        }
    }

    /// Brings the deadlines up to date after the gate, the decision or the validity changed.
    pub(crate) fn note_deadlines(&mut self) {
        self.note_release();
        let field = &self.entry.field;
        let end = field.validity.until.filter(|_| field.decision.is_mapped());
        self.deadlines.note_end(field.id, end, &mut self.entry.deadlines);
    }

    fn note_release(&mut self) {
        let due = self.entry.field.gate.due();
        self.deadlines.note_release(self.entry.field.id, due, &mut self.entry.deadlines);
    }
}

impl Deref for FieldMut<'_> {
    type Target = Field;

    fn deref(&self) -> &Field {
        &self.entry.field
    }
}

impl DerefMut for FieldMut<'_> {
    fn deref_mut(&mut self) -> &mut Field {
        &mut self.entry.field
    }
}
