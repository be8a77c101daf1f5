//! Journal: the entries of one operation, and the values of fields that follow from them.

use std::collections::{BTreeMap, HashSet};

use asi_model::{
    BuiltInType, DateTime, FieldKey,
    network::{OperationState, Semantic},
};
use serde::Serialize;
use serde_json::Value;

use super::{Action, EntryId, OperatorEntry, Piece};

/// Most entries of one operation.
const ENTRIES_MAX: usize = 10_000;

/// Entries of one operation in the order of their own times. Values that follow from them depend
/// neither on the order of delivery nor on repetitions.
#[derive(Debug, Clone, Default)]
pub struct Journal {
    entries: BTreeMap<(DateTime, EntryId), OperatorEntry>,
    ids: HashSet<EntryId>,
}

/// Statement of the entries about a field.
#[derive(Debug, Clone, PartialEq)]
pub enum OperatorStatement {
    /// A count or a share.
    Number(f64),
    State(OperationState),
    /// Time of an event.
    Time(DateTime),
    /// A value as an operator typed it.
    Typed(Value),
    /// An earlier statement does not hold any more.
    Withdrawn,
}

/// A problem that is not solved yet.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct OperatorProblem {
    pub text: String,
    /// Time of its entry.
    pub since: DateTime,
    /// Name of the user who entered it.
    #[serde(rename = "toldBy")]
    pub reported_by: String,
}

/// Status of an operation by its entries.
#[derive(Debug, Clone, PartialEq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct OperationStatus {
    /// `Running`, `Interrupted` or `Ended`; none before anything was entered.
    pub state: Option<OperationState>,
    /// Time of the first start.
    pub started_at: Option<DateTime>,
    /// Time of the end, while the operation is finished.
    pub ended_at: Option<DateTime>,
    /// Good pieces counted with the buttons.
    pub good_quantity: f64,
    /// Scrap counted with the buttons.
    pub scrap_quantity: f64,
    /// The problem that is not solved yet.
    pub problem: Option<OperatorProblem>,
    /// Greatest `madeAt` of all entries.
    pub last_entry_at: Option<DateTime>,
}

impl Journal {
    /// Returns true where an entry is stored already.
    #[must_use]
    pub fn has(&self, id: &EntryId) -> bool {
        self.ids.contains(id)
    }

    /// Returns true where no further entry is accepted.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.entries.len() >= ENTRIES_MAX
    }

    /// Adds an entry. Returns false where it is stored already.
    pub fn insert(&mut self, entry: OperatorEntry) -> bool {
        let is_new = self.ids.insert(entry.entry_id.clone());
        if is_new {
            self.entries.insert((entry.made_at, entry.entry_id.clone()), entry);
        }
        is_new
    }

    /// Returns the entries, newest first.
    pub fn newest(&self) -> impl Iterator<Item = &OperatorEntry> {
        self.entries.values().rev()
    }

    /// Returns the status of the operation.
    #[must_use]
    pub fn status(&self) -> OperationStatus {
        let mut status = OperationStatus::default();
        for entry in self.entries.values() {
            let at = entry.made_at;
            status.last_entry_at = Some(at);
            match &entry.action {
                Action::Start => {
                    status.state = Some(OperationState::Running);
                    status.started_at.get_or_insert(at);
                    (status.ended_at, status.problem) = (None, None);
                }
                Action::Add { quantity, piece } => {
                    let count = match piece {
                        Piece::Good => &mut status.good_quantity,
                        Piece::Scrap => &mut status.scrap_quantity,
                    };
                    *count = (*count + quantity).max(0.0);
                }
                Action::Done => {
                    status.state = Some(OperationState::Ended);
                    (status.ended_at, status.problem) = (Some(at), None);
                }
                Action::Problem { text } => {
                    status.state = Some(OperationState::Interrupted);
                    let reported_by = entry.made_by.clone();
                    status.problem =
                        Some(OperatorProblem { text: text.clone(), since: at, reported_by });
                }
                Action::Value { .. } => {}
            }
        }
        status
    }

    /// Returns the statement of the entries about a field of this meaning, and its time. A typed
    /// value counts from its time on, and pieces that are counted afterwards add to it.
    #[must_use]
    pub fn answer(
        &self,
        field: &FieldKey,
        semantic: Option<&Semantic>,
        planned: Option<f64>,
    ) -> Option<(OperatorStatement, DateTime)> {
        let mut answer: Option<(OperatorStatement, DateTime)> = None;
        // Good pieces, for the share of what is planned.
        let mut good = 0.0_f64;
        for entry in self.entries.values() {
            let before = answer.as_ref().map(|(answer, _)| answer);
            let says = match (&entry.action, semantic) {
                (Action::Value { value, .. }, _)
                    if entry.action.field(&entry.operation).as_ref() == Some(field) =>
                {
                    Some(OperatorStatement::Typed(value.clone()))
                }
                (Action::Add { quantity, piece }, Some(semantic)) => {
                    if *piece == Piece::Good {
                        good = (good + quantity).max(0.0);
                    }
                    counted(semantic, *piece, *quantity, before, good, planned)
                }
                (Action::Start, Some(Semantic::OperationState)) => {
                    Some(OperatorStatement::State(OperationState::Running))
                }
                (Action::Start, Some(Semantic::ActualStart)) if before.is_none() => {
                    Some(OperatorStatement::Time(entry.made_at))
                }
                (Action::Start, Some(Semantic::ActualEnd)) if before.is_some() => {
                    Some(OperatorStatement::Withdrawn)
                }
                (Action::Done, Some(Semantic::OperationState)) => {
                    Some(OperatorStatement::State(OperationState::Ended))
                }
                (Action::Done, Some(Semantic::ActualEnd)) => {
                    Some(OperatorStatement::Time(entry.made_at))
                }
                (Action::Done, Some(Semantic::PercentComplete)) => {
                    Some(OperatorStatement::Number(100.0))
                }
                (Action::Problem { .. }, Some(Semantic::OperationState)) => {
                    Some(OperatorStatement::State(OperationState::Interrupted))
                }
                _ => None,
            };
            if let Some(says) = says {
                answer = Some((says, entry.made_at));
            }
        }
        answer
    }
}

/// Returns the statement about a field after a count.
fn counted(
    semantic: &Semantic,
    piece: Piece,
    quantity: f64,
    before: Option<&OperatorStatement>,
    good: f64,
    planned: Option<f64>,
) -> Option<OperatorStatement> {
    let concerns = match semantic {
        Semantic::ProducedQuantity => true,
        Semantic::GoodQuantity | Semantic::PercentComplete => piece == Piece::Good,
        Semantic::ScrapQuantity => piece == Piece::Scrap,
        _ => false,
    };
    if !concerns {
        return None;
    }
    if *semantic == Semantic::PercentComplete {
        let planned = planned.filter(|planned| *planned > 0.0)?;
        return Some(OperatorStatement::Number((good / planned * 100.0).clamp(0.0, 100.0)));
    }
    let so_far = match before {
        Some(OperatorStatement::Number(number)) => *number,
        Some(OperatorStatement::Typed(Value::Number(number))) => number.as_f64().unwrap_or(0.0),
        Some(OperatorStatement::Typed(Value::String(text))) => text.trim().parse().unwrap_or(0.0),
        _ => 0.0,
    };
    Some(OperatorStatement::Number((so_far + quantity).max(0.0)))
}

impl OperatorStatement {
    /// Converts to plain JSON of a field's type where possible; `None` where there is no value any
    /// more.
    #[must_use]
    pub fn json(&self, field_type: BuiltInType) -> Option<Value> {
        let is_text = field_type == BuiltInType::String;
        Some(match self {
            Self::Number(number) if is_text => Value::String(number.to_string()),
            Self::Number(number) if field_type.is_integer() => whole(number.floor()),
            Self::Number(number) => Value::from(*number),
            Self::State(state) if is_text => Value::from(state.name()),
            Self::State(state) => Value::from(
                OperationState::ALL.iter().position(|known| known == state).unwrap_or_default(),
            ),
            Self::Time(at) => Value::from(at.to_string()),
            Self::Typed(value) => value.clone(),
            Self::Withdrawn => return None,
        })
    }
}

/// Counts stay far below the bound where a floating point number skips integers.
#[allow(clippy::cast_possible_truncation)]
fn whole(number: f64) -> Value {
    Value::from(number as i64)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::json;

    use super::*;

    fn field(name: &str) -> FieldKey {
        let request = asi_model::RequestKey {
            operation_network_id: "n".parse().expect("an id"),
            operation_id: "op".parse().expect("an id"),
            dynamic_data_request_id: "R1".parse().expect("an id"),
        };
        request.field(name.parse().expect("a name"))
    }

    fn entry(id: usize, minute: i64, action: Value) -> OperatorEntry {
        let at = DateTime::from_unix_micros(1_800_000_000_000_000 + minute * 60_000_000);
        OperatorEntry {
            entry_id: EntryId::try_from(format!("e{id}")).expect("an id"),
            operation: super::super::OperationKey {
                operation_network_id: "n".parse().expect("an id"),
                operation_id: "op".parse().expect("an id"),
            },
            made_at: at,
            received_at: at,
            made_by: "otto".to_owned(),
            action: serde_json::from_value(action).expect("an action"),
        }
    }

    fn typed(value: u32) -> Value {
        json!({ "action": "VALUE", "dynamicDataRequestId": "R1", "fieldName": "made", "value": value })
    }

    #[test]
    fn a_shift_yields_counts_states_and_times() {
        let mut journal = Journal::default();
        let actions = [
            json!({ "action": "START" }),
            json!({ "action": "ADD" }),
            json!({ "action": "ADD", "quantity": 2 }),
            json!({ "action": "ADD", "piece": "SCRAP" }),
            json!({ "action": "PROBLEM", "text": "The tool broke." }),
        ];
        for (minute, action) in (0..).zip(actions) {
            journal.insert(entry(usize::try_from(minute).expect("small"), minute, action));
        }
        let status = journal.status();
        assert_eq!((status.good_quantity, status.scrap_quantity), (3.0, 1.0));
        assert_eq!(status.state, Some(OperationState::Interrupted));
        assert_eq!(status.problem.map(|problem| problem.text).as_deref(), Some("The tool broke."));
        let says = |semantic: &Semantic, planned| {
            journal.answer(&field("made"), Some(semantic), planned).map(|(a, _)| a)
        };
        assert_eq!(says(&Semantic::ProducedQuantity, None), Some(OperatorStatement::Number(4.0)));
        assert_eq!(says(&Semantic::GoodQuantity, None), Some(OperatorStatement::Number(3.0)));
        assert_eq!(
            says(&Semantic::PercentComplete, Some(12.0)),
            Some(OperatorStatement::Number(25.0))
        );
        assert_eq!(says(&Semantic::PercentComplete, None), None);
        assert_eq!(
            says(&Semantic::OperationState, None),
            Some(OperatorStatement::State(OperationState::Interrupted))
        );
        assert_eq!(says(&Semantic::ActualEnd, None), None);
        journal.insert(entry(9, 9, json!({ "action": "DONE" })));
        assert!(matches!(
            journal.answer(&field("x"), Some(&Semantic::ActualEnd), None),
            Some((OperatorStatement::Time(_), _))
        ));
        journal.insert(entry(10, 10, json!({ "action": "START" })));
        let (answer, _) =
            journal.answer(&field("x"), Some(&Semantic::ActualEnd), None).expect("an answer");
        assert_eq!(answer, OperatorStatement::Withdrawn, "it was not finished after all");
        assert_eq!(journal.status().problem, None);
    }

    #[test]
    fn a_typed_total_counts_from_its_time_on() {
        let mut journal = Journal::default();
        journal.insert(entry(1, 10, json!({ "action": "ADD" })));
        journal.insert(entry(2, 20, typed(50)));
        journal.insert(entry(3, 30, json!({ "action": "ADD" })));
        let says =
            |journal: &Journal| journal.answer(&field("made"), Some(&Semantic::GoodQuantity), None);
        assert_eq!(says(&journal).map(|(answer, _)| answer), Some(OperatorStatement::Number(51.0)));
        // It was made before the total was typed, and came late.
        journal.insert(entry(4, 15, json!({ "action": "ADD" })));
        assert_eq!(says(&journal).map(|(answer, _)| answer), Some(OperatorStatement::Number(51.0)));
    }

    fn action() -> impl Strategy<Value = Value> {
        prop_oneof![
            Just(json!({ "action": "START" })),
            Just(json!({ "action": "DONE" })),
            Just(json!({ "action": "PROBLEM", "text": "x" })),
            (-3_i32..5)
                .prop_filter("adds nothing", |n| *n != 0)
                .prop_map(|n| json!({ "action": "ADD", "quantity": n })),
            (1_i32..3).prop_map(|n| json!({ "action": "ADD", "quantity": n, "piece": "SCRAP" })),
            (0_u32..100).prop_map(typed),
        ]
    }

    proptest! {
        /// The status follows from the set of entries, delivered late, out of order or twice.
        #[test]
        fn neither_order_nor_repeats_of_delivery_matter(
            entries in proptest::collection::vec((0_i64..50, action()), 1..30),
            order in proptest::collection::vec(any::<prop::sample::Index>(), 0..60),
        ) {
            let entries: Vec<_> =
                entries.into_iter().enumerate().map(|(id, (minute, action))| entry(id, minute, action)).collect();
            let mut in_order = Journal::default();
            for entry in &entries {
                in_order.insert(entry.clone());
            }
            let mut shuffled = Journal::default();
            for index in order {
                shuffled.insert(index.get(&entries).clone());
            }
            for entry in entries.iter().rev() {
                shuffled.insert(entry.clone());
            }
            prop_assert_eq!(in_order.status(), shuffled.status());
            for semantic in ["PRODUCED_QUANTITY", "GOOD_QUANTITY", "SCRAP_QUANTITY", "PERCENT_COMPLETE",
                "OPERATION_STATE", "ACTUAL_START", "ACTUAL_END", "EXPECTED_END"] {
                let semantic: Semantic = semantic.parse().expect("a semantic");
                let says = |journal: &Journal| journal.answer(&field("made"), Some(&semantic), Some(20.0));
                prop_assert_eq!(says(&in_order), says(&shuffled));
            }
        }
    }
}
