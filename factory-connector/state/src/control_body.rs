//! Bodies of control messages: what leaves the plant beside reports is made here alone, of messages
//! of the contract, none of which has a place for a value of a field.

use std::{fmt, ops::Deref, sync::Arc};

use asi_model::{
    DateTime, MessageId,
    messages::FactoryMessage,
    pubsub::{
        DataSetMessage, DataSetMessageKind, MetaDataMessage, MetaDataVersion, NetworkMessage,
        json::{Encoding, encode, encode_meta_data},
    },
};

/// A control message as JSON. The spool takes nothing else, and no code outside of this crate makes
/// it:
///
/// ```compile_fail,E0423
/// let _ = connector_state::ControlBody("{}".to_owned());
/// ```
///
/// ```compile_fail,E0277
/// let _: connector_state::ControlBody = "{}".to_owned().into();
/// ```
///
/// ```compile_fail,E0624
/// fn make(message: &asi_model::messages::FactoryMessage) -> connector_state::ControlBody {
///     connector_state::ControlBody::of(message)
/// }
/// ```
///
/// ```
/// fn length(body: &connector_state::ControlBody) -> usize {
///     body.len()
/// }
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct ControlBody(String);

impl ControlBody {
    /// Encodes an acknowledgement, decision, gap, comment, receipt or checkpoint.
    pub(crate) fn of(message: &FactoryMessage) -> Self {
        let json = serde_json::to_string(message);
        Self(json.expect("messages have text keys and finite numbers"))
    }

    /// Encodes the description of a data set.
    pub(crate) fn of_meta_data(message: &MetaDataMessage, encoding: Encoding) -> Self {
        let json = String::from_utf8(encode_meta_data(message, encoding));
        Self(json.expect("the encoder writes UTF-8"))
    }
}

impl Deref for ControlBody {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for ControlBody {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(formatter)
    }
}

/// A keep-alive as JSON, which has no payload. Only its encoder makes it:
///
/// ```compile_fail,E0423
/// let _ = connector_state::KeepAliveBody(b"{}".to_vec());
/// ```
///
/// ```compile_fail,E0277
/// let _: connector_state::KeepAliveBody = b"{}".to_vec().into();
/// ```
///
/// ```
/// fn send(body: connector_state::KeepAliveBody) -> Vec<u8> {
///     body.into_bytes()
/// }
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeepAliveBody(Vec<u8>);

/// Everything that a keep-alive says.
pub(crate) struct KeepAliveHeader<'h> {
    pub message_id: &'h MessageId,
    pub publisher_id: &'h str,
    pub data_set_writer_id: u16,
    /// Sequence number of the writer's next report.
    pub sequence_number: Option<u32>,
    pub version: Option<MetaDataVersion>,
    /// Time on the time step of the writer's fields.
    pub timestamp: Option<DateTime>,
}

impl KeepAliveBody {
    pub(crate) fn of(header: &KeepAliveHeader<'_>, encoding: Encoding) -> Self {
        let message = NetworkMessage {
            message_id: Some(header.message_id.clone()),
            publisher_id: Some(Arc::from(header.publisher_id)),
            messages: vec![DataSetMessage {
                data_set_writer_id: Some(header.data_set_writer_id),
                sequence_number: header.sequence_number,
                meta_data_version: header.version,
                timestamp: header.timestamp,
                kind: DataSetMessageKind::KeepAlive,
                ..DataSetMessage::default()
            }],
            ..NetworkMessage::default()
        };
        Self(encode(&message, encoding))
    }

    /// Returns the bytes to send.
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        self.0
    }
}
