//! The bounded reader.

use std::{borrow::Cow, collections::HashSet};

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

#[derive(Debug, Clone, Copy)]
struct Token {
    kind: Kind,
    /// A string that contains escapes.
    escaped: bool,
    /// The text, of a string without its quotes.
    start: u32,
    end: u32,
    /// The token after this one and all it contains.
    next: u32,
}

/// A JSON text with its tokens.
#[derive(Debug)]
pub struct Tape<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    duplicates: Vec<u32>,
}

/// How many repeated member names are remembered.
const DUPLICATES_MAX: usize = 64;

impl<'a> Tape<'a> {
    /// Reads a whole text.
    ///
    /// # Errors
    /// [`JsonError`] where the text breaks a limit or is not JSON (RFC 8259). Repeated member names are not an error
    /// here; see [`Self::duplicates`].
    pub fn read(bytes: &'a [u8], limits: Limits) -> Result<Self, JsonError> {
        let bytes_max = limits.bytes_max.min(u32::MAX as usize);
        if bytes.len() > bytes_max {
            return Err(JsonError::TooLarge { bytes: bytes.len(), bytes_max });
        }
        let text = std::str::from_utf8(bytes).map_err(|error| JsonError::NotUtf8 { offset: error.valid_up_to() })?;
        let mut reader = Reader {
            bytes,
            at: 0,
            limits,
            tokens: Vec::with_capacity((bytes.len() / 8 + 4).min(limits.tokens_max.saturating_add(1))),
            duplicates: Vec::new(),
            open: Vec::with_capacity(8),
        };
        reader.read()?;
        Ok(Self { text, tokens: reader.tokens, duplicates: reader.duplicates })
    }

    /// The outermost value.
    #[must_use]
    pub fn root(&self) -> Node<'_, 'a> {
        Node { tape: self, index: 0 }
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
    fn pointer(&self, wanted: u32) -> String {
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
                    push_pointer(&mut pointer, &Node { tape: self, index: child }.text().unwrap_or_default());
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

/// Appends a member name to a JSON pointer, escaped as RFC 6901 says; overlong names are cut with `…`.
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

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    limits: Limits,
    tokens: Vec<Token>,
    duplicates: Vec<u32>,
    /// The arrays and objects that are not closed yet.
    open: Vec<u32>,
}

impl Reader<'_> {
    fn read(&mut self) -> Result<(), JsonError> {
        self.skip_blanks();
        self.value()?;
        while let Some(&container) = self.open.last() {
            self.skip_blanks();
            let is_object = self.tokens[container as usize].kind == Kind::Object;
            let is_first = self.tokens.len() == container as usize + 1;
            let close = if is_object { b'}' } else { b']' };
            match self.peek() {
                Some(byte) if byte == close => {
                    self.at += 1;
                    self.close(container);
                    continue;
                }
                Some(b',') if !is_first => {
                    self.at += 1;
                    self.skip_blanks();
                }
                _ if is_first => {}
                _ if is_object => return Err(self.unexpected("`,` or `}`")),
                _ => return Err(self.unexpected("`,` or `]`")),
            }
            if is_object {
                if self.peek() != Some(b'"') {
                    return Err(self.unexpected("a member name in quotes"));
                }
                self.string()?;
                self.skip_blanks();
                if self.peek() != Some(b':') {
                    return Err(self.unexpected("`:`"));
                }
                self.at += 1;
                self.skip_blanks();
            }
            self.value()?;
        }
        self.skip_blanks();
        if self.at < self.bytes.len() { Err(self.unexpected("the end of the text")) } else { Ok(()) }
    }

    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn unexpected(&self, expected: &'static str) -> JsonError {
        JsonError::Unexpected { expected, offset: self.at }
    }

    fn skip_blanks(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\n' | b'\r' | b'\t')) {
            self.at += 1;
        }
    }

    #[allow(clippy::cast_possible_truncation)] // The length is checked against u32 at the start.
    fn push(&mut self, kind: Kind, escaped: bool, start: usize, end: usize) -> Result<(), JsonError> {
        if self.tokens.len() >= self.limits.tokens_max {
            return Err(JsonError::TooManyValues { tokens_max: self.limits.tokens_max });
        }
        let next = self.tokens.len() as u32 + 1;
        self.tokens.push(Token { kind, escaped, start: start as u32, end: end as u32, next });
        Ok(())
    }

    fn value(&mut self) -> Result<(), JsonError> {
        let start = self.at;
        match self.peek() {
            Some(b'"') => self.string(),
            Some(byte @ (b'{' | b'[')) => {
                if self.open.len() >= self.limits.depth_max {
                    return Err(JsonError::TooDeep { depth_max: self.limits.depth_max, offset: start });
                }
                self.at += 1;
                let index = u32::try_from(self.tokens.len()).expect("fewer tokens than bytes, which fit");
                self.push(if byte == b'{' { Kind::Object } else { Kind::Array }, false, start, start)?;
                self.open.push(index);
                Ok(())
            }
            Some(b'-' | b'0'..=b'9') => self.number(),
            Some(b't') => self.word("true", Kind::True),
            Some(b'f') => self.word("false", Kind::False),
            Some(b'n') => self.word("null", Kind::Null),
            _ => Err(self.unexpected("a value")),
        }
    }

    fn word(&mut self, word: &str, kind: Kind) -> Result<(), JsonError> {
        if !self.bytes[self.at..].starts_with(word.as_bytes()) {
            return Err(self.unexpected("a value"));
        }
        let start = self.at;
        self.at += word.len();
        self.push(kind, false, start, self.at)
    }

    fn digits(&mut self) -> Result<(), JsonError> {
        let start = self.at;
        while matches!(self.peek(), Some(b'0'..=b'9')) {
            self.at += 1;
        }
        if self.at == start { Err(self.unexpected("a digit")) } else { Ok(()) }
    }

    fn number(&mut self) -> Result<(), JsonError> {
        let start = self.at;
        if self.peek() == Some(b'-') {
            self.at += 1;
        }
        if self.peek() == Some(b'0') {
            self.at += 1;
        } else {
            self.digits()?;
        }
        if self.peek() == Some(b'.') {
            self.at += 1;
            self.digits()?;
        }
        if matches!(self.peek(), Some(b'e' | b'E')) {
            self.at += 1;
            if matches!(self.peek(), Some(b'+' | b'-')) {
                self.at += 1;
            }
            self.digits()?;
        }
        self.push(Kind::Number, false, start, self.at)
    }

    fn string(&mut self) -> Result<(), JsonError> {
        self.at += 1;
        let start = self.at;
        let mut escaped = false;
        loop {
            match self.peek() {
                Some(b'"') => break,
                Some(b'\\') => {
                    escaped = true;
                    self.escape()?;
                }
                Some(0..0x20) | None => return Err(self.unexpected("a closing quote")),
                Some(_) => self.at += 1,
            }
        }
        let end = self.at;
        self.at += 1;
        self.push(Kind::String, escaped, start, end)
    }

    fn escape(&mut self) -> Result<(), JsonError> {
        match self.bytes.get(self.at + 1) {
            Some(b'"' | b'\\' | b'/' | b'b' | b'f' | b'n' | b'r' | b't') => {
                self.at += 2;
                Ok(())
            }
            Some(b'u') => match code_unit(self.bytes, self.at) {
                Some(0xD800..0xDC00) => match code_unit(self.bytes, self.at + 6) {
                    Some(0xDC00..0xE000) => {
                        self.at += 12;
                        Ok(())
                    }
                    _ => Err(self.unexpected("a pair of surrogates")),
                },
                Some(0xDC00..0xE000) => Err(self.unexpected("a pair of surrogates")),
                Some(_) => {
                    self.at += 6;
                    Ok(())
                }
                None => Err(self.unexpected("four hexadecimal digits")),
            },
            _ => Err(self.unexpected("a known escape")),
        }
    }

    fn close(&mut self, container: u32) {
        self.open.pop();
        let next = u32::try_from(self.tokens.len()).expect("fewer tokens than bytes, which fit");
        let end = u32::try_from(self.at).expect("the length is checked against u32 at the start");
        let token = &mut self.tokens[container as usize];
        token.next = next;
        token.end = end;
        if token.kind == Kind::Object {
            self.find_duplicates(container, next);
        }
    }

    fn find_duplicates(&mut self, object: u32, end: u32) {
        /// Up to this many members, comparing each with each is quicker than hashing.
        const FEW: usize = 8;
        let mut few: [&[u8]; FEW] = [&[]; FEW];
        let (mut count, mut is_plain) = (0, true);
        let mut key = object + 1;
        while key < end {
            let token = self.tokens[key as usize];
            if count < FEW {
                few[count] = &self.bytes[token.start as usize..token.end as usize];
            }
            is_plain &= !token.escaped;
            count += 1;
            key = self.tokens[key as usize + 1].next;
        }
        let is_clean = is_plain && count <= FEW && (1..count).all(|index| !few[..index].contains(&few[index]));
        if is_clean {
            return;
        }
        let mut seen: HashSet<Cow<'_, [u8]>> = HashSet::with_capacity(count);
        let mut key = object + 1;
        while key < end {
            let token = self.tokens[key as usize];
            let raw = &self.bytes[token.start as usize..token.end as usize];
            let name = if token.escaped { Cow::Owned(unescape(raw).into_bytes()) } else { Cow::Borrowed(raw) };
            if !seen.insert(name) && self.duplicates.len() < DUPLICATES_MAX {
                self.duplicates.push(key);
            }
            key = self.tokens[key as usize + 1].next;
        }
    }
}

/// The UTF-16 code unit of an escape `\uXXXX` at a position.
fn code_unit(bytes: &[u8], at: usize) -> Option<u16> {
    let digits = bytes.get(at..at + 6)?.strip_prefix(b"\\u")?;
    digits.iter().try_fold(0_u16, |value, digit| {
        let digit = char::from(*digit).to_digit(16)?;
        Some(value << 4 | u16::try_from(digit).ok()?)
    })
}

/// Resolves the escapes of a string that was checked.
fn unescape(raw: &[u8]) -> String {
    let mut out = Vec::with_capacity(raw.len());
    let mut at = 0;
    while at < raw.len() {
        if raw[at] != b'\\' {
            out.push(raw[at]);
            at += 1;
            continue;
        }
        let simple = match raw[at + 1] {
            b'b' => Some(8),
            b'f' => Some(12),
            b'n' => Some(b'\n'),
            b'r' => Some(b'\r'),
            b't' => Some(b'\t'),
            b'u' => None,
            other => Some(other),
        };
        if let Some(byte) = simple {
            out.push(byte);
            at += 2;
            continue;
        }
        let first = u32::from(code_unit(raw, at).unwrap_or(0xFFFD));
        at += 6;
        let code = if (0xD800..0xDC00).contains(&first) {
            let second = u32::from(code_unit(raw, at).unwrap_or(0xDC00));
            at += 6;
            0x1_0000 + ((first - 0xD800) << 10) + (second - 0xDC00)
        } else {
            first
        };
        let c = char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER);
        out.extend_from_slice(c.encode_utf8(&mut [0; 4]).as_bytes());
    }
    String::from_utf8(out).expect("a checked string stays UTF-8 when its escapes are resolved")
}

/// A value within a [`Tape`].
#[derive(Debug, Clone, Copy)]
pub struct Node<'t, 'a> {
    tape: &'t Tape<'a>,
    index: u32,
}

impl<'t, 'a> Node<'t, 'a> {
    fn token(self) -> Token {
        self.tape.tokens[self.index as usize]
    }

    /// What kind of value it is.
    #[must_use]
    pub fn kind(self) -> Kind {
        self.token().kind
    }

    /// True for `null`.
    #[must_use]
    pub fn is_null(self) -> bool {
        self.kind() == Kind::Null
    }

    /// The JSON text of the value, as it came.
    #[must_use]
    pub fn raw(self) -> &'a str {
        let token = self.token();
        let quote = u32::from(token.kind == Kind::String);
        &self.tape.text[(token.start - quote) as usize..(token.end + quote) as usize]
    }

    /// Where the value begins in the text, in bytes.
    #[must_use]
    pub fn offset(self) -> usize {
        let token = self.token();
        (token.start - u32::from(token.kind == Kind::String)) as usize
    }

    /// The content of a string.
    #[must_use]
    pub fn text(self) -> Option<Cow<'a, str>> {
        let token = self.token();
        if token.kind != Kind::String {
            return None;
        }
        let raw = &self.tape.text[token.start as usize..token.end as usize];
        Some(if token.escaped { Cow::Owned(unescape(raw.as_bytes())) } else { Cow::Borrowed(raw) })
    }

    /// The digits of a number, as they came.
    #[must_use]
    pub fn number(self) -> Option<&'a str> {
        (self.kind() == Kind::Number).then(|| self.raw())
    }

    /// The value of a boolean.
    #[must_use]
    pub fn boolean(self) -> Option<bool> {
        match self.kind() {
            Kind::True => Some(true),
            Kind::False => Some(false),
            _ => None,
        }
    }

    /// A number without fraction and exponent that fits.
    #[must_use]
    pub fn integer<T: std::str::FromStr>(self) -> Option<T> {
        self.number()?.parse().ok()
    }

    /// The members of an object; none for other kinds.
    #[must_use]
    pub fn members(self) -> Members<'t, 'a> {
        let end = if self.kind() == Kind::Object { self.token().next } else { self.index + 1 };
        Members { tape: self.tape, at: self.index + 1, end }
    }

    /// The elements of an array; none for other kinds.
    #[must_use]
    pub fn elements(self) -> Elements<'t, 'a> {
        let end = if self.kind() == Kind::Array { self.token().next } else { self.index + 1 };
        Elements { tape: self.tape, at: self.index + 1, end }
    }

    /// The first member with a name.
    #[must_use]
    pub fn get(self, name: &str) -> Option<Self> {
        self.members().find(|(key, _)| key.is_text(name)).map(|(_, value)| value)
    }

    /// True for a string with this content.
    #[must_use]
    pub fn is_text(self, text: &str) -> bool {
        let token = self.token();
        if token.kind != Kind::String {
            return false;
        }
        let raw = &self.tape.text[token.start as usize..token.end as usize];
        if token.escaped { unescape(raw.as_bytes()) == text } else { raw == text }
    }

    /// The JSON pointer of the value.
    #[must_use]
    pub fn pointer(self) -> String {
        self.tape.pointer(self.index)
    }
}

/// The members of an object: name (a string node) and value.
#[derive(Debug, Clone)]
pub struct Members<'t, 'a> {
    tape: &'t Tape<'a>,
    at: u32,
    end: u32,
}

impl<'t, 'a> Iterator for Members<'t, 'a> {
    type Item = (Node<'t, 'a>, Node<'t, 'a>);

    fn next(&mut self) -> Option<Self::Item> {
        if self.at >= self.end {
            return None;
        }
        let (key, value) = (self.at, self.at + 1);
        self.at = self.tape.tokens[value as usize].next;
        Some((Node { tape: self.tape, index: key }, Node { tape: self.tape, index: value }))
    }
}

/// The elements of an array.
#[derive(Debug, Clone)]
pub struct Elements<'t, 'a> {
    tape: &'t Tape<'a>,
    at: u32,
    end: u32,
}

impl<'t, 'a> Iterator for Elements<'t, 'a> {
    type Item = Node<'t, 'a>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.at >= self.end {
            return None;
        }
        let index = self.at;
        self.at = self.tape.tokens[index as usize].next;
        Some(Node { tape: self.tape, index })
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
        assert!(matches!(read(&format!("[{}1]", "1,".repeat(1000))), Err(JsonError::TooManyValues { .. })));
        assert!(matches!(Tape::read(&[b'1'; 1 << 21], LIMITS), Err(JsonError::TooLarge { .. })));
        assert_eq!(Tape::read(b"\"\xff\"", LIMITS).err(), Some(JsonError::NotUtf8 { offset: 1 }));
    }

    #[test]
    fn repeated_names_are_found() {
        let many: Vec<String> = (0..20).map(|n| format!("\"k{n}\":0")).collect();
        for (text, expected) in [
            (r#"{"a":1,"b":2}"#.to_owned(), vec![]),
            (r#"{"a":1,"b":{"x":[0,{"c":1,"\u0063":2}]},"a":3}"#.to_owned(), vec!["/b/x/1/c", "/a"]),
            (format!("{{{},\"k7\":1}}", many.join(",")), vec!["/k7"]),
        ] {
            assert_eq!(read(&text).expect("JSON").duplicates().collect::<Vec<_>>(), expected);
        }
    }
}
