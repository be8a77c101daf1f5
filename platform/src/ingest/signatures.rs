//! Signatures of factories' messages: verified before a message is read, and judged again in the
//! transaction that applies it.

use std::collections::HashMap;

use asi_model::{FactoryId, MessageId};
use message_signature::{SIGNATURE_BYTES_MAX, SignedProperties, VerifiedSignature, verify};
use messaging::{Envelope, LogicalAddress};

use super::{
    decode::{Content, DeadLetterReason, Incoming},
    unit::IngestUnit,
};
use crate::{
    signing::{SigningState, Standing, UNSIGNED, WRONG_SIGNATURE},
    store::StoreError,
};

/// Verifies the signature of a message as it travelled, before anything of its body is read. Returns
/// none for what is not signed and need not be.
///
/// # Errors
/// Code and reason of the dead letter.
pub(super) fn examine(
    address: &LogicalAddress,
    envelope: &Envelope,
    known: &SigningState,
) -> Result<Option<VerifiedSignature>, DeadLetterReason> {
    // Tools do not sign: what they ask for is theirs to see.
    let LogicalAddress::FactoryIngress(factory) = address else { return Ok(None) };
    let signature = envelope.signature.as_deref().map(|text| verify(text, &envelope.body));
    let verified =
        signature.transpose().map_err(|error| (WRONG_SIGNATURE, format!("Refused: {error}.")))?;
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
    (WRONG_SIGNATURE, format!("What was signed is of {what}."))
}

/// Returns the signature as it is stored with a dead letter; none where no verifier would read it.
pub(super) fn stored(envelope: &Envelope) -> Option<String> {
    envelope.signature.clone().filter(|text| text.len() <= SIGNATURE_BYTES_MAX)
}

/// Judges messages within one unit of ingest, and pins the keys of first signatures.
#[derive(Default)]
pub(super) struct SignatureArbiter {
    known: HashMap<FactoryId, SigningState>,
}

impl SignatureArbiter {
    /// Returns true for a message that may take effect. Any other one becomes a dead letter and
    /// leaves no further trace: neither its sender nor its numbers count as heard of, so that the
    /// message as it was sent still can come.
    pub(super) async fn admit(
        &mut self,
        unit: &mut IngestUnit<'_>,
        address: &LogicalAddress,
        incoming: &Incoming,
    ) -> Result<bool, StoreError> {
        let LogicalAddress::FactoryIngress(factory) = address else { return Ok(true) };
        if let Content::Dead(letter) = &incoming.content
            && [UNSIGNED, WRONG_SIGNATURE].contains(&letter.code)
        {
            count(factory);
            unit.add_dead_letter(letter).await?;
            return Ok(false);
        }
        // Again, since a message before it in this unit, or an administrator, may have changed it.
        if !self.known.contains_key(factory) {
            let known = unit.work.signing_keys().of_factory(factory).await?;
            self.known.insert(factory.clone(), known);
        }
        let Some(known) = self.known.get_mut(factory) else { return Ok(true) };
        match (known.judge(incoming.signer.as_ref()), incoming.signer) {
            (Ok(Standing::FirstSigned), Some(key)) => {
                unit.work.signing_keys().pin(factory, &key, unit.now).await?;
                known.pin(key);
                tracing::info!(factory.id = %factory, key = %key, "A factory signs its messages from now on.");
                Ok(true)
            }
            (Ok(_), _) => Ok(true),
            (Err(refusal), _) => {
                count(factory);
                let reason = refusal.reason(factory);
                unit.reject(address, incoming, refusal.code(), reason).await?;
                Ok(false)
            }
        }
    }
}

fn count(factory: &FactoryId) {
    metrics::counter!("verbund_forged_messages_total", "factory" => factory.to_string())
        .increment(1);
}
