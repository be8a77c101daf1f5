//! Figures of the DIGICOR paper, layouts and round trips.

use std::sync::Arc;

use super::*;
use crate::pubsub::*;
use crate::values::{
    Array, BuiltInType, DataValue, DateTime, EnumType, EnumValue, Namespace, NodeId, QualifiedName,
    SimpleType, StatusCode, StructureField, StructureKind, StructureType, Variant,
};

fn time(text: &str) -> DateTime {
    text.parse().expect("a valid time")
}

fn recipients() -> Variant {
    Variant::Array(Arc::new(Array {
        element_type: BuiltInType::String,
        elements: vec!["acme-aero".into()],
        dimensions: None,
    }))
}

/// The report of figure 4, as `messages.md` fixes it.
fn progress_report() -> NetworkMessage {
    NetworkMessage {
        message_id: Some("3ea281da-fad0-42e0-8c9a-713bd4257fec".parse().expect("valid")),
        publisher_id: Some("FOR_MUC".into()),
        messages: vec![DataSetMessage {
            data_set_writer_id: Some(1),
            sequence_number: Some(0),
            meta_data_version: Some(MetaDataVersion { major: 608_926_829, minor: 608_926_829 }),
            timestamp: Some(time("2019-04-18T18:20:30Z")),
            fields: vec![
                PayloadField::new("reportName", "ProgressReport"),
                PayloadField::new("dynamicDataRequestId", "ReqResponse1"),
                PayloadField::new("operationId", "MakeFrame1"),
                PayloadField::new("operationNetworkId", "frame-4711"),
                PayloadField::new("shopfloorTimestamp", time("2019-04-18T18:20:05Z")),
                PayloadField::new("recipientList", recipients()),
                PayloadField::new("progressStatus", 1_u64),
                PayloadField::new("progressStatusUnit", "PIECE"),
            ],
            ..DataSetMessage::default()
        }],
        ..NetworkMessage::default()
    }
}

fn encoded(message: &NetworkMessage, encoding: Encoding) -> String {
    String::from_utf8(encode(message, encoding)).expect("UTF-8")
}

#[test]
fn the_contract_s_example_is_written_to_the_letter() {
    let expected = concat!(
        r#"{"MessageId":"3ea281da-fad0-42e0-8c9a-713bd4257fec","MessageType":"ua-data","PublisherId":"FOR_MUC","#,
        r#""Messages":[{"DataSetWriterId":1,"SequenceNumber":0,"#,
        r#""MetaDataVersion":{"MajorVersion":608926829,"MinorVersion":608926829},"Timestamp":"2019-04-18T18:20:30Z","#,
        r#""Payload":{"reportName":{"Type":12,"Body":"ProgressReport"},"#,
        r#""dynamicDataRequestId":{"Type":12,"Body":"ReqResponse1"},"operationId":{"Type":12,"Body":"MakeFrame1"},"#,
        r#""operationNetworkId":{"Type":12,"Body":"frame-4711"},"#,
        r#""shopfloorTimestamp":{"Type":13,"Body":"2019-04-18T18:20:05Z"},"#,
        r#""recipientList":{"Type":12,"Body":["acme-aero"]},"#,
        r#""progressStatus":{"Type":9,"Body":"1"},"progressStatusUnit":{"Type":12,"Body":"PIECE"}}}]}"#,
    );
    assert_eq!(encoded(&progress_report(), Encoding::Digicor), expected);
}

#[test]
fn every_encoding_reads_back() {
    let mut message = progress_report();
    message.messages[0].fields.push(PayloadField::with(
        "held",
        DataValue {
            value: 1.5.into(),
            status: StatusCode::UNCERTAIN_LAST_USABLE_VALUE,
            ..DataValue::default()
        },
    ));
    message.messages[0].fields.push(PayloadField::with(
        "lost",
        DataValue::status_only(StatusCode::BAD_NOT_CONNECTED, None),
    ));
    for encoding in [Encoding::Digicor, Encoding::Compact105] {
        let bytes = encode(&message, encoding);
        let decoded = decode(&bytes).expect("our own message");
        assert_eq!(decoded.diagnostics, []);
        assert_eq!(decoded.message, PubSubMessage::Data(message.clone()), "{encoding}");
    }
}

/// The figures of the paper as printed, deviations included: what is noted, and what we write
/// instead.
#[test]
fn the_figures_of_the_paper_decode() {
    let figure_4 = r#"{"MessageId":"3ea281da-fad0-42e0-8c9a-713bd4257fec","MessageType":"ua-data",
        "PublisherId":"FOR_MUC","Messages":[{"DataSetWriterId":1,"SequenceNumber":0,"Timestamp":"2019-04-18T18:20:30Z",
        "Payload":{"reportName":{"Type":12,"Body":"ProgressReport"},
        "dynamicDataRequestId":{"Type":12,"Body":"ReqResponse1"},
        "shopfloorTimestamp":{"Type":13,"Body":"2019-04-18T19:10:05Z"},
        "progressStatus":{"Type":9,"Body":1},"progressStatusUnit":{"Type":12,"Body":"PIECE"}}}]}"#;
    let figure_5 = r#"{"MessageId":"m5","MessageType":"ua-data","PublisherId":"FOR_MUC","Messages":[
        {"DataSetWriterId":"2","SequenceNumber":7,"Timestamp":"2019-03-26T18:28:55Z","Payload":{
        "AssetId":{"Value":{"Type":12,"Body":"GRU_Robot_eDO_1"},"SourceTimestamp":"2019-03-26T18:28:54.2940194Z"},
        "Axis1.ActualPosition":{"Value":{"Type":11,"Body":12.3},"SourceTimestamp":"2019-03-26T18:28:54.2940194Z"},
        "Axis1.ActualPosition.EURange":{"Value":{"Type":22,"Body":{"TypeId":{"Id":884},
            "Body":{"low":0,"high":359.99}}},"SourceTimestamp":"2019-03-26T18:28:54.2940194Z"}}}]}"#;
    let figure_6 = r#"{"MessageId":"m6","MessageType":"ua-data","PublisherId":"FOR_MUC","Messages":[
        {"DataSetWriterId":3,"SequenceNumber":7,"Timestamp":"2019-03-26T18:28:55Z","Payload":{
        "Motor1.RecentPowerConsumption":{"Value":{"Type":22,"Body":{
            "TypeId":{"IdType":1,"Id":"PowerConsumptionAggregate","Namespace":1},
            "Body":{"SecondsAggregated":60,"WattsMin":3.5,"WattsMax":121.25,"WattsAvg":48.75}}},
            "SourceTimestamp":"2019-03-26T18:28:54.2940194Z"}}}]}"#;
    let figure_7 = r#"{"MessageId":"m7","MessageType":"ua-data","PublisherId":"FOR_MUC","Messages":[
        {"DataSetWriterId":4,"SequenceNumber":7,"Timestamp":"2019-03-26T18:28:55Z","Payload":{
        "HealthOK":{"Value":{"Type":1,"Body":"false"},"SourceTimestamp":"2019-03-26T18:28:54.2940194Z"},
        "HealthInformation":{"Value":{"Type":12,"Body":"Brake worn "},
            "SourceTimestamp":"2019-03-26T18:28:53.1Z"}}}]}"#;
    for (figure, notes, corrected) in [
        (
            figure_4,
            vec!["/Messages/0/Payload/progressStatus/Body"],
            r#""progressStatus":{"Type":9,"Body":"1"}"#,
        ),
        (
            figure_5,
            vec![
                "/Messages/0/Payload/Axis1.ActualPosition.EURange/Value/Body/Body/low",
                "/Messages/0/Payload/Axis1.ActualPosition.EURange/Value/Body/Body/high",
            ],
            r#""Body":{"TypeId":{"Id":884},"Body":{"Low":0,"High":359.99}}},"SourceTimestamp":"2019-03-26T18:28:54.2940194Z""#,
        ),
        (
            figure_6,
            vec![],
            r#"{"TypeId":{"IdType":1,"Id":"PowerConsumptionAggregate","Namespace":1},"Body":{"SecondsAggregated":60,"#,
        ),
        (
            figure_7,
            vec!["/Messages/0/Payload/HealthOK/Value/Body"],
            r#""HealthOK":{"Value":{"Type":1,"Body":false},"SourceTimestamp":"2019-03-26T18:28:54.2940194Z"}"#,
        ),
    ] {
        let decoded = decode(figure.as_bytes()).expect("a figure of the paper");
        let noted: Vec<&str> =
            decoded.diagnostics.iter().map(|note| note.pointer.as_str()).collect();
        assert_eq!(noted, notes);
        let PubSubMessage::Data(message) = decoded.message else { panic!("ua-data") };
        let written = encoded(&message, Encoding::Digicor);
        assert!(written.contains(corrected), "{written}");
        assert_eq!(decode(written.as_bytes()).map(|again| again.diagnostics), Ok(vec![]));
        assert_eq!(
            decode(written.as_bytes()).map(|again| again.message),
            Ok(PubSubMessage::Data(message))
        );
    }
    // Taken strictly, a quoted Boolean costs its field and nothing else.
    let strict = decode_described(figure_7.as_bytes(), crate::opcua_json::Leniency::Strict, &())
        .expect("still a message");
    let PubSubMessage::Data(message) = strict.message else { panic!("ua-data") };
    let fields = &message.messages[0].fields;
    assert_eq!(fields[0].value.status, StatusCode::BAD_TYPE_MISMATCH);
    assert_eq!(fields[1].value.value.as_str(), Some("Brake worn "));
}

#[test]
fn every_header_layout_is_recognised_by_its_shape() {
    let payload = r#"{"a":{"Type":9,"Body":"1"}}"#;
    let with_header = format!(r#"{{"DataSetWriterId":3,"SequenceNumber":4,"Payload":{payload}}}"#);
    let network = |messages: &str| {
        format!(
            r#"{{"MessageId":"m","MessageType":"ua-data","PublisherId":"7","Messages":{messages}}}"#
        )
    };
    for (text, publisher, writer, count) in [
        (network(&format!("[{with_header},{with_header}]")), Some("7"), Some(3), 2),
        (network(&with_header), Some("7"), Some(3), 1),
        (network(&format!("[{payload}]")), Some("7"), None, 1),
        (network(payload), Some("7"), None, 1),
        (network("[]"), Some("7"), None, 0),
        (format!("[{with_header},{with_header}]"), None, Some(3), 2),
        (with_header.clone(), None, Some(3), 1),
        (format!("[{payload},{payload}]"), None, None, 2),
        (payload.to_owned(), None, None, 1),
    ] {
        let decoded = decode(text.as_bytes()).expect("a layout of the standard");
        assert_eq!(decoded.diagnostics, []);
        let PubSubMessage::Data(message) = decoded.message else { panic!("ua-data: {text}") };
        assert_eq!(message.publisher_id.as_deref(), publisher);
        assert_eq!(message.messages.len(), count, "{text}");
        for part in &message.messages {
            assert_eq!(part.data_set_writer_id, writer, "{text}");
            assert_eq!(
                part.field("a").map(|value| value.value.clone()),
                Some(1_u64.into()),
                "{text}"
            );
        }
    }
    // A publisher that names itself in each DataSetMessage, with the minor version only, as 1.05
    // minimal layouts do.
    let text = r#"{"DataSetWriterId":3,"PublisherId":17,"MinorVersion":5,"Status":{"Code":1073741824},
        "MessageType":"ua-deltaframe","Payload":{"a":{"UaType":6,"Value":1}}}"#;
    let PubSubMessage::Data(message) = decode(text.as_bytes()).expect("valid").message else {
        panic!("ua-data")
    };
    let part = &message.messages[0];
    assert_eq!((part.publisher_id.as_deref(), part.minor_version), (Some("17"), Some(5)));
    assert_eq!((part.kind, part.status), (DataSetMessageKind::DeltaFrame, StatusCode::UNCERTAIN));
}

#[test]
fn unknown_message_types_are_ignored() {
    for name in
        ["ua-connection", "ua-application", "ua-endpoints", "ua-action-request", "ua-future"]
    {
        let text = format!(
            r#"{{"MessageId":"m","MessageType":"{name}","PublisherId":"p","Anything":[1]}}"#
        );
        let message = decode(text.as_bytes()).expect("to be ignored").message;
        assert_eq!(message.message_type(), name);
        assert!(matches!(message, PubSubMessage::Other { .. }));
    }
    for text in [
        "1",
        "\"ua-data\"",
        r#"{"MessageType":"ua-data"}"#,
        r#"{"MessageType":"ua-metadata","DataSetWriterId":1}"#,
        r#"{"MessageType":"ua-data","Messages":[1]}"#,
        r#"{"MessageType":"ua-data","Messages":[{"DataSetWriterId":70000,"Payload":{}}]}"#,
        r#"{"MessageType":"ua-data","Messages":[{"DataSetWriterId":1,"MessageType":"ua-keyframe"}]}"#,
        r#"{"MessageType":"ua-status","Status":9}"#,
        r#"{"MessageType":"ua-data","MessageType":"ua-data","Messages":[]}"#,
    ] {
        assert!(decode(text.as_bytes()).is_err(), "{text}");
    }
}

#[test]
fn keep_alive_and_status_read_back() {
    let mut message = progress_report();
    message.messages[0].kind = DataSetMessageKind::KeepAlive;
    message.messages[0].fields.clear();
    for encoding in Encoding::ALL {
        let text = encoded(&message, encoding);
        assert!(
            text.contains(r#""MessageType":"ua-keepalive""#) && !text.contains("Payload"),
            "{text}"
        );
        assert_eq!(
            decode(text.as_bytes()).map(|again| again.message),
            Ok(PubSubMessage::Data(message.clone()))
        );
    }
    for status in PubSubState::ALL {
        let message = StatusMessage {
            message_id: Some("m".parse().expect("valid")),
            publisher_id: Some("p".into()),
            status,
            is_cyclic: true,
            timestamp: Some(time("2019-04-18T18:20:30Z")),
            next_report_time: Some(time("2019-04-18T18:21:30Z")),
        };
        let message = PubSubMessage::Status(message);
        let bytes = encode_message(&message, Encoding::Digicor);
        assert_eq!(decode(&bytes).map(|decoded| decoded.message), Ok(message));
    }
}

/// A structure type of a foreign namespace, with every kind of field.
fn power_type() -> StructureType {
    StructureType {
        type_id: power_id(),
        encoding_ids: vec![NodeId::string("urn:robots", "PowerJson")],
        name: "Power".into(),
        kind: StructureKind::WithOptionalFields,
        fields: vec![
            StructureField::scalar("WattsMin", BuiltInType::Double),
            StructureField {
                is_optional: true,
                ..StructureField::scalar("WattsMax", BuiltInType::Double)
            },
            StructureField::structure("Range", NodeId::ua(884)).array(),
            StructureField {
                data_type: NodeId::string("urn:robots", "Mode"),
                ..StructureField::scalar("Mode", BuiltInType::Int32)
            },
            StructureField {
                data_type: NodeId::string("urn:robots", "Watts"),
                ..StructureField::scalar("Limit", BuiltInType::Float)
            },
        ],
    }
}

fn power_id() -> NodeId {
    NodeId::string("urn:robots", "Power")
}

/// Metadata of the progress report and of one field of each described type.
fn described_report() -> DataSetMetaData {
    let mut fields: Vec<FieldMetaData> = progress_report().messages[0]
        .fields
        .iter()
        .map(|field| {
            let built_in_type = field.value.value.built_in_type().expect("not null");
            FieldMetaData::new(field.name.clone(), built_in_type, uuid::Uuid::from_u128(1))
        })
        .collect();
    fields[5].value_rank = crate::network::VALUE_RANK_ARRAY;
    fields[6].set_engineering_unit(crate::units::lookup("PIECE").expect("known"));
    fields[6].set_text_property(PROPERTY_SEMANTIC, "PRODUCED_QUANTITY");
    fields[6].set_text_property(PROPERTY_DISCLOSURE, "Rounded to 2 pieces.");
    let mut structured =
        FieldMetaData::new("power", BuiltInType::ExtensionObject, uuid::Uuid::from_u128(2));
    structured.data_type = power_id();
    structured.array_dimensions = vec![3];
    structured.max_string_length = 9;
    fields.push(structured);
    DataSetMetaData {
        name: "ProgressReport".into(),
        namespaces: vec![crate::asi_types::ASI_NAMESPACE_URI.into(), "urn:robots".into()],
        structure_types: vec![power_type()],
        enum_types: vec![EnumType {
            type_id: NodeId::string("urn:robots", "Mode"),
            name: "Mode".into(),
            built_in_type: BuiltInType::Int32,
            values: vec![EnumValue { value: 3, name: "AUTOMATIC".into(), ..EnumValue::default() }],
        }],
        simple_types: vec![SimpleType {
            type_id: NodeId::string("urn:robots", "Watts"),
            name: "Watts".into(),
            base_type: NodeId::ua(10),
            built_in_type: BuiltInType::Float,
        }],
        fields,
        configuration_version: MetaDataVersion { major: 7, minor: 8 },
        ..DataSetMetaData::default()
    }
}

#[test]
fn metadata_reads_back_in_every_encoding() {
    let meta_data = described_report();
    for encoding in Encoding::ALL {
        let message = MetaDataMessage {
            message_id: Some("m".parse().expect("valid")),
            publisher_id: Some("FOR_MUC".into()),
            data_set_writer_id: 1,
            writer_group_name: Some("ASI".into()),
            data_set_writer_name: Some("ReqResponse1".into()),
            timestamp: Some(time("2019-04-18T18:20:30Z")),
            meta_data: meta_data.clone(),
        };
        let text = encode_meta_data(&message, encoding);
        let decoded = decode(&text).expect("our own metadata");
        assert_eq!(decoded.diagnostics, []);
        assert_eq!(decoded.message, PubSubMessage::MetaData(Box::new(message)), "{encoding}");
    }
}

#[test]
fn metadata_has_unit_semantic_and_disclosure_as_properties() {
    let meta_data = described_report();
    let field = meta_data.field("progressStatus").expect("there");
    assert_eq!(field.engineering_unit().map(|unit| unit.code), Some("H87"));
    assert_eq!(field.semantic(), Some(crate::network::Semantic::ProducedQuantity));
    assert_eq!(field.disclosure(), Some("Rounded to 2 pieces."));
    assert!(field.properties.iter().any(|(key, _)| *key
        == QualifiedName {
            namespace: Namespace::uri("urn:verbund:UA:ASI"),
            name: Some("Semantic".into())
        }));
}

#[test]
fn metadata_gives_bare_values_their_types() {
    let meta_data = described_report();
    // Bare in Verbose: types come from the metadata, in any representation.
    for representation in [FieldRepresentation::Raw, FieldRepresentation::DataValue] {
        let mut message = progress_report();
        message.messages[0].representation = representation;
        if representation == FieldRepresentation::DataValue {
            for field in &mut message.messages[0].fields {
                field.value.source_timestamp = Some(time("2019-04-18T18:20:05.1234567Z"));
            }
        }
        let text = encode_described(&message, Encoding::Verbose105, &meta_data);
        let decoded = decode_described(&text, crate::opcua_json::Leniency::Strict, &meta_data)
            .expect("our own");
        assert_eq!(decoded.diagnostics, []);
        assert_eq!(decoded.message, PubSubMessage::Data(message));
    }
    // Without metadata the types are guessed, with a diagnostic each.
    let text = encode(&progress_report(), Encoding::Verbose105);
    assert_eq!(decode(&text).expect("our own").diagnostics.len(), 8);
}
