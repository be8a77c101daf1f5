//! One Activity Status Interface: the network as it was received, indexes into it, and a record for
//! every field.
//!
//! Lists inside a network may be long, so elements are found by binary search over ordered indexes of
//! four bytes each.

use std::{collections::HashMap, sync::Arc};

use asi_model::{
    DateTime, DynamicDataRequestId, FieldKey, FieldName, OperationId, OperationRelationId,
    RequestKey,
    messages::OperationNetworkMessage,
    network::{
        DynamicDataRequest, Operation, OperationNetwork, OperationRelation, ReportField, Semantic,
    },
};
use parking_lot::RwLock;

use super::node_address::NodeAddress;
use crate::document::{AsiDocument, FieldRecord};

/// Position of a dynamic data request within its network.
#[derive(Debug, Clone, Copy)]
pub(super) struct RequestSlot {
    pub operation: u32,
    pub position: u32,
    /// Index of its first field among all fields of the network.
    pub first_field: u32,
    pub data_set_writer_id: Option<u16>,
}

/// One Activity Status Interface.
pub(super) struct Interface {
    /// Number in the order of arrival; never reused.
    pub sequence: u64,
    pub message: Arc<OperationNetworkMessage>,
    pub received_at: DateTime,
    pub requests: Box<[RequestSlot]>,
    /// NodeVersion of all nodes that are not in `versions`.
    pub base_version: u64,
    /// NodeVersions that differ from the base version.
    pub versions: HashMap<NodeAddress, u64>,
    operations_by_id: Box<[u32]>,
    relations_by_id: Box<[u32]>,
    requests_by_id: Box<[u32]>,
    /// Field indexes; each request's range is ordered by name.
    fields_by_name: Box<[u32]>,
    /// Pairs of operation and relation, ordered by operation.
    relations_by_operation: Box<[(u32, u32)]>,
    pub records: RwLock<Box<[FieldRecord]>>,
}

fn position(index: usize) -> u32 {
    u32::try_from(index).expect("a message of at most one MiB has fewer than 2^32 entries")
}

fn ordered_by<'a, K: Ord>(count: usize, key: impl Fn(usize) -> K + 'a) -> Box<[u32]> {
    let mut order: Vec<u32> = (0..count).map(position).collect();
    order.sort_by_key(|i| key(*i as usize));
    order.into_boxed_slice()
}

fn find(order: &[u32], compare: impl Fn(usize) -> std::cmp::Ordering) -> Option<u32> {
    order.binary_search_by(|i| compare(*i as usize)).ok().map(|found| order[found])
}

impl Interface {
    /// Indexes a document; `versions` is empty at first.
    pub fn new(document: AsiDocument, sequence: u64, base_version: u64) -> Self {
        let AsiDocument { message, received_at, writers, mut fields } = document;
        let network = &message.operation_network;
        let (mut requests, mut records) = (Vec::new(), Vec::new());
        for (operation_position, operation) in network.operation_list.iter().enumerate() {
            for (request_position, request) in
                operation.dynamic_data_request_list.iter().enumerate()
            {
                let key = RequestKey {
                    operation_network_id: network.operation_network_id.clone(),
                    operation_id: operation.operation_id.clone(),
                    dynamic_data_request_id: request.dynamic_data_request_id.clone(),
                };
                requests.push(RequestSlot {
                    operation: position(operation_position),
                    position: position(request_position),
                    first_field: position(records.len()),
                    data_set_writer_id: writers.get(&key).copied(),
                });
                let names = request
                    .report_data_format
                    .report_field_list
                    .iter()
                    .map(|field| field.name.clone());
                records
                    .extend(names.map(|name| fields.remove(&key.field(name)).unwrap_or_default()));
            }
        }
        let requests = requests.into_boxed_slice();
        Self {
            sequence,
            received_at,
            base_version,
            versions: HashMap::new(),
            operations_by_id: ordered_by(network.operation_list.len(), |i| {
                &network.operation_list[i].operation_id
            }),
            relations_by_id: ordered_by(network.operation_relation_list.len(), |i| {
                &network.operation_relation_list[i].operation_relation_id
            }),
            requests_by_id: ordered_by(requests.len(), |i| {
                (
                    &request_of(network, &requests[i]).dynamic_data_request_id,
                    &network.operation_list[requests[i].operation as usize].operation_id,
                )
            }),
            fields_by_name: fields_by_name(network, &requests),
            relations_by_operation: relations_by_operation(network),
            requests,
            records: RwLock::new(records.into_boxed_slice()),
            message,
        }
    }

    /// Returns the network as it was received.
    pub fn network(&self) -> &OperationNetwork {
        &self.message.operation_network
    }

    /// Returns an operation by its index.
    pub fn operation(&self, operation: u32) -> &Operation {
        &self.network().operation_list[operation as usize]
    }

    /// Returns a relation by its index.
    pub fn relation(&self, relation: u32) -> &OperationRelation {
        &self.network().operation_relation_list[relation as usize]
    }

    /// Returns a request by its index.
    pub fn request(&self, request: u32) -> &DynamicDataRequest {
        request_of(self.network(), &self.requests[request as usize])
    }

    /// Returns the position of a request in the network.
    pub fn slot(&self, request: u32) -> &RequestSlot {
        &self.requests[request as usize]
    }

    /// Returns the request of a field, and the field's definition.
    pub fn field(&self, field: u32) -> (u32, &ReportField) {
        let request = self.requests.partition_point(|slot| slot.first_field <= field) - 1;
        let request = position(request);
        let within = field - self.slot(request).first_field;
        (request, &self.request(request).report_data_format.report_field_list[within as usize])
    }

    /// Returns a copy of a field's record.
    pub fn record(&self, field: u32) -> FieldRecord {
        self.records.read()[field as usize].clone()
    }

    /// Returns the indexes of a request's fields.
    pub fn fields_of(&self, request: u32) -> std::ops::Range<u32> {
        let first = self.slot(request).first_field;
        first..first + position(self.request(request).report_data_format.report_field_list.len())
    }

    /// Returns the indexes of an operation's requests.
    pub fn requests_of(&self, operation: u32) -> std::ops::Range<u32> {
        let first = self.requests.partition_point(|slot| slot.operation < operation);
        let last = self.requests.partition_point(|slot| slot.operation <= operation);
        position(first)..position(last)
    }

    /// Returns the relations of an operation.
    pub fn relations_of(&self, operation: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.relations_by_operation.partition_point(|(o, _)| *o < operation);
        self.relations_by_operation[first..]
            .iter()
            .take_while(move |(o, _)| *o == operation)
            .map(|(_, r)| *r)
    }

    /// Finds an operation by the text of its id.
    pub fn find_operation(&self, id: &str) -> Option<u32> {
        find(&self.operations_by_id, |i| {
            AsRef::<str>::as_ref(&self.network().operation_list[i].operation_id).cmp(id)
        })
    }

    /// Finds an operation by its id.
    pub fn find_operation_id(&self, id: &OperationId) -> Option<u32> {
        self.find_operation(id.as_str())
    }

    /// Finds a relation by its id.
    pub fn find_relation(&self, id: &str) -> Option<u32> {
        find(&self.relations_by_id, |i| {
            let relation_id: &OperationRelationId =
                &self.network().operation_relation_list[i].operation_relation_id;
            relation_id.as_str().cmp(id)
        })
    }

    /// Finds a request by its id and its operation's.
    pub fn find_request(&self, operation_id: &str, id: &str) -> Option<u32> {
        find(&self.requests_by_id, |i| {
            let request_id: &DynamicDataRequestId =
                &request_of(self.network(), &self.requests[i]).dynamic_data_request_id;
            let operation = &self.operation(self.requests[i].operation).operation_id;
            (request_id.as_str(), operation.as_str()).cmp(&(id, operation_id))
        })
    }

    /// Finds a field of a request by its name.
    pub fn find_field(&self, request: u32, name: &str) -> Option<u32> {
        let range = self.fields_of(request);
        let order = &self.fields_by_name[range.start as usize..range.end as usize];
        let fields = &self.request(request).report_data_format.report_field_list;
        find(order, |i| {
            let field_name: &FieldName = &fields[i - range.start as usize].name;
            field_name.as_str().cmp(name)
        })
    }

    /// Finds a field by its key.
    pub fn find_key(&self, key: &FieldKey) -> Option<u32> {
        let request = self.find_request(
            key.request.operation_id.as_str(),
            key.request.dynamic_data_request_id.as_str(),
        )?;
        self.find_field(request, key.field_name.as_str())
    }

    /// Returns the key of a field.
    pub fn key_of(&self, field: u32) -> FieldKey {
        let (request, definition) = self.field(field);
        let key = RequestKey {
            operation_network_id: self.network().operation_network_id.clone(),
            operation_id: self.operation(self.slot(request).operation).operation_id.clone(),
            dynamic_data_request_id: self.request(request).dynamic_data_request_id.clone(),
        };
        key.field(definition.name.clone())
    }

    /// Returns the DataSetWriterIds by request.
    pub fn writers(&self) -> HashMap<RequestKey, u16> {
        let with_writer = self.network().requests().zip(&self.requests);
        with_writer
            .filter_map(|((key, _, _), slot)| Some((key, slot.data_set_writer_id?)))
            .collect()
    }

    /// Returns the field that discloses an operation's state.
    pub fn state_field(&self, operation: u32) -> Option<u32> {
        self.requests_of(operation)
            .flat_map(|request| self.fields_of(request))
            .find(|field| self.field(*field).1.semantic == Some(Semantic::OperationState))
    }

    /// Returns the NodeVersion of a node.
    pub fn version(&self, address: NodeAddress) -> u64 {
        self.versions.get(&address).copied().unwrap_or(self.base_version)
    }
}

fn request_of<'a>(network: &'a OperationNetwork, slot: &RequestSlot) -> &'a DynamicDataRequest {
    &network.operation_list[slot.operation as usize].dynamic_data_request_list
        [slot.position as usize]
}

fn fields_by_name(network: &OperationNetwork, requests: &[RequestSlot]) -> Box<[u32]> {
    let mut order = Vec::new();
    for slot in requests {
        let fields = &request_of(network, slot).report_data_format.report_field_list;
        let within = ordered_by(fields.len(), |i| &fields[i].name);
        order.extend(within.iter().map(|i| i + slot.first_field));
    }
    order.into_boxed_slice()
}

fn relations_by_operation(network: &OperationNetwork) -> Box<[(u32, u32)]> {
    let positions: HashMap<&OperationId, u32> = network
        .operation_list
        .iter()
        .enumerate()
        .map(|(i, operation)| (&operation.operation_id, position(i)))
        .collect();
    let mut pairs: Vec<(u32, u32)> = network
        .operation_relation_list
        .iter()
        .enumerate()
        .flat_map(|(i, relation)| {
            [&relation.predecessor_operation_id, &relation.successor_operation_id]
                .into_iter()
                .filter_map(|id| positions.get(id))
                .map(move |operation| (*operation, position(i)))
        })
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs.into_boxed_slice()
}
