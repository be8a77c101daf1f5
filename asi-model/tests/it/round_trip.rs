//! A sound network survives every way it can be written and read.

use std::sync::LazyLock;

use asi_model::{
    BuiltInType, NodeId, Variant,
    instance::{self, Instance},
    messages::{OperationNetworkMessage, PlatformMessage},
    network::OperationNetwork,
    node_set::{self, Node, NodeClass, NodeSet},
    opcua_json::{DataEncoding, encode_variant},
    schema, units,
    validation::{parse_network, parse_platform_message, validate_factory_part},
    values::{Namespace, QualifiedName},
};
use proptest::prelude::*;

use crate::{
    networks::{factory, message},
    vectors::{Numbers, scalars, variants},
};

/// EUInformation knows a unit by its code, not by which of its names it was asked for.
fn with_plain_units(mut network: OperationNetwork) -> OperationNetwork {
    let plain = |unit: &mut Option<String>| {
        *unit = unit.as_deref().and_then(units::lookup).map(|unit| unit.alias())
    };
    for operation in &mut network.operation_list {
        plain(&mut operation.quantity_unit);
        for request in &mut operation.dynamic_data_request_list {
            request
                .report_data_format
                .report_field_list
                .iter_mut()
                .for_each(|field| plain(&mut field.unit));
        }
    }
    network
}

fn read(bytes: &[u8]) -> Result<OperationNetworkMessage, TestCaseError> {
    match parse_platform_message(bytes, &factory()) {
        Ok(PlatformMessage::OperationNetwork(message)) => Ok(message),
        Ok(other) => Err(TestCaseError::fail(format!("it was read as {}", other.message_type()))),
        Err(rejection) => Err(TestCaseError::fail(format!("{:#?}", rejection.faults))),
    }
}

/// Writes it as text, since NaN is no equal of itself.
fn as_text(value: &Variant) -> String {
    String::from_utf8(encode_variant(value, DataEncoding::Reversible104)).unwrap()
}

/// Every value that NodeSet2 documents have a form for comes back; the others are left out.
#[test]
fn values_survive_node_sets() {
    let mut written = 0;
    // XML has no way to write the control character that some texts have.
    let values = variants(&scalars(&mut Numbers(7)));
    for value in values.into_iter().filter(|value| !as_text(value).contains("\\u0001")) {
        let class = NodeClass::Variable {
            data_type: NodeId::ua(24),
            value_rank: -2,
            value: value.clone(),
            is_writable: false,
        };
        let browse_name =
            QualifiedName { namespace: Namespace::uri("urn:one"), name: Some("v".into()) };
        let set = NodeSet {
            models: vec![],
            nodes: vec![Node::new(NodeId::string("urn:one", "v"), browse_name, class)],
        };
        let text = node_set::write(&set);
        let found = node_set::read(text.as_bytes()).unwrap();
        let NodeClass::Variable { value: found, .. } = &found.nodes[0].class else {
            panic!("no variable")
        };
        if found.is_null() {
            let is_matrix = matches!(&value, Variant::Array(array) if array.dimensions.is_some());
            let holds_others = matches!(
                value.built_in_type(),
                Some(BuiltInType::Variant | BuiltInType::DataValue | BuiltInType::DiagnosticInfo)
            );
            let is_foreign = is_matrix || holds_others || as_text(&value).contains("null");
            assert!(is_foreign, "{text}");
            continue;
        }
        assert_eq!(as_text(found), as_text(&value), "{text}");
        written += 1;
    }
    assert!(written > 300, "{written} values");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn sound_networks_have_no_faults(message in message()) {
        prop_assert_eq!(validate_factory_part(&message.operation_network, &factory()), []);
    }

    #[test]
    fn networks_survive_json(message in message()) {
        let text = serde_json::to_vec(&PlatformMessage::OperationNetwork(message.clone())).unwrap();
        prop_assert_eq!(&read(&text)?, &message);
        let alone = serde_json::to_vec(&message.operation_network).unwrap();
        prop_assert_eq!(&parse_network(&alone).unwrap(), &message.operation_network);
    }

    #[test]
    fn networks_survive_node_sets(message in message()) {
        let nodes = instance::node_set(&Instance::new(&message));
        let xml = node_set::write(&nodes);
        let again = node_set::read(xml.as_bytes());
        prop_assert_eq!(again.as_ref(), Ok(&nodes));
        let found = read(xml.as_bytes())?;
        prop_assert_eq!((found.revision, &found.collaboration_id), (message.revision, &message.collaboration_id));
        prop_assert_eq!(found.operation_network, with_plain_units(message.operation_network));
    }

    #[test]
    fn networks_fit_their_schema(message in message()) {
        static VALIDATOR: LazyLock<jsonschema::Validator> = LazyLock::new(|| {
            let mut all = schema::all().into_iter();
            let (_, known) = all.find(|(name, _)| *name == "operation-network.schema.json").unwrap();
            jsonschema::validator_for(&known).unwrap()
        });
        let json = serde_json::to_value(PlatformMessage::OperationNetwork(message)).unwrap();
        let faults: Vec<String> = VALIDATOR.iter_errors(&json).map(|error| error.to_string()).collect();
        prop_assert_eq!(faults, Vec::<String>::new());
    }
}
