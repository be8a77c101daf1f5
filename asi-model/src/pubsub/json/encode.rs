//! Encoding of PubSub messages, straight into one buffer.

mod data_set_message;
mod header;
mod meta_data;

pub use header::NetworkMessageHeader;
pub use meta_data::encode_meta_data;

use data_set_message::DataSetMessageEncoder;
use header::{close, message_header};

use super::Encoding;
use crate::{
    json::write,
    opcua_json::encode::write_name,
    pubsub::{DataSetMessage, MetaDataLookup, NetworkMessage, PubSubMessage, StatusMessage},
};

/// Encodes a data message. In [`Encoding::Verbose105`] the receiver must know from metadata those
/// types that are not self-evident.
#[must_use]
pub fn encode(message: &NetworkMessage, encoding: Encoding) -> Vec<u8> {
    encode_described(message, encoding, &())
}

/// Encodes a data message as [`encode`] does, with the metadata at hand: namespaces that it lists
/// are written as indexes in 1.04, structures as it describes them, and fields of abstract types
/// keep their type in Verbose.
#[must_use]
pub fn encode_described(
    message: &NetworkMessage,
    encoding: Encoding,
    lookup: &dyn MetaDataLookup,
) -> Vec<u8> {
    let fields: usize = message.messages.iter().map(|part| part.fields.len()).sum();
    let mut out = Vec::with_capacity(256 + 160 * message.messages.len() + 64 * fields);
    NetworkMessageHeader::from(message).open(&mut out);
    for (index, part) in message.messages.iter().enumerate() {
        if index > 0 {
            out.push(b',');
        }
        let publisher_id = part.publisher_id.as_deref().or(message.publisher_id.as_deref());
        let meta_data = lookup.meta_data(publisher_id, part.data_set_writer_id);
        DataSetMessageEncoder::new(encoding, meta_data).write(&mut out, part);
    }
    close(&mut out);
    out
}

/// Encodes one DataSetMessage as a JSON object, for [`NetworkMessageHeader::wrap`].
#[must_use]
pub fn encode_data_set_message(message: &DataSetMessage, encoding: Encoding) -> String {
    let mut out = Vec::with_capacity(160 + 64 * message.fields.len());
    DataSetMessageEncoder::new(encoding, None).write(&mut out, message);
    String::from_utf8(out).expect("the encoder writes UTF-8")
}

/// Encodes any message; of one of unknown type, its header alone.
#[must_use]
pub fn encode_message(message: &PubSubMessage, encoding: Encoding) -> Vec<u8> {
    match message {
        PubSubMessage::Data(data) => encode(data, encoding),
        PubSubMessage::MetaData(meta_data) => encode_meta_data(meta_data, encoding),
        PubSubMessage::Status(status) => encode_status(status),
        PubSubMessage::Other { message_type, message_id } => {
            let mut out = vec![b'{'];
            message_header(&mut out, message_id.as_ref(), message_type, None);
            out.push(b'}');
            out
        }
    }
}

/// Encodes a status message; alike in all encodings.
fn encode_status(message: &StatusMessage) -> Vec<u8> {
    let mut out = Vec::with_capacity(256);
    out.push(b'{');
    message_header(
        &mut out,
        message.message_id.as_ref(),
        "ua-status",
        message.publisher_id.as_deref(),
    );
    for (name, time) in
        [("Timestamp", message.timestamp), ("NextReportTime", message.next_report_time)]
    {
        if let Some(time) = time {
            write_name(&mut out, name);
            write::date_time(&mut out, time);
        }
    }
    write_name(&mut out, "IsCyclic");
    out.extend_from_slice(if message.is_cyclic { b"true" } else { b"false" });
    write_name(&mut out, "Status");
    write::unsigned(&mut out, message.status as u64);
    out.push(b'}');
    out
}
