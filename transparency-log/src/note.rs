//! Signed notes: a text with signatures under it, C2SP signed-note 1.0.0.
//!
//! Two kinds of signature are read and made: Ed25519 over the text (type 01), and the cosignature
//! with its time of C2SP tlog-cosignature 1.0.1 (type 04). Lines of other keys are left alone.

mod error;
mod key;
#[cfg(test)]
mod tests;

use std::fmt;

use base64::{Engine as _, engine::general_purpose::STANDARD};
pub use error::{KeyError, NoteError};
use key::KeyId;
pub use key::{KeyKind, NoteKey, VerifierKey};

/// Longest note that is read, in bytes.
pub const NOTE_BYTES_MAX: usize = 16 * 1024;
/// Most signature lines of a note.
pub const SIGNATURES_MAX: usize = 16;
/// Beginning of a signature line: an em dash and a space.
const LINE: &str = "\u{2014} ";

/// A text with signatures that are yet to be verified.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignedNote {
    text: String,
    signatures: Vec<SignatureLine>,
}

/// One line below the text.
#[derive(Debug, Clone, PartialEq, Eq)]
struct SignatureLine {
    name: String,
    key_id: KeyId,
    signature: Vec<u8>,
}

/// A signature that one of the given keys made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VerifiedSignature<'k> {
    pub key: &'k VerifierKey,
    /// Time of a cosignature by the clock of the cosigner, in seconds since 1970.
    pub cosigned_at: Option<u64>,
}

impl SignedNote {
    /// Creates a note without signatures.
    ///
    /// # Errors
    /// [`NoteError::Text`] where the text is none of a note: empty, without a line feed at its end,
    /// or with other control characters.
    pub fn new(text: impl Into<String>) -> Result<Self, NoteError> {
        let text = text.into();
        let is_line = |byte: u8| byte >= b' ' || byte == b'\n';
        if text.len() < 2 || !text.ends_with('\n') || !text.bytes().all(is_line) {
            return Err(NoteError::Text);
        }
        Ok(Self { text, signatures: Vec::new() })
    }

    /// Reads a note: the text, a blank line, signature lines.
    ///
    /// # Errors
    /// [`NoteError`] where it has another form, or is longer than [`NOTE_BYTES_MAX`].
    pub fn parse(note: &str) -> Result<Self, NoteError> {
        if note.len() > NOTE_BYTES_MAX {
            return Err(NoteError::TooLong);
        }
        // The text may have blank lines; the signatures have none.
        let (text, lines) = note.rsplit_once("\n\n").ok_or(NoteError::NoSignatures)?;
        let lines = lines.strip_suffix('\n').ok_or(NoteError::Signature)?;
        let mut parsed = Self::new(format!("{text}\n"))?;
        for line in lines.split('\n') {
            if parsed.signatures.len() == SIGNATURES_MAX {
                return Err(NoteError::TooLong);
            }
            parsed.signatures.push(SignatureLine::parse(line).ok_or(NoteError::Signature)?);
        }
        Ok(parsed)
    }

    /// Returns the text that is signed, with its last line feed.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the number of signature lines, those of unknown keys included.
    #[must_use]
    pub const fn signature_count(&self) -> usize {
        self.signatures.len()
    }

    /// Adds a signature of type 01.
    ///
    /// # Errors
    /// [`NoteError::Kind`] for a key of another kind.
    pub fn sign(&mut self, key: &NoteKey) -> Result<(), NoteError> {
        if key.verifier().kind() != KeyKind::Ed25519 {
            return Err(NoteError::Kind);
        }
        self.add(key, key.sign(self.text.as_bytes()).to_vec());
        Ok(())
    }

    /// Adds a cosignature of this time, in seconds since 1970.
    ///
    /// # Errors
    /// [`NoteError::Kind`] for a key of another kind or a time beyond 2^63 - 1.
    pub fn cosign(&mut self, key: &NoteKey, at: u64) -> Result<(), NoteError> {
        if key.verifier().kind() != KeyKind::CosignatureV1 || i64::try_from(at).is_err() {
            return Err(NoteError::Kind);
        }
        let signature = key.sign(cosigned_text(&self.text, at).as_bytes());
        self.add(key, [&at.to_be_bytes()[..], &signature].concat());
        Ok(())
    }

    /// Adds the signature lines of another note with the same text, once each.
    ///
    /// # Errors
    /// [`NoteError::Text`] where the texts differ.
    pub fn add_signatures_of(&mut self, other: &Self) -> Result<(), NoteError> {
        if self.text != other.text {
            return Err(NoteError::Text);
        }
        for line in &other.signatures {
            if !self.signatures.contains(line) {
                self.signatures.push(line.clone());
            }
        }
        Ok(())
    }

    /// Removes the signature lines of all other names.
    pub fn keep_signatures_of(&mut self, name: &str) {
        self.signatures.retain(|line| line.name == name);
    }

    /// Returns the signatures that these keys made, one per key. Lines of unknown keys are left
    /// alone.
    ///
    /// # Errors
    /// [`NoteError::Forged`] where a line of one of these keys is not its signature,
    /// [`NoteError::Unsigned`] where none of them signed.
    pub fn verify<'k>(
        &self,
        keys: impl IntoIterator<Item = &'k VerifierKey>,
    ) -> Result<Vec<VerifiedSignature<'k>>, NoteError> {
        let mut verified = Vec::new();
        for key in keys {
            let mut found = None;
            for line in self.signatures.iter().filter(|line| line.is_of(key)) {
                let signature = self.verify_line(key, &line.signature).ok_or(NoteError::Forged)?;
                found.get_or_insert(signature);
            }
            verified.extend(found);
        }
        if verified.is_empty() { Err(NoteError::Unsigned) } else { Ok(verified) }
    }

    fn verify_line<'k>(
        &self,
        key: &'k VerifierKey,
        signature: &[u8],
    ) -> Option<VerifiedSignature<'k>> {
        let (is_signed, cosigned_at) = match key.kind() {
            KeyKind::Ed25519 => (key.is_signed(self.text.as_bytes(), signature), None),
            KeyKind::CosignatureV1 => {
                let (time, signature) = signature.split_first_chunk::<8>()?;
                let at = u64::from_be_bytes(*time);
                i64::try_from(at).ok()?;
                (key.is_signed(cosigned_text(&self.text, at).as_bytes(), signature), Some(at))
            }
        };
        is_signed.then_some(VerifiedSignature { key, cosigned_at })
    }

    fn add(&mut self, key: &NoteKey, signature: Vec<u8>) {
        let verifier = key.verifier();
        let (name, key_id) = (verifier.name().to_owned(), verifier.id());
        self.signatures.push(SignatureLine { name, key_id, signature });
    }
}

impl fmt::Display for SignedNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.text)?;
        self.signatures.iter().try_for_each(|line| write!(f, "{line}"))
    }
}

impl SignatureLine {
    fn parse(line: &str) -> Option<Self> {
        let (name, signature) = line.strip_prefix(LINE)?.split_once(' ')?;
        let bytes = STANDARD.decode(signature).ok()?;
        let (key_id, signature) = bytes.split_first_chunk::<4>()?;
        let is_line = key::is_name(name) && !signature.is_empty();
        is_line.then(|| Self {
            name: name.to_owned(),
            key_id: *key_id,
            signature: signature.to_vec(),
        })
    }

    fn is_of(&self, key: &VerifierKey) -> bool {
        self.name == key.name() && self.key_id == key.id()
    }
}

impl fmt::Display for SignatureLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let signature = STANDARD.encode([&self.key_id[..], &self.signature].concat());
        writeln!(f, "{LINE}{} {signature}", self.name)
    }
}

/// Returns the message of a cosignature: C2SP tlog-cosignature, "Format".
fn cosigned_text(text: &str, at: u64) -> String {
    format!("cosignature/v1\ntime {at}\n{text}")
}
