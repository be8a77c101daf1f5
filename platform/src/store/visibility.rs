//! Visibility of a network's parts: who owns them, and which of them a viewer sees. Pure functions
//! of document and owners; see `docs/rights.md`.

use std::collections::{BTreeSet, HashMap, HashSet};

use asi_model::{
    DynamicDataRequestId, FactoryId, OperationId, OrganisationId,
    network::{DynamicDataRequest, Operation, OperationKind, OperationNetwork, OperationRelation},
    split,
};

use super::scope::Scope;

/// Owners of a network and of what is in it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct NetworkOwners {
    /// The organisation that drew the network; none where only administrators own it.
    pub drawn_by: Option<OrganisationId>,
    /// The organisation of each factory of the collaboration.
    pub factories: HashMap<FactoryId, OrganisationId>,
    /// The organisation that added an operation, where one is known.
    pub drawers: HashMap<OperationId, OrganisationId>,
    /// Requests of which the factory has opened a field, with the parties to whom it did so.
    pub consents: HashSet<(DynamicDataRequestId, OrganisationId)>,
}

impl NetworkOwners {
    /// Returns the organisation that performs an operation: that of its factory.
    #[must_use]
    pub fn performer(&self, operation: &Operation) -> Option<&OrganisationId> {
        self.factories.get(operation.owning_factory_id.as_ref()?)
    }
}

/// Extent to which a viewer sees an operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sight {
    /// All members; of its requests those that concern the viewer.
    Full,
    /// Type, id, name, owner and plan times, and the requests that concern the viewer.
    Part,
    Hidden,
}

/// Visibility of a revision's parts for one viewer.
#[derive(Debug)]
pub struct Visibility<'n> {
    network: &'n OperationNetwork,
    owners: &'n NetworkOwners,
    viewer: Viewer<'n>,
    full: HashSet<&'n OperationId>,
    parts: HashSet<&'n OperationId>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Viewer<'n> {
    /// The platform itself and administrators: the whole structure.
    Everything,
    Organisation(&'n OrganisationId),
    Nobody,
}

impl<'n> Visibility<'n> {
    /// Determines the visibility of a revision for the viewer of a scope.
    #[must_use]
    pub fn new(network: &'n OperationNetwork, owners: &'n NetworkOwners, scope: &'n Scope) -> Self {
        match scope {
            Scope::Platform | Scope::Administration { .. } => {
                let full = network.operation_list.iter().map(|o| &o.operation_id).collect();
                Self { network, owners, viewer: Viewer::Everything, full, parts: HashSet::new() }
            }
            Scope::Organisation(organisation) => Self::of(network, owners, organisation),
            Scope::Nothing => {
                let (full, parts) = (HashSet::new(), HashSet::new());
                Self { network, owners, viewer: Viewer::Nobody, full, parts }
            }
        }
    }

    /// Determines the visibility of a revision for an organisation.
    #[must_use]
    pub fn of(
        network: &'n OperationNetwork,
        owners: &'n NetworkOwners,
        viewer: &'n OrganisationId,
    ) -> Self {
        let is_drawer = owners.drawn_by.as_ref() == Some(viewer);
        let performs = |operation: &Operation| owners.performer(operation) == Some(viewer);
        let (mut full, mut own, mut asked) = (HashSet::new(), HashSet::new(), Vec::new());
        for operation in &network.operation_list {
            if performs(operation) {
                own.insert(&operation.operation_id);
            }
            let is_drawn = is_drawer || owners.drawers.get(&operation.operation_id) == Some(viewer);
            let parties =
                operation.dynamic_data_request_list.iter().filter(|r| is_party(r, viewer));
            let ids: Vec<_> = parties.map(|request| &request.dynamic_data_request_id).collect();
            // To ask opens nothing: the inside is for whom the factory lets see something of it.
            let is_open =
                ids.iter().any(|&id| owners.consents.contains(&(id.clone(), viewer.clone())));
            if is_drawn || performs(operation) || is_open {
                full.insert(&operation.operation_id);
            } else if !ids.is_empty() {
                asked.push(&operation.operation_id);
            }
        }
        let parts =
            neighbours(network, &own).chain(asked).filter(|id| !full.contains(id)).collect();
        Self { network, owners, viewer: Viewer::Organisation(viewer), full, parts }
    }

    /// Returns how much of an operation the viewer sees.
    #[must_use]
    pub fn operation(&self, id: &OperationId) -> Sight {
        if self.full.contains(id) {
            Sight::Full
        } else if self.parts.contains(id) {
            Sight::Part
        } else {
            Sight::Hidden
        }
    }

    /// Returns true for requests that the viewer makes, receives or is asked, and for all where the
    /// viewer sees the whole structure. The drawer of the network does not see what others ask.
    #[must_use]
    pub fn request(&self, operation: &Operation, request: &DynamicDataRequest) -> bool {
        match self.viewer {
            Viewer::Everything => true,
            Viewer::Nobody => false,
            Viewer::Organisation(viewer) => {
                is_party(request, viewer) || self.owners.performer(operation) == Some(viewer)
            }
        }
    }

    /// Returns true for relations both of whose ends the viewer sees.
    #[must_use]
    pub fn relation(&self, relation: &OperationRelation) -> bool {
        [&relation.predecessor_operation_id, &relation.successor_operation_id]
            .into_iter()
            .all(|id| self.operation(id) != Sight::Hidden)
    }

    /// Returns the network as the viewer sees it, in the order of the document.
    #[must_use]
    pub fn project(&self) -> OperationNetwork {
        if self.viewer == Viewer::Everything {
            return self.network.clone();
        }
        let operations = self.network.operation_list.iter().filter_map(|operation| {
            match self.operation(&operation.operation_id) {
                Sight::Full => Some(self.in_full(operation)),
                Sight::Part => Some(self.in_part(operation)),
                Sight::Hidden => None,
            }
        });
        let relations = self.network.operation_relation_list.iter();
        OperationNetwork {
            operation_network_id: self.network.operation_network_id.clone(),
            name: self.network.name.clone(),
            description: self.network.description.clone(),
            operation_list: operations.collect(),
            operation_relation_list: relations.filter(|r| self.relation(r)).cloned().collect(),
        }
    }

    /// Returns the factories of whose operations the viewer sees any.
    #[must_use]
    pub fn factories(&self) -> BTreeSet<&'n FactoryId> {
        let operations = self.network.operation_list.iter();
        operations
            .filter(|operation| self.operation(&operation.operation_id) != Sight::Hidden)
            .filter_map(|operation| operation.owning_factory_id.as_ref())
            .collect()
    }

    /// Another's operation in part, with the requests that the viewer may see. With such it is no stub in
    /// the words of the contract.
    fn in_part(&self, operation: &Operation) -> Operation {
        let requests = operation.dynamic_data_request_list.iter();
        let requests: Vec<DynamicDataRequest> =
            requests.filter(|request| self.request(operation, request)).cloned().collect();
        Operation {
            stub: requests.is_empty(),
            dynamic_data_request_list: requests,
            ..part_of(operation)
        }
    }

    /// An operation with the requests that the viewer may see; a hidden operation that it inspects
    /// is not named.
    fn in_full(&self, operation: &Operation) -> Operation {
        let mut shown = operation.clone();
        shown.dynamic_data_request_list.retain(|request| self.request(operation, request));
        if let OperationKind::Inspection { inspected_operation_id, .. } = &mut shown.kind
            && inspected_operation_id
                .as_ref()
                .is_some_and(|inspected| self.operation(inspected) == Sight::Hidden)
        {
            *inspected_operation_id = None;
        }
        shown
    }
}

/// Returns the part of another's operation that partners see: as factories are sent it, with the plan
/// times, and without requests.
#[must_use]
pub fn part_of(operation: &Operation) -> Operation {
    Operation {
        planned_start: operation.planned_start,
        planned_end: operation.planned_end,
        ..split::stub(operation)
    }
}

/// Returns the organisations that see anything of a revision, with the factories whose operations
/// each of them sees; the drawer, who sees all, is left out.
#[must_use]
pub fn viewers(
    network: &OperationNetwork,
    owners: &NetworkOwners,
) -> Vec<(OrganisationId, FactoryId)> {
    let mut organisations: BTreeSet<&OrganisationId> = owners.drawers.values().collect();
    for operation in &network.operation_list {
        organisations.extend(owners.performer(operation));
        for request in &operation.dynamic_data_request_list {
            organisations.insert(&request.requester_id);
            organisations.extend(&request.recipient_list);
        }
    }
    organisations
        .into_iter()
        .filter(|organisation| owners.drawn_by.as_ref() != Some(*organisation))
        .flat_map(|organisation| {
            let visibility = Visibility::of(network, owners, organisation);
            let factories: Vec<FactoryId> = visibility.factories().into_iter().cloned().collect();
            factories.into_iter().map(move |factory| (organisation.clone(), factory))
        })
        .collect()
}

fn is_party(request: &DynamicDataRequest, organisation: &OrganisationId) -> bool {
    request.requester_id == *organisation || request.recipient_list.contains(organisation)
}

/// Operations that a relation joins to one's own, and those that one's own inspect.
fn neighbours<'n>(
    network: &'n OperationNetwork,
    own: &HashSet<&'n OperationId>,
) -> impl Iterator<Item = &'n OperationId> {
    let related = network.operation_relation_list.iter().flat_map(move |relation| {
        let ends = [&relation.predecessor_operation_id, &relation.successor_operation_id];
        let is_own = ends.iter().any(|id| own.contains(id));
        ends.into_iter().filter(move |_| is_own)
    });
    let inspected = network.operation_list.iter().filter_map(move |operation| {
        let OperationKind::Inspection { inspected_operation_id, .. } = &operation.kind else {
            return None;
        };
        inspected_operation_id.as_ref().filter(|_| own.contains(&operation.operation_id))
    });
    related.chain(inspected)
}

#[cfg(test)]
mod tests;
