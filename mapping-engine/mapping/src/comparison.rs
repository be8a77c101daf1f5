//! Differences between two versions of a mapping, for people.

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value as Json;
use utoipa::ToSchema;

use crate::document::Mapping;

/// Most differences that are told apart; beyond that the rest is one.
const CHANGES_MAX: usize = 200;

/// One difference.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct MappingChange {
    /// JSON pointer into the mapping: of the later version, or of the earlier one where something
    /// was taken away.
    pub pointer: String,
    /// Value in the earlier version; absent where it is new.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = asi_model::openapi::PlainValue, required = false)]
    pub before: Option<Json>,
    /// Value in the later version; absent where it was taken away.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = asi_model::openapi::PlainValue, required = false)]
    pub after: Option<Json>,
}

/// Returns the differences from one mapping to another. Inputs and functions that only moved
/// because another was inserted or removed are not differences.
#[must_use]
pub fn compare(before: &Mapping, after: &Mapping) -> Vec<MappingChange> {
    let json =
        |mapping: &Mapping| serde_json::to_value(mapping).expect("mappings have text keys only");
    let mut changes = Vec::new();
    compare_json(&json(before), &json(after), "", &mut changes);
    changes.truncate(CHANGES_MAX);
    changes
}

fn compare_json(before: &Json, after: &Json, pointer: &str, changes: &mut Vec<MappingChange>) {
    match (before, after) {
        _ if before == after => {}
        (Json::Object(old), Json::Object(new)) if is_same_kind(before, after) => {
            for (name, value) in old {
                let pointer = format!("{pointer}/{}", escaped(name));
                match new.get(name) {
                    Some(other) => compare_json(value, other, &pointer, changes),
                    None => changes.push(MappingChange {
                        pointer,
                        before: Some(value.clone()),
                        after: None,
                    }),
                }
            }
            for (name, value) in new.iter().filter(|(name, _)| !old.contains_key(*name)) {
                let pointer = format!("{pointer}/{}", escaped(name));
                changes.push(MappingChange { pointer, before: None, after: Some(value.clone()) });
            }
        }
        (Json::Array(old), Json::Array(new)) => compare_lists(old, new, pointer, changes),
        _ => changes.push(MappingChange {
            pointer: pointer.to_owned(),
            before: Some(before.clone()),
            after: Some(after.clone()),
        }),
    }
}

/// Elements that are equal stay; of what lies between, those of the same kind are compared, in
/// order.
fn compare_lists(old: &[Json], new: &[Json], pointer: &str, changes: &mut Vec<MappingChange>) {
    let (mut from_old, mut from_new) = (0, 0);
    let kept = common(old, new);
    for (at_old, at_new) in kept.into_iter().chain([(old.len(), new.len())]) {
        let mut left: Vec<usize> = (from_old..at_old).collect();
        for index in from_new..at_new {
            let Some(element) = new.get(index) else { continue };
            let partner = left
                .iter()
                .position(|at| old.get(*at).is_some_and(|was| is_same_kind(was, element)));
            let pointer = format!("{pointer}/{index}");
            match partner
                .map(|position| left.remove(position))
                .and_then(|position| old.get(position))
            {
                Some(was) => compare_json(was, element, &pointer, changes),
                None => changes.push(MappingChange {
                    pointer,
                    before: None,
                    after: Some(element.clone()),
                }),
            }
        }
        changes.extend(left.into_iter().filter_map(|position| {
            Some(MappingChange {
                pointer: format!("{pointer}/{position}"),
                before: Some(old.get(position)?.clone()),
                after: None,
            })
        }));
        (from_old, from_new) = (at_old + 1, at_new + 1);
    }
}

/// Functions of one kind, inputs of one name; anything else is of the same kind.
fn is_same_kind(before: &Json, after: &Json) -> bool {
    ["function", "name"].iter().all(|member| before.get(member) == after.get(member))
}

/// The positions of a longest common subsequence. Lists of a mapping have at most 32 elements.
fn common(old: &[Json], new: &[Json]) -> Vec<(usize, usize)> {
    let mut lengths = vec![vec![0_usize; new.len() + 1]; old.len() + 1];
    for (i, a) in old.iter().enumerate().rev() {
        for (j, b) in new.iter().enumerate().rev() {
            lengths[i][j] = if a == b {
                lengths[i + 1][j + 1] + 1
            } else {
                lengths[i + 1][j].max(lengths[i][j + 1])
            };
        }
    }
    let (mut i, mut j, mut positions) = (0, 0, Vec::new());
    while i < old.len() && j < new.len() {
        if old[i] == new[j] {
            positions.push((i, j));
            (i, j) = (i + 1, j + 1);
        } else if lengths[i + 1][j] >= lengths[i][j + 1] {
            i += 1;
        } else {
            j += 1;
        }
    }
    positions
}

fn escaped(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn mapping(steps: Json) -> Mapping {
        serde_json::from_value(json!({
            "mappingId": "m", "target": { "operationNetworkId": "n", "operationId": "o", "dynamicDataRequestId": "r",
            "fieldName": "f" }, "targetType": "Double", "steps": steps,
            "inputs": [{ "name": "a", "sourceId": "s", "nodeId": "nsu=urn:x;i=1" }] }))
        .expect("a mapping")
    }

    #[test]
    fn only_what_differs_is_listed() {
        let scale = |factor: i32| json!({ "function": "scale", "factor": factor });
        let deadband = json!({ "function": "deadband", "absolute": 1 });
        let compared = |before: Json, after: Json| {
            let changes = compare(&mapping(before), &mapping(after));
            changes
                .into_iter()
                .map(|change| (change.pointer, change.before.is_some(), change.after.is_some()))
                .collect::<Vec<_>>()
        };
        assert_eq!(compared(json!([scale(2), deadband]), json!([scale(2), deadband])), []);
        assert_eq!(
            compared(json!([scale(2), deadband]), json!([scale(3), deadband])),
            [("/steps/0/factor".into(), true, true)]
        );
        assert_eq!(
            compared(json!([scale(2), deadband]), json!([deadband])),
            [("/steps/0".into(), true, false)]
        );
        assert_eq!(
            compared(json!([deadband]), json!([scale(2), deadband])),
            [("/steps/0".into(), false, true)]
        );
        assert_eq!(
            compared(json!([scale(2)]), json!([deadband])),
            [("/steps/0".into(), false, true), ("/steps/0".into(), true, false)]
        );
    }
}
