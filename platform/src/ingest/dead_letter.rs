//! Dead letters of messages as they travelled.

use asi_model::DateTime;
use message_signature::SIGNATURE_BYTES_MAX;
use messaging::{Envelope, LogicalAddress};

use crate::store::NewDeadLetter;

/// Code and reason of a dead letter.
pub(super) type DeadLetterReason = (&'static str, String);

/// Returns the factory or tool that writes to an address.
pub(super) fn holder(address: &str) -> String {
    let parsed: Option<LogicalAddress> = address.parse().ok();
    let of_factory = parsed.as_ref().and_then(LogicalAddress::factory_id).map(ToString::to_string);
    let of_tool = parsed.as_ref().and_then(LogicalAddress::tool_id).map(ToString::to_string);
    of_factory.or(of_tool).unwrap_or_else(|| address.to_owned())
}

/// Makes the dead letter of a message.
pub(super) fn dead_letter(
    address: &LogicalAddress,
    envelope: &Envelope,
    received_at: DateTime,
    code: &'static str,
    reason: String,
) -> NewDeadLetter {
    NewDeadLetter {
        address: address.to_string(),
        message_id: envelope.message_id.as_ref().map(ToString::to_string),
        subject: envelope.subject.chars().take(100).collect(),
        code,
        reason: reason.chars().take(1000).collect(),
        received_at,
        body: envelope.body.to_vec(),
        content_encoding: envelope.content_encoding.map(messaging::ContentEncoding::as_str),
        // Only what a verifier would read.
        signature: envelope.signature.clone().filter(|text| text.len() <= SIGNATURE_BYTES_MAX),
    }
}
