//! Conversion of envelopes to MQTT 5 publishes and back.

use std::time::Duration;

use asi_model::MessageId;
use rumqttc::v5::mqttbytes::{
    QoS,
    v5::{Publish, PublishProperties},
};
use time::{OffsetDateTime, format_description::well_known::Rfc3339};

use crate::{
    envelope::{ContentEncoding, Envelope},
    inbox::Delivery,
    spool::Rejection,
};

const MESSAGE_ID: &str = "message-id";
const SUBJECT: &str = "subject";
const CONTENT_ENCODING: &str = "content-encoding";
const CREATION_TIME: &str = "creation-time";
const LEASE: &str = "lease";
const SIGNATURE: &str = "signature";
/// The last level of the topic that the backlog after an outage is published to.
pub(super) const REPLAY: &str = "/replay";

/// Converts an envelope to the message to publish; a replayed one goes to the replay topic.
pub(super) fn to_publish(topic: &str, envelope: &Envelope, now: OffsetDateTime) -> Publish {
    let mut user_properties = vec![(SUBJECT.to_owned(), envelope.subject.clone())];
    let mut property = |name: &str, value: Option<String>| {
        user_properties.extend(value.map(|value| (name.to_owned(), value)));
    };
    property(MESSAGE_ID, envelope.message_id.as_ref().map(ToString::to_string));
    property(
        CONTENT_ENCODING,
        envelope.content_encoding.map(|encoding| encoding.as_str().to_owned()),
    );
    property(CREATION_TIME, envelope.creation_time.and_then(|at| at.format(&Rfc3339).ok()));
    property(LEASE, envelope.lease.map(|number| number.to_string()));
    property(SIGNATURE, envelope.signature.clone());
    let remaining = envelope.expires_at().map(|at| (at - now).whole_seconds().max(1));
    let properties = PublishProperties {
        message_expiry_interval: remaining
            .map(|seconds| u32::try_from(seconds).unwrap_or(u32::MAX)),
        correlation_data: envelope.correlation_id.as_ref().map(|id| id.as_str().to_owned().into()),
        content_type: Some(envelope.content_type.clone()),
        user_properties,
        ..PublishProperties::default()
    };
    let topic = if envelope.replay { format!("{topic}{REPLAY}") } else { topic.to_owned() };
    Publish::new(topic, QoS::AtLeastOnce, envelope.body.clone(), Some(properties))
}

/// Converts a received message for the inbox; fails for encodings that are not supported.
pub(super) fn to_delivery(publish: Publish, now: OffsetDateTime) -> Result<Delivery, Rejection> {
    let properties = publish.properties.unwrap_or_default();
    let property = |name: &str| {
        let mut all = properties.user_properties.iter();
        all.find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    };
    let content_encoding = match property(CONTENT_ENCODING) {
        None | Some("" | "identity") => None,
        Some("gzip") => Some(ContentEncoding::Gzip),
        Some(other) => {
            let reason = format!("the content encoding {other:?} is not supported");
            return Err(Rejection { code: "amqp:not-implemented".to_owned(), reason });
        }
    };
    let correlation_id =
        properties.correlation_data.as_ref().and_then(|data| std::str::from_utf8(data).ok());
    let envelope = Envelope {
        message_id: property(MESSAGE_ID).and_then(|id| MessageId::new(id).ok()),
        subject: property(SUBJECT).unwrap_or_default().to_owned(),
        content_type: properties.content_type.clone().unwrap_or_default(),
        content_encoding,
        correlation_id: correlation_id.and_then(|id| MessageId::new(id).ok()),
        creation_time: property(CREATION_TIME)
            .and_then(|at| OffsetDateTime::parse(at, &Rfc3339).ok()),
        ttl: properties
            .message_expiry_interval
            .map(|seconds| Duration::from_secs(u64::from(seconds))),
        replay: publish.topic.ends_with(REPLAY.as_bytes()),
        lease: property(LEASE).and_then(|number| number.parse().ok()),
        signature: property(SIGNATURE).map(str::to_owned),
        body: publish.payload,
    };
    Ok(Delivery { envelope, is_redelivered: publish.dup, delivery_count: 0, received_at: now })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_envelope_survives_the_way() {
        let now = OffsetDateTime::from_unix_timestamp(1_555_607_910).expect("a time");
        let mut envelope =
            Envelope::new(MessageId::new("m1").expect("an id"), "comment", "{}").compressed();
        envelope.correlation_id = MessageId::new("m0").ok();
        envelope.creation_time = Some(now);
        envelope.ttl = Some(Duration::from_secs(60));
        for (replay, lease) in [(false, None), (true, Some(7))] {
            (envelope.replay, envelope.lease) = (replay, lease);
            envelope.signature = lease.map(|_| "e30..AAAA".to_owned());
            let delivery = to_delivery(to_publish("a/b", &envelope, now), now).expect("a delivery");
            assert_eq!(delivery.envelope, envelope);
        }
    }

    #[test]
    fn a_foreign_message_needs_no_properties() {
        let publish = Publish::new("a/b", QoS::AtLeastOnce, "{}", None);
        let delivery = to_delivery(publish, OffsetDateTime::UNIX_EPOCH).expect("a delivery");
        assert_eq!(
            (delivery.envelope.message_id, &delivery.envelope.body[..]),
            (None, b"{}".as_slice())
        );
    }
}
