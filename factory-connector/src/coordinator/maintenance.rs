//! Periodic maintenance: keep-alives, checkpoints, limits of the spool, retention.

use std::{collections::HashSet, time::Duration};

use asi_model::{DateTime, messages::GapCause};
use connector_state::{
    queries::time_step_of,
    use_cases::{
        deliver::{drop_reports, resend_reports},
        keep_alive::keep_alives,
        retain::{OldReport, RetentionLimit, empty_values, remove_entries},
        seal, witness,
    },
    writes::WaitingRow,
};
use messaging::spool::{ReportRow, RowId, coalesce, expire, overdue};
use tokio::time::Instant;

use super::{receipt_requests::ReceiptRequests, unit_of_work::UnitOfWork};
use crate::{clock::now, config::RetentionLimits, store::StoreError};

/// Pause between rounds, and so the inaccuracy of keep-alives and checkpoints.
const INTERVAL: Duration = Duration::from_secs(1);
/// Pause after everything too old was removed.
const RETENTION_INTERVAL: Duration = Duration::from_secs(3600);
/// Pause between examinations of the spool. Longer, since each one reads rows, and limits in hours
/// or megabytes are not exceeded by much in between.
const SPOOL_INTERVAL: Duration = Duration::from_secs(10);
/// Rows of the spool that one round examines: the coordinator serves nothing else meanwhile.
const ROWS_MAX: u32 = 10_000;
/// Time between two checkpoints of a log that grows.
const LOG_CHECKPOINT_INTERVAL: Duration = Duration::from_secs(60);
const DAY_MICROS: i64 = 86_400_000_000;

/// Times of the next rounds.
pub(super) struct MaintenanceSchedule {
    next: Instant,
    next_spool: Instant,
    next_retention: Instant,
    next_log_checkpoint: Instant,
    /// Number of the last report whose values were examined by retention.
    emptied_through: i64,
    receipt_requests: ReceiptRequests,
}

impl Default for MaintenanceSchedule {
    fn default() -> Self {
        let now = Instant::now();
        Self {
            next: now + INTERVAL,
            next_spool: now + SPOOL_INTERVAL,
            next_retention: now + INTERVAL,
            next_log_checkpoint: now + LOG_CHECKPOINT_INTERVAL,
            emptied_through: 0,
            receipt_requests: ReceiptRequests::default(),
        }
    }
}

impl MaintenanceSchedule {
    pub(super) const fn next(&self) -> Instant {
        self.next
    }

    /// Begins retention from the first report again: what was last emptied was not committed.
    pub(super) const fn begin_retention_again(&mut self) {
        self.emptied_through = 0;
    }
}

/// Runs the rounds that are due.
pub(super) async fn run_maintenance(
    work: &mut UnitOfWork,
    schedule: &mut MaintenanceSchedule,
) -> Result<(), StoreError> {
    let instant = Instant::now();
    if instant < schedule.next {
        return Ok(());
    }
    schedule.next = instant + INTERVAL;
    let now = now();
    send_keep_alives(work, now);
    let checkpoint = seal::checkpoint(&mut work.state, &work.key, now);
    work.pending.merge(checkpoint);
    if instant >= schedule.next_log_checkpoint {
        schedule.next_log_checkpoint = instant + LOG_CHECKPOINT_INTERVAL;
        let checkpoints = seal::checkpoint_logs(&mut work.state, &work.key);
        work.pending.merge(checkpoints);
        let submitted = witness::submit_due(&mut work.state, &work.key, now);
        work.pending.merge(submitted);
    }
    if instant >= schedule.next_spool {
        schedule.next_spool = instant + SPOOL_INTERVAL;
        let waiting = work.store.read().reports().oldest(ROWS_MAX).await?;
        limit_spool(work, &waiting, now).await?;
        if is_link_up(work) {
            schedule.receipt_requests.ask(work, &waiting, now).await?;
        }
    }
    if instant >= schedule.next_retention {
        schedule.next_retention = instant + RETENTION_INTERVAL;
        // Not passed on: reports leave as before while old values stay for another hour.
        if let Err(error) = retain(work, schedule, now).await {
            tracing::error!(
                error = &error as &dyn std::error::Error,
                "Old values and entries could not be removed; it is tried again in an hour."
            );
        }
    }
    Ok(())
}

fn send_keep_alives(work: &mut UnitOfWork, now: DateTime) {
    // While the link is down they would only pile up.
    let Some(link) = work.outputs.link.as_ref().filter(|link| link.state().borrow().is_up()) else {
        return;
    };
    let messages = keep_alives(&mut work.state, now);
    if messages.is_empty() {
        return;
    }
    for message in messages {
        work.outputs.keep_alives.put(message);
    }
    link.wake();
}

/// Empties old values and removes old entries, a bounded number at a time.
async fn retain(
    work: &mut UnitOfWork,
    schedule: &mut MaintenanceSchedule,
    now: DateTime,
) -> Result<(), StoreError> {
    let RetentionLimits { value_days, entry_days } = work.config.retention;
    let limit = |days: u32| {
        let micros = now.unix_micros() - i64::from(days) * DAY_MICROS;
        (days > 0).then_some(RetentionLimit { days, before: DateTime::from_unix_micros(micros) })
    };
    let mut is_done = true;
    if let Some(limit) = limit(value_days) {
        let old = work.store.read().reports().old(limit.before, schedule.emptied_through).await?;
        let moves = &work.pending.writes().reports.moves;
        // What this transaction sends again keeps its values until it has left.
        let is_moved =
            |old: &OldReport| moves.iter().any(|change| change.concerns(old.id, old.message));
        is_done &= old.is_empty();
        if let Some(last) = old.last().map(|old| old.id).filter(|_| !old.iter().any(is_moved)) {
            schedule.emptied_through = last;
            let changes = empty_values(&mut work.state, &old, limit, now);
            work.pending.merge(changes);
        }
    }
    if let Some(limit) = limit(entry_days) {
        let old = work.store.read().ledger().old_entries(limit.before).await?;
        is_done &= old.is_empty();
        let changes = remove_entries(&mut work.state, old, limit, &work.key, now);
        work.pending.merge(changes);
    }
    let pause = if is_done { RETENTION_INTERVAL } else { INTERVAL };
    schedule.next_retention = Instant::now() + pause;
    Ok(())
}

/// Drops reports that are too old or too many, and sends those again that were not receipted.
async fn limit_spool(
    work: &mut UnitOfWork,
    waiting: &[WaitingRow],
    now: DateTime,
) -> Result<(), StoreError> {
    if waiting.is_empty() {
        return Ok(());
    }
    let rows: Vec<ReportRow> = waiting.iter().map(|waiting| waiting.row).collect();
    let age_max = Duration::from_secs(u64::from(work.config.spool.age_hours_max) * 3600);
    // A report says the beginning of its time step, and is not older for that.
    let mut aged = rows.clone();
    for row in &mut aged {
        row.created_at += time_step_of(&work.state, row.data_set_writer_id);
    }
    let expired = expire(&aged, age_max, now.into());
    drop_chosen(work, &chosen(waiting, &expired.rows), GapCause::Expired, now);
    let bytes = work.store.read().reports().spooled_bytes().await?;
    let excess = bytes.checked_sub(work.config.spool.bytes_max);
    if let Some(excess) = excess.filter(|excess| *excess > 0) {
        let newest: HashSet<RowId> = work.store.read().reports().newest_of_writers().await?;
        let removal = coalesce(&rows, &newest, excess);
        drop_chosen(work, &chosen(waiting, &removal.rows), GapCause::Coalesced, now);
    }
    resend_overdue(work, waiting, &rows, now);
    Ok(())
}

fn drop_chosen(work: &mut UnitOfWork, rows: &[WaitingRow], cause: GapCause, now: DateTime) {
    let changes = drop_reports(&mut work.state, rows, cause, now);
    work.pending.merge(changes);
}

fn resend_overdue(
    work: &mut UnitOfWork,
    waiting: &[WaitingRow],
    rows: &[ReportRow],
    now: DateTime,
) {
    let Some(link) = &work.outputs.link else { return };
    let link_state = link.state().borrow().clone();
    if !link_state.is_up() {
        return;
    }
    let hears_receipts = link_state.last_receipted_at.is_some_and(|at| at > link_state.since);
    let policy = work.config.spool.overdue();
    let late = overdue(rows, &policy, now.into(), hears_receipts);
    let late = chosen(waiting, &late).into_iter().filter(|waiting| !waiting.is_revoked);
    let late: Vec<i64> = late.map(|waiting| waiting.row.id.0).collect();
    if !late.is_empty() {
        work.pending.merge(resend_reports(late));
    }
}

fn is_link_up(work: &UnitOfWork) -> bool {
    work.outputs.link.as_ref().is_some_and(|link| link.state().borrow().is_up())
}

fn chosen(waiting: &[WaitingRow], ids: &[RowId]) -> Vec<WaitingRow> {
    let ids: HashSet<RowId> = ids.iter().copied().collect();
    waiting.iter().filter(|waiting| ids.contains(&waiting.row.id)).cloned().collect()
}
