//! Interfaces go to NodeSet2 and back.

use super::*;
use crate::{
    messages::PlatformMessage,
    network::OperationNetwork,
    node_set, units,
    validation::{parse_any_platform_message, parse_platform_message},
};

fn example(text: &str) -> OperationNetworkMessage {
    match parse_any_platform_message(text.as_bytes()).expect("a valid example") {
        PlatformMessage::OperationNetwork(message) => message,
        other => panic!("{} is no operation network", other.message_type()),
    }
}

// A unit is the same under all of its names.
fn normalise(network: &mut OperationNetwork) {
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
}

#[test]
fn node_sets_are_accepted_in_place_of_json() {
    for text in [
        include_str!("../../examples/operation-network.json"),
        include_str!("../../examples/operation-network.inspection.json"),
        include_str!("../../examples/operation-network.transportation.json"),
    ] {
        let mut message = example(text);
        // Escaping in ids and texts survives.
        message.operation_network.description = Some("<Frames> & \"things\"\n'ü' ".to_owned());
        let mut instance = Instance::new(&message);
        instance.received_at = "2026-01-01T00:00:00Z".parse().ok();
        let (key, _, _) = message.operation_network.fields().next().expect("a field");
        let state = FieldState {
            mapping_state: MappingState::Mapped,
            value: 5_u64.into(),
            ..FieldState::default()
        };
        instance.writers.insert(key.request.clone(), 7);
        instance.fields.insert(key, state);
        let nodes = super::node_set(&instance);
        let xml = node_set::write(&nodes);
        assert_eq!(node_set::read(xml.as_bytes()).as_ref(), Ok(&nodes));
        let read = match parse_platform_message(xml.as_bytes(), &message.factory_id)
            .expect("a valid node set")
        {
            PlatformMessage::OperationNetwork(message) => message,
            other => panic!("{} is no operation network", other.message_type()),
        };
        let mut expected = message.operation_network.clone();
        normalise(&mut expected);
        assert_eq!(read.operation_network, expected);
        assert_eq!(
            (read.revision, read.collaboration_id),
            (message.revision, message.collaboration_id.clone())
        );
    }
}

#[test]
fn node_ids_are_readable_and_stable() {
    let message = example(include_str!("../../examples/operation-network.json"));
    let operation = &message.operation_network.operation_list[0];
    let path = Path::interface(&"net/1#%".parse().expect("valid"))
        .operation(&operation.operation_id)
        .request(&operation.dynamic_data_request_list[0].dynamic_data_request_id)
        .field(&"progressStatus".parse().expect("valid"));
    assert_eq!(path.as_str(), "net%2F1%23%25/op/MakeFrame1/req/ReqResponse1/progressStatus");
    assert_eq!(
        path.part("IsMapped").as_str(),
        "net%2F1%23%25/op/MakeFrame1/req/ReqResponse1/progressStatus#IsMapped"
    );
    assert_eq!(
        path.node_id(&message.factory_id).to_string(),
        "nsu=urn:verbund:cpt:FOR_MUC;s=net%2F1%23%25/op/MakeFrame1/req/ReqResponse1/progressStatus"
    );
}

#[test]
fn every_id_has_one_form_and_the_other_way_round() {
    for (id, form) in [
        ("frame", "frame"),
        ("a/b#c%", "a%2Fb%23c%25"),
        ("n ", "n%20"),
        (" n  n ", "%20n  n%20"),
        ("  ", "%20%20"),
        ("\u{a0}n\u{feff}", "%C2%A0n%EF%BB%BF"),
        ("%20", "%2520"),
    ] {
        let mut out = String::new();
        encode_segment(&mut out, id);
        assert_eq!(out, form);
        assert_eq!(decode_segment(form).as_deref(), Some(id));
    }
    for form in ["n ", "%6E", "%2f", "%", "%2", "%+5", "%C2", "a%20b", "ü%ü"] {
        assert_eq!(decode_segment(form), None, "{form}");
    }
}

#[test]
fn broken_node_sets_have_faults() {
    let factory = "FOR_MUC".parse().expect("valid");
    for (body, code) in [
        ("<UANodeSet>", "NOT_NODE_SET"),
        ("<!DOCTYPE x [<!ENTITY a 'b'>]><UANodeSet/>", "NOT_NODE_SET"),
        ("<html/>", "NOT_NODE_SET"),
        (
            r#"<UANodeSet><UAObject NodeId="i=1" BrowseName="a"/><UAObject NodeId="i=1" BrowseName="b"/></UANodeSet>"#,
            "NOT_NODE_SET",
        ),
        ("<UANodeSet/>", "NO_INTERFACE"),
    ] {
        let rejection = parse_platform_message(body.as_bytes(), &factory).expect_err(body);
        assert_eq!(rejection.faults[0].code, code, "{body}");
    }
}
