//! Bounds on a JSON text, and the reasons to refuse one.

/// Bounds on a JSON text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Longest text, in bytes.
    pub bytes_max: usize,
    /// Deepest nesting of arrays and objects.
    pub depth_max: usize,
    /// Most values and member names together.
    pub tokens_max: usize,
}

/// Error for a text that breaks a bound or is not JSON.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum JsonError {
    /// The text is longer than the bound.
    #[error("the text has {bytes} bytes, but at most {bytes_max} are accepted")]
    TooLarge { bytes: usize, bytes_max: usize },
    /// A byte sequence is not UTF-8.
    #[error("the text is not UTF-8 from byte {offset} on")]
    NotUtf8 {
        /// The first wrong byte.
        offset: usize,
    },
    #[error("arrays and objects are nested deeper than {depth_max} at byte {offset}")]
    TooDeep {
        depth_max: usize,
        /// Position of the array or object that is too deep, in bytes.
        offset: usize,
    },
    #[error("the text has more than {tokens_max} values and names")]
    TooManyValues { tokens_max: usize },
    /// The syntax breaks RFC 8259.
    #[error("expected {expected} at byte {offset}")]
    Unexpected {
        /// Name of the token that may stand there.
        expected: &'static str,
        /// Position of the first wrong byte.
        offset: usize,
    },
}
