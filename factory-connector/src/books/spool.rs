//! What becomes of reports after they were queued: sent, receipted, missing, taken back.

use std::collections::BTreeMap;

use asi_model::{
    DateTime, MessageId,
    messages::{FactoryMessage, Gap, GapCause},
};
use messaging::spool::{ReceiptEffect, RowId, SequenceGap, gaps_of};

use super::{Books, new_message_id};
use crate::store::{ReportMove, WaitingRow};
use ledger::Event;

impl Books {
    /// The broker accepted these reports, each in the message that left.
    pub fn sent(&mut self, reports: &[(WaitingRow, Option<MessageId>)], at: DateTime) {
        let mut messages: BTreeMap<i64, (Option<MessageId>, Vec<WaitingRow>)> = BTreeMap::new();
        for (kept, message_id) in reports {
            let message =
                messages.entry(kept.message).or_insert_with(|| (message_id.clone(), Vec::new()));
            message.1.push(kept.clone());
        }
        for (message_id, rows) in messages.into_values() {
            self.record_outcome(&rows, at, |range| Event::Sent {
                range,
                message_id: message_id.clone(),
            });
        }
        let reports =
            reports.iter().map(|(kept, message_id)| (kept.row.id.0, message_id.clone())).collect();
        self.changes.report_moves.push(ReportMove::Sent { reports, at });
    }

    /// What a receipt says about one writer; `rows` are all that the spool holds of it in the
    /// receipt's epoch.
    pub fn receipted(&mut self, effect: &ReceiptEffect, rows: &[WaitingRow], now: DateTime) {
        let of = |ids: &[RowId]| -> Vec<WaitingRow> {
            rows.iter().filter(|kept| ids.contains(&kept.row.id)).cloned().collect()
        };
        self.aftermath.is_receipted = true;
        let held = of(&effect.receipted);
        if !held.is_empty() {
            self.record_outcome(&held, now, Event::Receipted);
            self.changes
                .report_moves
                .push(ReportMove::Receipted { reports: ids_of(&held), at: now });
        }
        let (revoked, resend): (Vec<_>, Vec<_>) =
            of(&effect.resend).into_iter().partition(|kept| kept.is_revoked);
        if !resend.is_empty() {
            metrics::counter!("verbund_reports_resent_total").increment(resend.len() as u64);
            self.changes.report_moves.push(ReportMove::Waiting(ids_of(&resend)));
            self.aftermath.is_spool_rewound = true;
        }
        self.take_back(&revoked, GapCause::Revoked, now);
        self.announce(&effect.lost, GapCause::Expired, now);
    }

    /// Takes a writer's reports back: what waits never leaves, what was sent is not sent again.
    pub fn purge(&mut self, rows: Vec<WaitingRow>, cause: GapCause, now: DateTime) {
        let (waiting, sent): (Vec<_>, Vec<_>) =
            rows.into_iter().partition(|kept| kept.row.sent_at.is_none());
        self.take_back(&waiting, cause, now);
        // What the link has fetched of it is left out of what it sends; the rest of those messages
        // is fetched again.
        self.aftermath.is_spool_rewound |= !waiting.is_empty();
        if !sent.is_empty() {
            self.changes.report_moves.push(ReportMove::Revoked(ids_of(&sent)));
        }
    }

    fn take_back(&mut self, rows: &[WaitingRow], cause: GapCause, now: DateTime) {
        if rows.is_empty() {
            return;
        }
        self.record_outcome(rows, now, Event::Purged);
        self.changes.report_moves.push(ReportMove::Done(ids_of(rows)));
        let rows: Vec<_> = rows.iter().map(|kept| kept.row).collect();
        self.announce(&gaps_of(&rows), cause, now);
    }

    /// Removes reports that the spool has no room or time for.
    pub fn dropped(&mut self, rows: &[WaitingRow], cause: GapCause, now: DateTime) {
        if rows.is_empty() {
            return;
        }
        let outcome = if cause == GapCause::Expired { Event::Expired } else { Event::Coalesced };
        self.record_outcome(rows, now, outcome);
        self.changes.report_moves.push(ReportMove::Done(ids_of(rows)));
        let rows: Vec<_> = rows.iter().map(|kept| kept.row).collect();
        self.announce(&gaps_of(&rows), cause, now);
    }

    fn announce(&mut self, gaps: &[SequenceGap], cause: GapCause, now: DateTime) {
        for gap in gaps {
            let message = Gap {
                message_id: new_message_id(),
                factory_id: self.config.factory_id.clone(),
                data_set_writer_id: gap.data_set_writer_id,
                epoch: gap.epoch,
                first_sequence: gap.first_sequence,
                last_sequence: gap.last_sequence,
                cause,
            };
            self.send(&FactoryMessage::Gap(message), None, now);
        }
    }
}

fn ids_of(rows: &[WaitingRow]) -> Vec<i64> {
    rows.iter().map(|kept| kept.row.id.0).collect()
}
