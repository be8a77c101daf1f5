//! Reading PubSub messages: which type of message, which header layout.

use super::{
    decode_members::{message_id, publisher_id},
    decode_message, decode_meta_data,
};
use crate::{
    json::{JsonError, JsonNode, Kind, Tape},
    opcua_json::{Decoder, Diagnostic, LIMITS, Leniency, Mismatch, decode_scalar::date_time},
    pubsub::{
        DataSetMessageKind, MetaDataLookup, NetworkMessage, PubSubMessage, PubSubState,
        StatusMessage,
    },
};

/// A message, and what was noteworthy about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoded {
    pub message: PubSubMessage,
    /// Deviations that were taken nevertheless, and fields that could not be read.
    pub diagnostics: Vec<Diagnostic>,
}

/// Error for bytes that are not a PubSub message.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PubSubError {
    /// The text is not JSON or breaks a limit.
    #[error("the message is not acceptable JSON")]
    Json(#[from] JsonError),
    /// A member occurs twice, so that it has no certain meaning.
    #[error("{pointer}: the member occurs twice")]
    Duplicate {
        /// JSON pointer to the second.
        pointer: String,
    },
    /// The JSON is not a PubSub message.
    #[error("{pointer}: {message}")]
    Malformed {
        /// JSON pointer to what is wrong.
        pointer: String,
        message: String,
    },
}

impl From<Mismatch<'_, '_>> for PubSubError {
    fn from(mismatch: Mismatch<'_, '_>) -> Self {
        Self::Malformed { pointer: mismatch.node.pointer(), message: mismatch.message.into_owned() }
    }
}

/// Reads a message in any encoding and layout. A field that cannot be read gets a Bad status and a
/// diagnostic; the others stay. Bare values without metadata get the likeliest type, with a
/// diagnostic.
///
/// # Errors
/// [`PubSubError`] where the bytes are not a PubSub message.
pub fn decode(bytes: &[u8]) -> Result<Decoded, PubSubError> {
    decode_described(bytes, Leniency::Lenient, &())
}

/// Decodes like [`decode`], with the metadata that bare values, structures and namespace indexes
/// need, and as strict as wanted.
///
/// # Errors
/// [`PubSubError`] where the bytes are not a PubSub message.
pub fn decode_described(
    bytes: &[u8],
    leniency: Leniency,
    lookup: &dyn MetaDataLookup,
) -> Result<Decoded, PubSubError> {
    let tape = Tape::read(bytes, LIMITS)?;
    if let Some(pointer) = tape.duplicates().next() {
        return Err(PubSubError::Duplicate { pointer });
    }
    let mut decoder = Decoder::new(leniency, &[], &[]);
    let message = message(tape.root(), &mut decoder, lookup)?;
    Ok(Decoded { message, diagnostics: decoder.diagnostics.into_list() })
}

fn message<'t, 'a, 'd>(
    root: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'d>,
    lookup: &'d dyn MetaDataLookup,
) -> Result<PubSubMessage, Mismatch<'t, 'a>> {
    match root.kind() {
        // A layout without NetworkMessage header: one or several DataSetMessages or payloads.
        Kind::Array => {
            // OPC Publisher batches them so; receivers know a message by its own id.
            if let Some(whole) = root.elements().find(|element| is_network_message(*element)) {
                return Err(Mismatch::new(
                    whole,
                    "NetworkMessages must not be in an array: each is a message of its own",
                ));
            }
            let messages = decode_message::data_set_messages(root, decoder, lookup, None)?;
            Ok(PubSubMessage::Data(NetworkMessage { messages, ..NetworkMessage::default() }))
        }
        Kind::Object => object(root, decoder, lookup),
        _ => Err(Mismatch::new(root, "a PubSub message must be an object or an array")),
    }
}

/// True for an object with the messages or the type of a NetworkMessage.
fn is_network_message(node: JsonNode<'_, '_>) -> bool {
    let message_type = node.get("MessageType").and_then(JsonNode::text);
    node.get("Messages").is_some()
        || matches!(message_type.as_deref(), Some("ua-data" | "ua-metadata" | "ua-status"))
}

fn object<'t, 'a, 'd>(
    root: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'d>,
    lookup: &'d dyn MetaDataLookup,
) -> Result<PubSubMessage, Mismatch<'t, 'a>> {
    let message_type = root.get("MessageType").and_then(JsonNode::text);
    match message_type.as_deref() {
        Some("ua-metadata") if root.get("MetaData").is_some() => {
            decode_meta_data::message(root, decoder)
        }
        Some("ua-status") if root.get("Status").is_some() => status(root, decoder),
        Some("ua-data") | None if root.get("Messages").is_some() => {
            if message_type.is_none() {
                decoder.diagnostics.tolerate(root, "MessageType is missing; ua-data is meant")?;
            }
            decode_message::network_message(root, decoder, lookup).map(PubSubMessage::Data)
        }
        Some(wanted @ ("ua-data" | "ua-metadata" | "ua-status")) => {
            let missing = match wanted {
                "ua-data" => "Messages is missing",
                "ua-metadata" => "MetaData is missing",
                _ => "Status is missing",
            };
            Err(Mismatch::new(root, missing))
        }
        Some(other)
            if other.starts_with("ua-") && DataSetMessageKind::from_name(other).is_none() =>
        {
            Ok(PubSubMessage::Other {
                message_type: other.into(),
                message_id: message_id(root, decoder)?,
            })
        }
        Some(_) if root.get("Messages").is_some() => {
            let kind = root.get("MessageType").unwrap_or(root);
            Err(Mismatch::new(kind, "the MessageType of a message with Messages must be ua-data"))
        }
        _ => {
            let message = decode_message::data_set_message(root, decoder, lookup, None)?;
            Ok(PubSubMessage::Data(NetworkMessage {
                messages: vec![message],
                ..NetworkMessage::default()
            }))
        }
    }
}

fn status<'t, 'a>(
    root: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'_>,
) -> Result<PubSubMessage, Mismatch<'t, 'a>> {
    const EXPECTED: &str = "Status must be a PubSubState: a number from 0 to 4 or its name";
    let node = root.get("Status").unwrap_or(root);
    let state = match node.integer::<usize>() {
        Some(number) => PubSubState::ALL.get(number).copied(),
        None => {
            // Verbose writes an enumeration as NAME_4.
            let name = node.text().unwrap_or_default();
            let name = name.rsplit_once('_').map_or(&*name, |(name, _)| name);
            PubSubState::ALL.into_iter().find(|state| state.name().eq_ignore_ascii_case(name))
        }
    };
    let time = |name: &str| root.get(name).map(date_time).transpose();
    Ok(PubSubMessage::Status(StatusMessage {
        timestamp: time("Timestamp")?,
        next_report_time: time("NextReportTime")?,
        message_id: message_id(root, decoder)?,
        publisher_id: publisher_id(root)?,
        status: state.ok_or_else(|| Mismatch::new(node, EXPECTED))?,
        is_cyclic: root.get("IsCyclic").and_then(JsonNode::boolean).unwrap_or(false),
    }))
}
