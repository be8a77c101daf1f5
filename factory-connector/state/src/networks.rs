//! Operation networks with their dynamic data requests.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    sync::Arc,
};

use asi_model::{
    DateTime, DynamicDataRequestId, FieldKey, FieldName, OperationId, OperationNetworkId,
    OrganisationId, RequestKey,
    messages::OperationNetworkMessage,
    network::{DynamicDataRequest, Operation, ReportField},
    pubsub::RecipientList,
};

use crate::operator::OperationKey;

/// An operation network in its newest revision.
#[derive(Debug, Clone)]
pub struct Network {
    /// Revision of the network, or of its withdrawal.
    pub revision: u64,
    /// The message as received; `None` once withdrawn.
    pub message: Option<Arc<OperationNetworkMessage>>,
    pub received_at: DateTime,
    /// Positions of operations, requests and fields, so that each is found at the same cost in a
    /// large network as in a small one.
    operations: HashMap<OperationId, OperationPositions>,
}

/// Position of an operation in its network, and those of its requests.
#[derive(Debug, Clone)]
struct OperationPositions {
    position: usize,
    requests: HashMap<DynamicDataRequestId, RequestPositions>,
}

/// Position of a request in its operation, and those of its fields.
#[derive(Debug, Clone)]
struct RequestPositions {
    position: usize,
    /// Positions of the fields in the order of their names: a name is found by bisection.
    fields: Box<[u32]>,
    /// The recipients, encoded once for all reports.
    recipient_list: Option<RecipientList>,
}

impl RequestPositions {
    fn new(position: usize, request: &DynamicDataRequest) -> Self {
        let fields = &request.report_data_format.report_field_list;
        let mut by_name: Vec<(u32, &ReportField)> = (0..).zip(fields).collect();
        by_name.sort_by(|(_, left), (_, right)| left.name.cmp(&right.name));
        Self {
            position,
            fields: by_name.into_iter().map(|(position, _)| position).collect(),
            recipient_list: RecipientList::of(request),
        }
    }

    fn field<'n>(
        &self,
        request: &'n DynamicDataRequest,
        name: &FieldName,
    ) -> Option<&'n ReportField> {
        let fields = &request.report_data_format.report_field_list;
        let at = |position: u32| usize::try_from(position).ok().and_then(|at| fields.get(at));
        let order = |position: &u32| at(*position).map(|field| &field.name).cmp(&Some(name));
        at(self.fields[self.fields.binary_search_by(order).ok()?])
    }
}

impl Network {
    /// Takes a received network, or the tombstone of a withdrawn one.
    #[must_use]
    pub fn new(
        revision: u64,
        message: Option<Arc<OperationNetworkMessage>>,
        received_at: DateTime,
    ) -> Self {
        let operations =
            message.iter().flat_map(|message| &message.operation_network.operation_list);
        let operations = operations.enumerate().map(|(position, operation)| {
            let requests = operation.dynamic_data_request_list.iter().enumerate();
            let requests = requests.map(|(position, request)| {
                let id = request.dynamic_data_request_id.clone();
                (id, RequestPositions::new(position, request))
            });
            let requests = requests.collect();
            (operation.operation_id.clone(), OperationPositions { position, requests })
        });
        Self { revision, operations: operations.collect(), message, received_at }
    }

    fn operation(&self, id: &OperationId) -> Option<&Operation> {
        let OperationPositions { position, .. } = self.operations.get(id)?;
        self.message.as_ref()?.operation_network.operation_list.get(*position)
    }

    fn request(&self, key: &RequestKey) -> Option<(&DynamicDataRequest, &RequestPositions)> {
        let positions = self.operations.get(&key.operation_id)?;
        let positions = positions.requests.get(&key.dynamic_data_request_id)?;
        let operation = self.operation(&key.operation_id)?;
        let request = operation.dynamic_data_request_list.get(positions.position)?;
        Some((request, positions))
    }

    fn requests(&self) -> impl Iterator<Item = (RequestKey, &DynamicDataRequest)> {
        let message = self.message.iter();
        let requests = message.flat_map(|message| message.operation_network.requests());
        requests.map(|(key, _, request)| (key, request))
    }
}

/// Owner of all operation networks, withdrawn ones included.
#[derive(Debug, Default)]
pub struct NetworkRegistry {
    networks: BTreeMap<OperationNetworkId, Network>,
    /// Requests of active networks, by recipient.
    by_recipient: HashMap<OrganisationId, BTreeSet<RequestKey>>,
}

impl NetworkRegistry {
    /// Returns a network, withdrawn or not.
    #[must_use]
    pub fn get(&self, id: &OperationNetworkId) -> Option<&Network> {
        self.networks.get(id)
    }

    /// Returns all networks in the order of their ids, withdrawn ones included.
    pub fn iter(&self) -> impl Iterator<Item = (&OperationNetworkId, &Network)> {
        self.networks.iter()
    }

    /// Returns the messages of all active networks.
    pub fn active(&self) -> impl Iterator<Item = &Arc<OperationNetworkMessage>> {
        self.networks.values().filter_map(|network| network.message.as_ref())
    }

    /// Returns an operation of an active network.
    #[must_use]
    pub fn operation(&self, key: &OperationKey) -> Option<&Operation> {
        self.networks.get(&key.operation_network_id)?.operation(&key.operation_id)
    }

    /// Returns a request of an active network, with the message it came in.
    #[must_use]
    pub fn request(
        &self,
        key: &RequestKey,
    ) -> Option<(&Arc<OperationNetworkMessage>, &DynamicDataRequest)> {
        let network = self.networks.get(&key.operation_network_id)?;
        Some((network.message.as_ref()?, network.request(key)?.0))
    }

    /// Returns a field's definition as its request states it.
    #[must_use]
    pub fn definition(&self, key: &FieldKey) -> Option<&ReportField> {
        let network = self.networks.get(&key.request.operation_network_id)?;
        let (request, positions) = network.request(&key.request)?;
        positions.field(request, &key.field_name)
    }

    /// Returns the organisations that may read a request's reports.
    #[must_use]
    pub fn recipients(&self, request: &RequestKey) -> &[OrganisationId] {
        self.request(request).map_or(&[], |(_, document)| &document.recipient_list)
    }

    /// Returns the requests of active networks whose reports an organisation may read, sorted.
    pub(crate) fn requests_for(
        &self,
        recipient: &OrganisationId,
    ) -> impl Iterator<Item = &RequestKey> {
        self.by_recipient.get(recipient).into_iter().flatten()
    }

    /// Returns the organisations that may read a request's reports, as the reports name them;
    /// `None` where they name none.
    pub(crate) fn recipient_list(&self, key: &RequestKey) -> Option<&RecipientList> {
        let network = self.networks.get(&key.operation_network_id)?;
        network.request(key)?.1.recipient_list.as_ref()
    }

    pub(crate) fn put(&mut self, id: OperationNetworkId, network: Network) {
        for (key, request) in network.requests() {
            for recipient in &request.recipient_list {
                self.by_recipient.entry(recipient.clone()).or_default().insert(key.clone());
            }
        }
        let Some(former) = self.networks.insert(id, network) else { return };
        for (key, request) in former.requests() {
            let kept = self.recipients(&key).to_vec();
            for recipient in request.recipient_list.iter().filter(|former| !kept.contains(former)) {
                self.forget(recipient, &key);
            }
        }
    }

    fn forget(&mut self, recipient: &OrganisationId, key: &RequestKey) {
        let Some(requests) = self.by_recipient.get_mut(recipient) else { return };
        requests.remove(key);
        if requests.is_empty() {
            self.by_recipient.remove(recipient);
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::scene::{at, field, network};

    fn put(networks: &mut NetworkRegistry, revision: u64, request: &serde_json::Value) {
        let message = network(revision, |whole| {
            for (member, value) in request.as_object().expect("members") {
                whole[member] = value.clone();
            }
        });
        let id = message.operation_network.operation_network_id.clone();
        networks.put(id, Network::new(revision, Some(Arc::new(message)), at(0)));
    }

    #[test]
    fn a_definition_is_found_by_name_whatever_the_order() {
        let names = ["zeta", "alpha", "made", "note", "beta"];
        let fields = names.map(|name| json!({ "name": name, "type": 12, "description": name }));
        let mut networks = NetworkRegistry::default();
        let format = json!({ "reportName": "Progress", "reportFieldList": fields });
        put(&mut networks, 1, &json!({ "reportDataFormat": format }));
        for name in names {
            let found = networks.definition(&field(name));
            assert_eq!(found.and_then(|found| found.description.as_deref()), Some(name));
        }
        assert!(networks.definition(&field("gamma")).is_none());
        let none = json!({ "reportName": "Progress", "reportFieldList": [] });
        put(&mut networks, 2, &json!({ "reportDataFormat": none }));
        assert!(networks.definition(&field("made")).is_none());
    }

    #[test]
    fn requests_are_known_by_their_present_recipients() {
        let mut networks = NetworkRegistry::default();
        let count = |networks: &NetworkRegistry, recipient: &str| {
            networks.requests_for(&recipient.parse().expect("an id")).count()
        };
        put(&mut networks, 1, &json!({ "recipientList": ["acme", "hull"] }));
        put(&mut networks, 2, &json!({ "recipientList": ["hull", "spy"] }));
        let counts = ["acme", "hull", "spy"].map(|recipient| count(&networks, recipient));
        assert_eq!(counts, [0, 1, 1]);
        networks.put("n".parse().expect("an id"), Network::new(3, None, at(0)));
        assert!(networks.by_recipient.is_empty(), "a withdrawn network has no requests");
    }
}
