//! Signers of a forged end: nobody, or anybody but the log.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use ed25519_dalek::SigningKey;
use serde_json::{Value, json};
use transparency_log::{Checkpoint, KeyKind, LeafRange, NoteKey};

use crate::file::AuditFile;

/// Substitute for the checkpoint over a forged end.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Signer {
    /// The genuine checkpoint in the file, which does not cover the end.
    Genuine,
    Nobody,
    /// The checkpoint that was kept, a second time.
    Kept,
    /// Another key under the name of the log.
    OtherKey,
    /// Another key under the name and with the id of the log's.
    OtherKeyWithId,
    /// The genuine signature, below another text.
    OldSignature,
}

impl Signer {
    pub(crate) const ALL: [Self; 6] = [
        Self::Genuine,
        Self::Nobody,
        Self::Kept,
        Self::OtherKey,
        Self::OtherKeyWithId,
        Self::OldSignature,
    ];

    /// Returns the name in that of a kind.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Genuine => "beyond the genuine checkpoint",
            Self::Nobody => "without a checkpoint",
            Self::Kept => "with the kept checkpoint in the file",
            Self::OtherKey => "signed by another key",
            Self::OtherKeyWithId => "signed by another key with the id of the own",
            Self::OldSignature => "with the signature of another text",
        }
    }

    /// Puts its checkpoint over all leaves into the first line.
    pub(crate) fn sign(self, file: &AuditFile, start: &mut Value, leaves: &LeafRange) {
        let checkpoint =
            Checkpoint { origin: file.origin(), size: leaves.end(), root: leaves.root() };
        let thief = SigningKey::from_bytes(&[2; 32]);
        let thief = NoteKey::new(&checkpoint.origin, KeyKind::Ed25519, thief).expect("a key");
        let forged = checkpoint.sign(&thief).expect("it is signed").to_string();
        let genuine = start["checkpoint"].as_str().unwrap_or(&file.checkpoint).to_owned();
        start["checkpoint"] = match self {
            Self::Genuine => return,
            Self::Nobody => Value::Null,
            Self::Kept => json!(file.checkpoint),
            Self::OtherKey => json!(forged),
            Self::OtherKeyWithId => {
                let own = signature(&genuine);
                let bytes = [&own[..4], &signature(&forged)[4..]].concat();
                json!(with_signature(&checkpoint, &bytes))
            }
            Self::OldSignature => json!(with_signature(&checkpoint, &signature(&genuine))),
        };
    }
}

/// Returns id and signature in the last line of a note.
fn signature(note: &str) -> Vec<u8> {
    let text = note.trim_end().rsplit(' ').next().expect("a signature");
    STANDARD.decode(text).expect("base64")
}

fn with_signature(checkpoint: &Checkpoint, signature: &[u8]) -> String {
    format!("{checkpoint}\n\u{2014} {} {}\n", checkpoint.origin, STANDARD.encode(signature))
}
