//! Walking over the values of a text.

use std::borrow::Cow;

use super::{
    tape::Tape,
    token::{Kind, Token},
};

/// A value within a [`Tape`].
#[derive(Debug, Clone, Copy)]
pub struct JsonNode<'t, 'a> {
    tape: &'t Tape<'a>,
    index: u32,
}

impl<'a> Tape<'a> {
    /// Returns the outermost value of the document.
    #[must_use]
    pub fn root(&self) -> JsonNode<'_, 'a> {
        JsonNode { tape: self, index: 0 }
    }
}

impl<'t, 'a> JsonNode<'t, 'a> {
    fn token(self) -> Token {
        self.tape.token(self.index)
    }

    /// Returns the JSON type of the value.
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
        self.tape.raw(self.index)
    }

    /// Position of the value in the text, in bytes.
    #[must_use]
    pub fn offset(self) -> usize {
        let token = self.token();
        (token.start - u32::from(token.kind == Kind::String)) as usize
    }

    /// The content of a string.
    #[must_use]
    pub fn text(self) -> Option<Cow<'a, str>> {
        self.tape.string(self.index)
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

    /// The name of a member of an object that differs from a name in nothing but capitals.
    #[must_use]
    pub fn misspelt(self, name: &str) -> Option<Cow<'a, str>> {
        let is_alike = |found: &Cow<'a, str>| *found != name && found.eq_ignore_ascii_case(name);
        self.members().filter_map(|(found, _)| found.text()).find(is_alike)
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
        self.tape.string(self.index).is_some_and(|found| found == text)
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
    type Item = (JsonNode<'t, 'a>, JsonNode<'t, 'a>);

    fn next(&mut self) -> Option<Self::Item> {
        if self.at >= self.end {
            return None;
        }
        let (key, value) = (self.at, self.at + 1);
        self.at = self.tape.token(value).next;
        Some((JsonNode { tape: self.tape, index: key }, JsonNode { tape: self.tape, index: value }))
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
    type Item = JsonNode<'t, 'a>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.at >= self.end {
            return None;
        }
        let index = self.at;
        self.at = self.tape.token(index).next;
        Some(JsonNode { tape: self.tape, index })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::json::Limits;

    const LIMITS: Limits = Limits { bytes_max: 1 << 20, depth_max: 10, tokens_max: 1000 };

    #[test]
    fn values_are_reached() {
        let text = r#"{"a":[1,{"b~/":"x\u00e9\n"}],"c":-12,"d":{}}"#;
        let tape = Tape::read(text.as_bytes(), LIMITS).expect("JSON");
        let root = tape.root();
        let inner = root.get("a").and_then(|a| a.elements().nth(1)).expect("there");
        let text = inner.get("b~/").expect("there");
        assert_eq!(text.text().as_deref(), Some("xé\n"));
        assert_eq!(text.pointer(), "/a/1/b~0~1");
        assert_eq!(root.get("c").and_then(JsonNode::integer::<i64>), Some(-12));
        assert_eq!(root.get("c").and_then(JsonNode::integer::<u64>), None);
        assert_eq!(root.get("d").map(|d| (d.raw(), d.members().count())), Some(("{}", 0)));
        assert_eq!(root.members().count(), 3);
        assert_eq!(root.pointer(), "");
    }
}
