//! Transactions: the change sets of several use cases become one commit.
//!
//! The order of the steps is fixed by their types: [`refresh()`] brings the data sets up to date once,
//! [`Refreshed::take_back`] ends reports of consents that ended, [`TakenBack::report`] makes one
//! report per data set with released values, and [`Reported::sign`] signs the chains that grew.
//! Each step costs what changed, not what exists.

mod refresh;
mod report;
mod take_back;

use std::collections::BTreeMap;

use asi_model::DateTime;
use ledger::{LedgerKey, SALT_BYTES, SignedHead};
pub(crate) use refresh::begin_epoch;
pub use take_back::{SequenceProgress, WriterDelivery};

use crate::{
    ChangeSet, ConnectorState, Effects, Writes,
    writes::{RevocationRow, WaitingRow},
};

/// Brings the data sets up to date about whose fields something was decided.
pub fn refresh(state: &mut ConnectorState, mut changes: ChangeSet) -> Refreshed {
    refresh::refresh_writers(state, &mut changes);
    Refreshed(changes)
}

/// A transaction whose data sets are up to date.
pub struct Refreshed(ChangeSet);

/// Delivery of reports, as the spool knows it with the moves of this transaction.
#[derive(Debug, Default)]
pub struct DeliveryState {
    /// Writers of which consents ended.
    pub ended: BTreeMap<u16, WriterDelivery>,
    /// Reports in the spool of the writers whose waiting reports are taken back.
    pub purged: BTreeMap<u16, Vec<WaitingRow>>,
}

impl Refreshed {
    /// Returns the writers of which consents ended, with the epoch in which they did.
    pub fn ended_writers(&self) -> impl Iterator<Item = (u16, u32)> {
        let writers = self.0.ended.iter().flat_map(|ended| &ended.writers);
        writers.map(|(id, writer)| (*id, writer.epoch))
    }

    /// Returns the writers whose waiting reports are taken back.
    pub fn purged_writers(&self) -> impl Iterator<Item = u16> {
        self.0.purges.keys().copied()
    }

    /// Returns the rows to store so far.
    #[must_use]
    pub const fn writes(&self) -> &Writes {
        &self.0.writes
    }

    /// Takes waiting reports back, and makes the receipts of the consents that ended.
    pub fn take_back(
        self,
        state: &mut ConnectorState,
        mut delivery: DeliveryState,
        key: &LedgerKey,
        now: DateTime,
    ) -> TakenBack {
        let Self(mut changes) = self;
        take_back::purge_all(state, &mut changes, &mut delivery.purged, now);
        for ended in std::mem::take(&mut changes.ended) {
            let receipt = take_back::receipt(state, &mut changes, ended, &delivery.ended, now);
            take_back::notify_partners(state, &mut changes, &receipt, key, now);
            let content = receipt.canonical();
            changes.writes.ledger.revocations.push(RevocationRow {
                revocation_id: receipt.revocation_id,
                revoked_at: now,
                signature: key.sign(&content),
                public_key: key.public(),
                content,
            });
        }
        TakenBack(changes)
    }
}

/// A transaction after reports were taken back.
pub struct TakenBack(ChangeSet);

impl TakenBack {
    /// Makes one key frame per data set with released values. `salt` yields random bytes for each
    /// report.
    pub fn report(
        self,
        state: &mut ConnectorState,
        now: DateTime,
        salt: impl FnMut() -> [u8; SALT_BYTES],
    ) -> Reported {
        let Self(mut changes) = self;
        report::report(state, &mut changes, now, salt);
        Reported(changes)
    }
}

/// A transaction with its reports.
pub struct Reported(ChangeSet);

impl Reported {
    /// Signs the heads of the chains that grew, and returns what is to be committed. The first
    /// checkpoint of a log is signed with its first entry.
    #[must_use]
    pub fn sign(self, state: &mut ConnectorState, key: &LedgerKey) -> (Writes, Effects) {
        let ChangeSet { mut writes, effects, .. } = self.0;
        let entries = writes.ledger.entries.iter().map(|(entry, _)| entry);
        let heads = SignedHead::of(&state.config.factory_id, entries, key);
        for head in &heads {
            writes.ledger.logs.extend(state.ledger.signed_log(&head.recipient, key));
        }
        writes.ledger.heads.extend(heads);
        (writes, effects)
    }
}
