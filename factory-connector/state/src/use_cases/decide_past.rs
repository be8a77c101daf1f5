//! Decision whether a recipient that was added later sees what had left before.
//!
//! It is taken once about each report, by a person. What was shown cannot be made unseen: there is
//! no other decision about the same reports.

use asi_model::{
    DateTime,
    messages::{FactoryMessage, PastRelease, ReportRange},
    validation::LIST_MAX,
};
use ledger::{Event, Hash};

use crate::{
    ChangeSet, ConnectorState, LogRecord,
    effects::ConnectorEvent,
    past::{Past, PastOffer},
    queries::past_offer,
    writes::PastDecisionRow,
};

/// A decision about the past, with the offer that the person saw.
#[derive(Debug, Clone)]
pub struct PastDecisionRequest {
    /// The reports as the store has them.
    pub past: Past,
    /// Shown (true), or not.
    pub is_released: bool,
    /// Root of the offer that the person saw.
    pub root: Hash,
    pub reason: Option<String>,
    /// Name of the user.
    pub decided_by: String,
}

/// Reason for which a decision about the past is not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PastDecisionError {
    /// The recipient has everything, it was decided already, or nothing is open to it.
    #[error("there is nothing of the past to decide about for this recipient")]
    NoPast,
    /// Consents, policies or reports changed since the person looked.
    #[error("what can be shown changed since; look at it before you decide")]
    OfferChanged,
    /// No report satisfies the present policies.
    #[error("no report of the past left under policies that satisfy the present ones")]
    NothingToShow,
}

/// Shows a recipient the past as it was offered, or decides that it stays hidden: in the store, in
/// the ledger of the recipient, and for the platform.
///
/// # Errors
/// [`PastDecisionError`].
pub fn decide_past(
    state: &mut ConnectorState,
    request: PastDecisionRequest,
    now: DateTime,
) -> Result<(PastDecisionRow, ChangeSet), PastDecisionError> {
    let PastDecisionRequest { past, is_released, root, reason, decided_by } = request;
    let reason = reason.filter(|reason| !reason.trim().is_empty());
    let offer = past_offer(state, &past).ok_or(PastDecisionError::NoPast)?;
    if offer.root != root {
        return Err(PastDecisionError::OfferChanged);
    }
    if is_released && offer.ranges.is_empty() {
        return Err(PastDecisionError::NothingToShow);
    }
    let row = PastDecisionRow {
        request: past.request,
        recipient: past.recipient,
        is_released,
        through_report: offer.through_report,
        report_count: if is_released { offer.report_count } else { 0 },
        root: is_released.then(|| hex::encode(offer.root)),
        reason,
        decided_by,
        decided_at: now,
    };
    state.past.note(row.request.clone(), row.recipient.clone(), row.through_report);
    let mut changes = ChangeSet::default();
    if is_released {
        release(state, &mut changes, &row, &offer);
    }
    changes.effects.events.push(ConnectorEvent::Inbox(row.request.operation_network_id.clone()));
    changes.writes.ledger.past_decisions.push(row.clone());
    Ok((row, changes))
}

/// Enters the release in the recipient's chain, and tells the platform.
fn release(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    row: &PastDecisionRow,
    offer: &PastOffer,
) {
    for (range, values) in &offer.ranges {
        let event = Event::PastReleased {
            range: *range,
            values: hex::encode(values),
            decided_by: row.decided_by.clone(),
            reason: row.reason.clone(),
        };
        let recipient = std::slice::from_ref(&row.recipient);
        state.ledger.append(&mut changes.writes.ledger, recipient, row.decided_at, None, &event);
    }
    let ranges: Vec<ReportRange> = offer
        .ranges
        .iter()
        .map(|(range, _)| ReportRange {
            data_set_writer_id: range.data_set_writer_id,
            epoch: range.epoch,
            first_sequence: range.first_sequence,
            last_sequence: range.last_sequence,
        })
        .collect();
    for range_list in ranges.chunks(LIST_MAX) {
        let message = PastRelease {
            message_id: state.ids.next_message_id(),
            factory_id: state.config.factory_id.clone(),
            operation_network_id: row.request.operation_network_id.clone(),
            operation_id: row.request.operation_id.clone(),
            dynamic_data_request_id: row.request.dynamic_data_request_id.clone(),
            recipient_id: row.recipient.clone(),
            decided_at: row.decided_at,
            range_list: range_list.to_vec(),
        };
        state.send(changes, &FactoryMessage::PastRelease(message), None, row.decided_at);
    }
    changes.effects.log.push(LogRecord::PastReleased {
        request: row.request.clone(),
        recipient: row.recipient.clone(),
        report_count: row.report_count,
    });
}
