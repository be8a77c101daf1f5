//! Delivery progress of a writer's reports, with the moves of the transaction that is being made.

use std::collections::HashSet;

use connector_state::{
    transaction::{DeliveryState, Refreshed, SequenceProgress, WriterDelivery},
    writes::{ReportMove, WaitingRow},
};

use crate::store::{LastSequences, Store, StoreError};

/// Reads the delivery of the writers of which consents end, or whose reports are taken back.
pub(super) async fn delivery_state(
    store: &mut Store,
    transaction: &Refreshed,
) -> Result<DeliveryState, StoreError> {
    let moves = &transaction.writes().reports.moves;
    let mut delivery = DeliveryState::default();
    for (id, epoch) in transaction.ended_writers() {
        let rows = reports_of(store, moves, id, None).await?;
        let progress = progress(store, moves, id, epoch).await?;
        delivery.ended.insert(id, WriterDelivery { progress, rows });
    }
    for id in transaction.purged_writers() {
        let rows = reports_of(store, moves, id, None).await?;
        delivery.purged.insert(id, rows);
    }
    Ok(delivery)
}

/// Reads a writer's reports in the spool, as they are after these moves.
pub(super) async fn reports_of(
    store: &mut Store,
    moves: &[ReportMove],
    writer: u16,
    epoch: Option<u32>,
) -> Result<Vec<WaitingRow>, StoreError> {
    let rows = store.read().reports().of_writer(writer, epoch).await?;
    Ok(after_moves(rows, moves))
}

/// Reads the last sequence numbers of a writer's epoch.
async fn progress(
    store: &mut Store,
    moves: &[ReportMove],
    writer: u16,
    epoch: u32,
) -> Result<SequenceProgress, StoreError> {
    let LastSequences { mut sent, mut receipted } =
        store.read().reports().last_sequences(writer, epoch).await?;
    // The moves of this transaction go beyond what is stored.
    for waiting in store.read().reports().of_writer(writer, Some(epoch)).await? {
        let (id, sequence) = (waiting.row.id.0, Some(waiting.row.sequence));
        for change in moves {
            match change {
                ReportMove::Sent { reports, .. } if reports.iter().any(|(sent, _)| *sent == id) => {
                    sent = sent.max(sequence);
                }
                ReportMove::Receipted { reports, .. } if reports.contains(&id) => {
                    receipted = receipted.max(sequence);
                }
                _ => {}
            }
        }
    }
    Ok(SequenceProgress { sent, receipted })
}

/// Returns rows as they are after these moves, without those that the spool is done with.
pub(super) fn after_moves(mut rows: Vec<WaitingRow>, moves: &[ReportMove]) -> Vec<WaitingRow> {
    let is_in = |ids: &[i64]| -> HashSet<i64> { ids.iter().copied().collect() };
    for change in moves {
        match change {
            ReportMove::Sent { reports, at } => {
                let sent: HashSet<i64> = reports.iter().map(|(id, _)| *id).collect();
                for waiting in rows.iter_mut().filter(|row| sent.contains(&row.row.id.0)) {
                    waiting.row.sent_at = Some((*at).into());
                    waiting.row.sent_count += 1;
                }
            }
            ReportMove::Receipted { reports: ids, .. } | ReportMove::Done(ids) => {
                let done = is_in(ids);
                rows.retain(|waiting| !done.contains(&waiting.row.id.0));
            }
            ReportMove::Waiting(ids) => {
                let again = is_in(ids);
                for waiting in rows.iter_mut().filter(|row| again.contains(&row.row.id.0)) {
                    waiting.row.sent_at = None;
                }
            }
            ReportMove::Parked(messages) => {
                rows.retain(|waiting| !messages.contains(&waiting.message));
            }
            ReportMove::Revoked(ids) => {
                let revoked = is_in(ids);
                for waiting in rows.iter_mut().filter(|row| revoked.contains(&row.row.id.0)) {
                    waiting.is_revoked = true;
                }
            }
            // Those are no rows of the spool before the commit.
            ReportMove::Reopened(_) | ReportMove::Attempted(_) => {}
        }
    }
    rows
}
