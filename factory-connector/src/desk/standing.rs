//! How far the reports of a writer came, with what the transaction that is being made says about
//! them already; and what is taken back of them when their writer ends.

use std::collections::{BTreeMap, HashSet};

use asi_model::DateTime;

use super::Desk;
use crate::{
    books::Progress,
    store::{LastSequences, ReportMove, RevocationRow, StoreError, WaitingRow},
};

impl Desk {
    /// Takes back what waits of writers that end, and makes the receipts of what was delivered
    /// before.
    pub(super) async fn take_back_purged(&mut self, now: DateTime) -> Result<(), StoreError> {
        let ended = std::mem::take(&mut self.books.ended);
        let mut standing = BTreeMap::new();
        for (id, writer) in ended.iter().flat_map(|ended| &ended.writers) {
            let rows = self.kept_reports(*id, None).await?;
            let progress = self.progress(*id, writer.epoch).await?;
            standing.insert(*id, (progress, rows));
        }
        for (writer, cause) in std::mem::take(&mut self.books.purges) {
            let rows = self.kept_reports(writer, None).await?;
            // From here on the link lets none of them go, whether it has fetched them already or
            // not.
            let waiting = rows.iter().filter(|kept| kept.row.sent_at.is_none());
            self.rooms.departures.recall(waiting.map(|kept| kept.row.id.0));
            self.books.purge(rows, cause, now);
        }
        for ended in ended {
            let receipt = self.books.receipt_of(ended, &standing, now);
            let content = receipt.canonical();
            self.books.changes.revocations.push(RevocationRow {
                revocation_id: receipt.revocation_id,
                revoked_at: now,
                signature: self.key.sign(&content),
                public_key: self.key.public(),
                content,
            });
        }
        Ok(())
    }

    /// What the spool holds of a writer, with what this transaction has changed about it already.
    pub(super) async fn kept_reports(
        &mut self,
        writer: u16,
        epoch: Option<u32>,
    ) -> Result<Vec<WaitingRow>, StoreError> {
        let rows = self.store.read().reports().of_writer(writer, epoch).await?;
        Ok(moved(rows, &self.books.changes.report_moves))
    }

    /// How far a writer's reports came.
    async fn progress(&mut self, writer: u16, epoch: u32) -> Result<Progress, StoreError> {
        let LastSequences { mut sent, mut receipted } =
            self.store.read().reports().last_sequences(writer, epoch).await?;
        // What this transaction says goes beyond what is stored.
        for kept in self.store.read().reports().of_writer(writer, Some(epoch)).await? {
            for change in &self.books.changes.report_moves {
                match change {
                    ReportMove::Sent { reports, .. }
                        if reports.iter().any(|(id, _)| *id == kept.row.id.0) =>
                    {
                        sent = sent.max(Some(kept.row.sequence));
                    }
                    ReportMove::Receipted { reports, .. } if reports.contains(&kept.row.id.0) => {
                        receipted = receipted.max(Some(kept.row.sequence));
                    }
                    _ => {}
                }
            }
        }
        Ok(Progress { sent, receipted })
    }
}

/// Rows as they stand after these moves; those that the spool is done with are left out.
pub(super) fn moved(mut rows: Vec<WaitingRow>, moves: &[ReportMove]) -> Vec<WaitingRow> {
    for change in moves {
        match change {
            ReportMove::Sent { reports, at } => {
                let sent: HashSet<i64> = reports.iter().map(|(id, _)| *id).collect();
                for kept in rows.iter_mut().filter(|kept| sent.contains(&kept.row.id.0)) {
                    kept.row.sent_at = Some((*at).into());
                    kept.row.sent_count += 1;
                }
            }
            ReportMove::Receipted { reports: ids, .. } | ReportMove::Done(ids) => {
                let done: HashSet<i64> = ids.iter().copied().collect();
                rows.retain(|kept| !done.contains(&kept.row.id.0));
            }
            ReportMove::Waiting(ids) => {
                let again: HashSet<i64> = ids.iter().copied().collect();
                for kept in rows.iter_mut().filter(|kept| again.contains(&kept.row.id.0)) {
                    kept.row.sent_at = None;
                }
            }
            ReportMove::Parked(messages) => rows.retain(|kept| !messages.contains(&kept.message)),
            ReportMove::Revoked(ids) => {
                let revoked: HashSet<i64> = ids.iter().copied().collect();
                for kept in rows.iter_mut().filter(|kept| revoked.contains(&kept.row.id.0)) {
                    kept.is_revoked = true;
                }
            }
            ReportMove::Attempted(_) => {}
        }
    }
    rows
}
