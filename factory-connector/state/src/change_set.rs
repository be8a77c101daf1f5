//! Changes of the transaction that is being made.

mod ending;

use std::collections::BTreeMap;

use asi_model::{DateTime, messages::GapCause};
pub(crate) use ending::{EndedConsents, EndedWriter, Ending};

use crate::{Effects, Field, FieldEvent, Writes, effects::TwinUpdate};

/// Changes of one use case: rows to store, effects that follow their commit, and work that the
/// transaction does once for all its use cases.
#[derive(Debug, Default)]
pub struct ChangeSet {
    pub(crate) writes: Writes,
    /// Effects to publish after the commit.
    pub(crate) effects: Effects,
    /// Consents that ended, grouped by receipt.
    pub(crate) ended: Vec<EndedConsents>,
    /// Writers whose waiting reports are taken back.
    pub(crate) purges: BTreeMap<u16, Purge>,
    /// Writers whose data set has to be described again, with the time of the decision.
    pub(crate) to_refresh: BTreeMap<u16, DateTime>,
}

/// Reports of a writer that are taken back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Purge {
    /// Cause that the gap states.
    pub(crate) cause: GapCause,
    /// An earlier cause is stated instead.
    yields: bool,
    /// A consent ended, so that reports from then on belong to another epoch.
    pub(crate) is_end: bool,
}

impl ChangeSet {
    /// Returns the rows to store so far. Use cases alone put them.
    #[must_use]
    pub const fn writes(&self) -> &Writes {
        &self.writes
    }

    /// Returns true where something is to be committed without waiting for the publishing interval.
    #[must_use]
    pub fn is_urgent(&self) -> bool {
        !self.purges.is_empty()
            || !self.to_refresh.is_empty()
            || !self.writes.is_empty()
            || !self.effects.is_empty()
    }

    /// Adds the changes of a later use case of the same transaction.
    pub fn merge(&mut self, later: Self) {
        let Self { writes, effects, ended, purges, to_refresh } = later;
        self.writes.merge(writes);
        self.effects.merge(effects);
        for ended in ended {
            ending::append(&mut self.ended, ended);
        }
        for (writer, purge) in purges {
            self.put_purge(writer, purge);
        }
        self.to_refresh.extend(to_refresh);
    }

    /// Takes back what waits of a writer; of several causes the last one is stated.
    pub(crate) fn purge(&mut self, writer: u16, cause: GapCause) {
        self.put_purge(writer, Purge { cause, yields: false, is_end: true });
    }

    /// Takes back what waits of a writer, unless another cause is stated already.
    pub(crate) fn purge_unless_purged(&mut self, writer: u16, cause: GapCause) {
        self.put_purge(writer, Purge { cause, yields: true, is_end: true });
    }

    /// Takes back what waits of a writer since the consent to one of its fields was replaced by one
    /// that may not let all of it out: a stricter policy, or another source.
    pub(crate) fn purge_replaced(&mut self, writer: u16) {
        let cause = GapCause::Revoked;
        self.put_purge(writer, Purge { cause, yields: true, is_end: false });
    }

    fn put_purge(&mut self, writer: u16, purge: Purge) {
        let known = self.purges.entry(writer).or_insert(purge);
        let is_end = known.is_end || purge.is_end;
        if !purge.yields {
            *known = purge;
        }
        known.is_end = is_end;
    }

    /// Puts a field's decision among the rows to store, and its state among the events.
    pub(crate) fn put_field(&mut self, field: &Field) {
        self.writes.fields.decided.insert(field.id(), field.row());
        self.put_event(field);
    }

    /// Puts a field's state among the events for open pages.
    pub(crate) fn put_event(&mut self, field: &Field) {
        self.effects.fields.insert(
            field.id(),
            FieldEvent {
                key: field.key().clone(),
                mapping_state: field.decision().mapping_state,
                consent_version: field.decision().version,
                is_withheld: field.decision().is_mapped() && field.gate().is_withheld(),
                value: field.gate().disclosed().cloned(),
            },
        );
    }

    /// Counts a decision and shows it in the twin.
    pub(crate) fn count_decision(&mut self, field: &Field) {
        self.effects.twin.push(TwinUpdate::Decision(field.key().clone()));
        self.effects.decisions.count += 1;
    }
}
