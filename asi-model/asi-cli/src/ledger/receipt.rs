//! `asi ledger receipt`: the signed receipt of a revocation, as the platform hands it over.

use std::io::Write;

use ::ledger::RevocationReceipt;
use anyhow::Context as _;
use serde::Deserialize;
use transparency_log::VerifierKey;

use crate::outcome::CommandOutcome;

/// Receipt as the platform's API lists it; other members are not needed.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct SignedReceipt {
    signed_text: String,
    signature: String,
}

/// Verifies a receipt with the key of the factory's ledger, and prints the text that was signed.
///
/// # Errors
/// When the file has no receipt, or its signature is no hexadecimal text.
pub(super) fn verify(
    file: &[u8],
    key: &VerifierKey,
    out: &mut dyn Write,
) -> anyhow::Result<CommandOutcome> {
    let receipt: SignedReceipt =
        serde_json::from_slice(file).context("the file is no receipt with its signature")?;
    let signature = hex::decode(&receipt.signature).context("the signature is no hexadecimal")?;
    let verified = RevocationReceipt::verified(&receipt.signed_text, &signature, key.public_key());
    match verified {
        Ok(_) => {
            writeln!(out, "{}", receipt.signed_text)?;
            Ok(CommandOutcome::Valid)
        }
        Err(error) => {
            writeln!(out, "{:#}", anyhow::Error::new(error))?;
            Ok(CommandOutcome::Invalid)
        }
    }
}

#[cfg(test)]
mod tests {
    use ::ledger::{LedgerKey, log_verifier};
    use serde_json::json;

    use super::*;

    #[test]
    fn a_receipt_is_valid_with_the_key_of_its_factory_only() {
        let key = LedgerKey::from_secret(&[7; 32]);
        let text = json!({ "revocationId": "r", "factoryId": "F", "cause": "REVOKED",
            "revokedAt": "2026-11-21T10:00:00Z", "fields": [], "writers": [] })
        .to_string();
        let check = |text: &str, signature: &[u8], by: &LedgerKey| {
            let file = json!({ "signedText": text, "signature": hex::encode(signature) });
            let (factory, acme) = ("F".parse().expect("an id"), "acme".parse().expect("an id"));
            let by = log_verifier(&factory, &acme, &by.public()).expect("a key");
            verify(file.to_string().as_bytes(), &by, &mut Vec::new()).expect("readable")
        };
        let signature = key.sign(&text);
        assert!(matches!(check(&text, &signature, &key), CommandOutcome::Valid));
        let changed = text.replace("10:00", "11:00");
        assert!(matches!(check(&changed, &signature, &key), CommandOutcome::Invalid));
        let other = LedgerKey::from_secret(&[8; 32]);
        assert!(matches!(check(&text, &signature, &other), CommandOutcome::Invalid));
        assert!(matches!(check(&text, &other.sign(&text), &key), CommandOutcome::Invalid));
    }
}
