//! Checkpoints: size and root of a log at a moment, C2SP tlog-checkpoint 1.0.0.

use std::{fmt, str::FromStr};

use base64::{Engine as _, engine::general_purpose::STANDARD};

use crate::{
    merkle::Hash,
    note::{NoteError, NoteKey, SignedNote},
};

/// Fault of a text that is no checkpoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CheckpointError {
    /// The text has not exactly the lines origin, size and root. Further lines are refused: not
    /// every kind of cosignature covers them.
    #[error("a checkpoint has the lines origin, size and root")]
    Lines,
    /// The size is no decimal number without sign and leading zeros.
    #[error("the size of the checkpoint is no number")]
    Size,
    /// The root is not 32 bytes in base64.
    #[error("the root of the checkpoint is not 32 bytes in base64")]
    Root,
}

/// Size and root of the log with this origin. Its text is the one that is signed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checkpoint {
    /// Name of the log, unique among all logs.
    pub origin: String,
    /// Number of entries.
    pub size: u64,
    /// Root of the tree over them.
    pub root: Hash,
}

impl Checkpoint {
    /// Signs the checkpoint with the key of the log.
    ///
    /// # Errors
    /// [`NoteError`] where the origin has control characters, or the key is not of type 01.
    pub fn sign(&self, key: &NoteKey) -> Result<SignedNote, NoteError> {
        let mut note = SignedNote::new(self.to_string())?;
        note.sign(key)?;
        Ok(note)
    }
}

impl fmt::Display for Checkpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\n{}\n{}\n", self.origin, self.size, STANDARD.encode(self.root))
    }
}

impl FromStr for Checkpoint {
    type Err = CheckpointError;

    fn from_str(text: &str) -> Result<Self, CheckpointError> {
        let text = text.strip_suffix('\n').ok_or(CheckpointError::Lines)?;
        let mut lines = text.split('\n');
        let (Some(origin), Some(size), Some(root), None) =
            (lines.next(), lines.next(), lines.next(), lines.next())
        else {
            return Err(CheckpointError::Lines);
        };
        if origin.is_empty() {
            return Err(CheckpointError::Lines);
        }
        let root = STANDARD.decode(root).ok().and_then(|root| root.try_into().ok());
        Ok(Self {
            origin: origin.to_owned(),
            size: parse_size(size).ok_or(CheckpointError::Size)?,
            root: root.ok_or(CheckpointError::Root)?,
        })
    }
}

/// Reads a size: ASCII decimal digits without leading zeros.
pub(crate) fn parse_size(text: &str) -> Option<u64> {
    let is_canonical =
        text == "0" || (!text.starts_with('0') && text.bytes().all(|byte| byte.is_ascii_digit()));
    is_canonical.then(|| text.parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_one_form_is_read() {
        let root = "47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=";
        let check = |text: &str, expected: Result<u64, CheckpointError>| {
            let parsed = text.parse::<Checkpoint>();
            assert_eq!(parsed.as_ref().map(|found| found.size).map_err(|error| *error), expected);
            if let Ok(parsed) = parsed {
                assert_eq!(parsed.to_string(), text);
            }
        };
        check(&format!("o\n0\n{root}\n"), Ok(0));
        check(&format!("o\n18446744073709551615\n{root}\n"), Ok(u64::MAX));
        for size in ["18446744073709551616", "00", "01", "+1", "-1", " 1", "1 ", "", "0x1"] {
            check(&format!("o\n{size}\n{root}\n"), Err(CheckpointError::Size));
        }
        for lines in ["", "o\n0\n", "\n0\nx\n"] {
            check(lines, Err(CheckpointError::Lines));
        }
        check(&format!("o\n0\n{root}"), Err(CheckpointError::Lines));
        check(&format!("o\n0\n{root}\nextension\n"), Err(CheckpointError::Lines));
        check(&format!("o\n0\n{root}\n\n"), Err(CheckpointError::Lines));
        for root in ["", "AAAA", &root[..43], &root.replace("FU=", "FV="), &format!("{root}\r")] {
            check(&format!("o\n0\n{root}\n"), Err(CheckpointError::Root));
        }
    }
}
