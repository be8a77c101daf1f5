//! Operation networks with their dynamic data requests.

use std::{
    collections::{BTreeMap, HashMap},
    sync::Arc,
};

use asi_model::{
    DateTime, DynamicDataRequestId, FieldKey, OperationId, OperationNetworkId, OrganisationId,
    RequestKey,
    messages::OperationNetworkMessage,
    network::{DynamicDataRequest, Operation, ReportField},
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
    /// Positions of operations and their requests, so that a request is found at the same cost in
    /// a large network as in a small one.
    positions: HashMap<OperationId, (usize, HashMap<DynamicDataRequestId, usize>)>,
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
        let positions = operations.enumerate().map(|(position, operation)| {
            let requests = operation.dynamic_data_request_list.iter().enumerate();
            let requests = requests
                .map(|(position, request)| (request.dynamic_data_request_id.clone(), position));
            (operation.operation_id.clone(), (position, requests.collect()))
        });
        Self { revision, positions: positions.collect(), message, received_at }
    }

    fn operation(&self, id: &OperationId) -> Option<&Operation> {
        let (position, _) = self.positions.get(id)?;
        self.message.as_ref()?.operation_network.operation_list.get(*position)
    }
}

/// Owner of all operation networks, withdrawn ones included.
#[derive(Debug, Default)]
pub struct NetworkRegistry {
    networks: BTreeMap<OperationNetworkId, Network>,
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
        let message = network.message.as_ref()?;
        let (operation, requests) = network.positions.get(&key.operation_id)?;
        let request = requests.get(&key.dynamic_data_request_id)?;
        let operation = message.operation_network.operation_list.get(*operation)?;
        Some((message, operation.dynamic_data_request_list.get(*request)?))
    }

    /// Returns a field's definition as its request states it.
    #[must_use]
    pub fn definition(&self, key: &FieldKey) -> Option<&ReportField> {
        let (_, request) = self.request(&key.request)?;
        let mut fields = request.report_data_format.report_field_list.iter();
        fields.find(|field| field.name == key.field_name)
    }

    /// Returns the organisations that may read a request's reports.
    #[must_use]
    pub fn recipients(&self, request: &RequestKey) -> &[OrganisationId] {
        self.request(request).map_or(&[], |(_, document)| &document.recipient_list)
    }

    pub(crate) fn put(&mut self, id: OperationNetworkId, network: Network) {
        self.networks.insert(id, network);
    }
}
