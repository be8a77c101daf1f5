//! Keep-alives (OPC UA Part 14, `ua-keepalive`): a writer without reports says that it is alive.

use asi_model::{
    DateTime, MessageId,
    pubsub::{DataSetMessage, DataSetMessageKind, NetworkMessage, json::encode},
};

use crate::{ConnectorState, Writer, queries::time_step};

/// A keep-alive message. It is sent once and never stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeepAlive {
    /// Number in the spool, which orders it among control messages.
    pub row: i64,
    pub message_id: MessageId,
    /// The NetworkMessage as JSON.
    pub body: Vec<u8>,
}

/// Makes a keep-alive for each writer that was silent for the update interval its partner asked
/// for.
pub fn keep_alives(state: &mut ConnectorState, now: DateTime) -> Vec<KeepAlive> {
    let silent = state.writers.take_silent(now);
    silent.into_iter().map(|id| keep_alive(state, id, now)).collect()
}

fn keep_alive(state: &mut ConnectorState, id: u16, now: DateTime) -> KeepAlive {
    let row = state.next_row();
    let message_id = state.ids.next_message_id();
    let writer = state.writers.get(id);
    let message = NetworkMessage {
        message_id: Some(message_id.clone()),
        publisher_id: Some(state.config.factory_id.as_str().into()),
        messages: vec![DataSetMessage {
            data_set_writer_id: Some(id),
            sequence_number: writer.map(Writer::next_sequence),
            meta_data_version: writer.map(Writer::version),
            timestamp: writer.map(|writer| now.floor_to(time_step(state, writer))),
            kind: DataSetMessageKind::KeepAlive,
            ..DataSetMessage::default()
        }],
        ..NetworkMessage::default()
    };
    let body = encode(&message, state.config.encoding);
    KeepAlive { row, message_id, body }
}
