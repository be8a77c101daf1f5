//! AMQP messages as the broker stores and delivers them.
//!
//! The only module that uses the client library's encoding of whole messages. Its types are public
//! but named private, so the library's version is pinned.

use std::time::Duration;

use fe2o3_amqp_types::{
    messaging::{
        Body, Header, Message, MessageAnnotations, MessageId,
        annotations::OwnedKey,
        message::__private::{Deserializable, Serializable},
    },
    primitives::{Symbol, Value},
};

/// Characters of an id or a subject by which people recognise a message.
const FEATURE_CHARS_MAX: usize = 256;

/// Message annotation with the name of the signed-in sender.
pub(crate) const PRINCIPAL: &str = "x-opt-principal";

/// An AMQP message with any kind of body.
pub(crate) type AnyMessage = Message<Body<Value>>;

/// Prepares a received message for the store: drops what the sender claims about the delivery, and
/// stamps the sender's name on it.
pub(crate) fn stamp(message: &mut AnyMessage, principal: &str) {
    message.delivery_annotations = None;
    let annotations = message.message_annotations.get_or_insert_with(MessageAnnotations::default);
    annotations.0.swap_remove(&OwnedKey::Symbol(Symbol::from(PRINCIPAL)));
    annotations
        .0
        .insert(OwnedKey::Symbol(Symbol::from(PRINCIPAL)), Value::String(principal.to_owned()));
    let header = message.header.get_or_insert_with(Header::default);
    header.durable = true;
    header.first_acquirer = true;
    header.delivery_count = 0;
}

/// Returns the earlier of time to live and absolute expiry time, in Unix milliseconds; none when the
/// message never expires.
pub(crate) fn expires_at_ms(message: &AnyMessage, now_ms: i64) -> Option<i64> {
    let by_ttl = message
        .header
        .as_ref()
        .and_then(|h| h.ttl)
        .map(|ttl| now_ms.saturating_add(i64::from(ttl)));
    let absolute = message.properties.as_ref().and_then(|p| p.absolute_expiry_time.clone());
    let absolute = absolute.map(|at| at.milliseconds());
    match (by_ttl, absolute) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

/// Returns a copy with the header of one delivery.
pub(crate) fn for_delivery(
    message: &AnyMessage,
    delivery_count: u32,
    is_redelivered: bool,
    ttl: Option<Duration>,
) -> AnyMessage {
    let mut copy = message.clone();
    let header = copy.header.get_or_insert_with(Header::default);
    header.delivery_count = delivery_count;
    header.first_acquirer = !is_redelivered;
    header.ttl = ttl.map(|ttl| u32::try_from(ttl.as_millis()).unwrap_or(u32::MAX));
    copy
}

/// Encodes a message for the store.
pub(crate) fn encode(message: &AnyMessage) -> Result<Vec<u8>, serde_amqp::Error> {
    serde_amqp::to_vec(&Serializable(message))
}

/// Decodes a stored message.
pub(crate) fn decode(bytes: &[u8]) -> Result<AnyMessage, serde_amqp::Error> {
    serde_amqp::from_slice::<Deserializable<AnyMessage>>(bytes).map(|message| message.0)
}

/// Properties by which people recognise a message.
#[derive(Debug, Clone, Default)]
pub(crate) struct Features {
    pub message_id: Option<String>,
    pub subject: Option<String>,
    pub principal: Option<String>,
}

impl Features {
    pub(crate) fn of(message: &AnyMessage) -> Self {
        let properties = message.properties.as_ref();
        let principal = message
            .message_annotations
            .as_ref()
            .and_then(|a| a.0.get(&OwnedKey::Symbol(Symbol::from(PRINCIPAL))))
            .and_then(
                |value| if let Value::String(name) = value { Some(name.clone()) } else { None },
            );
        Self {
            message_id: properties.and_then(|p| p.message_id.as_ref()).map(message_id_text),
            subject: properties
                .and_then(|p| p.subject.as_deref())
                .map(|subject| cut(subject, FEATURE_CHARS_MAX)),
            principal,
        }
    }
}

fn message_id_text(id: &MessageId) -> String {
    match id {
        MessageId::Ulong(n) => n.to_string(),
        MessageId::Uuid(uuid) => hex::encode(uuid.as_inner()),
        MessageId::Binary(bytes) => hex::encode(&bytes[..bytes.len().min(FEATURE_CHARS_MAX / 2)]),
        MessageId::String(text) => cut(text, FEATURE_CHARS_MAX),
    }
}

/// Returns the beginning of a text: a peer may send one as long as a whole message.
pub(crate) fn cut(text: &str, chars_max: usize) -> String {
    text.chars().take(chars_max).collect()
}

/// Returns the body if it is bytes or text; empty otherwise.
pub(crate) fn body_bytes(message: AnyMessage) -> Vec<u8> {
    match message.body {
        Body::Data(sections) => sections.into_iter().flat_map(|data| data.0.into_vec()).collect(),
        Body::Value(value) => match value.0 {
            Value::String(text) => text.into_bytes(),
            Value::Binary(bytes) => bytes.into_vec(),
            _ => Vec::new(),
        },
        Body::Sequence(_) | Body::Empty => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use fe2o3_amqp_types::messaging::{Batch, Data, Properties};

    use super::*;

    fn message() -> AnyMessage {
        let mut message = Message::from(Body::Data(Batch::new(vec![Data::from(b"{}".as_slice())])));
        message.properties =
            Some(Properties::builder().message_id("m1".to_owned()).subject("comment").build());
        message
    }

    #[test]
    fn a_claimed_principal_is_replaced() {
        let mut forged = message();
        stamp(&mut forged, "mallory");
        stamp(&mut forged, "f1");
        let stored = decode(&encode(&forged).expect("encodes")).expect("decodes");
        assert_eq!(stored, forged);
        let features = Features::of(&stored);
        assert_eq!(features.principal.as_deref(), Some("f1"));
        assert_eq!(features.message_id.as_deref(), Some("m1"));
        assert_eq!(features.subject.as_deref(), Some("comment"));
        assert_eq!(stored.message_annotations.as_ref().expect("annotations").0.len(), 1);
        assert_eq!(body_bytes(stored), b"{}");
    }

    #[test]
    fn what_people_recognise_a_message_by_is_short() {
        let mut long = message();
        for id in
            [MessageId::String("\u{e4}".repeat(10_000)), MessageId::Binary(vec![1; 10_000].into())]
        {
            long.properties =
                Some(Properties::builder().message_id(id).subject("x".repeat(10_000)).build());
            let features = Features::of(&long);
            let lengths = [features.message_id, features.subject]
                .map(|text| text.map(|text| text.chars().count()));
            assert_eq!(lengths, [Some(256), Some(256)]);
        }
    }

    #[test]
    fn the_earlier_of_both_expiries_counts() {
        let mut short = message();
        assert_eq!(expires_at_ms(&short, 1000), None);
        short.header = Some(Header { ttl: Some(500), ..Header::default() });
        assert_eq!(expires_at_ms(&short, 1000), Some(1500));
        if let Some(p) = short.properties.as_mut() {
            p.absolute_expiry_time = Some(fe2o3_amqp_types::primitives::Timestamp::from(1200));
        }
        assert_eq!(expires_at_ms(&short, 1000), Some(1200));
    }

    #[test]
    fn a_redelivery_is_marked_in_the_header() {
        let copy = for_delivery(&message(), 2, true, Some(Duration::from_millis(7)));
        let header = copy.header.expect("a header");
        assert_eq!(header.delivery_count, 2);
        assert!(!header.first_acquirer);
        assert_eq!(header.ttl, Some(7));
    }
}
