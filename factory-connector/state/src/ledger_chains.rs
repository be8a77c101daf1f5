//! Chains of the ledger as far as they are needed to append to them.

use std::collections::BTreeSet;

use asi_model::{DateTime, FactoryId, OrganisationId};
use ledger::{Event, Heads, LedgerKey, Log, Logs, SequenceRange};

use crate::writes::{LedgerWrites, WaitingRow};

/// Owner of the heads of all chains, of their logs and of the last checkpoint.
#[derive(Debug)]
pub struct LedgerChains {
    factory_id: FactoryId,
    heads: Heads,
    logs: Logs,
    /// Recipients of the logs of which the platform holds another history: every commit asks.
    in_conflict: BTreeSet<OrganisationId>,
    /// Number and time of the last checkpoint.
    checkpoint: Option<(u64, DateTime)>,
}

impl LedgerChains {
    pub(crate) fn new(
        factory_id: FactoryId,
        heads: Heads,
        logs: Logs,
        checkpoint: Option<(u64, DateTime)>,
    ) -> Self {
        let in_conflict = logs.iter().filter(|log| log.witnessing().conflict().is_some());
        let in_conflict = in_conflict.map(|log| log.start().recipient.clone()).collect();
        Self { factory_id, heads, logs, in_conflict, checkpoint }
    }

    /// Returns the heads of all chains.
    #[must_use]
    pub const fn heads(&self) -> &Heads {
        &self.heads
    }

    /// Returns the log of a recipient's chain; `None` before its first entry.
    #[must_use]
    pub fn log(&self, recipient: &OrganisationId) -> Option<&Log> {
        self.logs.get(recipient)
    }

    /// Returns the logs of all chains, by their recipients.
    pub fn logs(&self) -> impl Iterator<Item = &Log> {
        self.logs.iter()
    }

    /// Returns whether the platform holds another history of any log: then nothing may leave.
    #[must_use]
    pub fn is_in_conflict(&self) -> bool {
        !self.in_conflict.is_empty()
    }

    /// Returns whether a platform that has countersigned before has yet to answer about any log.
    #[must_use]
    pub fn is_answer_awaited(&self) -> bool {
        self.logs().any(|log| log.witnessing().is_awaited())
    }

    /// Changes the log of a recipient's chain, for instance by the platform's answer, which may find
    /// a conflict. `None` before its first entry.
    pub(crate) fn change_log<T>(
        &mut self,
        recipient: &OrganisationId,
        change: impl FnOnce(&mut Log) -> T,
    ) -> Option<T> {
        let log = self.logs.get_mut(recipient)?;
        let changed = change(log);
        let is_in_conflict = log.witnessing().conflict().is_some();
        self.note_conflict(recipient.clone(), is_in_conflict);
        Some(changed)
    }

    /// Puts a log in the place of the recipient's former one.
    pub(crate) fn put_log(&mut self, log: Log) {
        self.note_conflict(log.start().recipient.clone(), log.witnessing().conflict().is_some());
        self.logs.insert(log);
    }

    fn note_conflict(&mut self, recipient: OrganisationId, is_in_conflict: bool) {
        if is_in_conflict {
            self.in_conflict.insert(recipient);
        } else {
            self.in_conflict.remove(&recipient);
        }
    }

    /// Returns the log of a recipient's chain with a checkpoint: the last one, or else the first.
    pub(crate) fn signed_log(
        &mut self,
        recipient: &OrganisationId,
        key: &LedgerKey,
    ) -> Option<Log> {
        let log = self.logs.get_mut(recipient)?;
        if log.checkpoint().is_none() {
            log.sign_checkpoint(key);
        }
        Some(log.clone())
    }

    /// Returns all logs, to sign their checkpoints; an answer of the platform goes through
    /// [`Self::change_log`].
    pub(crate) fn logs_mut(&mut self) -> impl Iterator<Item = &mut Log> {
        self.logs.iter_mut()
    }

    /// Returns number and time of the last checkpoint.
    #[must_use]
    pub const fn last_checkpoint(&self) -> Option<(u64, DateTime)> {
        self.checkpoint
    }

    pub(crate) const fn set_checkpoint(&mut self, number: u64, at: DateTime) {
        self.checkpoint = Some((number, at));
    }

    /// Appends an event to the chains of all recipients; `report` is the number of the report that
    /// the event is about.
    pub(crate) fn append(
        &mut self,
        writes: &mut LedgerWrites,
        recipients: &[OrganisationId],
        now: DateTime,
        report: Option<i64>,
        event: &Event,
    ) {
        for recipient in recipients {
            let entry = self.heads.append(recipient, now, event.clone());
            self.logs.append(&self.factory_id, &entry);
            writes.entries.push((entry, report));
        }
    }

    /// Appends an event to one chain.
    pub(crate) fn append_one(
        &mut self,
        writes: &mut LedgerWrites,
        recipient: &OrganisationId,
        now: DateTime,
        event: &Event,
    ) {
        self.append(writes, std::slice::from_ref(recipient), now, None, event);
    }

    /// Appends the outcome of reports to the chains of their recipients: one entry for neighbouring
    /// sequence numbers.
    pub(crate) fn append_outcome(
        &mut self,
        writes: &mut LedgerWrites,
        rows: &[WaitingRow],
        now: DateTime,
        outcome: impl Fn(SequenceRange) -> Event,
    ) {
        for (range, recipients) in ranges_of(rows) {
            self.append(writes, recipients, now, None, &outcome(range));
        }
    }
}

/// Groups reports with the same recipients and neighbouring sequence numbers.
fn ranges_of(rows: &[WaitingRow]) -> Vec<(SequenceRange, &[OrganisationId])> {
    let mut sorted: Vec<&WaitingRow> = rows.iter().collect();
    sorted.sort_by_key(|waiting| {
        (waiting.row.data_set_writer_id, waiting.row.epoch, waiting.row.sequence)
    });
    let mut ranges: Vec<(SequenceRange, &[OrganisationId])> = Vec::new();
    for waiting in sorted {
        let row = &waiting.row;
        match ranges.last_mut() {
            Some((range, recipients))
                if range.data_set_writer_id == row.data_set_writer_id
                    && range.epoch == row.epoch
                    && range.last_sequence.checked_add(1) == Some(row.sequence)
                    && *recipients == &waiting.recipients[..] =>
            {
                range.last_sequence = row.sequence;
            }
            _ => ranges.push((
                single(row.data_set_writer_id, row.epoch, row.sequence),
                &waiting.recipients,
            )),
        }
    }
    ranges
}

/// Returns the range of a single sequence number.
pub(crate) const fn single(data_set_writer_id: u16, epoch: u32, sequence: u32) -> SequenceRange {
    SequenceRange { data_set_writer_id, epoch, first_sequence: sequence, last_sequence: sequence }
}
