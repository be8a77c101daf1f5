//! Outcomes of sending: which reports left, in which message.

use std::collections::HashMap;

use asi_model::DateTime;
use connector_state::use_cases::deliver::{SentReports, record_outcomes};
use messaging::{RowOutcome, SendOutcome};

use super::{delivery_progress::after_moves, unit_of_work::UnitOfWork};
use crate::{in_flight::SentMessage, store::StoreError};

/// Records outcomes; `sent` are the messages of reports that the broker accepted.
pub(super) async fn record(
    work: &mut UnitOfWork,
    outcomes: &[RowOutcome],
    sent: Vec<SentMessage>,
    now: DateTime,
) -> Result<(), StoreError> {
    for outcome in outcomes {
        // A keep-alive is sent once, whatever came of it: the next one says the same.
        work.outputs.keep_alives.remove(outcome.id.0);
    }
    let is_accepted = |outcome: &&RowOutcome| matches!(outcome.outcome, SendOutcome::Accepted);
    let accepted: Vec<i64> =
        outcomes.iter().filter(is_accepted).map(|outcome| outcome.id.0).collect();
    let reports =
        if accepted.is_empty() { Vec::new() } else { sent_reports(work, &accepted, sent).await? };
    let changes = record_outcomes(&mut work.state, outcomes, reports, now);
    work.pending.merge(changes);
    Ok(())
}

/// Returns the reports in accepted messages that were not known to have left.
async fn sent_reports(
    work: &mut UnitOfWork,
    accepted: &[i64],
    sent: Vec<SentMessage>,
) -> Result<SentReports, StoreError> {
    let sent: HashMap<i64, SentMessage> =
        sent.into_iter().map(|message| (message.row, message)).collect();
    let rows = work.store.read().reports().unsent_in(accepted).await?;
    let rows = after_moves(rows, &work.pending.writes().reports.moves);
    let left = rows.into_iter().filter(|waiting| waiting.row.sent_at.is_none());
    let left = left.filter_map(|waiting| match sent.get(&waiting.message) {
        // A message may be sent again without the reports that were taken back meanwhile.
        Some(message) if message.reports.contains(&waiting.row.id.0) => {
            Some((waiting, Some(message.message_id.clone())))
        }
        Some(_) => None,
        None => (!waiting.is_done).then_some((waiting, None)),
    });
    Ok(left.collect())
}
