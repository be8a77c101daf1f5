//! Dead letters of messages as they travelled.

use asi_model::DateTime;
use message_signature::SIGNATURE_BYTES_MAX;
use messaging::{Delivery, Envelope, LogicalAddress};

use crate::store::NewDeadLetter;

/// Code and reason of a dead letter.
pub(super) type DeadLetterReason = (&'static str, String);

/// Returns why a broker of another make put a message into its queue of the dead letters. Over AMQP 1.0 RabbitMQ says
/// neither the cause nor the queue of before; that the time of the message is over shows in the message itself.
pub(super) fn reason_of_broker(delivery: &Delivery) -> DeadLetterReason {
    if delivery.envelope.is_expired(delivery.received_at) {
        let reason = "It expired in a queue of the broker before its reader took it.";
        return ("EXPIRED", reason.to_owned());
    }
    let reason = "The broker set it aside: its reader refused it, it was delivered too often, or no queue is for it.";
    ("SET_ASIDE_BY_BROKER", reason.to_owned())
}

/// Returns the factory or tool that writes to an address.
pub(super) fn holder(address: &str) -> String {
    let parsed: Option<LogicalAddress> = address.parse().ok();
    let of_factory = parsed.as_ref().and_then(LogicalAddress::factory_id).map(ToString::to_string);
    let of_tool = parsed.as_ref().and_then(LogicalAddress::tool_id).map(ToString::to_string);
    of_factory.or(of_tool).unwrap_or_else(|| address.to_owned())
}

/// Makes the dead letter of a message. Of one that a broker set aside nothing of the content is kept: whose it was is not
/// known, so it could neither be tried again nor go with a factory or tool that leaves.
pub(super) fn dead_letter(
    address: &LogicalAddress,
    envelope: &Envelope,
    received_at: DateTime,
    code: &'static str,
    reason: String,
) -> NewDeadLetter {
    let is_kept = *address != LogicalAddress::DeadLetters;
    let body = if is_kept { envelope.body.to_vec() } else { Vec::new() };
    NewDeadLetter {
        address: address.to_string(),
        message_id: envelope.message_id.as_ref().map(ToString::to_string),
        subject: envelope.subject.chars().take(100).collect(),
        code,
        reason: reason.chars().take(1000).collect(),
        received_at,
        body,
        content_encoding: envelope.content_encoding.map(messaging::ContentEncoding::as_str),
        // Only what a verifier would read.
        signature: envelope
            .signature
            .clone()
            .filter(|text| is_kept && text.len() <= SIGNATURE_BYTES_MAX),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use time::OffsetDateTime;

    use super::*;

    #[test]
    fn a_message_whose_time_is_over_has_expired_and_any_other_was_set_aside() {
        let sent_at = OffsetDateTime::UNIX_EPOCH;
        let code = |ttl: Option<Duration>, seconds: u64| {
            let envelope = Envelope::new("m".parse().expect("an id"), "lease", "{}");
            let envelope = Envelope { ttl, creation_time: Some(sent_at), ..envelope };
            let received_at = sent_at + Duration::from_secs(seconds);
            let (is_redelivered, delivery_count) = (false, 0);
            reason_of_broker(&Delivery { envelope, is_redelivered, delivery_count, received_at }).0
        };
        let minute = Some(Duration::from_secs(60));
        assert_eq!(code(minute, 60), "EXPIRED");
        assert_eq!(code(minute, 59), "SET_ASIDE_BY_BROKER");
        assert_eq!(code(None, 60), "SET_ASIDE_BY_BROKER");
    }
}
