//! A field that is being changed. Its gate is not reached from here: a value that is released has to
//! be reported, see [`FieldRegistry::through_gate`](super::FieldRegistry::through_gate).

use std::{ops::Deref, sync::Arc};

use asi_model::{DataValue, DateTime, network::ReportField};
use mapping::{Mapping, TransformState};

use super::{
    DisclosureRate, Field, FieldDecision, ShadowMapping, Validity, entry::FieldEntry, index::Index,
};

/// A field that is being changed. Each method brings up to date what the registry knows about all
/// fields: deadlines, named policies, and which fields the next transaction writes.
pub(crate) struct FieldMut<'r> {
    pub(super) entry: &'r mut FieldEntry,
    pub(super) index: &'r mut Index,
}

impl FieldMut<'_> {
    /// Marks that the next transaction writes the field's gate and transform.
    pub(crate) fn mark_dirty(&mut self) {
        self.index.mark_dirty(self.entry);
    }

    pub(crate) fn change_decision<T>(&mut self, change: impl FnOnce(&mut FieldDecision) -> T) -> T {
        self.index.forget_decision(&self.entry.field);
        let result = change(&mut self.entry.field.decision);
        self.index.note_decision(&self.entry.field);
        self.index.note_deadlines(self.entry);
        result
    }

    /// Closes the gate, and forgets the newest candidate: the consent ended.
    pub(crate) fn close(&mut self, now: DateTime) {
        self.forget_candidates();
        self.close_gate(now);
    }

    /// Begins a consent: nothing is left of values from before, and counting starts again.
    pub(crate) fn begin_consent(&mut self, now: DateTime) {
        self.entry.field.rate = DisclosureRate::new(now);
        self.close_gate(now);
    }

    /// Follows the field's request as it is now. For another type the gate closes.
    pub(crate) fn change_definition(
        &mut self,
        definition: ReportField,
        validity: Validity,
        now: DateTime,
    ) {
        let field = &mut self.entry.field;
        let field_type = definition.field_type.0;
        if field.definition.field_type.0 != field_type {
            field.gate.change_type(field_type, now);
            self.index.mark_dirty(self.entry);
        }
        let field = &mut self.entry.field;
        field.definition = definition;
        field.validity = validity;
        if field.kept.is_some() {
            self.index.deadlines.note_beginning(field.id(), validity.from.unwrap_or(now));
        }
        self.index.note_deadlines(self.entry);
    }

    /// Takes a candidate on its way to the gate, with the state of the functions that made it.
    pub(crate) fn receive(
        &mut self,
        candidate: DataValue,
        transform: Option<TransformState>,
        now: DateTime,
    ) {
        let field = &mut self.entry.field;
        if transform.is_some() {
            field.transform = transform;
        }
        field.newest = Some(candidate);
        field.rate.count_candidate(now);
        self.mark_dirty();
    }

    /// Keeps a candidate that came before its request asks for it, until then; none that a state
    /// withholds.
    pub(crate) fn keep_until(&mut self, candidate: DataValue, is_withheld: bool, from: DateTime) {
        let field = &mut self.entry.field;
        field.kept = (!is_withheld).then(|| candidate.clone());
        field.newest = Some(candidate);
        self.index.deadlines.note_beginning(field.id(), from);
    }

    /// Notes the newest candidate, which the gate has had.
    pub(crate) fn know(&mut self, newest: DataValue) {
        self.entry.field.newest = Some(newest);
    }

    /// Takes the candidate away that was kept until the request begins.
    pub(crate) fn take_kept(&mut self) -> Option<DataValue> {
        self.entry.field.kept.take()
    }

    /// Begins another source of values: its functions start in this state, and nothing of the former
    /// source leaves, neither what waited nor what was disclosed.
    pub(crate) fn begin_source(&mut self, transform: Option<TransformState>, now: DateTime) {
        self.forget_candidates();
        self.close_gate(now);
        self.set_transform(transform);
    }

    /// Sets the state of the mapping's functions.
    pub(crate) fn set_transform(&mut self, transform: Option<TransformState>) {
        self.entry.field.transform = transform;
        self.mark_dirty();
    }

    /// Notes whether the mapping of the decision is the newest recorded version.
    pub(crate) const fn set_recorded(&mut self, is_recorded: bool) {
        self.entry.field.versions.is_recorded = is_recorded;
    }

    /// Counts the mapping of the decision as the next version, and returns both; `None` where it is
    /// the newest version already.
    pub(crate) fn next_version(&mut self) -> Option<(u32, Arc<Mapping>)> {
        let Field { versions, decision, .. } = &mut self.entry.field;
        let mapping = decision.mapping.as_ref().filter(|_| !versions.is_recorded)?;
        versions.newest += 1;
        versions.is_recorded = true;
        Some((versions.newest, Arc::clone(mapping)))
    }

    /// Sets the mapping that runs beside the published one.
    pub(crate) fn set_shadow(&mut self, shadow: Option<Box<ShadowMapping>>) {
        self.entry.field.versions.shadow = shadow;
    }

    fn forget_candidates(&mut self) {
        let field = &mut self.entry.field;
        (field.newest, field.kept) = (None, None);
    }

    fn close_gate(&mut self, now: DateTime) {
        self.entry.field.gate.close(now);
        self.index.mark_dirty(self.entry);
        self.index.note_deadlines(self.entry);
    }
}

impl Deref for FieldMut<'_> {
    type Target = Field;

    fn deref(&self) -> &Field {
        &self.entry.field
    }
}
