//! Answers of the platform as the witness of the ledger, and decisions about conflicts with it, as
//! far as stored entries have to be read for them.

use asi_model::{DateTime, OrganisationId, messages::LedgerCosignature};
use connector_state::{
    ConnectorState,
    use_cases::witness::{self, NewLogDecision},
};
use ledger::Log;
use transparency_log::{LeafRange, leaf_hash};

use super::{outputs::Outputs, unit_of_work::UnitOfWork};
use crate::store::StoreError;

/// Holds all reports back while the platform holds another history of the ledger. The connector
/// stays ready all the same: the engineer who decides needs its pages.
pub(super) fn hold(outputs: &Outputs, state: &ConnectorState) {
    let is_in_conflict = state.ledger().is_in_conflict();
    outputs.in_flight.set_held(is_in_conflict);
    metrics::gauge!("verbund_ledger_conflict").set(f64::from(u8::from(is_in_conflict)));
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
    let entries = work.pending.writes.ledger.entries.iter();
    let later =
        entries.filter(move |(entry, _)| entry.recipient == *recipient && entry.number > after);
    later.map(|(entry, _)| entry.content.as_str())
}
