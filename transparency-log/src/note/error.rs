//! Faults of notes and of their keys.

/// Fault of a note.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoteError {
    /// The text is empty, does not end with a line feed, or has other control characters.
    #[error("this is no text of a note")]
    Text,
    /// No blank line with signatures after it.
    #[error("the note has no signatures")]
    NoSignatures,
    /// A line after the text is no signature.
    #[error("a signature line of the note cannot be read")]
    Signature,
    /// The note is longer, or has more signatures, than is read.
    #[error("the note is too long")]
    TooLong,
    /// None of the known keys signed.
    #[error("no known key signed the note")]
    Unsigned,
    /// A line that names a known key is not its signature.
    #[error("a signature of the note is not that of the key it names")]
    Forged,
    /// The key is not one for this kind of signature.
    #[error("the key does not make signatures of this kind")]
    Kind,
}

/// Fault of a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum KeyError {
    /// The text is not `name+id+key`.
    #[error("a key has the form name+id+key")]
    Form,
    /// The name is empty, or has spaces or a `+`.
    #[error("the name of a key has neither spaces nor a plus sign")]
    Name,
    /// The id does not belong to name and key.
    #[error("the id of the key is not that of its name and bytes")]
    Id,
    /// The kind of signature is not supported.
    #[error("the kind of the key is not supported")]
    Kind,
    /// The bytes are no Ed25519 key, or one that signs anything.
    #[error("the key is no safe Ed25519 key")]
    Key,
}
