//! Signer of the messages to the platform: the ledger's key, over each message as it leaves.

use asi_model::FactoryId;
use ledger::LedgerKey;
use message_signature::{InvalidPublicKey, PublicKey, SignedProperties, sign};
use messaging::Envelope;

/// Signs messages in the name of one factory.
///
/// The key is the ledger's, so that a platform which countersigned the ledger's checkpoints knows it
/// already. No message passes for a text of the ledger, nor the other way round: see [`sign`].
#[derive(Clone)]
pub struct MessageSigner {
    factory_id: FactoryId,
    key: LedgerKey,
    public_key: PublicKey,
}

impl MessageSigner {
    /// Signs with a key for a factory.
    ///
    /// # Errors
    /// [`InvalidPublicKey`] for a key under which anybody signs; no key that was drawn is one.
    pub fn new(factory_id: FactoryId, key: LedgerKey) -> Result<Self, InvalidPublicKey> {
        let public_key = PublicKey::from_bytes(&key.public())?;
        Ok(Self { factory_id, key, public_key })
    }

    /// Signs a message with what it says at this moment; a message without an id stays as it is.
    pub fn sign(&self, envelope: &mut Envelope) {
        let Some(message_id) = envelope.message_id.clone() else { return };
        let properties = SignedProperties {
            factory_id: self.factory_id.clone(),
            message_id,
            subject: envelope.subject.clone(),
            lease: envelope.lease,
        };
        let sign_bytes = |bytes: &[u8]| self.key.sign_bytes(bytes);
        envelope.signature = Some(sign(&properties, &self.public_key, &envelope.body, sign_bytes));
    }
}

#[cfg(test)]
mod tests {
    use message_signature::verify;

    use super::*;

    #[test]
    fn a_message_is_signed_with_its_properties() {
        let key = LedgerKey::from_secret(&[7; 32]);
        let signer = MessageSigner::new("F".parse().expect("an id"), key).expect("a key");
        let mut envelope = Envelope::new("m1".parse().expect("an id"), "comment", "{}");
        envelope.lease = Some(3);
        signer.sign(&mut envelope);
        let signature = envelope.signature.clone().expect("signed");
        let verified = verify(&signature, &envelope.body).expect("it holds");
        assert_eq!(verified.key, signer.public_key);
        let SignedProperties { factory_id, message_id, subject, lease } = verified.properties;
        let said = (factory_id.as_str(), message_id.as_str(), subject.as_str(), lease);
        assert_eq!(said, ("F", "m1", "comment", Some(3)));
        signer.sign(&mut envelope);
        assert_eq!(envelope.signature, Some(signature), "sent again, it is signed alike");
    }
}
