//! The header of a NetworkMessage (OPC 10000-14 §7.2.5.3) and members that messages share.

use uuid::Uuid;

use crate::{
    ids::MessageId,
    json::write,
    opcua_json::encode::write_name,
    pubsub::{MetaDataVersion, NetworkMessage},
};

/// The header of a `ua-data` message: everything but its DataSetMessages.
///
/// DataSetMessages are encoded once, when their values are recorded, and may travel later in
/// another message than the one they were first put into. [`Self::wrap`] makes that message.
#[derive(Debug, Clone, Copy, Default)]
pub struct NetworkMessageHeader<'h> {
    /// Unique per message.
    pub message_id: Option<&'h MessageId>,
    /// A factory id, or `<factoryId>.<assetId>`.
    pub publisher_id: Option<&'h str>,
    /// The WriterGroup of all contained DataSetMessages.
    pub writer_group_name: Option<&'h str>,
    /// The class that all contained data sets share.
    pub data_set_class_id: Option<Uuid>,
}

impl<'h> NetworkMessageHeader<'h> {
    /// Puts already encoded DataSetMessages into one NetworkMessage, in the given order.
    ///
    /// Each part is the output of [`encode_data_set_message`](super::encode_data_set_message); it
    /// is copied as it is. The result is what [`encode`](super::encode) writes for the whole
    /// message.
    #[must_use]
    pub fn wrap<P: AsRef<[u8]>>(&self, parts: impl IntoIterator<Item = P>) -> Vec<u8> {
        let mut out = Vec::with_capacity(256);
        self.open(&mut out);
        for (index, part) in parts.into_iter().enumerate() {
            if index > 0 {
                out.push(b',');
            }
            out.extend_from_slice(part.as_ref());
        }
        close(&mut out);
        out
    }

    /// Writes everything before the first DataSetMessage.
    pub(super) fn open(&self, out: &mut Vec<u8>) {
        out.push(b'{');
        message_header(out, self.message_id, "ua-data", self.publisher_id);
        if let Some(group) = self.writer_group_name {
            write_name(out, "WriterGroupName");
            write::string(out, group);
        }
        if let Some(class) = self.data_set_class_id {
            write_name(out, "DataSetClassId");
            write::string(out, class.hyphenated().encode_lower(&mut Uuid::encode_buffer()));
        }
        out.extend_from_slice(b",\"Messages\":[");
    }
}

impl<'m> From<&'m NetworkMessage> for NetworkMessageHeader<'m> {
    fn from(message: &'m NetworkMessage) -> Self {
        Self {
            message_id: message.message_id.as_ref(),
            publisher_id: message.publisher_id.as_deref(),
            writer_group_name: message.writer_group_name.as_deref(),
            data_set_class_id: message.data_set_class_id,
        }
    }
}

/// Writes everything after the last DataSetMessage.
pub(super) fn close(out: &mut Vec<u8>) {
    out.extend_from_slice(b"]}");
}

/// Writes the members that every message begins with.
pub(super) fn message_header(
    out: &mut Vec<u8>,
    message_id: Option<&MessageId>,
    message_type: &str,
    publisher_id: Option<&str>,
) {
    if let Some(message_id) = message_id {
        write_name(out, "MessageId");
        write::string(out, message_id.as_ref());
    }
    write_name(out, "MessageType");
    write::string(out, message_type);
    if let Some(publisher_id) = publisher_id {
        write_name(out, "PublisherId");
        write::string(out, publisher_id);
    }
}

/// Writes `{"MajorVersion":…,"MinorVersion":…}`.
pub(super) fn version(out: &mut Vec<u8>, version: MetaDataVersion) {
    out.extend_from_slice(b"{\"MajorVersion\":");
    write::unsigned(out, u64::from(version.major));
    out.extend_from_slice(b",\"MinorVersion\":");
    write::unsigned(out, u64::from(version.minor));
    out.push(b'}');
}
