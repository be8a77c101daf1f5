//! Taking commands into the books.

use std::collections::{HashMap, HashSet};

use asi_model::{
    DateTime, MessageId,
    messages::{AcknowledgementResult, PlatformMessage, REQUEST_BYTES_MAX, Receipt},
    validation::{Rejection, parse_platform_message},
};
use messaging::{
    Delivery, RowOutcome, SendOutcome, Settlement,
    spool::{ReportRow, apply_receipt},
};

use super::{
    Desk, Instant, Taken,
    handle::{Command, Reply},
    now,
    standing::moved,
};
use crate::{
    books::new_message_id,
    outbox::Departure,
    store::{DeadLetterRow, ReportMove, StoreError},
};

/// A report that was sent less long ago may still be on its way.
const ON_ITS_WAY: std::time::Duration = std::time::Duration::from_secs(5);
/// Most bytes kept of a message that was rejected.
const DEAD_LETTER_BYTES_MAX: usize = 256 * 1024;
/// Largest request once unpacked, in bytes.
const UNPACKED_BYTES_MAX: usize = 8 * REQUEST_BYTES_MAX;

impl Desk {
    pub(super) async fn take(&mut self, command: Command) -> Result<(), StoreError> {
        let now = now();
        match command {
            Command::Deliver(deliveries, reply) => {
                let settlements = self.deliver(deliveries, now).await?;
                self.replies.push(Reply::Settle(settlements, reply));
            }
            Command::Outcomes(outcomes, departures, reply) => {
                self.outcomes(&outcomes, departures, now).await?;
                self.replies.push(Reply::Done(reply));
            }
            Command::Value(field, source, value, reply) => {
                let refusal = self.books.refusal(&field, source, now);
                let outcome = self.books.candidate(&field, source, value, None, now);
                let taken = match (outcome, refusal) {
                    (Some(outcome), _) => Taken::Through(outcome),
                    (None, refusal) => {
                        Taken::Not(refusal.unwrap_or(asi_model::StatusCode::BAD_NOT_WRITABLE))
                    }
                };
                self.oldest_unwritten.get_or_insert_with(Instant::now);
                self.replies.push(Reply::Value(taken, reply));
            }
            Command::Enter(entries, reply) => {
                let outcomes =
                    entries.into_iter().map(|entry| self.books.enter(entry, now)).collect();
                self.oldest_unwritten.get_or_insert_with(Instant::now);
                self.replies.push(Reply::Entered(outcomes, reply));
            }
            Command::Decide(command, reply) => {
                match self.books.decide(
                    &command.field,
                    command.verdict,
                    command.reason,
                    &command.decided_by,
                    now,
                ) {
                    Ok(()) => self.replies.push(Reply::Decided(reply)),
                    Err(error) => drop(reply.send(Err(error.into()))),
                }
            }
            Command::Revoke(command, reply) => {
                let reason = command.reason.as_deref();
                match self.books.revoke(
                    &command.fields,
                    &command.verdict,
                    reason,
                    &command.revoked_by,
                    now,
                ) {
                    Ok(id) => self.replies.push(Reply::Revoked(id, reply)),
                    Err(error) => drop(reply.send(Err(error.into()))),
                }
            }
            Command::Comment(comment, reply) => {
                self.books.comment_made(comment, now);
                self.replies.push(Reply::Done(reply));
            }
            Command::PutSource(row, reply) => {
                self.books.changes.sources.push(row);
                self.replies.push(Reply::Done(reply));
            }
            Command::RemoveSource(source_id, reply) => {
                self.books.changes.removed_sources.push(source_id);
                self.replies.push(Reply::Done(reply));
            }
            Command::Place(placings, reply) => {
                self.books.place(placings, now);
                self.replies.push(Reply::Done(reply));
            }
            Command::Shadow(command, reply) => {
                match self.books.set_shadow(&command.field, command.mapping, &command.author, now) {
                    Ok(()) => self.replies.push(Reply::Decided(reply)),
                    Err(error) => drop(reply.send(Err(error.into()))),
                }
            }
            Command::PutTemplate(row, reply) => {
                self.books.changes.mappings.templates.push(row);
                self.replies.push(Reply::Done(reply));
            }
            Command::RemoveTemplate(template_id, reply) => {
                self.books.changes.mappings.removed_templates.push(template_id);
                self.replies.push(Reply::Done(reply));
            }
            Command::Read(look) => look(&self.books),
            Command::Change(change) => {
                let tell = change(&mut self.books, now);
                self.replies.push(Reply::Then(tell));
            }
        }
        Ok(())
    }

    /// Everything is accepted once it is stored: what is wrong is answered and kept as a dead
    /// letter.
    async fn deliver(
        &mut self,
        deliveries: Vec<Delivery>,
        now: DateTime,
    ) -> Result<Vec<Settlement>, StoreError> {
        let ids: Vec<String> = deliveries
            .iter()
            .filter_map(|d| d.envelope.message_id.as_ref().map(ToString::to_string))
            .collect();
        let mut seen: HashSet<String> =
            self.store.read().received_messages().known_of(&ids).await?.into_iter().collect();
        seen.extend(self.books.changes.seen.iter().map(|(id, _)| id.to_string()));
        for delivery in &deliveries {
            let transport_id = delivery.envelope.message_id.clone().unwrap_or_else(new_message_id);
            if !seen.insert(transport_id.to_string()) {
                metrics::counter!("verbund_messages_repeated_total").increment(1);
                continue;
            }
            self.books.changes.seen.push((transport_id.clone(), now));
            match delivery.envelope.unpacked(UNPACKED_BYTES_MAX) {
                Ok(body) => {
                    self.message(&body, &delivery.envelope.subject, transport_id, now).await?
                }
                Err(error) => {
                    let fault = asi_model::messages::Fault {
                        pointer: String::new(),
                        code: "UNREADABLE".to_owned(),
                        message: error.to_string(),
                    };
                    let rejection = Rejection {
                        faults: vec![fault],
                        message_id: None,
                        operation_network_id: None,
                        revision: None,
                    };
                    self.reject(
                        rejection,
                        &delivery.envelope.body,
                        &delivery.envelope.subject,
                        transport_id,
                        now,
                    );
                }
            }
        }
        Ok(vec![Settlement::Accept; deliveries.len()])
    }

    async fn message(
        &mut self,
        body: &[u8],
        subject: &str,
        transport_id: MessageId,
        now: DateTime,
    ) -> Result<(), StoreError> {
        let message = match parse_platform_message(body, &self.config.books.factory_id) {
            Ok(message) => message,
            Err(rejection) => {
                self.reject(rejection, body, subject, transport_id, now);
                return Ok(());
            }
        };
        match message {
            PlatformMessage::OperationNetwork(network) => {
                let raw = serde_json::to_string(&network).map_err(|error| {
                    StoreError::Unreadable { what: "network", reason: error.to_string() }
                })?;
                self.books.network_arrived(network, raw, now);
            }
            PlatformMessage::Withdraw(withdraw) => self.books.network_withdrawn(withdraw, now),
            PlatformMessage::Comment(comment) => self.books.comment_arrived(comment, now),
            PlatformMessage::Receipt(receipt) => self.receipt(receipt, now).await?,
            // Is received at an address of its own.
            PlatformMessage::Lease(_) => {}
            PlatformMessage::AssetRequest(request) => {
                let fault = asi_model::messages::Fault {
                    pointer: "/assetId".to_owned(),
                    code: "NOT_OFFERED".to_owned(),
                    message: format!(
                        "This factory offers no status of the asset {}.",
                        request.asset_id
                    ),
                };
                let result = AcknowledgementResult::Rejected;
                self.books.acknowledge(request.message_id, None, result, vec![fault], now);
            }
        }
        Ok(())
    }

    fn reject(
        &mut self,
        rejection: Rejection,
        body: &[u8],
        subject: &str,
        transport_id: MessageId,
        now: DateTime,
    ) {
        metrics::counter!("verbund_messages_rejected_total").increment(1);
        tracing::warn!(message.id = %transport_id, faults = rejection.faults.len(), "A message was rejected and answered.");
        let first = rejection.faults.first();
        self.books.changes.dead_letters.push(DeadLetterRow {
            is_received: true,
            message_id: Some(transport_id.clone()),
            subject: subject.chars().take(128).collect(),
            code: first.map_or_else(|| "REJECTED".to_owned(), |fault| fault.code.clone()),
            reason: first.map_or_else(String::new, |fault| fault.message.clone()),
            body: body[..body.len().min(DEAD_LETTER_BYTES_MAX)].to_vec(),
            occurred_at: now,
        });
        let correlation_id = rejection.message_id.clone().unwrap_or(transport_id);
        let subject = rejection.operation_network_id.clone().zip(rejection.revision);
        self.books.acknowledge(
            correlation_id,
            subject,
            AcknowledgementResult::Rejected,
            rejection.faults,
            now,
        );
    }

    async fn receipt(&mut self, receipt: Receipt, now: DateTime) -> Result<(), StoreError> {
        let sent_before = time::OffsetDateTime::from(now) - ON_ITS_WAY;
        for writer in receipt.receipt_list {
            let rows = self.kept_reports(writer.data_set_writer_id, Some(writer.epoch)).await?;
            let decided: Vec<ReportRow> = rows.iter().map(|kept| kept.row).collect();
            let effect = apply_receipt(&writer, &decided, sent_before);
            self.books.receipted(&effect, &rows, now);
        }
        Ok(())
    }

    /// A number is either a control message's or a message of reports'; what concerns the other
    /// kind finds nothing.
    async fn outcomes(
        &mut self,
        outcomes: &[RowOutcome],
        departures: Vec<Departure>,
        now: DateTime,
    ) -> Result<(), StoreError> {
        let (mut accepted, mut attempted, mut parked) = (Vec::new(), Vec::new(), Vec::new());
        for outcome in outcomes {
            let id = outcome.id.0;
            self.rooms.ephemerals.remove(id);
            match &outcome.outcome {
                SendOutcome::Accepted => accepted.push(id),
                SendOutcome::Expired => self.books.changes.controls_done.push(id),
                SendOutcome::Rejected(_) => attempted.push(id),
                SendOutcome::Parked(rejection) => {
                    parked.push(id);
                    self.books.changes.dead_letters.push(DeadLetterRow {
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
        if !accepted.is_empty() {
            let departed: HashMap<i64, Departure> =
                departures.into_iter().map(|left| (left.message, left)).collect();
            let unsent = self.store.read().reports().unsent_in(&accepted).await?;
            let unsent = moved(unsent, &self.books.changes.report_moves);
            let left: Vec<_> = unsent
                .into_iter()
                .filter(|kept| kept.row.sent_at.is_none())
                .filter_map(|kept| match departed.get(&kept.message) {
                    Some(left) if left.reports.contains(&kept.row.id.0) => {
                        Some((kept, Some(left.message_id.clone())))
                    }
                    Some(_) => None,
                    None => (!kept.is_done).then_some((kept, None)),
                })
                .collect();
            self.books.changes.controls_done.extend(&accepted);
            if !left.is_empty() {
                self.books.sent(&left, now);
            }
        }
        let changes = &mut self.books.changes;
        if !attempted.is_empty() {
            changes.controls_attempted.extend(&attempted);
            changes.report_moves.push(ReportMove::Attempted(attempted));
        }
        if !parked.is_empty() {
            changes.controls_parked.extend(&parked);
            changes.report_moves.push(ReportMove::Parked(parked));
        }
        Ok(())
    }
}
