//! Keep-alives (OPC UA Part 14, `ua-keepalive`): a writer without reports says that it is alive.

use asi_model::{DateTime, MessageId};

use crate::{
    ConnectorState, KeepAliveBody, Writer, control_body::KeepAliveHeader, queries::time_step,
};

/// A keep-alive message. It is sent once and never stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeepAlive {
    /// Number in the spool, which orders it among control messages.
    pub row: i64,
    pub message_id: MessageId,
    /// The NetworkMessage as JSON.
    pub body: KeepAliveBody,
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
    let header = KeepAliveHeader {
        message_id: &message_id,
        publisher_id: state.config.factory_id.as_str(),
        data_set_writer_id: id,
        sequence_number: writer.map(Writer::next_sequence),
        version: writer.map(Writer::version),
        timestamp: writer.map(|writer| now.floor_to(time_step(state, writer))),
    };
    let body = KeepAliveBody::of(&header, state.config.encoding);
    KeepAlive { row, message_id, body }
}
