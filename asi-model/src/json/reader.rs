//! Turning text into tokens, without recursion.

use std::{borrow::Cow, collections::HashSet};

use super::{
    error::{JsonError, Limits},
    escapes::{code_unit, unescape},
    token::{Kind, Token},
};

/// Most repeated member names that are remembered.
const DUPLICATES_MAX: usize = 64;

/// U+FEFF in UTF-8. RFC 8259 §8.1 forbids it before JSON, and most receivers refuse it.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

pub(super) struct TapeReader<'a> {
    bytes: &'a [u8],
    at: usize,
    limits: Limits,
    pub(super) tokens: Vec<Token>,
    pub(super) duplicates: Vec<u32>,
    /// The arrays and objects that are not closed yet.
    open: Vec<u32>,
}

impl<'a> TapeReader<'a> {
    pub(super) fn new(bytes: &'a [u8], limits: Limits) -> Self {
        Self {
            bytes,
            at: 0,
            limits,
            tokens: Vec::with_capacity(
                (bytes.len() / 8 + 4).min(limits.tokens_max.saturating_add(1)),
            ),
            duplicates: Vec::new(),
            open: Vec::with_capacity(8),
        }
    }

    pub(super) fn read(&mut self) -> Result<(), JsonError> {
        if self.bytes.starts_with(BYTE_ORDER_MARK) {
            return Err(self.unexpected("a value instead of the byte order mark (U+FEFF)"));
        }
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
        if self.at < self.bytes.len() {
            Err(self.unexpected("the end of the text"))
        } else {
            Ok(())
        }
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
    fn push(
        &mut self,
        kind: Kind,
        escaped: bool,
        start: usize,
        end: usize,
    ) -> Result<(), JsonError> {
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
                    return Err(JsonError::TooDeep {
                        depth_max: self.limits.depth_max,
                        offset: start,
                    });
                }
                self.at += 1;
                let index =
                    u32::try_from(self.tokens.len()).expect("fewer tokens than bytes, which fit");
                self.push(
                    if byte == b'{' { Kind::Object } else { Kind::Array },
                    false,
                    start,
                    start,
                )?;
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
            // Most bytes are plain; a search over the slice is quicker than looking at each through
            // the position.
            let rest = &self.bytes[self.at..];
            let plain = rest
                .iter()
                .position(|byte| matches!(byte, b'"' | b'\\' | 0..0x20))
                .unwrap_or(rest.len());
            self.at += plain;
            match self.peek() {
                Some(b'"') => break,
                Some(b'\\') => {
                    escaped = true;
                    self.escape()?;
                }
                _ => return Err(self.unexpected("a closing quote")),
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
        let is_clean =
            is_plain && count <= FEW && (1..count).all(|index| !few[..index].contains(&few[index]));
        if is_clean {
            return;
        }
        let mut seen: HashSet<Cow<'_, [u8]>> = HashSet::with_capacity(count);
        let mut key = object + 1;
        while key < end {
            let token = self.tokens[key as usize];
            let raw = &self.bytes[token.start as usize..token.end as usize];
            let name = if token.escaped {
                Cow::Owned(unescape(raw).into_bytes())
            } else {
                Cow::Borrowed(raw)
            };
            if !seen.insert(name) && self.duplicates.len() < DUPLICATES_MAX {
                self.duplicates.push(key);
            }
            key = self.tokens[key as usize + 1].next;
        }
    }
}
