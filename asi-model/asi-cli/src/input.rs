//! Inputs: a file or standard input, and the kind of message it looks like.

use std::{io::Read as _, path::Path};

use anyhow::{Context as _, bail};
use asi_model::{
    json::{JsonNode, Kind as JsonKind, Limits, Tape},
    messages::REQUEST_BYTES_MAX,
};

/// The longest input; longer ones no receiver takes.
const BYTES_MAX: u64 = 16 * REQUEST_BYTES_MAX as u64;

/// File or standard input that was read whole, at most `BYTES_MAX` long.
pub struct Input {
    pub bytes: Vec<u8>,
    /// Kind of message, recognised by its members.
    pub kind: InputKind,
}

/// Reading of JSON inputs, as generous as any receiver's.
pub const INPUT_LIMITS: Limits =
    Limits { bytes_max: usize::MAX, depth_max: 100, tokens_max: 2_000_000 };

/// Kinds of message, recognised by the members that every message of the kind has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputKind {
    /// From the platform to a factory.
    ToFactory,
    /// From a factory to the platform, besides reports.
    FromFactory,
    /// A whole operation network without envelope.
    Network,
    /// An OPC UA PubSub message.
    PubSub,
    /// Members of a PubSub message, but none that it begins with.
    PubSubPart,
    /// An object or array without headers, perhaps the payload of a PubSub layout.
    Payload,
    /// A NodeSet2 document.
    NodeSet,
    /// No member of any kind was found.
    Unknown,
}

impl InputKind {
    /// The kind for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ToFactory => "a message to a factory",
            Self::FromFactory => "a message from a factory",
            Self::Network => "an operation network",
            Self::PubSub | Self::PubSubPart => "an OPC UA PubSub message",
            Self::Payload => "an object or array without headers",
            Self::NodeSet => "an interface as NodeSet2",
            Self::Unknown => "a message of unknown kind",
        }
    }

    fn of(bytes: &[u8]) -> Self {
        if bytes.trim_ascii_start().starts_with(b"<") || bytes.starts_with(b"\xef\xbb\xbf<") {
            return Self::NodeSet;
        }
        let Ok(tape) = Tape::read(bytes, INPUT_LIMITS) else { return Self::Unknown };
        let root = tape.root();
        match root.get("messageType").and_then(|node| node.text()).as_deref() {
            Some(
                "acknowledgement" | "decision" | "gap" | "asset-offer" | "lease-request"
                | "revocation" | "ledger-checkpoint" | "past-release" | "receipt-request",
            ) => Self::FromFactory,
            Some(_) => Self::ToFactory,
            None if root.get("operationNetworkId").is_some() => Self::Network,
            None if has_headers(root) => Self::PubSub,
            None if has_part_of_pubsub(root) => Self::PubSubPart,
            None if matches!(root.kind(), JsonKind::Object | JsonKind::Array) => Self::Payload,
            None => Self::Unknown,
        }
    }
}

/// True for a NetworkMessage, or DataSetMessages without NetworkMessage.
fn has_headers(root: JsonNode<'_, '_>) -> bool {
    let is_payload = |payload: JsonNode<'_, '_>| {
        matches!(payload.kind(), JsonKind::Object | JsonKind::Null)
            && payload.get("UaType").is_none()
    };
    let is_headed = |node: JsonNode<'_, '_>| {
        let kind = node.get("MessageType").and_then(|kind| kind.text());
        kind.is_some_and(|kind| kind.starts_with("ua-"))
            || node.get("Messages").is_some()
            || node.get("Payload").is_some_and(is_payload)
    };
    match root.kind() {
        JsonKind::Array => root.elements().next().is_some() && root.elements().all(is_headed),
        _ => is_headed(root),
    }
}

/// True for an object with members of a PubSub message that no request has.
fn has_part_of_pubsub(root: JsonNode<'_, '_>) -> bool {
    // A request whose messageType is misspelt is a request all the same.
    let kind = root.get("MessageType").and_then(|kind| kind.text());
    let is_request = kind.is_some_and(|kind| !kind.starts_with("ua-"));
    const NAMES: [&str; 8] = [
        "Payload",
        "MessageId",
        "PublisherId",
        "DataSetWriterId",
        "DataSetWriterName",
        "SequenceNumber",
        "MetaDataVersion",
        "MetaData",
    ];
    !is_request
        && (NAMES.into_iter().any(|name| root.get(name).is_some())
            || ["Messages", "Payload"].into_iter().any(|name| root.misspelt(name).is_some()))
}

impl Input {
    /// Reads a file, or standard input where there is none or it is called `-`.
    pub fn read(file: Option<&Path>) -> anyhow::Result<Self> {
        let mut bytes = Vec::new();
        match file.filter(|file| *file != Path::new("-")) {
            Some(file) => {
                let context = || format!("cannot read {}", file.display());
                let opened = std::fs::File::open(file).with_context(context)?;
                opened.take(BYTES_MAX + 1).read_to_end(&mut bytes).with_context(context)?;
            }
            None => {
                std::io::stdin()
                    .lock()
                    .take(BYTES_MAX + 1)
                    .read_to_end(&mut bytes)
                    .context("cannot read standard input")?;
            }
        }
        if bytes.len() as u64 > BYTES_MAX {
            bail!("the input is longer than {BYTES_MAX} bytes");
        }
        Ok(Self { kind: InputKind::of(&bytes), bytes })
    }
}
