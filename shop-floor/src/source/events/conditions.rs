//! Conditions that are active, kept right through changes and refreshes (OPC 10000-9 §5.5.7).

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use asi_model::values::{DateTime, Identifier, LocalizedText, NodeId, Scalar, StatusCode, Variant};

use super::{EventFields, boolean, node_id};
use crate::EventValue;

/// Most active conditions that are kept; no operator looks at so many.
const CONDITIONS_MAX: usize = 10_000;
/// Longest identifier of a condition, in bytes (OPC 10000-3 §8.2.4), and most characters of its message.
const IDENTIFIER_MAX: usize = 4096;
const MESSAGE_MAX: usize = 500;
/// Number of the fields of a condition.
pub(super) const FIELDS: usize = 6;

/// Knowledge of a server's conditions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Knowledge {
    /// The server is still to name those that were active before.
    #[default]
    Awaited,
    /// All are known.
    Complete,
    /// Some may be missing: the server cannot name those that were active before, or there are too many.
    Partial,
}

/// Active conditions of one input, by the node of each.
#[derive(Debug, Default)]
pub(super) struct Conditions {
    active: HashMap<NodeId, Condition>,
    /// Conditions that the server has named since a refresh began; `None` outside of one.
    named: Option<HashSet<NodeId>>,
    knowledge: Knowledge,
}

#[derive(Debug)]
struct Condition {
    severity: u16,
    message: Variant,
    time: Option<DateTime>,
}

impl Conditions {
    /// Takes the state of a condition: severity, message, its node, its branch, and whether it is retained and active.
    pub(super) fn take(&mut self, fields: EventFields, severity_min: u16) {
        let time = fields.time;
        let mut others = fields.others;
        let mut next = || others.next().unwrap_or_default();
        let severity = severity(&next());
        let message = shortened(next());
        let (Some(id), branch) = (node_id(&next()).filter(is_short), node_id(&next())) else {
            return;
        };
        // A branch is a state of the past that waits for its acknowledgement.
        if branch.is_some_and(|branch| branch != NodeId::ua(0)) {
            return;
        }
        let is_retained = boolean(&next()).unwrap_or(false);
        // Conditions that are no alarms have no such state: they are active while they are of interest.
        let is_active = is_retained && boolean(&next()).unwrap_or(true);
        if let Some(named) = &mut self.named
            && named.len() < CONDITIONS_MAX
        {
            named.insert(id.clone());
        }
        if !is_active || severity < severity_min {
            self.active.remove(&id);
        } else if self.active.len() < CONDITIONS_MAX || self.active.contains_key(&id) {
            self.active.insert(id, Condition { severity, message, time });
        } else {
            self.knowledge = Knowledge::Partial;
        }
    }

    /// Begins to look which conditions the server names.
    pub(super) fn begin_refresh(&mut self) {
        self.named = Some(HashSet::new());
    }

    /// Drops the conditions that the server did not name.
    pub(super) fn end_refresh(&mut self) {
        if let Some(named) = self.named.take() {
            self.active.retain(|id, _| named.contains(id));
            let is_whole = named.len() < CONDITIONS_MAX && self.active.len() < CONDITIONS_MAX;
            self.knowledge = if is_whole { Knowledge::Complete } else { Knowledge::Partial };
        }
    }

    /// Knows again nothing for certain: the server is to name all conditions.
    pub(super) fn doubt(&mut self) {
        // A refresh that runs may be among what was lost.
        self.named = None;
        self.knowledge = Knowledge::Awaited;
    }

    /// Goes on without those that were active before, which the server does not name. Returns false where it has
    /// named them meanwhile.
    pub(super) fn give_up_refresh(&mut self) -> bool {
        let is_open = self.is_unsettled();
        if is_open {
            self.named = None;
            self.knowledge = Knowledge::Partial;
        }
        is_open
    }

    /// Returns true while a value would say what is not known yet.
    pub(super) fn is_unsettled(&self) -> bool {
        self.named.is_some() || self.knowledge == Knowledge::Awaited
    }

    /// Returns the quality of what is known.
    pub(super) fn status(&self) -> StatusCode {
        match self.knowledge {
            Knowledge::Complete => StatusCode::GOOD,
            Knowledge::Partial | Knowledge::Awaited => StatusCode::UNCERTAIN_INITIAL_VALUE,
        }
    }

    /// Returns the value of the conditions.
    pub(super) fn value(&self, of: &EventValue) -> Variant {
        match of {
            EventValue::ActiveConditions => {
                u32::try_from(self.active.len()).unwrap_or(u32::MAX).into()
            }
            EventValue::ActiveSeverity => {
                self.active.values().map(|one| one.severity).max().unwrap_or(0).into()
            }
            EventValue::ActiveMessage => {
                let worst = self.active.values().max_by_key(|one| (one.severity, one.time));
                worst.map_or_else(no_message, |one| one.message.clone())
            }
            EventValue::Field { .. } => Variant::Null,
        }
    }
}

fn severity(value: &Variant) -> u16 {
    let number = value.as_scalar().and_then(Scalar::as_i128);
    number.and_then(|number| u16::try_from(number).ok()).unwrap_or(0)
}

fn is_short(id: &NodeId) -> bool {
    match &id.identifier {
        Identifier::String(text) => text.len() <= IDENTIFIER_MAX,
        Identifier::Opaque(bytes) => bytes.len() <= IDENTIFIER_MAX,
        Identifier::Numeric(_) | Identifier::Guid(_) => true,
    }
}

/// Cuts a message: many are kept at a time, and a server may send megabytes.
fn shortened(message: Variant) -> Variant {
    match message {
        Variant::Scalar(Scalar::LocalizedText(text)) => {
            let short = |text: &str| Arc::from(text.chars().take(MESSAGE_MAX).collect::<String>());
            let LocalizedText { locale, text } = *text;
            let (locale, text) = (locale.as_deref().map(short), text.as_deref().map(short));
            Variant::Scalar(Scalar::LocalizedText(Box::new(LocalizedText { locale, text })))
        }
        _ => no_message(),
    }
}

fn no_message() -> Variant {
    let text = LocalizedText { locale: None, text: Some("".into()) };
    Variant::Scalar(Scalar::LocalizedText(Box::new(text)))
}
