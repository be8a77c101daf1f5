//! Keys with which a factory's connectors sign, and the rule by which a message counts. Pure.
//!
//! A key is pinned by the enrolment that brings it. A connector that enrolled before connectors had
//! keys is trusted on first use: the key of its first signed message is pinned, or, where the platform
//! has countersigned the ledger of its factory, only a key of that ledger. From then on unsigned messages
//! and those of other keys change nothing.

use asi_model::FactoryId;
use message_signature::PublicKey;

/// Code of a message that lacks its signature.
pub const UNSIGNED: &str = "UNSIGNED";
/// Code of a message whose signature does not hold, or is another's.
pub const WRONG_SIGNATURE: &str = "WRONG_SIGNATURE";

/// Knowledge of a factory's signatures. By default none: as before the first one.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SigningState {
    /// True once the factory signed, or enrolled with a key.
    pub must_sign: bool,
    /// Keys whose signatures count.
    pub pinned: Vec<PublicKey>,
    /// Keys of the factory's logs that the platform countersigned; read while none is pinned.
    pub of_ledger: Vec<PublicKey>,
}

/// Standing of a message that counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Of a connector of before, which signs nothing.
    Unsigned,
    /// Signed with a pinned key.
    Signed,
    /// Signed with a key that is to be pinned.
    FirstSigned,
}

/// Reason for which a message does not count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SignatureRefusal {
    /// No signature, and its factory signs.
    Unsigned,
    /// A signature that holds, of a key that is not the factory's.
    OtherKey,
}

impl SigningState {
    /// Judges a message by the key that signed it.
    ///
    /// # Errors
    /// [`SignatureRefusal`].
    pub fn judge(&self, signer: Option<&PublicKey>) -> Result<Standing, SignatureRefusal> {
        let Some(key) = signer else {
            return if self.must_sign {
                Err(SignatureRefusal::Unsigned)
            } else {
                Ok(Standing::Unsigned)
            };
        };
        if self.pinned.contains(key) {
            return Ok(Standing::Signed);
        }
        // Where a factory that signs has no key, an administrator took the former ones away: then the
        // ledger's, which may be lost or stolen, say nothing.
        let is_expected =
            self.must_sign || self.of_ledger.is_empty() || self.of_ledger.contains(key);
        if self.pinned.is_empty() && is_expected {
            Ok(Standing::FirstSigned)
        } else {
            Err(SignatureRefusal::OtherKey)
        }
    }

    /// Pins the key of a first signed message.
    pub fn pin(&mut self, key: PublicKey) {
        self.must_sign = true;
        self.pinned.push(key);
    }
}

impl SignatureRefusal {
    /// Returns the code of the dead letter.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::Unsigned => UNSIGNED,
            Self::OtherKey => WRONG_SIGNATURE,
        }
    }

    /// Returns the reason in a sentence for people.
    #[must_use]
    pub fn reason(self, factory: &FactoryId) -> String {
        match self {
            Self::Unsigned => format!(
                "{factory} signs its messages, and this one has no signature: it was taken out on the way, or a \
                 connector of a former version sent it."
            ),
            Self::OtherKey => format!(
                "The signature is not of a key of {factory}. If its connector has a new key, enrol it again."
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_counts_once_it_is_pinned_and_no_other_does() {
        use SignatureRefusal::{OtherKey, Unsigned};
        // Public keys of the secrets [1; 32] to [3; 32].
        let [a, b, c] = [1, 2, 3].map(|byte| {
            let key = ed25519_dalek::SigningKey::from_bytes(&[byte; 32]);
            PublicKey::from_bytes(key.verifying_key().as_bytes()).expect("a key")
        });
        let (unsigned, first, signed) =
            (Ok(Standing::Unsigned), Ok(Standing::FirstSigned), Ok(Standing::Signed));
        let state = |must_sign, pinned: &[PublicKey], of_ledger: &[PublicKey]| SigningState {
            must_sign,
            pinned: pinned.to_vec(),
            of_ledger: of_ledger.to_vec(),
        };
        for (state, signer, expected) in [
            (state(false, &[], &[]), None, unsigned),
            (state(false, &[], &[]), Some(&a), first),
            (state(false, &[], &[a, b]), Some(&b), first),
            (state(false, &[], &[a, b]), Some(&c), Err(OtherKey)),
            (state(false, &[], &[a]), None, unsigned),
            (state(true, &[a], &[]), Some(&a), signed),
            (state(true, &[a, b], &[]), Some(&b), signed),
            (state(true, &[a], &[b]), Some(&b), Err(OtherKey)),
            (state(true, &[a], &[]), None, Err(Unsigned)),
            (state(true, &[], &[a]), Some(&b), first),
            (state(true, &[], &[a]), None, Err(Unsigned)),
        ] {
            assert_eq!(state.judge(signer), expected, "{state:?} {signer:?}");
        }
        let mut state = SigningState::default();
        state.pin(a);
        assert_eq!([state.judge(Some(&a)), state.judge(None)], [signed, Err(Unsigned)]);
    }
}
