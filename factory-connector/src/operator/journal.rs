//! The entries of one operation, and what follows from them.

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

/// The entries of one operation, in the order of their own times. What follows from them does not
/// depend on the order in which they came, nor on how often.
#[derive(Debug, Clone, Default)]
pub struct Journal {
    entries: BTreeMap<(DateTime, EntryId), OperatorEntry>,
    ids: HashSet<EntryId>,
}

/// What the entries say about a field.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// A count or a share.
    Number(f64),
    /// How the operation stands.
    State(OperationState),
    /// When something happened.
    Time(DateTime),
    /// As typed.
    Typed(Value),
    /// What was said is not so any more.
    Withdrawn,
}

/// A problem that lasts.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
// The problem document of a failed request is another schema, also named `Problem`.
#[schema(as = OperatorProblem)]
pub struct Problem {
    /// What is wrong.
    pub text: String,
    /// Since when.
    pub since: DateTime,
    /// Who said so.
    pub told_by: String,
}

/// How an operation stands by its entries.
#[derive(Debug, Clone, PartialEq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Standing {
    /// `Running`, `Interrupted` or `Ended`; none before anything was entered.
    pub state: Option<OperationState>,
    /// When it was first started.
    pub started_at: Option<DateTime>,
    /// When it was finished, while it is.
    pub ended_at: Option<DateTime>,
    /// Good pieces counted with the buttons.
    pub good_quantity: f64,
    /// Scrap counted with the buttons.
    pub scrap_quantity: f64,
    /// The problem that lasts.
    pub problem: Option<Problem>,
    /// When the last entry was made.
    pub last_entry_at: Option<DateTime>,
}

impl Journal {
    /// Whether an entry is here already.
    #[must_use]
    pub fn has(&self, id: &EntryId) -> bool {
        self.ids.contains(id)
    }

    /// No further entry is taken.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.entries.len() >= ENTRIES_MAX
    }

    /// Takes an entry; false where it is here already.
    pub fn insert(&mut self, entry: OperatorEntry) -> bool {
        let is_new = self.ids.insert(entry.entry_id.clone());
        if is_new {
            self.entries.insert((entry.made_at, entry.entry_id.clone()), entry);
        }
        is_new
    }

    /// The entries, newest first.
    pub fn newest(&self) -> impl Iterator<Item = &OperatorEntry> {
        self.entries.values().rev()
    }

    /// How the operation stands.
    #[must_use]
    pub fn standing(&self) -> Standing {
        let mut standing = Standing::default();
        for entry in self.entries.values() {
            let at = entry.made_at;
            standing.last_entry_at = Some(at);
            match &entry.action {
                Action::Start => {
                    standing.state = Some(OperationState::Running);
                    standing.started_at.get_or_insert(at);
                    (standing.ended_at, standing.problem) = (None, None);
                }
                Action::Add { quantity, piece } => {
                    let count = match piece {
                        Piece::Good => &mut standing.good_quantity,
                        Piece::Scrap => &mut standing.scrap_quantity,
                    };
                    *count = (*count + quantity).max(0.0);
                }
                Action::Done => {
                    standing.state = Some(OperationState::Ended);
                    (standing.ended_at, standing.problem) = (Some(at), None);
                }
                Action::Problem { text } => {
                    standing.state = Some(OperationState::Interrupted);
                    let told_by = entry.made_by.clone();
                    standing.problem = Some(Problem { text: text.clone(), since: at, told_by });
                }
                Action::Value { .. } => {}
            }
        }
        standing
    }

    /// What the entries say about a field of this meaning, and since when. A typed value counts
    /// from its time on, and pieces counted afterwards add to it.
    #[must_use]
    pub fn answer(
        &self,
        field: &FieldKey,
        semantic: Option<&Semantic>,
        planned: Option<f64>,
    ) -> Option<(Answer, DateTime)> {
        let mut answer: Option<(Answer, DateTime)> = None;
        // Good pieces, for the share of what is planned.
        let mut good = 0.0_f64;
        for entry in self.entries.values() {
            let before = answer.as_ref().map(|(answer, _)| answer);
            let says = match (&entry.action, semantic) {
                (Action::Value { value, .. }, _)
                    if entry.action.field(&entry.operation).as_ref() == Some(field) =>
                {
                    Some(Answer::Typed(value.clone()))
                }
                (Action::Add { quantity, piece }, Some(semantic)) => {
                    if *piece == Piece::Good {
                        good = (good + quantity).max(0.0);
                    }
                    counted(semantic, *piece, *quantity, before, good, planned)
                }
                (Action::Start, Some(Semantic::OperationState)) => {
                    Some(Answer::State(OperationState::Running))
                }
                (Action::Start, Some(Semantic::ActualStart)) if before.is_none() => {
                    Some(Answer::Time(entry.made_at))
                }
                (Action::Start, Some(Semantic::ActualEnd)) if before.is_some() => {
                    Some(Answer::Withdrawn)
                }
                (Action::Done, Some(Semantic::OperationState)) => {
                    Some(Answer::State(OperationState::Ended))
                }
                (Action::Done, Some(Semantic::ActualEnd)) => Some(Answer::Time(entry.made_at)),
                (Action::Done, Some(Semantic::PercentComplete)) => Some(Answer::Number(100.0)),
                (Action::Problem { .. }, Some(Semantic::OperationState)) => {
                    Some(Answer::State(OperationState::Interrupted))
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

/// What a count makes of a field.
fn counted(
    semantic: &Semantic,
    piece: Piece,
    quantity: f64,
    before: Option<&Answer>,
    good: f64,
    planned: Option<f64>,
) -> Option<Answer> {
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
        return Some(Answer::Number((good / planned * 100.0).clamp(0.0, 100.0)));
    }
    let so_far = match before {
        Some(Answer::Number(number)) => *number,
        Some(Answer::Typed(Value::Number(number))) => number.as_f64().unwrap_or(0.0),
        Some(Answer::Typed(Value::String(text))) => text.trim().parse().unwrap_or(0.0),
        _ => 0.0,
    };
    Some(Answer::Number((so_far + quantity).max(0.0)))
}

impl Answer {
    /// As plain JSON that fits a field's type, where it can; none where there is no value any more.
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
    fn a_shift_is_told() {
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
        let standing = journal.standing();
        assert_eq!((standing.good_quantity, standing.scrap_quantity), (3.0, 1.0));
        assert_eq!(standing.state, Some(OperationState::Interrupted));
        assert_eq!(
            standing.problem.map(|problem| problem.text).as_deref(),
            Some("The tool broke.")
        );
        let says = |semantic: &Semantic, planned| {
            journal.answer(&field("made"), Some(semantic), planned).map(|(a, _)| a)
        };
        assert_eq!(says(&Semantic::ProducedQuantity, None), Some(Answer::Number(4.0)));
        assert_eq!(says(&Semantic::GoodQuantity, None), Some(Answer::Number(3.0)));
        assert_eq!(says(&Semantic::PercentComplete, Some(12.0)), Some(Answer::Number(25.0)));
        assert_eq!(says(&Semantic::PercentComplete, None), None);
        assert_eq!(
            says(&Semantic::OperationState, None),
            Some(Answer::State(OperationState::Interrupted))
        );
        assert_eq!(says(&Semantic::ActualEnd, None), None);
        journal.insert(entry(9, 9, json!({ "action": "DONE" })));
        assert!(matches!(
            journal.answer(&field("x"), Some(&Semantic::ActualEnd), None),
            Some((Answer::Time(_), _))
        ));
        journal.insert(entry(10, 10, json!({ "action": "START" })));
        let (answer, _) =
            journal.answer(&field("x"), Some(&Semantic::ActualEnd), None).expect("an answer");
        assert_eq!(answer, Answer::Withdrawn, "it was not finished after all");
        assert_eq!(journal.standing().problem, None);
    }

    #[test]
    fn a_typed_total_counts_from_its_time_on() {
        let mut journal = Journal::default();
        journal.insert(entry(1, 10, json!({ "action": "ADD" })));
        journal.insert(entry(2, 20, typed(50)));
        journal.insert(entry(3, 30, json!({ "action": "ADD" })));
        let says =
            |journal: &Journal| journal.answer(&field("made"), Some(&Semantic::GoodQuantity), None);
        assert_eq!(says(&journal).map(|(answer, _)| answer), Some(Answer::Number(51.0)));
        // It was made before the total was typed, and came late.
        journal.insert(entry(4, 15, json!({ "action": "ADD" })));
        assert_eq!(says(&journal).map(|(answer, _)| answer), Some(Answer::Number(51.0)));
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
        /// Late, out of order, twice: only the set of entries counts.
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
            prop_assert_eq!(in_order.standing(), shuffled.standing());
            for semantic in ["PRODUCED_QUANTITY", "GOOD_QUANTITY", "SCRAP_QUANTITY", "PERCENT_COMPLETE",
                "OPERATION_STATE", "ACTUAL_START", "ACTUAL_END", "EXPECTED_END"] {
                let semantic: Semantic = semantic.parse().expect("a semantic");
                let says = |journal: &Journal| journal.answer(&field("made"), Some(&semantic), Some(20.0));
                prop_assert_eq!(says(&in_order), says(&shuffled));
            }
        }
    }
}
