//! Index of all fields as a whole: the few of many that are looked for are found without a scan.

use super::{
    Field, deadlines::Deadlines, entry::FieldEntry, policy_index::PolicyIndex,
    variable_index::VariableIndex,
};

/// Deadlines, named policies and variables of all fields, and those that the next transaction writes.
#[derive(Debug, Default)]
pub(super) struct Index {
    pub(super) deadlines: Deadlines,
    pub(super) policies: PolicyIndex,
    pub(super) variables: VariableIndex,
    /// Numbers of fields whose gate or transform state the next transaction writes.
    pub(super) dirty: Vec<i64>,
}

impl Index {
    /// Marks that the next transaction writes the field's gate and transform.
    pub(super) fn mark_dirty(&mut self, entry: &mut FieldEntry) {
        if !std::mem::replace(&mut entry.is_dirty, true) {
            self.dirty.push(entry.field.id());
        }
    }

    pub(super) fn add(&mut self, entry: &mut FieldEntry) {
        self.note_decision(&entry.field);
        self.note_deadlines(entry);
    }

    /// Forgets a field that is removed.
    pub(super) fn forget(&mut self, entry: &mut FieldEntry) {
        self.forget_decision(&entry.field);
        self.deadlines.forget(entry.field.id(), &mut entry.deadlines);
    }

    /// Notes what is found by the field's decision.
    pub(super) fn note_decision(&mut self, field: &Field) {
        self.policies.note(field);
        self.variables.note(field);
    }

    /// Forgets what is found by the field's decision, before it changes.
    pub(super) fn forget_decision(&mut self, field: &Field) {
        self.policies.forget(field);
        self.variables.forget(field);
    }

    /// Brings the deadlines up to date after the gate, the decision or the validity changed.
    pub(super) fn note_deadlines(&mut self, entry: &mut FieldEntry) {
        self.note_release(entry);
        let field = &entry.field;
        let end = field.validity.until.filter(|_| field.decision.is_mapped());
        self.deadlines.note_end(field.id(), end, &mut entry.deadlines);
    }

    /// Brings the deadline of the gate up to date.
    pub(super) fn note_release(&mut self, entry: &mut FieldEntry) {
        let due = entry.field.gate.due();
        self.deadlines.note_release(entry.field.id(), due, &mut entry.deadlines);
    }
}
