//! Messages of the platform that are answered: acknowledged, or rejected with all faults.

use asi_model::{
    DateTime, MessageId, OperationNetworkId,
    messages::{Acknowledgement, AcknowledgementResult, AssetRequest, FactoryMessage, Fault},
    validation::InvalidMessage,
};

use crate::{ChangeSet, ConnectorState, LogRecord, writes::DeadLetterRow};

/// Bytes of a rejected message that are stored.
const DEAD_LETTER_BYTES_MAX: usize = 256 * 1024;
/// Characters of a rejected message's subject that are stored.
const SUBJECT_CHARS_MAX: usize = 128;

/// A message as the broker delivered it.
#[derive(Debug, Clone, Copy)]
pub struct ReceivedMessage<'m> {
    pub transport_id: &'m MessageId,
    pub subject: &'m str,
    pub body: &'m [u8],
}

/// Notes that a message was received, so that a repetition has no effect.
#[must_use]
pub fn note_received(transport_id: MessageId, now: DateTime) -> ChangeSet {
    let mut changes = ChangeSet::default();
    changes.writes.messages.seen.push((transport_id, now));
    changes
}

/// Rejects a message: stores it as a dead letter and answers with all its faults.
pub fn reject(
    state: &mut ConnectorState,
    rejection: InvalidMessage,
    received: ReceivedMessage<'_>,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    let ReceivedMessage { transport_id, subject, body } = received;
    let first = rejection.faults.first();
    changes.writes.messages.dead_letters.push(DeadLetterRow {
        is_received: true,
        message_id: Some(transport_id.clone()),
        subject: subject.chars().take(SUBJECT_CHARS_MAX).collect(),
        code: first.map_or_else(|| "REJECTED".to_owned(), |fault| fault.code.clone()),
        reason: first.map_or_else(String::new, |fault| fault.message.clone()),
        body: body[..body.len().min(DEAD_LETTER_BYTES_MAX)].to_vec(),
        occurred_at: now,
    });
    changes.effects.log.push(LogRecord::MessageRejected {
        message_id: transport_id.clone(),
        fault_count: rejection.faults.len(),
    });
    let answer = Answer {
        correlation_id: rejection.message_id.unwrap_or_else(|| transport_id.clone()),
        network: rejection.operation_network_id.zip(rejection.revision),
        result: AcknowledgementResult::Rejected,
        faults: rejection.faults,
    };
    acknowledge(state, &mut changes, answer, now);
    changes
}

/// Answers a request for the status of an asset: this factory offers none.
pub fn reject_asset_request(
    state: &mut ConnectorState,
    request: &AssetRequest,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    let fault = Fault {
        pointer: "/assetId".to_owned(),
        code: "NOT_OFFERED".to_owned(),
        message: format!("This factory offers no status of the asset {}.", request.asset_id),
    };
    let answer = Answer {
        correlation_id: request.message_id.clone(),
        network: None,
        result: AcknowledgementResult::Rejected,
        faults: vec![fault],
    };
    acknowledge(state, &mut changes, answer, now);
    changes
}

/// An answer to a message of the platform.
pub(super) struct Answer {
    pub(super) correlation_id: MessageId,
    /// The network and revision that the message is about.
    pub(super) network: Option<(OperationNetworkId, u64)>,
    pub(super) result: AcknowledgementResult,
    pub(super) faults: Vec<Fault>,
}

/// Answers a message of the platform.
pub(super) fn acknowledge(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    answer: Answer,
    now: DateTime,
) {
    let (operation_network_id, revision) = answer.network.unzip();
    let acknowledgement = Acknowledgement {
        message_id: state.ids.next_message_id(),
        factory_id: state.config.factory_id.clone(),
        correlation_id: answer.correlation_id.clone(),
        operation_network_id,
        revision,
        result: answer.result,
        fault_list: answer.faults,
    };
    let message = FactoryMessage::Acknowledgement(acknowledgement);
    state.send(changes, &message, Some(answer.correlation_id), now);
}
