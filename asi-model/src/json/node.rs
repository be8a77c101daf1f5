//! Walking over the values of a text.

use std::borrow::Cow;

use super::{
    escapes::unescape,
    tape::{Kind, Tape, Token},
};

/// A value within a [`Tape`].
#[derive(Debug, Clone, Copy)]
pub struct Node<'t, 'a> {
    tape: &'t Tape<'a>,
    index: u32,
}

impl<'t, 'a> Node<'t, 'a> {
    pub(super) const fn new(tape: &'t Tape<'a>, index: u32) -> Self {
        Self { tape, index }
    }

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
