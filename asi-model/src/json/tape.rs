//! The bounded reader.

use std::borrow::Cow;

use super::{
    error::{JsonError, Limits},
    escapes::unescape,
    reader::TapeReader,
    token::{Kind, Token},
};

/// A JSON text with its tokens.
#[derive(Debug)]
pub struct Tape<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    duplicates: Vec<u32>,
}

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
        let mut reader = TapeReader::new(bytes, limits);
        reader.read()?;
        Ok(Self { text, tokens: reader.tokens, duplicates: reader.duplicates })
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

    pub(super) fn token(&self, index: u32) -> Token {
        self.tokens[index as usize]
    }

    /// The JSON text of the value at a token, a string with its quotes.
    pub(super) fn raw(&self, index: u32) -> &'a str {
        let Token { kind, start, end, .. } = self.token(index);
        let quote = u32::from(kind == Kind::String);
        &self.text[(start - quote) as usize..(end + quote) as usize]
    }

    /// The content of the string at a token, escapes resolved; `None` for other kinds.
    pub(super) fn string(&self, index: u32) -> Option<Cow<'a, str>> {
        let Token { kind, escaped, start, end, .. } = self.token(index);
        if kind != Kind::String {
            return None;
        }
        let raw = &self.text[start as usize..end as usize];
        Some(if escaped { Cow::Owned(unescape(raw.as_bytes())) } else { Cow::Borrowed(raw) })
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
                    push_pointer(&mut pointer, &self.string(child).unwrap_or_default());
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

/// Appends a member name to a JSON pointer, escaped by RFC 6901; overlong names are cut with
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
    fn a_byte_order_mark_is_named() {
        let error = read("\u{feff}{}").expect_err("refused").to_string();
        assert_eq!(error, "expected a value instead of the byte order mark (U+FEFF) at byte 0");
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
