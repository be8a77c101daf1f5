//! Tokens of a JSON text.

/// JSON type of a value, with both booleans apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Null,
    False,
    True,
    Number,
    String,
    Array,
    Object,
}

impl Kind {
    /// The kind as users call it, with article.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::False | Self::True => "a boolean",
            Self::Number => "a number",
            Self::String => "a string",
            Self::Array => "an array",
            Self::Object => "an object",
        }
    }
}

/// One value or member name.
#[derive(Debug, Clone, Copy)]
pub(super) struct Token {
    pub(super) kind: Kind,
    /// A string that contains escapes.
    pub(super) escaped: bool,
    /// The text, of a string without its quotes.
    pub(super) start: u32,
    pub(super) end: u32,
    /// The token after this one and all it contains.
    pub(super) next: u32,
}
