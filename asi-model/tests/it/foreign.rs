//! Our messages as other people's stacks read them: values by node-opcua-json, node sets by
//! node-opcua and asyncua.
//!
//! The vectors are the same on every run.

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use asi_model::{
    DataValue, DateTime, NodeId, Scalar, Variant, asi_types,
    instance::{self, Instance},
    messages::{OperationNetworkMessage, PlatformMessage},
    node_set::{self, Node, NodeClass, NodeSet},
    opcua_json::{DataEncoding, Encoder},
    validation::parse_any_platform_message,
    values::{ExtensionBody, Namespace},
};
use proptest::{
    strategy::{Strategy as _, ValueTree as _},
    test_runner::TestRunner,
};
use serde_json::{Value, json};

use crate::{
    networks,
    vectors::{Numbers, namespaces, scalars, variants},
};

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn peers() -> PathBuf {
    let root = root();
    let status = Command::new(root.join("tests/foreign/setup.sh")).status().expect("bash runs");
    assert!(status.success(), "tests/foreign/setup.sh could not install the foreign peers");
    root.join("tests/foreign/asi")
}

pub fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn run(command: &mut Command) {
    let output = command.output().expect("the peer's interpreter is installed");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(
        output.status.success(),
        "{command:?}\n{}\n{}",
        text(&output.stdout),
        text(&output.stderr)
    );
}

/// The value that a foreign stack is expected to have read. Times are compared to the millisecond,
/// as JavaScript knows them.
fn expected(value: &Variant) -> Value {
    match value {
        Variant::Null => Value::Null,
        Variant::Scalar(scalar) => {
            json!({ "type": scalar.built_in_type().name(), "value": expected_scalar(scalar) })
        }
        Variant::Array(array) => {
            let elements: Vec<Value> = array.elements.iter().map(expected_scalar).collect();
            let mut found = json!({ "type": array.element_type.name(), "value": elements });
            if let Some(dimensions) = &array.dimensions {
                found["dimensions"] = json!(dimensions);
            }
            found
        }
    }
}

fn expected_scalar(scalar: &Scalar) -> Value {
    match scalar {
        Scalar::Boolean(value) => json!(value),
        Scalar::Int64(value) => json!(value.to_string()),
        Scalar::UInt64(value) => json!(value.to_string()),
        Scalar::Double(value) if !value.is_finite() => json!(special(*value)),
        Scalar::Float(value) if !value.is_finite() => json!(special(f64::from(*value))),
        Scalar::Double(value) => json!(value),
        Scalar::Float(value) => json!(f64::from(*value)),
        Scalar::String(text) | Scalar::XmlElement(text) => json!(text.as_deref()),
        Scalar::DateTime(time) => json!(milliseconds(*time)),
        Scalar::Guid(value) => json!(value.hyphenated().to_string()),
        Scalar::ByteString(bytes) => {
            json!(
                bytes
                    .as_deref()
                    .unwrap_or_default()
                    .iter()
                    .map(|byte| format!("{byte:02x}"))
                    .collect::<String>()
            )
        }
        Scalar::NodeId(id) => json!(indexed(id)),
        Scalar::ExpandedNodeId(id) => json!(indexed(&id.node_id)),
        Scalar::StatusCode(status) => json!(status.0),
        Scalar::QualifiedName(name) => {
            json!({ "namespace": index(&name.namespace), "name": name.name.as_deref() })
        }
        Scalar::LocalizedText(text) => {
            json!({ "locale": text.locale.as_deref(), "text": text.text.as_deref() })
        }
        Scalar::ExtensionObject(object) => {
            let ExtensionBody::Structure(structure) = &object.body else { return Value::Null };
            let name =
                if object.type_id.node_id == NodeId::ua(884) { "Range" } else { "EUInformation" };
            let members: serde_json::Map<String, Value> = structure
                .fields
                .iter()
                .map(|(name, value)| {
                    (name.to_lowercase(), value.as_scalar().map_or(Value::Null, expected_scalar))
                })
                .collect();
            json!({ "type": name, "members": members })
        }
        Scalar::Variant(inner) => expected(inner),
        Scalar::DataValue(inner) => json!({
            "value": expected(&inner.value),
            "sourceTimestamp": inner.source_timestamp.map(milliseconds)
        }),
        Scalar::DiagnosticInfo(info) => json!({
            "symbolicId": info.symbolic_id,
            "namespaceUri": info.namespace_uri,
            "locale": info.locale,
            "localizedText": info.localized_text,
            "additionalInfo": info.additional_info.as_deref(),
            "innerStatusCode": info.inner_status_code.map_or(0, |status| status.0)
        }),
        other => json!(i64::try_from(other.as_i128().unwrap()).unwrap()),
    }
}

fn special(value: f64) -> &'static str {
    if value.is_nan() {
        "NaN"
    } else if value > 0.0 {
        "Infinity"
    } else {
        "-Infinity"
    }
}

fn milliseconds(time: DateTime) -> String {
    let whole = time.to_string();
    let (seconds, fraction) =
        whole.trim_end_matches('Z').split_once('.').unwrap_or((whole.trim_end_matches('Z'), ""));
    format!("{seconds}.{:0<3}Z", fraction.get(..3).unwrap_or(fraction))
}

fn index(namespace: &Namespace) -> usize {
    match namespace {
        Namespace::Uri(uri) => namespaces().iter().position(|known| known == uri).unwrap() + 1,
        _ => 0,
    }
}

fn indexed(id: &NodeId) -> String {
    format!("ns={};{}", index(&id.namespace), id.identifier)
}

#[test]
fn foreign_digicor_values_decode_identically_with_node_opcua_json() {
    let peers = peers();
    let table = namespaces();
    let encoder = Encoder::described(DataEncoding::Reversible104, &table, &[]);
    let scalars = scalars(&mut Numbers(1));
    let mut lines = String::new();
    for value in variants(&scalars) {
        let mut text = Vec::new();
        encoder.variant(&mut text, &value);
        let text = String::from_utf8(text).unwrap();
        lines.push_str(&format!(
            "{}\n",
            json!({ "form": "variant", "text": text, "expected": expected(&value) })
        ));
        let time: DateTime = "2019-03-26T18:28:54.2940194Z".parse().unwrap();
        let mut text = Vec::new();
        encoder.data_value(&mut text, &DataValue::good(value.clone(), time));
        let text = String::from_utf8(text).unwrap();
        let expected = json!({ "value": expected(&value), "sourceTimestamp": milliseconds(time) });
        lines.push_str(&format!(
            "{}\n",
            json!({ "form": "dataValue", "text": text, "expected": expected })
        ));
    }
    let file = scratch("digicor-vectors.jsonl");
    std::fs::write(&file, lines).unwrap();
    run(Command::new("node").arg(peers.join("decode_digicor.js")).arg(&file));
}

fn class_name(node: &Node) -> &'static str {
    match node.class {
        NodeClass::Object => "Object",
        NodeClass::Variable { .. } => "Variable",
        NodeClass::Method => "Method",
        NodeClass::ObjectType { .. } => "ObjectType",
        NodeClass::VariableType { .. } => "VariableType",
        NodeClass::ReferenceType { .. } => "ReferenceType",
        NodeClass::DataType { .. } => "DataType",
    }
}

/// Nodes and references as the peers are expected to have them.
fn expected_nodes(sets: &[NodeSet]) -> Value {
    let nodes = || sets.iter().flat_map(|set| &set.nodes);
    let list: Vec<Value> = nodes()
        .map(|node| {
            json!({ "id": node.node_id.to_string(), "class": class_name(node),
                "browseName": node.browse_name.name.as_deref() })
        })
        .collect();
    let references: Vec<String> = nodes()
        .flat_map(|node| {
            node.references.iter().map(move |reference| {
                let (from, to) = if reference.is_forward {
                    (&node.node_id, &reference.target)
                } else {
                    (&reference.target, &node.node_id)
                };
                format!("{from} {} {to}", reference.reference_type)
            })
        })
        .collect();
    let values: Vec<Value> = nodes()
        .filter_map(|node| match &node.class {
            NodeClass::Variable { value, .. } => {
                value.as_str().map(|text| json!({ "id": node.node_id.to_string(), "text": text }))
            }
            _ => None,
        })
        .collect();
    let namespaces: Vec<&str> =
        sets.iter().flat_map(|set| &set.models).map(|model| model.uri.as_str()).collect();
    json!({ "namespaces": namespaces, "nodes": list, "references": references, "values": values })
}

/// Networks with ids that are hard to carry, the same on every run, each at a factory of its own:
/// its folder is in each of its documents.
fn random_messages(count: usize) -> Vec<OperationNetworkMessage> {
    let mut runner = TestRunner::deterministic();
    let messages =
        std::iter::repeat_with(|| networks::message().new_tree(&mut runner).unwrap().current());
    messages
        .take(count)
        .enumerate()
        .map(|(number, mut message)| {
            message.factory_id = format!("RANDOM_{number}").parse().unwrap();
            message
        })
        .collect()
}

#[test]
fn foreign_stacks_load_the_node_sets() {
    let peers = peers();
    let types = asi_types::node_set();
    let types_file = root().join("asi-model/node-set/Verbund.ASI.NodeSet2.xml");
    let (mut sets, mut files) = (vec![types], vec![types_file]);
    for name in
        ["operation-network", "operation-network.inspection", "operation-network.transportation"]
    {
        let text = std::fs::read(root().join(format!("asi-model/examples/{name}.json"))).unwrap();
        let PlatformMessage::OperationNetwork(message) = parse_any_platform_message(&text).unwrap()
        else {
            panic!("{name} is an operation network")
        };
        let nodes = instance::node_set(&Instance::new(&message));
        let file = scratch(&format!("{name}.xml"));
        std::fs::write(&file, node_set::write(&nodes)).unwrap();
        sets.push(nodes);
        files.push(file);
    }
    for (number, message) in random_messages(4).into_iter().enumerate() {
        let nodes = instance::node_set(&Instance::new(&message));
        let file = scratch(&format!("random-{number}.xml"));
        std::fs::write(&file, node_set::write(&nodes)).unwrap();
        sets.push(nodes);
        files.push(file);
    }
    let expected_file = scratch("nodes.json");
    std::fs::write(&expected_file, expected_nodes(&sets).to_string()).unwrap();
    let mut asyncua = Command::new(root().join("target/foreign/python/bin/python"));
    asyncua.arg(peers.join("load_node_set.py"));
    let mut node_opcua = Command::new("node");
    node_opcua.arg(peers.join("load_node_set.js"));
    for peer in [&mut asyncua, &mut node_opcua] {
        run(peer.arg(&expected_file).args(&files));
    }
}
