//! NetworkMessages and what they carry.

use std::sync::Arc;

use uuid::Uuid;

use super::meta_data::{DataSetMetaData, MetaDataVersion};
use crate::{
    ids::MessageId,
    values::{DataValue, DateTime, StatusCode, Variant},
};

/// PubSub message by its MessageType (OPC 10000-14).
#[derive(Debug, Clone, PartialEq)]
pub enum PubSubMessage {
    /// `ua-data`: values of one or more writers.
    Data(NetworkMessage),
    /// `ua-metadata`: what the values of one writer are.
    MetaData(Box<MetaDataMessage>),
    /// `ua-status`: how the publisher is.
    Status(StatusMessage),
    /// A message type this version does not know. To be ignored (OPC 10000-14 §7.2.5.1), never an
    /// error.
    Other {
        /// The message type as it came.
        message_type: Arc<str>,
        /// The message's id, where it has a usable one.
        message_id: Option<MessageId>,
    },
}

impl PubSubMessage {
    /// The wire name of the message type, also the AMQP subject.
    #[must_use]
    pub fn message_type(&self) -> &str {
        match self {
            Self::Data(_) => "ua-data",
            Self::MetaData(_) => "ua-metadata",
            Self::Status(_) => "ua-status",
            Self::Other { message_type, .. } => message_type,
        }
    }

    /// The message's id, where it has one.
    #[must_use]
    pub fn message_id(&self) -> Option<&MessageId> {
        match self {
            Self::Data(m) => m.message_id.as_ref(),
            Self::MetaData(m) => m.message_id.as_ref(),
            Self::Status(m) => m.message_id.as_ref(),
            Self::Other { message_id, .. } => message_id.as_ref(),
        }
    }

    /// The publisher, where the message names it.
    #[must_use]
    pub fn publisher_id(&self) -> Option<&str> {
        match self {
            Self::Data(m) => m.publisher_id.as_deref(),
            Self::MetaData(m) => m.publisher_id.as_deref(),
            Self::Status(m) => m.publisher_id.as_deref(),
            Self::Other { .. } => None,
        }
    }
}

/// `ua-data` (OPC 10000-14 §7.2.5.3): DataSetMessages of one publisher. The header members are
/// absent where the publisher left its header off.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NetworkMessage {
    /// Unique per message.
    pub message_id: Option<MessageId>,
    /// The publisher: a factory id, or `<factoryId>.<assetId>`.
    pub publisher_id: Option<Arc<str>>,
    pub writer_group_name: Option<Arc<str>>,
    /// The class that all contained data sets share.
    pub data_set_class_id: Option<Uuid>,
    pub messages: Vec<DataSetMessage>,
}

/// Content of a DataSetMessage (OPC UA Part 14, 7.2.5.4): its JSON `MessageType`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum DataSetMessageKind {
    /// All fields. Where a message does not say, this is meant.
    #[default]
    KeyFrame,
    /// Fields that changed.
    DeltaFrame,
    Event,
    /// "I am still here": no fields; the sequence number is the next expected one.
    KeepAlive,
}

impl DataSetMessageKind {
    /// The wire name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::KeyFrame => "ua-keyframe",
            Self::DeltaFrame => "ua-deltaframe",
            Self::Event => "ua-event",
            Self::KeepAlive => "ua-keepalive",
        }
    }

    /// The kind with this wire name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::KeyFrame, Self::DeltaFrame, Self::Event, Self::KeepAlive]
            .into_iter()
            .find(|kind| kind.name() == name)
    }
}

/// Form of the fields of a DataSetMessage (DataSetFieldContentMask).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum FieldRepresentation {
    /// Type and value; no times. A status that is not Good replaces (Bad) or wraps (Uncertain) the
    /// value.
    #[default]
    Variant,
    /// Value, status and times.
    DataValue,
    /// The bare value; only metadata has its type. Accepted on input; emitted as
    /// [`Self::Variant`] in `digicor`.
    Raw,
}

/// Values of one data set at one moment (OPC 10000-14 §7.2.5.4).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DataSetMessage {
    /// The writer; absent where the publisher left its DataSetMessage header off.
    pub data_set_writer_id: Option<u16>,
    pub data_set_writer_name: Option<Arc<str>>,
    /// The publisher, where the NetworkMessage has no header to say it.
    pub publisher_id: Option<Arc<str>>,
    /// The writer's group, where the NetworkMessage has no header to say it.
    pub writer_group_name: Option<Arc<str>>,
    /// Counts up by one per DataSetMessage of the writer; in a keep-alive the next expected number.
    pub sequence_number: Option<u32>,
    pub meta_data_version: Option<MetaDataVersion>,
    /// The metadata's minor version, where the message has no other (1.05).
    pub minor_version: Option<u32>,
    pub timestamp: Option<DateTime>,
    /// The data set's quality as a whole.
    pub status: StatusCode,
    pub kind: DataSetMessageKind,
    pub representation: FieldRepresentation,
    /// The fields, in payload order.
    pub fields: Vec<PayloadField>,
}

impl DataSetMessage {
    /// The value of a field.
    #[must_use]
    pub fn field(&self, name: &str) -> Option<&DataValue> {
        self.fields.iter().find(|field| &*field.name == name).map(|field| &field.value)
    }

    /// The text of a String field, as `operationId`.
    #[must_use]
    pub fn text(&self, name: &str) -> Option<&str> {
        self.field(name)?.value.as_str()
    }
}

/// One member of a payload.
#[derive(Debug, Clone, PartialEq)]
pub struct PayloadField {
    /// Its name, unique within the payload.
    pub name: Arc<str>,
    /// Its value. With [`FieldRepresentation::Variant`] the times are not transmitted.
    pub value: DataValue,
}

impl PayloadField {
    /// A field with a Good value and no time of its own.
    #[must_use]
    pub fn new(name: impl Into<Arc<str>>, value: impl Into<Variant>) -> Self {
        Self { name: name.into(), value: DataValue { value: value.into(), ..DataValue::default() } }
    }

    /// A field with a value, status and times.
    #[must_use]
    pub fn with(name: impl Into<Arc<str>>, value: DataValue) -> Self {
        Self { name: name.into(), value }
    }
}

/// `ua-metadata` (OPC 10000-14 §7.2.5.5.2): what the values of one writer are.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MetaDataMessage {
    /// Unique per message.
    pub message_id: Option<MessageId>,
    pub publisher_id: Option<Arc<str>>,
    pub data_set_writer_id: u16,
    pub writer_group_name: Option<Arc<str>>,
    pub data_set_writer_name: Option<Arc<str>>,
    pub timestamp: Option<DateTime>,
    pub meta_data: DataSetMetaData,
}

/// `ua-status` (OPC 10000-14 §7.2.5.5.4): how the publisher is.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct StatusMessage {
    /// Unique per message.
    pub message_id: Option<MessageId>,
    pub publisher_id: Option<Arc<str>>,
    pub status: PubSubState,
    /// True where the message is repeated; then both times are given.
    pub is_cyclic: bool,
    /// Time of the message; absent in a broker's last will.
    pub timestamp: Option<DateTime>,
    /// Time of the next message; reasonably later the publisher counts as failed.
    pub next_report_time: Option<DateTime>,
}

/// The state of a publisher.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum PubSubState {
    Disabled = 0,
    Paused = 1,
    #[default]
    Operational = 2,
    Error = 3,
    PreOperational = 4,
}

impl PubSubState {
    /// All states; the index is the numeric form.
    pub const ALL: [Self; 5] =
        [Self::Disabled, Self::Paused, Self::Operational, Self::Error, Self::PreOperational];

    /// The standard's name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Disabled => "Disabled",
            Self::Paused => "Paused",
            Self::Operational => "Operational",
            Self::Error => "Error",
            Self::PreOperational => "PreOperational",
        }
    }
}
