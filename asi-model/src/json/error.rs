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

/// Why a text is not JSON we take.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum JsonError {
    /// Too long.
    #[error("the text has {bytes} bytes, but at most {bytes_max} are accepted")]
    TooLarge {
        /// How long it is.
        bytes: usize,
        /// How long it may be.
        bytes_max: usize,
    },
    /// Not UTF-8.
    #[error("the text is not UTF-8 from byte {offset} on")]
    NotUtf8 {
        /// The first wrong byte.
        offset: usize,
    },
    /// Nested too deeply.
    #[error("arrays and objects are nested deeper than {depth_max} at byte {offset}")]
    TooDeep {
        /// How deep they may be.
        depth_max: usize,
        /// Where it is exceeded.
        offset: usize,
    },
    /// Too many values.
    #[error("the text has more than {tokens_max} values and names")]
    TooManyValues {
        /// How many it may have.
        tokens_max: usize,
    },
    /// Not JSON.
    #[error("expected {expected} at byte {offset}")]
    Unexpected {
        /// What would be right.
        expected: &'static str,
        /// Where it is wrong.
        offset: usize,
    },
}
