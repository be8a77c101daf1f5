//! One Activity Status Interface: the network as it was received, indexes into it, and a record for
//! every field.
//!
//! Lists inside a network may be long, so everything is found by binary search over positions; the
//! positions cost four bytes an entry.

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

use super::place::Place;
use crate::document::{AsiDocument, FieldRecord};

/// One dynamic data request within its network.
#[derive(Debug, Clone, Copy)]
pub(super) struct RequestSlot {
    pub operation: u32,
    pub position: u32,
    /// The number of its first field among all fields of the network.
    pub first_field: u32,
    pub data_set_writer_id: Option<u16>,
}

/// One Activity Status Interface.
pub(super) struct Interface {
    /// Its place in the order of arrival; never reused.
    pub sequence: u64,
    pub message: Arc<OperationNetworkMessage>,
    pub received_at: DateTime,
    pub requests: Box<[RequestSlot]>,
    /// NodeVersion of everything that is not in `versions`.
    pub base_version: u64,
    /// NodeVersion of what changed after the interface came.
    pub versions: HashMap<Place, u64>,
    operations_by_id: Box<[u32]>,
    relations_by_id: Box<[u32]>,
    requests_by_id: Box<[u32]>,
    /// Field numbers; each request's range is ordered by name.
    fields_by_name: Box<[u32]>,
    /// (operation, relation) ordered by operation: the relations that name it.
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
    /// Indexes a document. `versions` are taken over from the state before, where there was one.
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

    pub fn network(&self) -> &OperationNetwork {
        &self.message.operation_network
    }

    pub fn operation(&self, operation: u32) -> &Operation {
        &self.network().operation_list[operation as usize]
    }

    pub fn relation(&self, relation: u32) -> &OperationRelation {
        &self.network().operation_relation_list[relation as usize]
    }

    pub fn request(&self, request: u32) -> &DynamicDataRequest {
        request_of(self.network(), &self.requests[request as usize])
    }

    pub fn slot(&self, request: u32) -> &RequestSlot {
        &self.requests[request as usize]
    }

    /// The request that a field belongs to, and the field's definition.
    pub fn field(&self, field: u32) -> (u32, &ReportField) {
        let request = self.requests.partition_point(|slot| slot.first_field <= field) - 1;
        let request = position(request);
        let within = field - self.slot(request).first_field;
        (request, &self.request(request).report_data_format.report_field_list[within as usize])
    }

    pub fn record(&self, field: u32) -> FieldRecord {
        self.records.read()[field as usize].clone()
    }

    /// The numbers of a request's fields.
    pub fn fields_of(&self, request: u32) -> std::ops::Range<u32> {
        let first = self.slot(request).first_field;
        first..first + position(self.request(request).report_data_format.report_field_list.len())
    }

    /// The numbers of an operation's requests.
    pub fn requests_of(&self, operation: u32) -> std::ops::Range<u32> {
        let first = self.requests.partition_point(|slot| slot.operation < operation);
        let last = self.requests.partition_point(|slot| slot.operation <= operation);
        position(first)..position(last)
    }

    /// The relations that name an operation.
    pub fn relations_of(&self, operation: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.relations_by_operation.partition_point(|(o, _)| *o < operation);
        self.relations_by_operation[first..]
            .iter()
            .take_while(move |(o, _)| *o == operation)
            .map(|(_, r)| *r)
    }

    pub fn find_operation(&self, id: &str) -> Option<u32> {
        find(&self.operations_by_id, |i| {
            AsRef::<str>::as_ref(&self.network().operation_list[i].operation_id).cmp(id)
        })
    }

    pub fn find_operation_id(&self, id: &OperationId) -> Option<u32> {
        self.find_operation(id.as_str())
    }

    pub fn find_relation(&self, id: &str) -> Option<u32> {
        find(&self.relations_by_id, |i| {
            let relation_id: &OperationRelationId =
                &self.network().operation_relation_list[i].operation_relation_id;
            relation_id.as_str().cmp(id)
        })
    }

    /// A request by its id and its operation's.
    pub fn find_request(&self, operation_id: &str, id: &str) -> Option<u32> {
        find(&self.requests_by_id, |i| {
            let request_id: &DynamicDataRequestId =
                &request_of(self.network(), &self.requests[i]).dynamic_data_request_id;
            let operation = &self.operation(self.requests[i].operation).operation_id;
            (request_id.as_str(), operation.as_str()).cmp(&(id, operation_id))
        })
    }

    pub fn find_field(&self, request: u32, name: &str) -> Option<u32> {
        let range = self.fields_of(request);
        let order = &self.fields_by_name[range.start as usize..range.end as usize];
        let fields = &self.request(request).report_data_format.report_field_list;
        find(order, |i| {
            let field_name: &FieldName = &fields[i - range.start as usize].name;
            field_name.as_str().cmp(name)
        })
    }

    pub fn find_key(&self, key: &FieldKey) -> Option<u32> {
        let request = self.find_request(
            key.request.operation_id.as_str(),
            key.request.dynamic_data_request_id.as_str(),
        )?;
        self.find_field(request, key.field_name.as_str())
    }

    pub fn key_of(&self, field: u32) -> FieldKey {
        let (request, definition) = self.field(field);
        let key = RequestKey {
            operation_network_id: self.network().operation_network_id.clone(),
            operation_id: self.operation(self.slot(request).operation).operation_id.clone(),
            dynamic_data_request_id: self.request(request).dynamic_data_request_id.clone(),
        };
        key.field(definition.name.clone())
    }

    /// The DataSetWriterIds, by request.
    pub fn writers(&self) -> HashMap<RequestKey, u16> {
        let with_writer = self.network().requests().zip(&self.requests);
        with_writer
            .filter_map(|((key, _, _), slot)| Some((key, slot.data_set_writer_id?)))
            .collect()
    }

    /// The field that says an operation's state, if the operation has one.
    pub fn state_field(&self, operation: u32) -> Option<u32> {
        self.requests_of(operation)
            .flat_map(|request| self.fields_of(request))
            .find(|field| self.field(*field).1.semantic == Some(Semantic::OperationState))
    }

    /// The NodeVersion of a container.
    pub fn version(&self, place: Place) -> u64 {
        self.versions.get(&place).copied().unwrap_or(self.base_version)
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
