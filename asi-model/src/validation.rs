//! Checking what others send: structure first, then meaning, all faults at once.
//!
//! Every fault has a JSON pointer to what is wrong, a stable [`FaultCode`] and a sentence that a
//! partner can act on. What is rejected changes nothing; the faults travel back in the
//! acknowledgement.

mod acyclic;
mod bounds;
mod conditions;
mod disclosure;
mod factory_message;
mod faults;
mod lists;
mod message_members;
mod network;
mod operations;
mod past_release;
mod platform_message;
mod reader;
mod report_format;

pub use bounds::{
    LIST_MAX, MESSAGE_LIMITS, NAME_CHARS_MAX, OPERATIONS_MAX, RELATIONS_MAX, REQUEST_LIMITS,
    REVISION_MAX, TEXT_CHARS_MAX,
};
pub use faults::{FAULTS_MAX, FaultCode};

use crate::{
    ids::{FactoryId, MessageId, OperationNetworkId},
    instance,
    json::{Limits, Tape},
    messages::{
        Acknowledgement, AcknowledgementResult, FactoryMessage, Fault, PlatformMessage,
        REQUEST_BYTES_MAX,
    },
    network::OperationNetwork,
    node_set,
};
use reader::Reader;

/// Faults of a rejected message, with the ids that could be read of it nevertheless.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", summary(faults))]
pub struct InvalidMessage {
    /// Everything that is wrong; never empty.
    pub faults: Vec<Fault>,
    pub message_id: Option<MessageId>,
    /// The network it is about.
    pub operation_network_id: Option<OperationNetworkId>,
    /// The revision it is about.
    pub revision: Option<u64>,
}

/// Faults in the error's text; all of them are in the list.
const SUMMARISED_MAX: usize = 5;

fn summary(faults: &[Fault]) -> String {
    let first = faults.iter().take(SUMMARISED_MAX);
    first.map(|fault| format!("{}: {}", fault.pointer, fault.message)).collect::<Vec<_>>().join(" ")
}

impl InvalidMessage {
    /// The acknowledgement for the sender. Where the message's own id could not be read, it
    /// refers to the id that the transport gave it.
    #[must_use]
    pub fn into_acknowledgement(
        self,
        message_id: MessageId,
        factory_id: FactoryId,
        transport_id: MessageId,
    ) -> Acknowledgement {
        Acknowledgement {
            message_id,
            factory_id,
            correlation_id: self.message_id.unwrap_or(transport_id),
            operation_network_id: self.operation_network_id,
            revision: self.revision,
            result: AcknowledgementResult::Rejected,
            fault_list: self.faults,
        }
    }
}

/// Reads and checks a message from the platform to a factory: JSON, or a NodeSet2 document with an
/// Activity Status Interface in place of an `operation-network` message (pointers of faults then
/// refer to the JSON it stands for).
///
/// # Errors
/// [`InvalidMessage`] with all faults.
pub fn parse_platform_message(
    bytes: &[u8],
    expected: &FactoryId,
) -> Result<PlatformMessage, InvalidMessage> {
    platform_message(bytes, Some(expected))
}

/// Parses like [`parse_platform_message`], for the factory that the message names.
///
/// # Errors
/// [`InvalidMessage`] with all faults.
pub fn parse_any_platform_message(bytes: &[u8]) -> Result<PlatformMessage, InvalidMessage> {
    platform_message(bytes, None)
}

/// The factory that a message to a factory names, also where the message is rejected.
#[must_use]
pub fn named_factory(bytes: &[u8]) -> Option<FactoryId> {
    let json = if is_xml(bytes) { Some(from_node_set(bytes).ok()?) } else { None };
    let tape = Tape::read(json.as_deref().unwrap_or(bytes), REQUEST_LIMITS).ok()?;
    tape.root().get("factoryId")?.text()?.parse().ok()
}

fn is_xml(bytes: &[u8]) -> bool {
    bytes.iter().find(|byte| !byte.is_ascii_whitespace() && !b"\xef\xbb\xbf".contains(byte))
        == Some(&b'<')
}

fn platform_message(
    bytes: &[u8],
    expected: Option<&FactoryId>,
) -> Result<PlatformMessage, InvalidMessage> {
    let json = if is_xml(bytes) { Some(from_node_set(bytes)?) } else { None };
    parse(json.as_deref().unwrap_or(bytes), REQUEST_LIMITS, |reader, tape| {
        platform_message::platform_message(reader, tape.root(), expected)
    })
}

/// The JSON that a NodeSet2 document stands for. Its message id follows from the text, so that a
/// repeated document is a repeated message.
fn from_node_set(bytes: &[u8]) -> Result<Vec<u8>, InvalidMessage> {
    let reject = |code: FaultCode, message: String| {
        let mut reader = Reader::default();
        reader.faults.push("", code, message);
        let faults = reader.faults.into_list();
        InvalidMessage { faults, message_id: None, operation_network_id: None, revision: None }
    };
    if bytes.len() > REQUEST_LIMITS.bytes_max {
        let message = format!(
            "The body has {} bytes; at most {REQUEST_BYTES_MAX} are accepted.",
            bytes.len()
        );
        return Err(reject(FaultCode::TooLarge, message));
    }
    let node_set = node_set::read(bytes).map_err(|error| {
        reject(FaultCode::NotNodeSet, format!("The body is no NodeSet2 document: {error}."))
    })?;
    // FNV-1a: no secret is at stake, only that the same text has the same id.
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    });
    match instance::to_json(&node_set, &format!("nodeset-{hash:016x}")) {
        Some(message) => Ok(message.to_string().into_bytes()),
        None => {
            let message = "The document has no object of ActivityStatusInterfaceType.".to_owned();
            Err(reject(FaultCode::NoInterface, message))
        }
    }
}

/// Reads and checks a message from a factory, besides reports.
///
/// # Errors
/// [`InvalidMessage`] with all faults.
pub fn parse_factory_message(bytes: &[u8]) -> Result<FactoryMessage, InvalidMessage> {
    parse(bytes, MESSAGE_LIMITS, |reader, tape| {
        factory_message::factory_message(reader, tape.root())
    })
}

/// Reads and checks a whole network, as partners' tools hand it to the platform. Pointers are
/// relative to it.
///
/// # Errors
/// [`InvalidMessage`] with all faults.
pub fn parse_network(bytes: &[u8]) -> Result<OperationNetwork, InvalidMessage> {
    parse(bytes, REQUEST_LIMITS, |reader, tape| {
        let read = network::read(reader, tape.root())?;
        network::check(&read, "", None, reader);
        Some(read)
    })
}

/// Checks the meaning of a network whose structure is sound. Pointers are relative to it.
#[must_use]
pub fn validate_network(network: &OperationNetwork) -> Vec<Fault> {
    let mut reader = Reader::default();
    network::check(network, "", None, &mut reader);
    reader.faults.into_list()
}

/// Validates like [`validate_network`], for the part of one factory: its operations are its own,
/// all others stubs.
#[must_use]
pub fn validate_factory_part(network: &OperationNetwork, factory_id: &FactoryId) -> Vec<Fault> {
    let mut reader = Reader::default();
    network::check(network, "", Some(factory_id), &mut reader);
    reader.faults.into_list()
}

fn parse<T>(
    bytes: &[u8],
    limits: Limits,
    read: impl FnOnce(&mut Reader, &Tape<'_>) -> Option<T>,
) -> Result<T, InvalidMessage> {
    let mut reader = Reader::of_text();
    let tape = match Tape::read(bytes, limits) {
        Ok(tape) => tape,
        Err(error) => {
            reader.faults.unreadable(&error);
            return Err(InvalidMessage {
                faults: reader.faults.into_list(),
                message_id: None,
                operation_network_id: None,
                revision: None,
            });
        }
    };
    for pointer in tape.duplicates() {
        reader.faults.push(
            pointer,
            FaultCode::DuplicateMember,
            "The member occurs twice; keep one.",
        );
    }
    let message = read(&mut reader, &tape);
    match message {
        Some(message) if reader.faults.is_empty() => Ok(message),
        _ => Err(reader.into_rejection(&tape)),
    }
}

impl Reader {
    fn into_rejection(self, tape: &Tape<'_>) -> InvalidMessage {
        let root = tape.root();
        let id = |name: &str| root.get(name).and_then(|node| node.text());
        let network_id = root
            .get("operationNetwork")
            .and_then(|network| network.get("operationNetworkId"))
            .and_then(|node| node.text())
            .or_else(|| id("operationNetworkId"));
        InvalidMessage {
            faults: self.faults.into_list(),
            message_id: id("messageId").and_then(|id| id.parse().ok()),
            operation_network_id: network_id.and_then(|id| id.parse().ok()),
            revision: root
                .get("revision")
                .and_then(|node| node.integer())
                .filter(|revision| *revision <= REVISION_MAX),
        }
    }
}

#[cfg(test)]
mod tests;
