//! Names of queues and patterns over them.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Longest name of a queue, in bytes.
pub const QUEUE_NAME_BYTES_MAX: usize = 255;

/// Name of a queue: 1 to 255 letters, digits, `_`, `-` and, between words, `.`.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct QueueName(std::sync::Arc<str>);

/// Error for a text that is not the name of a queue.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "a queue's name consists of words of letters, digits, _ and - with dots between them, at most 255 bytes"
)]
pub struct InvalidQueueName;

impl QueueName {
    /// Returns the name of the queue of rejected messages, `dead-letters`.
    #[must_use]
    pub fn dead_letters() -> Self {
        Self("dead-letters".into())
    }

    /// Returns the name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl FromStr for QueueName {
    type Err = InvalidQueueName;

    fn from_str(text: &str) -> Result<Self, InvalidQueueName> {
        let is_valid = text.len() <= QUEUE_NAME_BYTES_MAX && text.split('.').all(is_word);
        if is_valid { Ok(Self(text.into())) } else { Err(InvalidQueueName) }
    }
}

impl fmt::Display for QueueName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Serialize for QueueName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for QueueName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = std::borrow::Cow::<'de, str>::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

fn is_word(word: &str) -> bool {
    !word.is_empty() && word.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-')
}

/// Pattern over queue names: words with dots between them, `*` for exactly one word, and `#` at the
/// end for any number of words.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct AddressPattern(String);

/// Error for a text that is not a pattern.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{found:?} is not an address pattern: words with dots between them, * for one word, # at the end for any rest"
)]
pub struct InvalidPattern {
    /// Beginning of the text, at most 160 characters.
    pub found: String,
}

impl AddressPattern {
    /// Returns the pattern that matches exactly one queue.
    #[must_use]
    pub fn exact(name: &QueueName) -> Self {
        Self(name.to_string())
    }

    /// Returns the pattern that matches every queue, `#`.
    #[must_use]
    pub fn any() -> Self {
        Self("#".to_owned())
    }

    /// Returns true if the name matches word by word.
    #[must_use]
    pub fn matches(&self, name: &QueueName) -> bool {
        let mut words = name.as_str().split('.');
        for part in self.0.split('.') {
            match (part, words.next()) {
                ("#", _) => return true,
                ("*", Some(_)) => {}
                (part, Some(word)) if part == word => {}
                _ => return false,
            }
        }
        words.next().is_none()
    }
}

impl FromStr for AddressPattern {
    type Err = InvalidPattern;

    fn from_str(text: &str) -> Result<Self, InvalidPattern> {
        let body =
            text.strip_suffix('#').map_or(text, |rest| rest.strip_suffix('.').unwrap_or(rest));
        let is_valid = text == "#"
            || (text.len() <= QUEUE_NAME_BYTES_MAX
                && (!text.ends_with('#') || text.ends_with(".#"))
                && body.split('.').all(|part| part == "*" || is_word(part)));
        if is_valid {
            Ok(Self(text.to_owned()))
        } else {
            Err(InvalidPattern { found: text.chars().take(160).collect() })
        }
    }
}

impl fmt::Display for AddressPattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Serialize for AddressPattern {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for AddressPattern {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = std::borrow::Cow::<'de, str>::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_word_by_word() {
        for (pattern, name, expected) in [
            ("factory.f1.requests", "factory.f1.requests", true),
            ("factory.f1.requests", "factory.f10.requests", false),
            ("factory.*.ingress", "factory.f1.ingress", true),
            ("factory.*.ingress", "factory.f1.requests", false),
            ("factory.*.ingress", "factory.ingress", false),
            ("factory.*", "factory.f1.ingress", false),
            ("factory.#", "factory.f1.ingress", true),
            ("factory.#", "factory", true),
            ("factory.#", "tool.t1.reports", false),
            ("#", "anything.at-all", true),
        ] {
            let pattern: AddressPattern = pattern.parse().expect("a pattern");
            assert_eq!(
                pattern.matches(&name.parse().expect("a name")),
                expected,
                "{pattern} on {name}"
            );
        }
    }

    #[test]
    fn malformed_patterns_and_names_are_refused() {
        for text in ["", ".", "a..b", "a#", "#.a", "a.#.b", "a b", "ü"] {
            assert!(text.parse::<AddressPattern>().is_err(), "{text:?}");
        }
        for text in ["", ".", "a..b", "a.*", "#", "/queue/x", "a b"] {
            assert!(text.parse::<QueueName>().is_err(), "{text:?}");
        }
        assert!("x".repeat(256).parse::<QueueName>().is_err());
    }
}
