//! Commitment to the documents that a decision is based on.

use disclosure::DecisionBasis;
use sha2::{Digest, Sha256};

/// Domain separator: these hashes differ from any other use of SHA-256.
const DOMAIN: &[u8] = b"verbund decision basis 1";

/// Returns the basis of a stored consent as entries of the ledger have it: a salted hash in place of
/// policies, rules and caps. Their ids are words of the plant that may name other partners, and a
/// recipient reads its chain. The salt forbids to confirm guessed ids. The basis of a former version
/// has no salt, and is in the entry as it is.
#[must_use]
pub fn basis_for_recipients(stored: &DecisionBasis) -> DecisionBasis {
    let Some(salt) = &stored.salt else { return stored.clone() };
    let documents = DecisionBasis { preview: None, salt: None, ..stored.clone() };
    let text = serde_json::to_string(&documents).expect("bases have text keys and whole numbers");
    let mut hasher = Sha256::new();
    hasher.update(DOMAIN);
    hasher.update(u64::try_from(salt.len()).unwrap_or(u64::MAX).to_be_bytes());
    hasher.update(salt);
    hasher.update(text.as_bytes());
    DecisionBasis {
        preview: stored.preview.clone(),
        commitment: Some(hex::encode(hasher.finalize())),
        ..DecisionBasis::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stored(json: &str) -> DecisionBasis {
        serde_json::from_str(json).expect("a basis")
    }

    #[test]
    fn the_commitment_to_a_basis_never_changes() {
        let basis = stored(
            r#"{"policyId":"p","rules":[{"id":"r","version":1}],"preview":"00ff","salt":"0102"}"#,
        );
        let stated = serde_json::to_string(&basis_for_recipients(&basis)).expect("JSON");
        insta::assert_snapshot!(stated, @r#"{"preview":"00ff","commitment":"1acc7112ebef37ab3e22dfb2fbc181bda69676d5e4101c94c220287447ecb45b"}"#);
        let other = DecisionBasis { salt: Some("0103".to_owned()), ..basis.clone() };
        assert_ne!(
            basis_for_recipients(&other).commitment,
            basis_for_recipients(&basis).commitment
        );
    }

    #[test]
    fn a_basis_of_a_former_version_stays_as_it_is() {
        let basis = stored(r#"{"policyId":"p","caps":[{"id":"c","version":2}]}"#);
        assert_eq!(basis_for_recipients(&basis), basis);
    }
}
