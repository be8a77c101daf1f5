//! Conversion of envelopes to AMQP 1.0 messages and back. Bodies of foreign senders may be any AMQP
//! section of bytes or text.

use std::time::Duration;

use asi_model::MessageId;
use bytes::Bytes;
use fe2o3_amqp::types::{
    definitions::{ErrorCondition, LinkError},
    messaging::{self, ApplicationProperties, Body, Data, Header, Message, Properties},
    primitives::{Binary, SimpleValue, Symbol, Timestamp, Value},
};
use time::OffsetDateTime;

use crate::{
    envelope::{ContentEncoding, Envelope},
    inbox::Delivery,
    spool::Rejection,
};

/// The application property that marks the backlog after an outage.
const REPLAY: &str = "replay";
/// The application property with the number of the sender's lease. A text, because some brokers
/// change numbers.
const LEASE: &str = "lease";
/// The application property with the sender's signature.
const SIGNATURE: &str = "signature";

/// Converts an envelope to the message to send.
pub(super) fn to_message(envelope: &Envelope, now: OffsetDateTime) -> Message<Data> {
    let remaining = envelope.expires_at().map(|at| at - now);
    let header = Header {
        durable: true,
        ttl: remaining.map(|remaining| {
            u32::try_from(remaining.whole_milliseconds().max(0)).unwrap_or(u32::MAX)
        }),
        ..Header::default()
    };
    let text_id = |id: &MessageId| messaging::MessageId::String(id.as_str().to_owned());
    let properties = Properties {
        message_id: envelope.message_id.as_ref().map(text_id),
        correlation_id: envelope.correlation_id.as_ref().map(text_id),
        subject: Some(envelope.subject.clone()),
        content_type: Some(Symbol::from(envelope.content_type.as_str())),
        content_encoding: envelope.content_encoding.map(|encoding| Symbol::from(encoding.as_str())),
        creation_time: envelope.creation_time.map(timestamp),
        absolute_expiry_time: envelope.expires_at().map(timestamp),
        ..Properties::default()
    };
    let mut marks = ApplicationProperties::default();
    if envelope.replay {
        marks.0.insert(REPLAY.to_owned(), SimpleValue::Bool(true));
    }
    if let Some(lease) = envelope.lease {
        marks.0.insert(LEASE.to_owned(), SimpleValue::String(lease.to_string()));
    }
    if let Some(signature) = &envelope.signature {
        marks.0.insert(SIGNATURE.to_owned(), SimpleValue::String(signature.clone()));
    }
    let application_properties = (!marks.0.is_empty()).then_some(marks);
    Message {
        header: Some(header),
        delivery_annotations: None,
        message_annotations: None,
        properties: Some(properties),
        application_properties,
        body: Data(Binary::from(envelope.body.to_vec())),
        footer: None,
    }
}

/// Converts a received message for the inbox; fails for encodings and bodies that are not
/// supported, and for bodies larger than `bytes_max`.
pub(super) fn to_delivery(
    message: Message<Body<Value>>,
    now: OffsetDateTime,
    bytes_max: u64,
) -> Result<Delivery, Rejection> {
    let Message { header, properties, application_properties, body, .. } = message;
    let header = header.unwrap_or_default();
    let properties = properties.unwrap_or_default();
    let content_encoding = match properties.content_encoding.as_ref().map(Symbol::as_str) {
        None | Some("" | "identity") => None,
        Some("gzip") => Some(ContentEncoding::Gzip),
        Some(other) => {
            return Err(unsupported(format!("the content encoding {other:?} is not supported")));
        }
    };
    let body = match body {
        Body::Data(sections) => {
            let mut sections: Vec<Data> = sections.into_iter().collect();
            match sections.len() {
                1 => sections.remove(0).0.into_vec(),
                _ => sections.into_iter().flat_map(|data| data.0.into_vec()).collect(),
            }
        }
        Body::Value(value) => match value.0 {
            Value::String(text) => text.into_bytes(),
            Value::Binary(bytes) => bytes.into_vec(),
            Value::Null => Vec::new(),
            _ => return Err(unsupported("the body is neither bytes nor text".to_owned())),
        },
        Body::Empty => Vec::new(),
        Body::Sequence(_) => {
            return Err(unsupported("the body is a sequence; send one data section".to_owned()));
        }
    };
    if body.len() as u64 > bytes_max {
        let reason =
            format!("the body has {} bytes, and at most {bytes_max} are taken", body.len());
        return Err(Rejection {
            code: condition_text(&LinkError::MessageSizeExceeded.into()),
            reason,
        });
    }
    let mark =
        |name: &str| application_properties.as_ref().and_then(|properties| properties.0.get(name));
    let replay = mark(REPLAY).is_some_and(|value| matches!(value, SimpleValue::Bool(true)));
    let text = |name: &str| match mark(name) {
        Some(SimpleValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    let creation_time = properties.creation_time.as_ref().and_then(moment);
    // `ttl` is what was left when it was sent, and a broker takes it off what has expired; the time of expiry says both.
    let expiry = properties.absolute_expiry_time.as_ref().and_then(moment);
    let ttl = expiry.zip(creation_time).and_then(|(at, from)| Duration::try_from(at - from).ok());
    let ttl = ttl.or_else(|| header.ttl.map(|ttl| Duration::from_millis(u64::from(ttl))));
    let lease = text(LEASE).and_then(|number| number.parse().ok());
    let signature = text(SIGNATURE).map(str::to_owned);
    let envelope = Envelope {
        message_id: properties.message_id.as_ref().and_then(text_of_id),
        subject: properties.subject.unwrap_or_default(),
        content_type: properties.content_type.map(|t| t.0).unwrap_or_default(),
        content_encoding,
        correlation_id: properties.correlation_id.as_ref().and_then(text_of_id),
        creation_time,
        ttl,
        replay,
        lease,
        signature,
        body: Bytes::from(body),
    };
    Ok(Delivery {
        envelope,
        is_redelivered: header.delivery_count > 0 || !header.first_acquirer,
        delivery_count: header.delivery_count,
        received_at: now,
    })
}

fn unsupported(reason: String) -> Rejection {
    Rejection { code: "amqp:not-implemented".to_owned(), reason }
}

fn text_of_id(id: &messaging::MessageId) -> Option<MessageId> {
    let text = match id {
        messaging::MessageId::String(text) => text.clone(),
        messaging::MessageId::Ulong(number) => number.to_string(),
        messaging::MessageId::Uuid(id) => uuid::Uuid::from_bytes(*id.as_inner()).to_string(),
        messaging::MessageId::Binary(bytes) => bytes
            .iter()
            .fold(String::with_capacity(bytes.len() * 2), |text, byte| format!("{text}{byte:02x}")),
    };
    MessageId::new(text).ok()
}

fn timestamp(at: OffsetDateTime) -> Timestamp {
    let ms = at.unix_timestamp_nanos() / 1_000_000;
    Timestamp::from_milliseconds(i64::try_from(ms).unwrap_or(i64::MAX))
}

fn moment(at: &Timestamp) -> Option<OffsetDateTime> {
    OffsetDateTime::from_unix_timestamp_nanos(i128::from(at.milliseconds()) * 1_000_000).ok()
}

/// Returns the symbol of an error condition, as on the wire.
pub(super) fn condition_text(condition: &ErrorCondition) -> String {
    serde_amqp::to_vec(condition)
        .ok()
        .and_then(|bytes| serde_amqp::from_slice::<Symbol>(&bytes).ok())
        .map_or_else(|| format!("{condition:?}"), |symbol| symbol.0)
}

#[cfg(test)]
mod tests {
    use fe2o3_amqp::types::messaging::{AmqpValue, Batch};

    use super::*;

    const BYTES_MAX: u64 = 1000;

    fn received(body: Body<Value>) -> Message<Body<Value>> {
        Message::from(body)
    }

    #[test]
    fn an_envelope_survives_the_way() {
        let now = OffsetDateTime::from_unix_timestamp(1_555_607_910).expect("a time");
        let mut envelope = Envelope::new(MessageId::new("m1").expect("an id"), "comment", "{}");
        envelope.correlation_id = Some(MessageId::new("m0").expect("an id"));
        envelope.creation_time = Some(now);
        envelope.ttl = Some(Duration::from_secs(60));
        (envelope.replay, envelope.lease) = (true, Some(7));
        envelope.signature = Some("e30..AAAA".to_owned());
        let sent = to_message(&envelope, now);
        let arrived = sent.map_body(|data| Body::Data(Batch::new(vec![data])));
        let delivery = to_delivery(arrived, now, BYTES_MAX).expect("a delivery");
        assert_eq!(delivery.envelope, envelope);
        assert!(delivery.is_redelivered, "the first acquirer is marked by the broker");
    }

    #[test]
    fn what_a_broker_set_aside_as_expired_still_says_when() {
        let now = OffsetDateTime::from_unix_timestamp(1_555_607_910).expect("a time");
        let mut envelope = Envelope::new(MessageId::new("m1").expect("an id"), "lease", "{}");
        envelope.creation_time = Some(now);
        envelope.ttl = Some(Duration::from_secs(60));
        let sent = to_message(&envelope, now + Duration::from_secs(20));
        // One broker takes the time to live off, another one leaves what was left of it.
        let mut without = sent.clone();
        without.header.as_mut().expect("a header").ttl = None;
        for sent in [sent, without] {
            let arrived = sent.map_body(|data| Body::Data(Batch::new(vec![data])));
            let delivery = to_delivery(arrived, now, BYTES_MAX).expect("a delivery");
            assert_eq!(delivery.envelope.expires_at(), envelope.expires_at());
        }
    }

    #[test]
    fn foreign_bodies_are_taken_as_bytes() {
        let now = OffsetDateTime::UNIX_EPOCH;
        for (body, expected) in [
            (Body::Value(AmqpValue(Value::String("{}".into()))), "{}"),
            (Body::Value(AmqpValue(Value::Binary(Binary::from(b"{}".to_vec())))), "{}"),
            (
                Body::Data(Batch::new(vec![
                    Data::from(b"{".as_slice()),
                    Data::from(b"}".as_slice()),
                ])),
                "{}",
            ),
            (Body::Empty, ""),
        ] {
            let delivery = to_delivery(received(body), now, BYTES_MAX).expect("a delivery");
            assert_eq!(delivery.envelope.body, expected);
            assert_eq!(delivery.envelope.message_id, None);
        }
        let number = received(Body::Value(AmqpValue(Value::Int(1))));
        let rejection = to_delivery(number, now, BYTES_MAX).expect_err("a number");
        assert_eq!(rejection.code, "amqp:not-implemented");
    }

    #[test]
    fn bodies_beyond_the_bound_are_rejected() {
        let body = |bytes| Body::Data(Batch::new(vec![Data::from(vec![b'x'; bytes].as_slice())]));
        let now = OffsetDateTime::UNIX_EPOCH;
        assert!(to_delivery(received(body(10)), now, 10).is_ok());
        let rejection = to_delivery(received(body(11)), now, 10).expect_err("eleven bytes");
        assert_eq!(rejection.code, "amqp:link:message-size-exceeded");
    }

    #[test]
    fn conditions_keep_their_wire_names() {
        use fe2o3_amqp::types::definitions::{AmqpError, LinkError};
        assert_eq!(
            condition_text(&AmqpError::UnauthorizedAccess.into()),
            "amqp:unauthorized-access"
        );
        assert_eq!(
            condition_text(&LinkError::MessageSizeExceeded.into()),
            "amqp:link:message-size-exceeded"
        );
        assert_eq!(condition_text(&ErrorCondition::Custom(Symbol::from("own"))), "own");
    }
}
