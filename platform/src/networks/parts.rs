//! Parts of a revision for each factory, as messages. Pure: a function of the network and of the
//! parts sent before.

use std::{collections::BTreeSet, time::Duration};

use asi_model::{
    DateTime, FactoryId, MessageId,
    messages::{Fault, OperationNetworkMessage, PlatformMessage, REQUEST_BYTES_MAX, Withdraw},
};
use messaging::{ContentEncoding, Envelope, LogicalAddress};

use crate::{
    clock::new_message_id,
    store::{NetworkPart, NetworkRow, NewOutgoing, PartState},
};

/// A part with the message that carries it.
#[derive(Debug, Clone)]
pub(super) struct PlannedPart {
    pub(super) part: NetworkPart,
    pub(super) message: NewOutgoing,
}

impl PlannedPart {
    /// Returns the fault of a part that is too large for a broker.
    pub(super) fn oversize(&self) -> Option<Fault> {
        let bytes = self.message.body.len();
        (bytes > REQUEST_BYTES_MAX).then(|| Fault {
            pointer: String::new(),
            code: "TOO_LARGE".to_owned(),
            message: format!(
                "The part for {} has {bytes} bytes after compression; at most {REQUEST_BYTES_MAX} are sent. Divide \
                 the network.",
                self.part.factory_id
            ),
        })
    }
}

/// Size from which bodies are compressed; smaller ones stay readable in a broker's console.
const COMPRESSED_FROM_BYTES: usize = 64 * 1024;

/// Plans what to send: its part to each factory whose part has changed, and a withdrawal to those
/// without a part any more.
pub(super) fn plan(
    row: &NetworkRow,
    before: &[NetworkPart],
    resend_after: Duration,
) -> Vec<PlannedPart> {
    let owners: BTreeSet<&FactoryId> = match row.withdrawn_at {
        Some(_) => BTreeSet::new(),
        None => {
            row.network.operation_list.iter().filter_map(|o| o.owning_factory_id.as_ref()).collect()
        }
    };
    let previous = |factory: &FactoryId| before.iter().find(|part| part.factory_id == *factory);
    let mut planned = Vec::new();
    for factory in &owners {
        let part = asi_model::split::factory_part(&row.network, factory);
        let document = serde_json::to_string(&part).expect("a network has text keys only");
        if previous(factory).is_some_and(|old| !old.is_withdrawal && old.document == document) {
            continue;
        }
        let message_id = new_message_id();
        let message = PlatformMessage::OperationNetwork(OperationNetworkMessage {
            message_id: message_id.clone(),
            factory_id: (*factory).clone(),
            collaboration_id: row.collaboration_id.clone(),
            revision: row.revision,
            operation_network: part,
        });
        planned.push(planned_part(row, factory, &message, message_id, document, resend_after));
    }
    for old in before.iter().filter(|old| !old.is_withdrawal && !owners.contains(&old.factory_id)) {
        let message_id = new_message_id();
        let message = PlatformMessage::Withdraw(Withdraw {
            message_id: message_id.clone(),
            factory_id: old.factory_id.clone(),
            operation_network_id: row.network.operation_network_id.clone(),
            revision: row.revision,
        });
        planned.push(planned_part(
            row,
            &old.factory_id,
            &message,
            message_id,
            String::new(),
            resend_after,
        ));
    }
    planned
}

fn planned_part(
    row: &NetworkRow,
    factory: &FactoryId,
    message: &PlatformMessage,
    message_id: MessageId,
    document: String,
    resend_after: Duration,
) -> PlannedPart {
    let now = row.updated_at;
    let part = NetworkPart {
        operation_network_id: row.network.operation_network_id.clone(),
        factory_id: factory.clone(),
        revision: row.revision,
        is_withdrawal: matches!(message, PlatformMessage::Withdraw(_)),
        document,
        message_id,
        state: PartState::Sent,
        fault_list: Vec::new(),
        sent_at: now,
        sent_count: 1,
        resend_at: now.after(resend_after),
        acknowledged_at: None,
    };
    PlannedPart { message: outgoing(factory, message, now), part }
}

/// Makes the row of a message to a factory.
pub(crate) fn outgoing(
    factory: &FactoryId,
    message: &PlatformMessage,
    now: DateTime,
) -> NewOutgoing {
    let body = serde_json::to_vec(message).expect("messages have text keys only");
    let is_large = body.len() > COMPRESSED_FROM_BYTES;
    let envelope = Envelope::new(message.message_id().clone(), message.message_type(), body);
    let envelope = if is_large { envelope.compressed() } else { envelope };
    NewOutgoing {
        address: LogicalAddress::FactoryRequests(factory.clone()),
        message_id: message.message_id().clone(),
        subject: message.message_type().to_owned(),
        correlation_id: None,
        created_at: now,
        time_to_live: None,
        content_encoding: envelope
            .content_encoding
            .map(|ContentEncoding::Gzip| ContentEncoding::Gzip),
        body: envelope.body,
    }
}
