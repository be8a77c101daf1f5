//! Merging of a document as its author sees the network with what is hidden from the author.

use std::{
    collections::{HashMap, HashSet},
    hash::Hash,
};

use asi_model::network::{Operation, OperationNetwork};

use crate::store::{Sight, Visibility};

/// Returns the whole network that an author's document makes: what the author sees is replaced,
/// what is hidden stays in its place. The document has passed the checks of rights, so that of
/// others' operations only the plan can differ, for an author who may propose one.
pub(super) fn merge(
    before: &OperationNetwork,
    visibility: &Visibility<'_>,
    performs: impl Fn(&Operation) -> bool,
    may_propose: bool,
    document: &OperationNetwork,
) -> OperationNetwork {
    let stored: HashMap<_, &Operation> =
        before.operation_list.iter().map(|stored| (&stored.operation_id, stored)).collect();
    let operations =
        document.operation_list.iter().map(|shown| match stored.get(&shown.operation_id) {
            None => shown.clone(),
            Some(stored) => {
                let mut merged = match visibility.operation(&stored.operation_id) {
                    Sight::Full if performs(stored) => shown.clone(),
                    Sight::Full if may_propose => planned(stored, shown),
                    Sight::Full | Sight::Part | Sight::Hidden => (*stored).clone(),
                };
                merged.dynamic_data_request_list = merge_list(
                    &stored.dynamic_data_request_list,
                    &shown.dynamic_data_request_list,
                    |request| &request.dynamic_data_request_id,
                    |request| !visibility.request(stored, request),
                );
                merged
            }
        });
    OperationNetwork {
        operation_list: merge_list(
            &before.operation_list,
            &operations.collect::<Vec<_>>(),
            |operation| &operation.operation_id,
            |operation| visibility.operation(&operation.operation_id) == Sight::Hidden,
        ),
        operation_relation_list: merge_list(
            &before.operation_relation_list,
            &document.operation_relation_list,
            |relation| &relation.operation_relation_id,
            |relation| !visibility.relation(relation),
        ),
        operation_network_id: document.operation_network_id.clone(),
        name: document.name.clone(),
        description: document.description.clone(),
    }
}

/// Another's operation with the plan that the document proposes.
fn planned(stored: &Operation, shown: &Operation) -> Operation {
    Operation {
        planned_start: shown.planned_start,
        planned_end: shown.planned_end,
        planned_quantity: shown.planned_quantity,
        quantity_unit: shown.quantity_unit.clone(),
        ..stored.clone()
    }
}

/// Puts hidden elements behind the visible one that they followed, as far as it is still there.
fn merge_list<T: Clone, I: Eq + Hash>(
    stored: &[T],
    shown: &[T],
    id: impl Fn(&T) -> &I,
    is_hidden: impl Fn(&T) -> bool,
) -> Vec<T> {
    let present: HashSet<&I> = shown.iter().map(&id).collect();
    let mut followers: HashMap<Option<&I>, Vec<&T>> = HashMap::new();
    let mut anchor = None;
    for element in stored {
        if is_hidden(element) {
            followers.entry(anchor).or_default().push(element);
        } else if present.contains(id(element)) {
            anchor = Some(id(element));
        }
    }
    let leading = followers.remove(&None).unwrap_or_default();
    let mut merged: Vec<T> = leading.into_iter().cloned().collect();
    for element in shown {
        merged.push(element.clone());
        let behind = followers.remove(&Some(id(element))).unwrap_or_default();
        merged.extend(behind.into_iter().cloned());
    }
    merged
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn merged(stored: &str, shown: &str) -> String {
        let list = |text: &str| text.chars().collect::<Vec<_>>();
        // Capital letters are hidden.
        merge_list(&list(stored), &list(shown), |letter| letter, |letter| letter.is_uppercase())
            .into_iter()
            .collect()
    }

    #[test]
    fn hidden_elements_keep_their_places() {
        for (stored, shown, expected) in [
            ("aXbY", "ab", "aXbY"),
            ("XabY", "ab", "XabY"),
            ("aXbY", "b", "XbY"),
            ("aXbY", "ba", "bYaX"),
            ("aXbY", "acb", "aXcbY"),
            ("aXYb", "", "XY"),
            ("XY", "ab", "XYab"),
        ] {
            assert_eq!(merged(stored, shown), expected, "{stored} and {shown}");
        }
    }

    proptest! {
        #[test]
        fn nothing_hidden_is_lost_or_doubled(stored in "[a-f]{0,3}[A-F]{0,3}[g-k]{0,3}", shown in "[a-k]{0,8}") {
            let distinct = |text: &str| {
                let mut seen = HashSet::new();
                text.chars().filter(|letter| seen.insert(*letter)).collect::<String>()
            };
            let (stored, shown) = (distinct(&stored), distinct(&shown));
            let merged = merged(&stored, &shown);
            let part = |is_hidden: bool| {
                merged.chars().filter(|letter| letter.is_uppercase() == is_hidden).collect::<String>()
            };
            let mut hidden: Vec<char> = part(true).chars().collect();
            hidden.sort_unstable();
            let mut expected: Vec<char> = stored.chars().filter(|c| c.is_uppercase()).collect();
            expected.sort_unstable();
            prop_assert_eq!(hidden, expected);
            prop_assert_eq!(part(false), shown);
        }
    }
}
