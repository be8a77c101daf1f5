//! Answers of the platform as the witness of the ledger, and decisions about conflicts with it, as
//! far as stored entries have to be read for them.

use std::time::Duration;

use asi_model::{DateTime, OrganisationId, messages::LedgerCosignature};
use connector_state::{
    ConnectorState,
    use_cases::witness::{self, NewLogDecision},
};
use ledger::Log;
use transparency_log::{LeafRange, leaf_hash};

use super::{outputs::Outputs, unit_of_work::UnitOfWork};
use crate::store::StoreError;

/// Wait after a start until the platform has told of each log that it countersigned before which
/// checkpoint it holds: a store that was set back would disclose in between. It ends once and for all.
pub(super) struct StartWait {
    /// Longest time from the first reports that the link could send.
    limit: Duration,
    is_over: bool,
}

impl StartWait {
    /// Begins to wait; not at all with a limit of 0.
    pub(super) const fn new(limit: Duration) -> Self {
        Self { limit, is_over: limit.is_zero() }
    }

    /// Returns true after the last answer, or after the limit.
    pub(super) const fn is_over(&self) -> bool {
        self.is_over
    }

    fn end_when_due(&mut self, outputs: &Outputs, state: &ConnectorState) {
        if self.is_over {
            return;
        }
        // While there is no connection nothing leaves, and nobody could answer.
        let is_late = outputs.in_flight.waited().is_some_and(|waited| waited >= self.limit);
        let is_answered = !state.ledger().is_answer_awaited();
        self.is_over = is_answered || is_late;
        if self.is_over && !is_answered {
            tracing::warn!(
                "The platform has not answered about the ledger; reports leave without its word."
            );
        }
    }
}

/// Holds all reports back while the platform holds another history of the ledger, and after a start
/// until its word is known. The connector stays ready all the same: the engineer who decides needs
/// its pages.
pub(super) fn hold(outputs: &Outputs, state: &ConnectorState, wait: &mut StartWait) {
    let is_in_conflict = state.ledger().is_in_conflict();
    wait.end_when_due(outputs, state);
    let (was_held, is_held) = (outputs.in_flight.is_held(), is_in_conflict || !wait.is_over());
    outputs.in_flight.set_held(is_held);
    metrics::gauge!("verbund_ledger_conflict").set(f64::from(u8::from(is_in_conflict)));
    if was_held
        && !is_held
        && let Some(link) = &outputs.link
    {
        // It has read past what was held back.
        link.restart_reading();
    }
}

/// Takes an answer to a checkpoint.
pub(super) async fn receive(
    work: &mut UnitOfWork,
    answer: &LedgerCosignature,
    now: DateTime,
) -> Result<(), StoreError> {
    let (held, changes) = witness::receive_answer(&mut work.state, answer, &work.key, now);
    work.pending.merge(changes);
    let Some(held) = held else { return Ok(()) };
    // Seldom: one of the two stores is a restored one. Then every entry is read once.
    let leaves = leaves_around(work, &answer.recipient_id, held.size()).await?;
    let changes = witness::compare(&mut work.state, &answer.recipient_id, held, leaves, now);
    work.pending.merge(changes);
    Ok(())
}

/// Begins a new log in place of one in conflict; false where there is none.
pub(super) async fn begin_log(
    work: &mut UnitOfWork,
    decision: &NewLogDecision,
    now: DateTime,
) -> Result<bool, StoreError> {
    let recipient = &decision.recipient;
    let previous = work.store.read().ledger().anchor(recipient).await?;
    let Some(start) = witness::successor(&work.state, decision, &previous, now) else {
        return Ok(false);
    };
    let mut log = Log::beginning(start);
    let mut take = |content: &str| log.append(content);
    let last = work.store.read().ledger().each_entry(recipient, previous.number, &mut take).await?;
    pending_entries(work, recipient, last).for_each(take);
    let changes = witness::replace_log(&mut work.state, log, &work.key, now);
    work.pending.merge(changes);
    Ok(true)
}

/// Computes the leaves of a log before and after a size from its entries; `None` where those before
/// are removed.
async fn leaves_around(
    work: &mut UnitOfWork,
    recipient: &OrganisationId,
    size: u64,
) -> Result<Option<(LeafRange, LeafRange)>, StoreError> {
    let Some(log) = work.state.ledger().log(recipient) else { return Ok(None) };
    let start = log.start().clone();
    let anchor = work.store.read().ledger().stored_anchor(recipient).await?;
    let Some(mut older) = start.leaves_before(anchor.as_ref()).filter(|log| log.end() <= size)
    else {
        return Ok(None);
    };
    let mut since = LeafRange::starting_at(size);
    // The first leaf is no entry.
    let number = start.number + older.end() - 1;
    let mut take = |content: &str| {
        let range = if older.end() < size { &mut older } else { &mut since };
        range.append(leaf_hash(content.as_bytes()));
    };
    let last = work.store.read().ledger().each_entry(recipient, number, &mut take).await?;
    pending_entries(work, recipient, last).for_each(take);
    Ok(Some((older, since)))
}

/// Returns the entries of the transaction that is being made after a number of a chain.
fn pending_entries<'w>(
    work: &'w UnitOfWork,
    recipient: &OrganisationId,
    after: u64,
) -> impl Iterator<Item = &'w str> {
    let entries = work.pending.writes().ledger.entries.iter();
    let later =
        entries.filter(move |(entry, _)| entry.recipient == *recipient && entry.number > after);
    later.map(|(entry, _)| entry.content.as_str())
}
