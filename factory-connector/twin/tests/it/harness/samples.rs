//! Networks, fields and values as the connector hands them to the twin.

use std::{collections::HashMap, sync::Arc};

use asi_model::{
    BuiltInType, DataValue, FieldKey,
    messages::{MappingState, OperationNetworkMessage, PlatformMessage, ValueSource},
};
use disclosure::{DisclosurePolicy, Gate, GateState, Released, StatusCodes};
use opcua_stack::opcua::types::NodeId;
use twin::{AsiDocument, FieldRecord};

use super::{INSTANCES, now};

pub fn instance(identifier: &str) -> NodeId {
    NodeId::new(INSTANCES, identifier)
}

/// Returns the example message of the wire contract, with another revision and id.
pub fn message(network: &str, revision: u64) -> OperationNetworkMessage {
    let text = include_str!("../frame-order.json");
    let PlatformMessage::OperationNetwork(mut message) = serde_json::from_str(text).unwrap() else {
        panic!("the example is an operation network")
    };
    message.revision = revision;
    message.operation_network.operation_network_id = network.parse().unwrap();
    message
}

pub fn document(message: OperationNetworkMessage) -> AsiDocument {
    let keys: Vec<_> = message.operation_network.requests().map(|(key, _, _)| key).collect();
    AsiDocument {
        message: Arc::new(message),
        received_at: now(),
        writers: (1..).zip(keys).map(|(writer, key)| (key, writer)).collect(),
        fields: HashMap::new(),
    }
}

pub fn field(network: &str, name: &str) -> FieldKey {
    serde_json::from_value(serde_json::json!({
        "operationNetworkId": network,
        "operationId": "MakeFrame1",
        "dynamicDataRequestId": "ReqResponse1",
        "fieldName": name,
    }))
    .unwrap()
}

/// Returns a released number that was measured now.
pub fn good(number: u64) -> Released {
    released(DataValue::good(number, now()))
}

/// Lets a value through an open gate, which is the only way to show one.
pub fn released(value: DataValue) -> Released {
    let field_type = value.value.built_in_type().unwrap_or(BuiltInType::UInt64);
    let policy = DisclosurePolicy { status_codes: StatusCodes::Full, ..Default::default() };
    let mut gate = Gate::new(Arc::new(policy), field_type, GateState::default(), now());
    gate.on(now(), value);
    gate.disclosed().expect("an open gate releases at once").clone()
}

pub fn external() -> FieldRecord {
    FieldRecord {
        mapping_state: MappingState::Mapped,
        value_source: Some(ValueSource::External),
        decided_by: Some("anna".into()),
        decision_time: Some(now()),
        disclosure: Some("as it is".into()),
        ..FieldRecord::default()
    }
}

/// Returns the identifier of a field of the example's request.
pub fn field_id(network: &str, name: &str) -> String {
    format!("{network}/op/MakeFrame1/req/ReqResponse1/{name}")
}
