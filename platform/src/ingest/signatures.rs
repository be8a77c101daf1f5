//! Verification of the signatures of factories' messages. Pure.

use asi_model::{FactoryId, MessageId};
use message_signature::{SignedProperties, VerifiedMessage, verify};
use messaging::{Envelope, LogicalAddress};

use super::dead_letter::DeadLetterReason;
use crate::signing::{SigningState, WRONG_SIGNATURE};

/// Verifies the signature of a message as it travelled, before anything of its body is read. Returns
/// none for what is not signed and need not be.
///
/// # Errors
/// Code and reason of the dead letter.
pub(super) fn examine(
    address: &LogicalAddress,
    envelope: &Envelope,
    known: &SigningState,
) -> Result<Option<VerifiedMessage>, DeadLetterReason> {
    // Tools do not sign: what they ask for is theirs to see.
    let LogicalAddress::FactoryIngress(factory) = address else { return Ok(None) };
    let signature = envelope.signature.as_deref().map(|text| verify(text, &envelope.body));
    let verified = signature
        .transpose()
        .map_err(|error| (WRONG_SIGNATURE, format!("It is refused: {error}.")))?;
    let signer = verified.as_ref().map(|verified| &verified.key);
    known.judge(signer).map_err(|refusal| (refusal.code(), refusal.reason(factory)))?;
    if let Some(verified) = &verified {
        check_transport(factory, envelope, &verified.properties)?;
    }
    Ok(verified)
}

/// Checks that address and transport do not contradict what is signed. What the transport dropped is
/// no contradiction: the signed value counts.
fn check_transport(
    factory: &FactoryId,
    envelope: &Envelope,
    signed: &SignedProperties,
) -> Result<(), DeadLetterReason> {
    let contradicted = if signed.factory_id != *factory {
        "another factory"
    } else if envelope.message_id.as_ref().is_some_and(|id| *id != signed.message_id) {
        "another id of the message"
    } else if envelope.lease.is_some() && envelope.lease != signed.lease {
        "another lease"
    } else {
        return Ok(());
    };
    Err(contradiction(contradicted))
}

/// Checks that a body says the kind and the id that are signed beside it, where it has one.
///
/// # Errors
/// Code and reason of the dead letter.
pub(super) fn check_body(
    signed: &SignedProperties,
    message_id: Option<&MessageId>,
    message_type: &str,
) -> Result<(), DeadLetterReason> {
    if signed.subject != message_type {
        return Err(contradiction("another kind of message"));
    }
    if message_id.is_some_and(|id| *id != signed.message_id) {
        return Err(contradiction("another id of the message"));
    }
    Ok(())
}

fn contradiction(what: &str) -> DeadLetterReason {
    (WRONG_SIGNATURE, format!("The signature is for {what}."))
}
