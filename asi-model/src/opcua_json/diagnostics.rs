//! Deviations from the standard, noted or refused.

use super::mismatch::Mismatch;
use crate::json::JsonNode;

/// Most diagnostics of one input.
const DIAGNOSTICS_MAX: usize = 64;

/// Treatment of deviations from the standard on input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Leniency {
    /// Harmless ones are taken, with a diagnostic.
    #[default]
    Lenient,
    /// Every deviation is an error.
    Strict,
}

/// Finding about an input that was taken nevertheless.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// JSON pointer to it.
    pub pointer: String,
    pub message: String,
}

/// A bare value without metadata, as 1.05 Verbose and raw data have it.
pub(super) const GUESSED: &str =
    "the value does not name its type and there is no metadata; its type is a guess";

impl Diagnostic {
    /// True for a value that keeps the standard, but whose type only metadata names.
    #[must_use]
    pub fn is_guess(&self) -> bool {
        self.message == GUESSED
    }
}

/// The deviations of one input, as strict as asked for.
#[derive(Debug)]
pub(crate) struct Diagnostics {
    leniency: Leniency,
    list: Vec<Diagnostic>,
}

impl Diagnostics {
    pub(super) const fn new(leniency: Leniency) -> Self {
        Self { leniency, list: Vec::new() }
    }

    pub(crate) const fn leniency(&self) -> Leniency {
        self.leniency
    }

    /// Notes something about a node.
    pub(crate) fn note(&mut self, node: JsonNode<'_, '_>, message: impl Into<String>) {
        // A pointer costs a walk from the root, which a full list does not need.
        if self.list.len() < DIAGNOSTICS_MAX {
            self.list.push(Diagnostic { pointer: node.pointer(), message: message.into() });
        }
    }

    /// Takes a deviation with a note, or refuses it where strictness is asked for.
    pub(crate) fn tolerate<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        message: &'static str,
    ) -> Result<(), Mismatch<'t, 'a>> {
        if self.leniency == Leniency::Strict {
            return Err(Mismatch::new(node, message));
        }
        self.note(node, message);
        Ok(())
    }

    /// Appends what another decoder of the same input noted.
    pub(crate) fn append(&mut self, other: Self) {
        let free = DIAGNOSTICS_MAX.saturating_sub(self.list.len());
        self.list.extend(other.list.into_iter().take(free));
    }

    pub(crate) fn into_list(self) -> Vec<Diagnostic> {
        self.list
    }
}
