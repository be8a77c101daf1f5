//! Journals of operators, by network.

use std::collections::HashMap;

use asi_model::{OperationId, OperationNetworkId};

use crate::operator::{Journal, OperationKey, OperatorEntry};

/// Owner of the journals of all operations about which anything was entered.
#[derive(Debug, Default)]
pub struct JournalRegistry(HashMap<OperationNetworkId, HashMap<OperationId, Journal>>);

impl JournalRegistry {
    /// Returns the journal of an operation, if anything was entered about it.
    #[must_use]
    pub fn get(&self, operation: &OperationKey) -> Option<&Journal> {
        self.0.get(&operation.operation_network_id)?.get(&operation.operation_id)
    }

    /// Adds an entry to the journal of its operation.
    pub(crate) fn insert(&mut self, entry: OperatorEntry) {
        let OperationKey { operation_network_id, operation_id } = entry.operation.clone();
        let network = self.0.entry(operation_network_id).or_default();
        network.entry(operation_id).or_default().insert(entry);
    }

    /// Removes the journals of a network's operations, also of those that an earlier revision
    /// removed.
    pub(crate) fn remove(&mut self, network: &OperationNetworkId) {
        self.0.remove(network);
    }
}

#[cfg(test)]
mod tests {
    use asi_model::DateTime;

    use super::*;
    use crate::{operator::Action, scene::at};

    #[test]
    fn journals_are_removed_with_their_network_only() {
        let entry = |network: &str, made_at: DateTime| OperatorEntry {
            entry_id: "a".to_owned().try_into().expect("an id"),
            operation: OperationKey {
                operation_network_id: network.parse().expect("an id"),
                operation_id: "op".parse().expect("an id"),
            },
            made_at,
            received_at: made_at,
            made_by: "otto".to_owned(),
            action: Action::Start,
        };
        let mut journals = JournalRegistry::default();
        let (one, other) = (entry("n", at(0)), entry("m", at(0)));
        journals.insert(one.clone());
        journals.insert(other.clone());
        assert!(journals.get(&one.operation).is_some_and(|journal| journal.has(&one.entry_id)));
        journals.remove(&one.operation.operation_network_id);
        assert!(journals.get(&one.operation).is_none());
        assert!(journals.get(&other.operation).is_some());
    }
}
