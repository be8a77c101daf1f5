//! Messages of the platform. Each is settled once its effects are stored; what cannot be understood
//! is answered, stored as a dead letter and settled, too.

use std::collections::HashSet;

use asi_model::{
    DateTime,
    messages::{Fault, PlatformMessage, REQUEST_BYTES_MAX, Receipt},
    validation::{InvalidMessage, parse_platform_message},
};
use connector_state::use_cases::{
    comments::receive_comment,
    deliver::{ReceiptedRows, record_receipt},
    receive::{self, ReceivedMessage},
    revise,
};
use messaging::{
    Delivery,
    spool::{ReportRow, apply_receipt},
};

use super::{delivery_progress::reports_of, unit_of_work::UnitOfWork, witnessing};
use crate::{clock::new_message_id, store::StoreError};

/// Age below which a report that was sent may still be under way.
const UNDER_WAY: std::time::Duration = std::time::Duration::from_secs(5);
/// Largest request once unpacked, in bytes.
const UNPACKED_BYTES_MAX: usize = 8 * REQUEST_BYTES_MAX;

/// Runs the use case of each message that was not received before.
pub(super) async fn deliver(
    work: &mut UnitOfWork,
    deliveries: Vec<Delivery>,
    now: DateTime,
) -> Result<(), StoreError> {
    let ids: Vec<String> = deliveries
        .iter()
        .filter_map(|delivery| delivery.envelope.message_id.as_ref().map(ToString::to_string))
        .collect();
    let mut seen: HashSet<String> =
        work.store.read().received_messages().known_of(&ids).await?.into_iter().collect();
    // A repetition may be part of the same transaction, so the store does not know the first one
    // yet.
    let pending = work.pending.writes().messages.seen.iter();
    seen.extend(pending.map(|(id, _)| id.to_string()));
    for delivery in deliveries {
        let envelope = &delivery.envelope;
        let transport_id = envelope.message_id.clone().unwrap_or_else(new_message_id);
        if !seen.insert(transport_id.to_string()) {
            metrics::counter!("verbund_messages_repeated_total").increment(1);
            continue;
        }
        // Noted even where it is rejected: a repetition is not answered twice.
        work.pending.merge(receive::note_received(transport_id.clone(), now));
        let (body, parsed) = match envelope.unpacked(UNPACKED_BYTES_MAX) {
            Ok(body) => {
                let factory_id = &work.config.state.factory_id;
                let parsed = parse_platform_message(&body, factory_id);
                (body, parsed)
            }
            Err(error) => (envelope.body.clone(), Err(unreadable(&error))),
        };
        let received = ReceivedMessage {
            transport_id: &transport_id,
            subject: &envelope.subject,
            body: &body,
        };
        match parsed {
            Ok(message) => handle_message(work, message, now).await?,
            Err(rejection) => reject(work, rejection, received, now),
        }
    }
    Ok(())
}

fn unreadable(error: &impl ToString) -> InvalidMessage {
    let fault =
        Fault { pointer: String::new(), code: "UNREADABLE".to_owned(), message: error.to_string() };
    InvalidMessage {
        faults: vec![fault],
        message_id: None,
        operation_network_id: None,
        revision: None,
    }
}

fn reject(
    work: &mut UnitOfWork,
    rejection: InvalidMessage,
    received: ReceivedMessage<'_>,
    now: DateTime,
) {
    let changes = receive::reject(&mut work.state, rejection, received, now);
    work.pending.merge(changes);
}

async fn handle_message(
    work: &mut UnitOfWork,
    message: PlatformMessage,
    now: DateTime,
) -> Result<(), StoreError> {
    let state = &mut work.state;
    let changes = match message {
        PlatformMessage::OperationNetwork(network) => {
            let json = serde_json::to_string(&network).map_err(|error| StoreError::Unreadable {
                what: "network",
                reason: error.to_string(),
            })?;
            revise::receive_network(state, network, json, now)
        }
        PlatformMessage::Withdraw(withdraw) => revise::receive_withdrawal(state, withdraw, now),
        PlatformMessage::Comment(comment) => receive_comment(comment, now),
        PlatformMessage::Receipt(receipt) => return record(work, receipt, now).await,
        // Leases arrive at an address of their own.
        PlatformMessage::Lease(_) => return Ok(()),
        PlatformMessage::LedgerCosignature(answer) => {
            return witnessing::receive(work, &answer, now).await;
        }
        PlatformMessage::AssetRequest(request) => {
            receive::reject_asset_request(state, &request, now)
        }
    };
    work.pending.merge(changes);
    Ok(())
}

async fn record(work: &mut UnitOfWork, receipt: Receipt, now: DateTime) -> Result<(), StoreError> {
    for writer in receipt.receipt_list {
        let moves = &work.pending.writes().reports.moves;
        let (id, epoch) = (writer.data_set_writer_id, Some(writer.epoch));
        // As they are after the moves of this transaction, which the store does not know yet.
        let rows = reports_of(&mut work.store, moves, id, epoch).await?;
        let reports: Vec<ReportRow> = rows.iter().map(|waiting| waiting.row).collect();
        let mut effect = apply_receipt(&writer, &reports, now.into(), UNDER_WAY);
        let lost: Vec<u32> = effect.lost_sequences().collect();
        if !lost.is_empty() {
            let receipted = work.store.read().reports().receipted(id, writer.epoch, &lost).await?;
            effect
                .reopen_receipted(&receipted.iter().map(|waiting| waiting.row).collect::<Vec<_>>());
        }
        let gaps = work.store.read().announced_gaps().of_writer(id, writer.epoch).await?;
        let rows = ReceiptedRows { reports: &rows, gaps: &gaps };
        let changes = record_receipt(&mut work.state, &writer, &effect, rows, now);
        work.pending.merge(changes);
    }
    Ok(())
}
