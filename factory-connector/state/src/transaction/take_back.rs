//! Reports that are taken back, and receipts of the consents that ended.

use std::collections::BTreeMap;

use asi_model::{
    DateTime,
    messages::{FactoryMessage, SignedRevocation},
};
use ledger::{Event, LedgerKey, RevocationReceipt, RevokedWriter, Sequences};

use crate::{
    ChangeSet, ConnectorState,
    change_set::{EndedConsents, EndedWriter, Purge},
    effects::ConnectorEvent,
    use_cases::deliver::purge,
    writes::WaitingRow,
};

/// Last sequence numbers of a writer's epoch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SequenceProgress {
    /// The last that the broker accepted.
    pub sent: Option<u32>,
    /// The last that the platform has stored.
    pub receipted: Option<u32>,
}

/// Delivery of a writer's reports.
#[derive(Debug, Clone, Default)]
pub struct WriterDelivery {
    pub progress: SequenceProgress,
    /// Its reports in the spool.
    pub rows: Vec<WaitingRow>,
}

/// Takes back the reports of all writers of which a consent ended or was replaced. Their newest
/// values are reported again, as far as they are disclosed.
pub(super) fn purge_all(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    rows: &mut BTreeMap<u16, Vec<WaitingRow>>,
    now: DateTime,
) {
    for (writer, Purge { cause, .. }) in std::mem::take(&mut changes.purges) {
        let rows = rows.remove(&writer).unwrap_or_default();
        if rows.iter().any(|waiting| waiting.row.sent_at.is_none()) {
            state.writers.mark_unreported(writer);
        }
        purge(state, changes, rows, cause, now);
    }
}

/// Makes the receipt of consents that ended, and enters it in the chains of the recipients.
pub(super) fn receipt(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    ended: EndedConsents,
    delivery: &BTreeMap<u16, WriterDelivery>,
    now: DateTime,
) -> RevocationReceipt {
    let EndedConsents { revocation_id, revoked_by, reason, cause, fields, writers } = ended;
    let revocation_id = revocation_id.to_string();
    let none = WriterDelivery::default();
    let mut revoked_writers = Vec::with_capacity(writers.len());
    for (id, writer) in writers {
        let revoked = revoked_writer(id, writer, delivery.get(&id).unwrap_or(&none));
        let event = Event::Revoked {
            revocation_id: revocation_id.clone(),
            data_set_writer_id: id,
            epoch: revoked.epoch,
            last_sent_sequence: revoked.last_sent_sequence,
            last_delivered_sequence: revoked.last_delivered_sequence,
        };
        let writes = &mut changes.writes.ledger;
        state.ledger.append(writes, &revoked.recipient_list, now, None, &event);
        revoked_writers.push(revoked);
    }
    changes.effects.events.push(ConnectorEvent::Revocation(revocation_id.clone()));
    RevocationReceipt {
        revocation_id,
        factory_id: state.config.factory_id.clone(),
        revoked_at: now,
        revoked_by,
        reason,
        cause,
        fields,
        writers: revoked_writers,
    }
}

/// Sends the recipients of each data set what the receipt says about it, signed.
pub(super) fn notify_partners(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    receipt: &RevocationReceipt,
    key: &LedgerKey,
    now: DateTime,
) {
    for writer in receipt.writers.iter().filter(|writer| !writer.recipient_list.is_empty()) {
        for statement in receipt.for_partners(writer) {
            let signed_text = statement.canonical();
            let message = FactoryMessage::Revocation(SignedRevocation {
                message_id: state.ids.next_message_id(),
                factory_id: state.config.factory_id.clone(),
                operation_network_id: writer.request.operation_network_id.clone(),
                operation_id: writer.request.operation_id.clone(),
                dynamic_data_request_id: writer.request.dynamic_data_request_id.clone(),
                recipient_list: writer.recipient_list.clone(),
                signature: hex::encode(key.sign(&signed_text)),
                public_key: hex::encode(key.public()),
                signed_text,
            });
            state.send(changes, &message, None, now);
        }
    }
}

fn revoked_writer(id: u16, writer: EndedWriter, delivery: &WriterDelivery) -> RevokedWriter {
    let WriterDelivery { progress, rows } = delivery;
    let sequences = |is_sent: bool| {
        let rows = rows.iter().filter(|waiting| waiting.row.epoch == writer.epoch);
        let rows = rows.filter(|waiting| waiting.row.sent_at.is_some() == is_sent);
        Sequences::of(rows.map(|waiting| waiting.row.sequence).collect())
    };
    RevokedWriter {
        data_set_writer_id: id,
        epoch: writer.epoch,
        in_flight: sequences(true),
        taken_back: sequences(false),
        request: writer.request,
        recipient_list: writer.recipients,
        last_queued_sequence: writer.next_sequence.checked_sub(1),
        last_sent_sequence: progress.sent,
        last_delivered_sequence: progress.receipted,
    }
}
