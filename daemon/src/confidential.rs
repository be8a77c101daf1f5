//! Values that must never reach a log: passwords, tokens, keys, plant values.

use std::fmt;

use serde::{Deserialize, Deserializer};
use zeroize::Zeroize;

/// A value that is shown to nobody by accident: no `Display`, no `Serialize`, a redacted `Debug`,
/// and its memory is overwritten when it is dropped. Reading it takes the word
/// [`Confidential::expose`], which reviewers can search for.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Confidential<T: Zeroize>(T);

impl<T: Zeroize> Confidential<T> {
    /// Takes the value into custody.
    pub const fn new(value: T) -> Self {
        Self(value)
    }

    /// Returns the value itself. The caller must not log or show it.
    pub const fn expose(&self) -> &T {
        &self.0
    }
}

impl<T: Zeroize> fmt::Debug for Confidential<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("<confidential>")
    }
}

impl<T: Zeroize> From<T> for Confidential<T> {
    fn from(value: T) -> Self {
        Self::new(value)
    }
}

impl From<&str> for Confidential<String> {
    fn from(value: &str) -> Self {
        Self::new(value.to_owned())
    }
}

impl<T: Zeroize> Drop for Confidential<T> {
    fn drop(&mut self) {
        self.0.zeroize();
    }
}

impl<'de, T: Zeroize + Deserialize<'de>> Deserialize<'de> for Confidential<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        T::deserialize(deserializer).map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn debug_shows_nothing() {
        #[derive(Debug)]
        struct Holder {
            #[allow(dead_code)]
            password: Confidential<String>,
        }
        let text = format!(
            "{:?} {:#?}",
            Confidential::from("canary"),
            Holder { password: "canary".into() }
        );
        assert!(!text.contains("canary"), "{text}");
    }

    #[test]
    fn the_value_is_read_from_configuration() {
        let secret: Confidential<String> = serde_json::from_str("\"canary\"").expect("a string");
        assert_eq!(secret.expose(), "canary");
    }
}
