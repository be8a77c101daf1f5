//! Reading members of JSON objects into types, noting every fault and going on.
//!
//! A placeholder takes the position of an identifier or of a whole list element that cannot be read,
//! so that the rest is checked all the same, at the positions of the text; a message with faults
//! never leaves the validation.

use std::str::FromStr;

use super::{FaultCode, NAME_CHARS_MAX, TEXT_CHARS_MAX, faults::Faults};
use crate::{
    ids::{ID_BYTES_MAX, InvalidId, is_noncharacter},
    json::{JsonNode, Kind},
    messages::MESSAGE_BYTES_MAX,
    values::DateTime,
};

/// Beginning of placeholders, before their number.
const PLACEHOLDER: &str = "unreadable-";

/// The faults so far, and what could not be read at all.
#[derive(Debug, Default)]
pub(super) struct Reader {
    pub(super) faults: Faults,
    /// True where the message is read from a text, whose members are judged where they stand.
    pub(super) has_text: bool,
    /// True where operations could not be read, or not their identifiers: others may mean them.
    pub(super) has_unreadable_operations: bool,
    /// Number of identifiers with placeholders.
    unreadable_ids: usize,
}

impl Reader {
    /// A reader of a message that comes as text.
    pub(super) fn of_text() -> Self {
        Self { has_text: true, ..Self::default() }
    }

    /// Notes a fault at a node.
    pub(super) fn fault(
        &mut self,
        node: JsonNode<'_, '_>,
        code: FaultCode,
        message: impl Into<String>,
    ) {
        // A pointer costs a walk from the root; a full list needs no more.
        if self.faults.is_full() {
            self.faults.count_unlisted();
        } else {
            self.faults.push(node.pointer(), code, message);
        }
    }

    fn wrong_type<T>(&mut self, node: JsonNode<'_, '_>, wanted: &str) -> Option<T> {
        self.fault(
            node,
            FaultCode::WrongType,
            format!("Expected {wanted}, but found {}.", node.kind().name()),
        );
        None
    }

    /// True for an object; else a fault.
    pub(super) fn is_object(&mut self, node: JsonNode<'_, '_>, what: &str) -> bool {
        let is_object = node.kind() == Kind::Object;
        if !is_object {
            self.fault(
                node,
                FaultCode::WrongType,
                format!("{what} must be an object, but is {}.", node.kind().name()),
            );
        }
        is_object
    }

    /// A member that must be there.
    pub(super) fn required<'t, 'a, T>(
        &mut self,
        object: JsonNode<'t, 'a>,
        name: &str,
        read: impl FnOnce(&mut Self, JsonNode<'t, 'a>) -> Option<T>,
    ) -> Option<T> {
        match object.get(name).filter(|node| !node.is_null()) {
            Some(node) => read(self, node),
            None if self.faults.is_full() => {
                self.faults.count_unlisted();
                None
            }
            None => {
                let pointer = format!("{}/{name}", object.pointer());
                let message = match object.misspelt(name) {
                    Some(found) => format!(
                        "The member {name} is missing; {found} differs from it in capitals."
                    ),
                    None => format!("The member {name} is missing."),
                };
                self.faults.push(pointer, FaultCode::MissingMember, message);
                None
            }
        }
    }

    /// A member that may be absent or null.
    pub(super) fn optional<'t, 'a, T>(
        &mut self,
        object: JsonNode<'t, 'a>,
        name: &str,
        read: impl FnOnce(&mut Self, JsonNode<'t, 'a>) -> Option<T>,
    ) -> Option<T> {
        object.get(name).filter(|node| !node.is_null()).and_then(|node| read(self, node))
    }

    /// The elements of a list that must be there, each read; unreadable ones are left out.
    pub(super) fn list<'t, 'a, T>(
        &mut self,
        object: JsonNode<'t, 'a>,
        name: &str,
        count_max: usize,
        mut read: impl FnMut(&mut Self, JsonNode<'t, 'a>) -> Option<T>,
    ) -> Vec<T> {
        let list =
            self.required(object, name, |reader, node| reader.elements(node, count_max, &mut read));
        list.unwrap_or_default()
    }

    /// Reads like [`Self::list`], of a list that may be absent.
    pub(super) fn optional_list<'t, 'a, T>(
        &mut self,
        object: JsonNode<'t, 'a>,
        name: &str,
        count_max: usize,
        mut read: impl FnMut(&mut Self, JsonNode<'t, 'a>) -> Option<T>,
    ) -> Vec<T> {
        let list =
            self.optional(object, name, |reader, node| reader.elements(node, count_max, &mut read));
        list.unwrap_or_default()
    }

    fn elements<'t, 'a, T>(
        &mut self,
        node: JsonNode<'t, 'a>,
        count_max: usize,
        read: &mut impl FnMut(&mut Self, JsonNode<'t, 'a>) -> Option<T>,
    ) -> Option<Vec<T>> {
        if node.kind() != Kind::Array {
            return self.wrong_type(node, "an array");
        }
        if node.elements().count() > count_max {
            self.fault(
                node,
                FaultCode::TooManyElements,
                format!("The list may have at most {count_max} elements."),
            );
            return None;
        }
        Some(node.elements().filter_map(|element| read(self, element)).collect())
    }

    /// Reads an identifier; notes a fault and returns `None` where it is none.
    pub(super) fn id<T: FromStr<Err = InvalidId>>(&mut self, node: JsonNode<'_, '_>) -> Option<T> {
        let Some(text) = node.text() else {
            return self.wrong_type(node, "an identifier as a string");
        };
        match text.parse() {
            Ok(id) => Some(id),
            Err(InvalidId { kind, pattern, .. }) => {
                // A pattern counts characters, the bound bytes.
                let message = match text.len() {
                    length if length > ID_BYTES_MAX => {
                        format!(
                            "This is not {kind}: it has {length} bytes in UTF-8; \
                             at most {ID_BYTES_MAX} are accepted."
                        )
                    }
                    _ => format!("This is not {kind}: it must match {pattern}."),
                };
                self.fault(node, FaultCode::InvalidId, message);
                None
            }
        }
    }

    /// An identifier that must be there, or a placeholder after the fault.
    pub(super) fn required_id<T: FromStr<Err = InvalidId>>(
        &mut self,
        object: JsonNode<'_, '_>,
        name: &str,
    ) -> T {
        match self.required(object, name, |reader, node| reader.id(node)) {
            Some(id) => id,
            None => self.placeholder(),
        }
    }

    /// An identifier that takes the position of one that cannot be read.
    pub(super) fn placeholder<T: FromStr<Err = InvalidId>>(&mut self) -> T {
        self.unreadable_ids += 1;
        format!("{PLACEHOLDER}{}", self.unreadable_ids)
            .parse()
            .expect("the placeholder matches the patterns of all identifiers")
    }

    /// True for an identifier that could not be read.
    pub(super) fn is_placeholder(&self, id: &str) -> bool {
        id.strip_prefix(PLACEHOLDER)
            .and_then(|number| number.parse::<usize>().ok())
            .is_some_and(|number| (1..=self.unreadable_ids).contains(&number))
    }

    fn bounded_text(&mut self, node: JsonNode<'_, '_>, chars_max: usize) -> Option<String> {
        let Some(text) = node.text() else { return self.wrong_type(node, "a string") };
        if text.chars().nth(chars_max).is_some() {
            self.fault(
                node,
                FaultCode::TextTooLong,
                format!("The text may have at most {chars_max} characters."),
            );
            return None;
        }
        // XML, and with it NodeSet2, has no way to write these.
        let is_unwritable =
            |c: char| (c < ' ' && !matches!(c, '\t' | '\n' | '\r')) || is_noncharacter(c);
        if let Some((index, c)) = text.chars().enumerate().find(|(_, c)| is_unwritable(*c)) {
            let message = format!(
                "The text has the control character U+{:04X} at position {index}; remove it.",
                c as u32
            );
            self.fault(node, FaultCode::InvalidValue, message);
            return None;
        }
        Some(text.into_owned())
    }

    /// A name, or another party's identifier.
    pub(super) fn name(&mut self, node: JsonNode<'_, '_>) -> Option<String> {
        self.bounded_text(node, NAME_CHARS_MAX)
    }

    /// A description, purpose or comment.
    pub(super) fn text(&mut self, node: JsonNode<'_, '_>) -> Option<String> {
        self.bounded_text(node, TEXT_CHARS_MAX)
    }

    /// A document inside of the message.
    pub(super) fn document(&mut self, node: JsonNode<'_, '_>) -> Option<String> {
        self.bounded_text(node, MESSAGE_BYTES_MAX)
    }

    /// A text of more than white space.
    pub(super) fn non_empty_text(&mut self, node: JsonNode<'_, '_>) -> Option<String> {
        let text = self.text(node)?;
        if text.trim().is_empty() {
            self.fault(node, FaultCode::InvalidValue, "The text must not be empty.");
        }
        Some(text)
    }

    /// Reads an RFC 3339 time; notes a fault and returns `None` where it is none.
    pub(super) fn time(&mut self, node: JsonNode<'_, '_>) -> Option<DateTime> {
        let Some(text) = node.text() else { return self.wrong_type(node, "a time as a string") };
        let time = crate::json::write::parse_date_time(&text);
        if time.is_none() {
            self.fault(
                node,
                FaultCode::InvalidValue,
                "A time must be RFC 3339, as 2019-04-18T06:00:00Z.",
            );
        }
        time
    }

    /// A value with its own text form.
    pub(super) fn parsed<T: FromStr>(
        &mut self,
        node: JsonNode<'_, '_>,
        expected: &str,
    ) -> Option<T> {
        let Some(text) = node.text() else { return self.wrong_type(node, "a string") };
        let value = text.parse().ok();
        if value.is_none() {
            self.fault(node, FaultCode::InvalidValue, format!("Expected {expected}."));
        }
        value
    }

    /// One of several names.
    pub(super) fn choice<T: Clone>(
        &mut self,
        node: JsonNode<'_, '_>,
        choices: &[(&str, T)],
    ) -> Option<T> {
        let Some(text) = node.text() else { return self.wrong_type(node, "a string") };
        let found = choices.iter().find(|(name, _)| *name == text).map(|(_, value)| value.clone());
        if found.is_none() {
            let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
            self.fault(
                node,
                FaultCode::InvalidValue,
                format!("Expected one of {}.", names.join(", ")),
            );
        }
        found
    }

    /// An integer that fits.
    pub(super) fn integer<T: FromStr>(
        &mut self,
        node: JsonNode<'_, '_>,
        expected: &str,
    ) -> Option<T> {
        if node.kind() != Kind::Number {
            return self.wrong_type(node, expected);
        }
        let value = node.integer();
        if value.is_none() {
            self.fault(node, FaultCode::InvalidValue, format!("Expected {expected}."));
        }
        value
    }

    /// A finite number that is not negative.
    pub(super) fn quantity(&mut self, node: JsonNode<'_, '_>) -> Option<f64> {
        let Some(digits) = node.number() else { return self.wrong_type(node, "a number") };
        let value = digits.parse().ok().filter(|value: &f64| value.is_finite() && *value >= 0.0);
        if value.is_none() {
            self.fault(
                node,
                FaultCode::InvalidValue,
                "The number must not be negative or beyond 1e308.",
            );
        }
        value
    }

    /// Reads a finite number; notes a fault and returns `None` where it is none.
    pub(super) fn number(&mut self, node: JsonNode<'_, '_>) -> Option<f64> {
        let Some(digits) = node.number() else { return self.wrong_type(node, "a number") };
        let value = digits.parse().ok().filter(|value: &f64| value.is_finite());
        if value.is_none() {
            self.fault(node, FaultCode::InvalidValue, "The number must not be beyond 1e308.");
        }
        value
    }

    /// Reads a boolean; notes a fault and returns `None` where it is none.
    pub(super) fn boolean(&mut self, node: JsonNode<'_, '_>) -> Option<bool> {
        match node.boolean() {
            Some(value) => Some(value),
            None => self.wrong_type(node, "true or false"),
        }
    }
}
