//! Delivery of reports after they were queued: sent, receipted, missing, dropped, taken back.

use std::collections::BTreeMap;

use asi_model::{
    DateTime, MessageId,
    messages::{FactoryMessage, Gap, GapCause, ReceiptRequest, WriterReceipt, WriterSequences},
};
use ledger::Event;
use spool::{ReceiptEffect, RowId, RowOutcome, SendOutcome, SequenceGap, gaps_of, join};

use crate::{
    ChangeSet, ConnectorState, LogRecord,
    writes::{AnnouncedGapRow, DeadLetterRow, ReportMove, WaitingRow},
};

/// Reports that left, each with the id of the message that carried it.
pub type SentReports = Vec<(WaitingRow, Option<MessageId>)>;

/// Records outcomes of sending. A number is that of a control message or that of a message of
/// reports; rows of the other kind are not found and stay as they are.
pub fn record_outcomes(
    state: &mut ConnectorState,
    outcomes: &[RowOutcome],
    sent: SentReports,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    let (mut attempted, mut parked) = (Vec::new(), Vec::new());
    for outcome in outcomes {
        let id = outcome.id.0;
        match &outcome.outcome {
            SendOutcome::Accepted | SendOutcome::Expired => {
                changes.writes.controls.done.push(id);
            }
            SendOutcome::Rejected(_) => attempted.push(id),
            SendOutcome::Parked(rejection) => {
                parked.push(id);
                changes.writes.messages.dead_letters.push(DeadLetterRow {
                    is_received: false,
                    message_id: None,
                    subject: format!("spool message {id}"),
                    code: rejection.code.clone(),
                    reason: rejection.reason.clone(),
                    body: Vec::new(),
                    occurred_at: now,
                });
            }
        }
    }
    if !sent.is_empty() {
        record_sent(state, &mut changes, sent, now);
    }
    if !attempted.is_empty() {
        changes.writes.controls.attempted.extend(&attempted);
        changes.writes.reports.moves.push(ReportMove::Attempted(attempted));
    }
    if !parked.is_empty() {
        changes.writes.controls.parked.extend(&parked);
        changes.writes.reports.moves.push(ReportMove::Parked(parked));
    }
    changes
}

fn record_sent(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    reports: SentReports,
    at: DateTime,
) {
    let mut messages: BTreeMap<i64, (Option<MessageId>, Vec<WaitingRow>)> = BTreeMap::new();
    for (report, message_id) in &reports {
        let (_, rows) =
            messages.entry(report.message).or_insert_with(|| (message_id.clone(), Vec::new()));
        rows.push(report.clone());
    }
    for (message_id, rows) in messages.into_values() {
        let event = |range| Event::Sent { range, message_id: message_id.clone() };
        state.ledger.append_outcome(&mut changes.writes.ledger, &rows, at, event);
    }
    let reports =
        reports.into_iter().map(|(report, message_id)| (report.row.id.0, message_id)).collect();
    changes.writes.reports.moves.push(ReportMove::Sent { reports, at });
}

/// Reports and gaps of one writer and epoch that a receipt is about.
#[derive(Debug, Clone, Copy)]
pub struct ReceiptedRows<'r> {
    /// All reports that the spool has of them.
    pub reports: &'r [WaitingRow],
    /// The gaps that no receipt covered so far.
    pub gaps: &'r [AnnouncedGapRow],
}

/// Records what a receipt says about one writer.
pub fn record_receipt(
    state: &mut ConnectorState,
    receipt: &WriterReceipt,
    effect: &ReceiptEffect,
    ReceiptedRows { reports: rows, gaps }: ReceiptedRows<'_>,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    if !gaps.is_empty() {
        changes.writes.reports.gaps.receipts.push(receipt.clone());
    }
    let with_ids = |ids: &[RowId]| -> Vec<WaitingRow> {
        rows.iter().filter(|waiting| ids.contains(&waiting.row.id)).cloned().collect()
    };
    changes.effects.link.is_receipted = true;
    let receipted = with_ids(&effect.receipted);
    if !receipted.is_empty() {
        let ledger = &mut changes.writes.ledger;
        state.ledger.append_outcome(ledger, &receipted, now, Event::Receipted);
        let reports = ids_of(&receipted);
        changes.writes.reports.moves.push(ReportMove::Receipted { reports, at: now });
    }
    let (revoked, resend): (Vec<_>, Vec<_>) =
        with_ids(&effect.resend).into_iter().partition(|waiting| waiting.is_revoked);
    if !resend.is_empty() {
        changes.effects.resent_report_count += resend.len() as u64;
        changes.merge(resend_reports(ids_of(&resend)));
    }
    end_revoked(state, &mut changes, &revoked, gaps, now);
    if !effect.reopen.is_empty() {
        changes.effects.resent_report_count += effect.reopen.len() as u64;
        changes.effects.link.is_spool_rewound = true;
        changes.writes.reports.moves.push(ReportMove::Reopened(numbers(&effect.reopen)));
    }
    for (cause, lost) in by_cause(&effect.lost, gaps) {
        announce(state, &mut changes, &lost, cause, now);
    }
    changes
}

/// Ends reports that were sent, that the platform lacks, and that are not sent again. One that was given up while it was
/// leaving has a cause already, which the ledger states and which was announced: it is announced once more.
fn end_revoked(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    revoked: &[WaitingRow],
    announced: &[AnnouncedGapRow],
    now: DateTime,
) {
    use GapCause::{Coalesced, Expired, Revoked, Withdrawn};

    let cause_of = |waiting: &WaitingRow| {
        let known = announced.iter().find(|known| known.gap.has(&waiting.row));
        known.map(|known| known.cause)
    };
    for cause in [None, Some(Expired), Some(Coalesced), Some(Withdrawn), Some(Revoked)] {
        let rows: Vec<_> =
            revoked.iter().filter(|waiting| cause_of(waiting) == cause).cloned().collect();
        match cause {
            Some(cause) if !rows.is_empty() => finish(state, changes, &rows, cause, now),
            Some(_) => {}
            None => end_reports(state, changes, &rows, Revoked, now),
        }
    }
}

/// Returns lost sequence numbers with the cause that was announced of them. What the spool removed long
/// ago was stored somewhere once: it has expired.
fn by_cause(
    lost: &[SequenceGap],
    announced: &[AnnouncedGapRow],
) -> Vec<(GapCause, Vec<SequenceGap>)> {
    let cause_of = |number: u32| {
        let known = announced
            .iter()
            .find(|row| (row.gap.first_sequence..=row.gap.last_sequence).contains(&number));
        known.map_or(GapCause::Expired, |row| row.cause)
    };
    let numbers = |gap: &SequenceGap| {
        let (writer, epoch) = (gap.data_set_writer_id, gap.epoch);
        (gap.first_sequence..=gap.last_sequence).map(move |number| (writer, epoch, number))
    };
    let of_cause = |cause| {
        let all = lost.iter().flat_map(numbers);
        (cause, join(all.filter(|(.., number)| cause_of(*number) == cause).collect()))
    };
    use GapCause::{Coalesced, Expired, Revoked, Withdrawn};
    [Expired, Coalesced, Withdrawn, Revoked].map(of_cause).into()
}

/// Asks the platform which reports of these writers it holds.
pub fn ask_for_receipts(
    state: &mut ConnectorState,
    writers: Vec<WriterSequences>,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    let message = FactoryMessage::ReceiptRequest(ReceiptRequest {
        message_id: state.ids.next_message_id(),
        factory_id: state.config.factory_id.clone(),
        writer_list: writers,
    });
    state.send(&mut changes, &message, None, now);
    changes
}

/// Lets reports wait again that were sent and not receipted in time.
#[must_use]
pub fn resend_reports(reports: Vec<i64>) -> ChangeSet {
    let mut changes = ChangeSet::default();
    changes.writes.reports.moves.push(ReportMove::Waiting(reports));
    changes.effects.link.is_spool_rewound = true;
    changes
}

/// Drops reports that the spool has no space for, or that are too old.
pub fn drop_reports(
    state: &mut ConnectorState,
    rows: &[WaitingRow],
    cause: GapCause,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    end_reports(state, &mut changes, rows, cause, now);
    if cause == GapCause::Coalesced {
        changes.effects.log.push(LogRecord::ReportsCoalesced { report_count: rows.len() });
    }
    changes
}

/// Takes a writer's reports back: those that wait are never sent, those that were sent are not sent
/// again.
pub(crate) fn purge(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    rows: Vec<WaitingRow>,
    cause: GapCause,
    now: DateTime,
) {
    let (waiting, sent): (Vec<_>, Vec<_>) =
        rows.into_iter().partition(|waiting| waiting.row.sent_at.is_none());
    if !waiting.is_empty() {
        let ledger = &mut changes.writes.ledger;
        state.ledger.append_outcome(ledger, &waiting, now, Event::Purged);
        finish(state, changes, &waiting, cause, now);
        // The link leaves these out of the messages it has fetched; the rest of these messages is
        // fetched again.
        changes.effects.link.is_spool_rewound = true;
    }
    if !sent.is_empty() {
        changes.writes.reports.moves.push(ReportMove::Revoked(ids_of(&sent)));
    }
}

/// Ends reports, and states the cause in the ledger.
fn end_reports(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    rows: &[WaitingRow],
    cause: GapCause,
    now: DateTime,
) {
    if rows.is_empty() {
        return;
    }
    let event = match cause {
        GapCause::Expired => Event::Expired,
        GapCause::Revoked | GapCause::Withdrawn => Event::Purged,
        _ => Event::Coalesced,
    };
    state.ledger.append_outcome(&mut changes.writes.ledger, rows, now, event);
    finish(state, changes, rows, cause, now);
}

fn finish(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    rows: &[WaitingRow],
    cause: GapCause,
    now: DateTime,
) {
    changes.writes.reports.moves.push(ReportMove::Done(ids_of(rows)));
    let rows: Vec<_> = rows.iter().map(|waiting| waiting.row).collect();
    announce(state, changes, &gaps_of(&rows), cause, now);
}

/// Tells the platform which sequence numbers never come.
fn announce(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    gaps: &[SequenceGap],
    cause: GapCause,
    now: DateTime,
) {
    for gap in gaps {
        let message = FactoryMessage::Gap(Gap {
            message_id: state.ids.next_message_id(),
            factory_id: state.config.factory_id.clone(),
            data_set_writer_id: gap.data_set_writer_id,
            epoch: gap.epoch,
            first_sequence: gap.first_sequence,
            last_sequence: gap.last_sequence,
            cause,
        });
        state.send(changes, &message, None, now);
        let announced = AnnouncedGapRow { gap: *gap, cause, announced_at: now };
        changes.writes.reports.gaps.announced.push(announced);
    }
}

fn numbers(ids: &[RowId]) -> Vec<i64> {
    ids.iter().map(|id| id.0).collect()
}

fn ids_of(rows: &[WaitingRow]) -> Vec<i64> {
    rows.iter().map(|waiting| waiting.row.id.0).collect()
}
