//! What has to be done from time to time: bounds of the spool, keep-alives, the daily checkpoint.

use std::{collections::HashSet, time::Duration};

use asi_model::{
    DateTime,
    messages::GapCause,
    pubsub::{DataSetMessage, DataSetMessageKind, NetworkMessage, json::encode},
};
use messaging::spool::{ReportRow, RowId, coalesce, expire, overdue};
use tokio::time::Instant;

use super::{Desk, RetentionLimits, aftermath::offset_now, now};
use crate::{
    books::new_message_id,
    store::{CheckpointRow, ReportMove, StoreError, WaitingRow},
};
use ledger::Checkpoint;

const INTERVAL: Duration = Duration::from_secs(1);
/// Pause after everything too old was removed.
const RETENTION_INTERVAL: Duration = Duration::from_secs(3600);
const SPOOL_INTERVAL: Duration = Duration::from_secs(10);
/// Rows looked at in one round.
const ROWS_MAX: u32 = 10_000;
/// A checkpoint states the heads of all chains once a day.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(86_400);

/// When what is due.
pub(super) struct Housekeeping {
    next: Instant,
    next_spool: Instant,
    next_retention: Instant,
    /// The last report whose values were looked at.
    emptied_through: i64,
}

impl Default for Housekeeping {
    fn default() -> Self {
        let now = Instant::now();
        Self {
            next: now + INTERVAL,
            next_spool: now + SPOOL_INTERVAL,
            next_retention: now + INTERVAL,
            emptied_through: 0,
        }
    }
}

impl Housekeeping {
    pub(super) const fn next(&self) -> Instant {
        self.next
    }
}

impl Desk {
    pub(super) async fn keep_house(&mut self) -> Result<(), StoreError> {
        let instant = Instant::now();
        if instant < self.housekeeping.next {
            return Ok(());
        }
        self.housekeeping.next = instant + INTERVAL;
        let now = now();
        self.keep_alive(now);
        self.checkpoint(now);
        if instant >= self.housekeeping.next_spool {
            self.housekeeping.next_spool = instant + SPOOL_INTERVAL;
            self.tidy_spool(now).await?;
        }
        if instant >= self.housekeeping.next_retention {
            self.housekeeping.next_retention = instant + RETENTION_INTERVAL;
            if let Err(error) = self.retain(now).await {
                tracing::error!(
                    error = &error as &dyn std::error::Error,
                    "What is too old could not be removed; it is tried again in an hour."
                );
            }
        }
        Ok(())
    }

    /// A writer that had no news for the period its partner asked for says that it is alive.
    fn keep_alive(&mut self, now: DateTime) {
        let Some(link) = &self.rooms.link else { return };
        if !link.state().borrow().is_up() {
            return;
        }
        let mut silent = Vec::new();
        for (id, writer) in &self.books.writers {
            let period = self
                .books
                .request(&writer.request)
                .and_then(|(_, request)| request.update_interval());
            if let Some(period) = period
                && !writer.fields.is_empty()
                && now.since(writer.last_sign_at) >= period.max(INTERVAL)
            {
                silent.push(*id);
            }
        }
        for id in silent {
            let row = self.books.next_row();
            let Some(writer) = self.books.writers.get_mut(&id) else { continue };
            writer.last_sign_at = now;
            let message_id = new_message_id();
            let message = NetworkMessage {
                message_id: Some(message_id.clone()),
                publisher_id: Some(self.config.books.factory_id.as_str().into()),
                messages: vec![DataSetMessage {
                    data_set_writer_id: Some(id),
                    sequence_number: Some(writer.next_sequence),
                    meta_data_version: Some(writer.version()),
                    timestamp: Some(now),
                    kind: DataSetMessageKind::KeepAlive,
                    ..DataSetMessage::default()
                }],
                ..NetworkMessage::default()
            };
            self.rooms.ephemerals.put(
                row,
                message_id,
                encode(&message, self.config.books.encoding),
            );
            link_wake(&self.rooms.link);
        }
    }

    fn checkpoint(&mut self, now: DateTime) {
        let (number, is_due) = match self.books.checkpoint {
            None => (1, self.books.heads.iter().next().is_some()),
            Some((number, at)) => (number + 1, now.since(at) >= CHECKPOINT_INTERVAL),
        };
        if !is_due {
            return;
        }
        let checkpoint =
            Checkpoint::new(self.config.books.factory_id.clone(), number, now, &self.books.heads);
        let text = checkpoint.canonical();
        let signature = self.key.sign(&text);
        let public_key = self.key.public();
        self.books.changes.checkpoint =
            Some(CheckpointRow { number, recorded_at: now, content: text, signature, public_key });
        self.books.checkpoint = Some((number, now));
    }

    /// Empties old values and removes old entries, a bounded number at a time.
    async fn retain(&mut self, now: DateTime) -> Result<(), StoreError> {
        let before = |days: u32| {
            DateTime::from_unix_micros(now.unix_micros() - i64::from(days) * 86_400_000_000)
        };
        let RetentionLimits { value_days, entry_days } = self.config.retention;
        let mut is_done = true;
        if value_days > 0 {
            let last = self
                .store
                .empty_values(before(value_days), self.housekeeping.emptied_through)
                .await?;
            is_done &= last.is_none();
            if let Some(last) = last {
                self.housekeeping.emptied_through = last;
            }
        }
        if entry_days > 0 {
            let factory = &self.config.books.factory_id;
            is_done &=
                self.store.prune_ledger(before(entry_days), factory, &self.key, now).await? == 0;
        }
        self.housekeeping.next_retention =
            Instant::now() + if is_done { RETENTION_INTERVAL } else { INTERVAL };
        Ok(())
    }

    /// Age, size and missing receipts.
    async fn tidy_spool(&mut self, now: DateTime) -> Result<(), StoreError> {
        let kept = self.store.read().reports().oldest(ROWS_MAX).await?;
        if kept.is_empty() {
            return Ok(());
        }
        let rows: Vec<ReportRow> = kept.iter().map(|kept| kept.row).collect();
        let age_max = Duration::from_secs(u64::from(self.config.spool.age_hours_max) * 3600);
        let expired = expire(&rows, age_max, offset_now());
        self.books.dropped(&chosen(&kept, &expired.rows), GapCause::Expired, now);
        let bytes: u64 = self.store.read().reports().spooled_bytes().await?;
        if let Some(excess) =
            bytes.checked_sub(self.config.spool.bytes_max).filter(|excess| *excess > 0)
        {
            let newest: HashSet<RowId> = self.store.read().reports().newest_of_writers().await?;
            let removal = coalesce(&rows, &newest, excess);
            metrics::counter!("verbund_reports_coalesced_total")
                .increment(removal.rows.len() as u64);
            tracing::warn!(
                reports = removal.rows.len(),
                "The spool is full; older reports were given up for newer ones."
            );
            self.books.dropped(&chosen(&kept, &removal.rows), GapCause::Coalesced, now);
        }
        let hears_receipts = self.rooms.link.as_ref().is_some_and(|link| {
            let state = link.state();
            let state = state.borrow();
            state.is_up() && state.last_receipted_at.is_some_and(|at| at > state.since)
        });
        if self.rooms.link.as_ref().is_some_and(|link| link.state().borrow().is_up()) {
            let late = overdue(&rows, &self.config.spool.overdue(), offset_now(), hears_receipts);
            let late: Vec<i64> =
                chosen(&kept, &late).iter().filter(|k| !k.is_revoked).map(|k| k.row.id.0).collect();
            if !late.is_empty() {
                self.books.changes.report_moves.push(ReportMove::Waiting(late));
                self.books.aftermath.is_spool_rewound = true;
            }
        }
        Ok(())
    }
}

fn link_wake(link: &Option<messaging::LinkHandle>) {
    if let Some(link) = link {
        link.wake();
    }
}

fn chosen(kept: &[WaitingRow], ids: &[RowId]) -> Vec<WaitingRow> {
    let ids: HashSet<RowId> = ids.iter().copied().collect();
    kept.iter().filter(|row| ids.contains(&row.row.id)).cloned().collect()
}
