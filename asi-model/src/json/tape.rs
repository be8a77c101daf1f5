//! The bounded reader.

use super::{node::Node, reader::Reader};

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

/// What kind of value a token is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
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

/// A JSON text with its tokens.
#[derive(Debug)]
pub struct Tape<'a> {
    pub(super) text: &'a str,
    pub(super) tokens: Vec<Token>,
    duplicates: Vec<u32>,
}

/// How many repeated member names are remembered.
pub(super) const DUPLICATES_MAX: usize = 64;

impl<'a> Tape<'a> {
    /// Reads a whole text.
    ///
    /// # Errors
    /// [`JsonError`] where the text breaks a limit or is not JSON (RFC 8259). Repeated member names
    /// are not an error here; see [`Self::duplicates`].
    pub fn read(bytes: &'a [u8], limits: Limits) -> Result<Self, JsonError> {
        let bytes_max = limits.bytes_max.min(u32::MAX as usize);
        if bytes.len() > bytes_max {
            return Err(JsonError::TooLarge { bytes: bytes.len(), bytes_max });
        }
        let text = std::str::from_utf8(bytes)
            .map_err(|error| JsonError::NotUtf8 { offset: error.valid_up_to() })?;
        let mut reader = Reader::new(bytes, limits);
        reader.read()?;
        Ok(Self { text, tokens: reader.tokens, duplicates: reader.duplicates })
    }

    /// The outermost value.
    #[must_use]
    pub fn root(&self) -> Node<'_, 'a> {
        Node::new(self, 0)
    }

    /// Pointers to members whose name occurred before in the same object (the first 64).
    pub fn duplicates(&self) -> impl Iterator<Item = String> + '_ {
        self.duplicates.iter().map(|key| self.pointer(*key))
    }

    /// True where some object has a member name twice.
    #[must_use]
    pub fn has_duplicates(&self) -> bool {
        !self.duplicates.is_empty()
    }

    /// The JSON pointer (RFC 6901) of the value, or of the member whose name it is, at a token.
    pub(super) fn pointer(&self, wanted: u32) -> String {
        let mut pointer = String::new();
        let mut index = 0;
        while index != wanted {
            let parent = &self.tokens[index as usize];
            let mut child = index + 1;
            let mut position = 0;
            match parent.kind {
                Kind::Array => {
                    while self.tokens[child as usize].next <= wanted {
                        child = self.tokens[child as usize].next;
                        position += 1;
                    }
                    pointer.push_str(&format!("/{position}"));
                    index = child;
                }
                Kind::Object => {
                    while self.tokens[child as usize + 1].next <= wanted {
                        child = self.tokens[child as usize + 1].next;
                    }
                    push_pointer(&mut pointer, &Node::new(self, child).text().unwrap_or_default());
                    if wanted == child {
                        break;
                    }
                    index = child + 1;
                }
                _ => break,
            }
        }
        pointer
    }
}

/// Longest part of a JSON pointer that is written in full, in characters.
const POINTER_PART_MAX: usize = 128;

/// Appends a member name to a JSON pointer, escaped as RFC 6901 says; overlong names are cut with
/// `…`.
fn push_pointer(pointer: &mut String, name: &str) {
    pointer.push('/');
    for (count, c) in name.chars().enumerate() {
        if count == POINTER_PART_MAX {
            pointer.push('…');
            break;
        }
        match c {
            '~' => pointer.push_str("~0"),
            '/' => pointer.push_str("~1"),
            c => pointer.push(c),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { bytes_max: 1 << 20, depth_max: 10, tokens_max: 1000 };

    fn read(text: &str) -> Result<Tape<'_>, JsonError> {
        Tape::read(text.as_bytes(), LIMITS)
    }

    #[test]
    fn takes_exactly_what_serde_json_takes() {
        for text in [
            "",
            " ",
            "{}",
            "[]",
            "null",
            "tru",
            "true",
            "-",
            "-0",
            "01",
            "1.",
            "1.5e+3",
            "1e",
            "[1,]",
            "[,1]",
            "{\"a\"}",
            "{\"a\":1,}",
            "{\"a\":1 \"b\":2}",
            "[1 2]",
            "\"a",
            "\"\\x\"",
            "\"\\ud800\"",
            "\"\\ud83d\\ude00\"",
            "\"\\udc00\"",
            "\"\u{1}\"",
            "{\"a\":[1,{\"b\":null}],\"c\":\"d\\n\"}",
            "[1] 2",
            "]",
            "}",
            "[}",
            "{]",
            "nullx",
            "\"\\u12\"",
            "1 ",
            "{,}",
            "[[]",
            "{\"a\":}",
            "{1:2}",
            "\u{feff}1",
        ] {
            let theirs = serde_json::from_str::<serde_json::Value>(text);
            let ours = read(text);
            assert_eq!(ours.is_ok(), theirs.is_ok(), "{text:?}: {ours:?}");
        }
    }

    #[test]
    fn values_are_reached() {
        let tape = read(r#"{"a":[1,{"b~/":"x\u00e9\n"}],"c":-12,"d":{}}"#).expect("JSON");
        let root = tape.root();
        let inner = root.get("a").and_then(|a| a.elements().nth(1)).expect("there");
        let text = inner.get("b~/").expect("there");
        assert_eq!(text.text().as_deref(), Some("xé\n"));
        assert_eq!(text.pointer(), "/a/1/b~0~1");
        assert_eq!(root.get("c").and_then(Node::integer::<i64>), Some(-12));
        assert_eq!(root.get("c").and_then(Node::integer::<u64>), None);
        assert_eq!(root.get("d").map(|d| (d.raw(), d.members().count())), Some(("{}", 0)));
        assert_eq!(root.members().count(), 3);
        assert_eq!(root.pointer(), "");
    }

    #[test]
    fn limits_hold() {
        assert!(matches!(read(&"[".repeat(11)), Err(JsonError::TooDeep { offset: 10, .. })));
        assert!(matches!(
            read(&format!("[{}1]", "1,".repeat(1000))),
            Err(JsonError::TooManyValues { .. })
        ));
        assert!(matches!(Tape::read(&[b'1'; 1 << 21], LIMITS), Err(JsonError::TooLarge { .. })));
        assert_eq!(Tape::read(b"\"\xff\"", LIMITS).err(), Some(JsonError::NotUtf8 { offset: 1 }));
    }

    #[test]
    fn repeated_names_are_found() {
        let many: Vec<String> = (0..20).map(|n| format!("\"k{n}\":0")).collect();
        for (text, expected) in [
            (r#"{"a":1,"b":2}"#.to_owned(), vec![]),
            (
                r#"{"a":1,"b":{"x":[0,{"c":1,"\u0063":2}]},"a":3}"#.to_owned(),
                vec!["/b/x/1/c", "/a"],
            ),
            (format!("{{{},\"k7\":1}}", many.join(",")), vec!["/k7"]),
        ] {
            assert_eq!(read(&text).expect("JSON").duplicates().collect::<Vec<_>>(), expected);
        }
    }
}
