//! Decoding of bytes to what they say. Pure: no store, no clock.

use asi_model::{
    DataValue, DateTime, DynamicDataRequestId, FactoryId, MessageId, OperationId,
    OperationNetworkId, OrganisationId, RequestKey,
    messages::FactoryMessage,
    opcua_json::Leniency,
    pubsub::{
        DataSetMessage, DataSetMessageKind, DataSetMetaData, MetaDataLookup, NetworkMessage,
        PubSubMessage, PubSubState, ReportHeader, is_report_field, json::decode_described,
        recipient_list,
    },
};
use bytes::Bytes;
use message_signature::PublicKey;
use messaging::{BodyError, Envelope, LogicalAddress};
use serde::Deserialize;
use sha2::{Digest, Sha256};

use super::{
    dead_letter::{DeadLetterReason, dead_letter, reason_of_broker},
    portion::Unpacked,
    signatures::{check_body, examine},
};
use crate::{
    signing::SigningState,
    store::NewDeadLetter,
    tools::{DataRequestMessage, parse_data_request},
};

/// Most reports and keep-alives of one message: each may need a row of its own.
const ITEMS_MAX: usize = 2_000;

/// A received message, understood.
#[derive(Debug, Clone, PartialEq)]
pub struct Incoming {
    /// Its id: the body's, else the transport's, else made from the body.
    pub message_id: MessageId,
    /// Its type, as `ua-data`.
    pub message_type: String,
    /// Time of arrival at the platform.
    pub received_at: DateTime,
    /// The message as it travelled; id and lease are the signed ones, where it is signed.
    pub envelope: Envelope,
    /// The key that signed it; none where it is not signed.
    pub signer: Option<PublicKey>,
    /// Body in UTF-8 after its content encoding was undone.
    pub body: String,
    pub content: Content,
}

impl Incoming {
    /// Makes the dead letter in its place.
    pub(super) fn set_aside(
        &self,
        address: &LogicalAddress,
        code: &'static str,
        reason: String,
    ) -> Self {
        let letter = NewDeadLetter {
            message_id: Some(self.message_id.to_string()),
            subject: self.message_type.clone(),
            ..dead_letter(address, &self.envelope, self.received_at, code, reason)
        };
        Self { content: Content::Dead(Box::new(letter)), ..self.clone() }
    }
}

/// Decoded content of a message.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    Reports {
        /// The reports, in their order.
        reports: Vec<IncomingReport>,
        /// Writers that say they are still there, with their epoch.
        keep_alives: Vec<(u16, u32)>,
        /// The message as it was, to forward parts of it.
        message: Box<NetworkMessage>,
    },
    /// Metadata of a data set writer.
    MetaData(u16, Box<DataSetMetaData>),
    /// State of the publisher.
    Status(PubSubState),
    /// An acknowledgement, decision, gap, comment or offer.
    Factory(Box<FactoryMessage>),
    /// A tool asks for data.
    DataRequest(Box<DataRequestMessage>),
    /// A type that this version does not know; ignored, as the standard asks.
    Unknown,
    /// Unusable; stored with the reason, and settled.
    Dead(Box<NewDeadLetter>),
}

/// One DataSetMessage with values.
#[derive(Debug, Clone, PartialEq)]
pub struct IncomingReport {
    pub data_set_writer_id: u16,
    pub epoch: u32,
    /// The sequence number within the epoch.
    pub sequence: u32,
    /// The request it claims to answer.
    pub request: RequestKey,
    pub report_name: String,
    /// The newest source time among the fields.
    pub shopfloor_timestamp: Option<DateTime>,
    /// Time of the report at the connector.
    pub report_timestamp: Option<DateTime>,
    /// The organisations to which the factory released it; none of them where its writer's metadata
    /// says that it names them and it does not, absent where it names none.
    pub released_to: Option<Vec<OrganisationId>>,
    /// The fields with their values, names in payload order.
    pub fields: Vec<(String, DataValue)>,
    /// Its place in the NetworkMessage.
    pub position: usize,
}

/// Understands a message. `lookup` knows the metadata of the factory's writers, `signing` its keys.
#[must_use]
pub fn decode(
    address: &LogicalAddress,
    message: &Unpacked,
    lookup: &dyn MetaDataLookup,
    signing: &SigningState,
) -> Incoming {
    let delivery = &message.delivery;
    let mut envelope = delivery.envelope.clone();
    let received_at = DateTime::from(delivery.received_at);
    let examined = examine(address, &envelope, signing);
    let mut signer = None;
    if let Ok(Some(verified)) = &examined {
        signer = Some(verified.key);
        envelope.message_id = Some(verified.properties.message_id.clone());
        envelope.lease = verified.properties.lease;
    }
    let understood = examined.and_then(|verified| {
        if *address == LogicalAddress::DeadLetters {
            return Err(reason_of_broker(delivery));
        }
        let text = text_of(&message.text)?;
        let (id, kind, content) = understand(address, &text, lookup)?;
        if let Some(verified) = &verified {
            check_body(&verified.properties, id.as_ref(), &kind)?;
        }
        Ok((id, kind, content, text))
    });
    let transport_id = envelope.message_id.clone();
    match understood {
        Ok((body_id, message_type, content, body)) => Incoming {
            message_id: body_id.or(transport_id).unwrap_or_else(|| id_of(&body)),
            message_type,
            received_at,
            envelope,
            signer,
            body,
            content,
        },
        Err((code, reason)) => {
            let letter = dead_letter(address, &envelope, received_at, code, reason);
            Incoming {
                message_id: transport_id.unwrap_or_else(|| id_of(&envelope.body)),
                message_type: envelope.subject.clone(),
                received_at,
                envelope,
                signer,
                body: String::new(),
                content: Content::Dead(Box::new(letter)),
            }
        }
    }
}

fn text_of(unpacked: &Result<Bytes, BodyError>) -> Result<String, DeadLetterReason> {
    let unpacked = unpacked.as_ref().map_err(|error| ("UNREADABLE_BODY", error.to_string()))?;
    String::from_utf8(unpacked.to_vec())
        .map_err(|_| ("NOT_UTF8", "The body is not UTF-8.".to_owned()))
}

type Understood = (Option<MessageId>, String, Content);

fn understand(
    address: &LogicalAddress,
    text: &str,
    lookup: &dyn MetaDataLookup,
) -> Result<Understood, DeadLetterReason> {
    match address {
        LogicalAddress::FactoryIngress(factory) if is_own_message(text) => {
            factory_message(factory, text)
        }
        LogicalAddress::FactoryIngress(factory) => pub_sub_message(factory, text, lookup),
        LogicalAddress::ToolRequests(tool) => {
            let request = parse_data_request(text, tool)?;
            Ok((
                Some(request.message_id.clone()),
                "data-request".into(),
                Content::DataRequest(Box::new(request)),
            ))
        }
        other => Err(("WRONG_ADDRESS", format!("Nothing is received from {other}."))),
    }
}

/// Our own messages say `messageType`, those of OPC UA PubSub `MessageType` or nothing.
fn is_own_message(text: &str) -> bool {
    #[derive(Deserialize)]
    struct Kind {
        #[serde(rename = "messageType")]
        message_type: Option<serde::de::IgnoredAny>,
    }
    // Most messages are reports; looking for the word first saves reading them twice.
    text.contains("\"messageType\"")
        && serde_json::from_str::<Kind>(text).is_ok_and(|kind| kind.message_type.is_some())
}

fn factory_message(factory: &FactoryId, text: &str) -> Result<Understood, DeadLetterReason> {
    let message =
        asi_model::validation::parse_factory_message(text.as_bytes()).map_err(|rejection| {
            ("INVALID_MESSAGE", format!("The message is not valid: {rejection}"))
        })?;
    let claimed = message.factory_id();
    if claimed != factory {
        return Err(forged(factory, claimed.as_str()));
    }
    let (id, kind) = (message.message_id().clone(), message.message_type().to_owned());
    Ok((Some(id), kind, Content::Factory(Box::new(message))))
}

fn pub_sub_message(
    factory: &FactoryId,
    text: &str,
    lookup: &dyn MetaDataLookup,
) -> Result<Understood, DeadLetterReason> {
    let decoded =
        decode_described(text.as_bytes(), Leniency::Lenient, lookup).map_err(|error| {
            ("INVALID_MESSAGE", format!("The message is not valid: {}.", chain(&error)))
        })?;
    let message = decoded.message;
    if let Some(publisher) = message.publisher_id() {
        check_publisher(factory, publisher)?;
    }
    let (id, kind) = (message.message_id().cloned(), message.message_type().to_owned());
    let content = match message {
        PubSubMessage::Data(message) => reports(factory, message, lookup)?,
        PubSubMessage::MetaData(message) => {
            Content::MetaData(message.data_set_writer_id, Box::new(message.meta_data))
        }
        PubSubMessage::Status(message) => Content::Status(message.status),
        PubSubMessage::Other { .. } => Content::Unknown,
    };
    Ok((id, kind, content))
}

/// PublisherId is the factory's id, or that of one of its assets: `<factoryId>.<assetId>`.
fn check_publisher(factory: &FactoryId, publisher: &str) -> Result<(), DeadLetterReason> {
    match publisher.strip_prefix(factory.as_str()) {
        Some(rest) if rest.is_empty() || rest.starts_with('.') => Ok(()),
        _ => Err(forged(factory, publisher)),
    }
}

fn forged(factory: &FactoryId, claimed: &str) -> DeadLetterReason {
    metrics::counter!("verbund_forged_messages_total", "factory" => factory.to_string())
        .increment(1);
    let claimed: String = claimed.chars().take(80).collect();
    (
        "FORGED_PUBLISHER",
        format!("The message came from {factory} and claims to be of {claimed:?}."),
    )
}

fn reports(
    factory: &FactoryId,
    message: NetworkMessage,
    lookup: &dyn MetaDataLookup,
) -> Result<Content, DeadLetterReason> {
    let count = message.messages.len();
    if count > ITEMS_MAX {
        let reason = format!("It has {count} DataSetMessages; {ITEMS_MAX} are allowed.");
        return Err(("TOO_MANY_MESSAGES", reason));
    }
    let (mut reports, mut keep_alives) = (Vec::with_capacity(count), Vec::new());
    for (position, part) in message.messages.iter().enumerate() {
        if let Some(publisher) = part.publisher_id.as_deref() {
            check_publisher(factory, publisher)?;
        }
        let missing =
            |what: &str| ("NO_SEQUENCE", format!("DataSetMessage {position} has no {what}."));
        let writer = part.data_set_writer_id.ok_or_else(|| missing("DataSetWriterId"))?;
        let epoch = part.meta_data_version.map_or(0, |version| version.major);
        if part.kind == DataSetMessageKind::KeepAlive {
            keep_alives.push((writer, epoch));
            continue;
        }
        let sequence = part.sequence_number.ok_or_else(|| missing("SequenceNumber"))?;
        let mut report = report(part, writer, epoch, sequence, position)?;
        let publisher = part.publisher_id.as_deref().or(message.publisher_id.as_deref());
        if report.released_to.is_none()
            && lookup
                .meta_data(publisher, Some(writer))
                .is_some_and(|known| names_recipients(known, epoch))
        {
            // The connector of this epoch always says it; the platform does not put its own list in
            // the place of a missing one.
            report.released_to = Some(Vec::new());
        }
        reports.push(report);
    }
    Ok(Content::Reports { reports, keep_alives, message: Box::new(message) })
}

fn report(
    part: &DataSetMessage,
    writer: u16,
    epoch: u32,
    sequence: u32,
    position: usize,
) -> Result<IncomingReport, DeadLetterReason> {
    let text = |name: &'static str| {
        part.text(name)
            .ok_or_else(|| ("NO_REQUEST", format!("DataSetMessage {position} has no {name}.")))
    };
    let invalid = |error: asi_model::InvalidId| {
        ("NO_REQUEST", format!("DataSetMessage {position}: {error}."))
    };
    let request = RequestKey {
        operation_network_id: OperationNetworkId::new(text(ReportHeader::OPERATION_NETWORK_ID)?)
            .map_err(invalid)?,
        operation_id: OperationId::new(text(ReportHeader::OPERATION_ID)?).map_err(invalid)?,
        dynamic_data_request_id: DynamicDataRequestId::new(text(
            ReportHeader::DYNAMIC_DATA_REQUEST_ID,
        )?)
        .map_err(invalid)?,
    };
    let shopfloor_timestamp = part.field(ReportHeader::SHOPFLOOR_TIMESTAMP).and_then(time_of);
    let fields = part
        .fields
        .iter()
        .filter(|field| is_report_field(part, &field.name))
        .map(|field| {
            let mut value = field.value.clone();
            // A variant travels without its own time; the data set's is the best that is known.
            value.source_timestamp = value.source_timestamp.or(shopfloor_timestamp);
            (field.name.to_string(), value)
        })
        .collect();
    Ok(IncomingReport {
        data_set_writer_id: writer,
        epoch,
        sequence,
        request,
        report_name: part.text(ReportHeader::REPORT_NAME).unwrap_or_default().to_owned(),
        shopfloor_timestamp,
        report_timestamp: part.timestamp,
        released_to: recipient_list(part),
        fields,
        position,
    })
}

/// Returns whether the reports of an epoch say to whom they are released.
fn names_recipients(meta_data: &DataSetMetaData, epoch: u32) -> bool {
    meta_data.configuration_version.major == epoch && describes_recipients(meta_data)
}

/// Returns whether metadata describes the member that says to whom a report is released.
pub(super) fn describes_recipients(meta_data: &DataSetMetaData) -> bool {
    meta_data.field(ReportHeader::RECIPIENT_LIST).is_some_and(|field| field.value_rank > 0)
}

fn time_of(value: &DataValue) -> Option<DateTime> {
    match value.value.as_scalar()? {
        asi_model::Scalar::DateTime(time) => Some(*time),
        asi_model::Scalar::String(text) => text.as_deref()?.parse().ok(),
        _ => None,
    }
}

fn id_of(body: impl AsRef<[u8]>) -> MessageId {
    let digest = hex::encode(Sha256::digest(body.as_ref()));
    MessageId::new(format!("sha256:{digest}")).expect("hexadecimal digits are graphic characters")
}

fn chain(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(cause) => format!("{error}: {}", chain(cause)),
        None => error.to_string(),
    }
}

#[cfg(test)]
mod tests;
