//! Messages as other products write them, and what becomes of each.

use std::path::Path;

use asi_model::{
    opcua_json::{DataEncoding, Leniency, encode_variant},
    pubsub::{
        DataSetMessage, NetworkMessage, PubSubMessage,
        json::{PubSubError, decode, decode_described},
    },
};

/// The message of a file, in short, and the pointers of its diagnostics.
fn read(name: &str, leniency: Leniency) -> Result<(Vec<String>, Vec<String>), String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign-messages");
    let text = std::fs::read(folder.join(name)).unwrap();
    let decoded = match decode_described(&text, leniency, &()) {
        Ok(decoded) => decoded,
        Err(PubSubError::Malformed { pointer, message }) => {
            return Err(format!("{pointer}: {message}"));
        }
        Err(error) => return Err(error.to_string()),
    };
    let summary = match decoded.message {
        PubSubMessage::Data(message) => message.messages.iter().flat_map(data_set).collect(),
        PubSubMessage::MetaData(message) => {
            let known = message.meta_data;
            let fields = known.fields.iter();
            let fields = fields.map(|field| format!("{} {}", field.name, field.data_type));
            let types = known.structure_types.iter();
            let types = types.map(|known| format!("type {} {}", known.name, known.type_id));
            std::iter::once(format!("metadata of {}", message.data_set_writer_id))
                .chain(types)
                .chain(fields)
                .collect()
        }
        other => vec![other.message_type().to_owned()],
    };
    let pointers = decoded.diagnostics.into_iter().map(|diagnostic| diagnostic.pointer);
    Ok((summary, pointers.map(|pointer| pointer.replace("/Messages/0/Payload", "~")).collect()))
}

fn data_set(message: &DataSetMessage) -> Vec<String> {
    let writer = message.data_set_writer_id.unwrap_or_default();
    let heading = format!("{} of {writer}, {}", message.kind.name(), message.status);
    let fields = message.fields.iter().map(|field| {
        let value = encode_variant(&field.value.value, DataEncoding::Reversible104);
        let value = String::from_utf8(value).unwrap();
        format!("{} {value} {}", field.name, field.value.status)
    });
    std::iter::once(heading).chain(fields).collect()
}

/// One file: its name, its content in short, and the pointers of its diagnostics.
type Expected = (&'static str, &'static [&'static str], &'static [&'static str]);

const TAKEN: &[Expected] = &[
    (
        "opc-publisher.key-frame.json",
        &[
            "ua-keyframe of 1, Good",
            r#"AlternatingBoolean {"Type":1,"Body":true} Good"#,
            r#"StepUp {"Type":8,"Body":"8141"} Good"#,
        ],
        &["~/AlternatingBoolean/Value", "~/StepUp/Value"],
    ),
    (
        "opc-publisher.delta-frame.json",
        &[
            "ua-deltaframe of 1, Good",
            "BadFastUInt1 null 0x80310000",
            r#"FastUInt1 {"Type":8,"Body":"7"} Good"#,
        ],
        &["~/BadFastUInt1/StatusCode", "~/FastUInt1/Value"],
    ),
    ("opc-publisher.keep-alive.json", &["ua-keepalive of 1, Good"], &[]),
    (
        "opc-publisher.condition.json",
        &["ua-deltaframe of 1, Good", r#"StepUp {"Type":7,"Body":8150} Good"#],
        &["/Messages/0/MessageType"],
    ),
    (
        // No message of PubSub; the layout without headers is all that it can be.
        "opc-publisher.samples.json",
        &[
            "ua-keyframe of 0, Good",
            r#"NodeId {"Type":12,"Body":"http://microsoft.com/Opc/OpcPlc/#s=StepUp"} Good"#,
            r#"ApplicationUri {"Type":12,"Body":"urn:OpcPlc:opcplc"} Good"#,
            r#"Value {"Type":8,"Body":"8153"} Good"#,
        ],
        &["/NodeId", "/ApplicationUri", "/Value/Value"],
    ),
    (
        "opc-publisher.type-names.json",
        &[
            "ua-keyframe of 3, Good",
            r#"EventId {"Type":15,"Body":"AQID"} Good"#,
            r#"Temperature {"Type":11,"Body":21.5} Good"#,
        ],
        &["~/EventId/Type", "~/Temperature/Value/Type"],
    ),
    (
        "opc-publisher.metadata.json",
        &[
            "metadata of 3",
            "type HeaterState nsu=http://microsoft.com/Opc/OpcPlc/;i=3003",
            "Heater nsu=http://microsoft.com/Opc/OpcPlc/;i=3003",
        ],
        &["/MetaData/Namespaces/0"],
    ),
    (
        "umati.data.json",
        &[
            "ua-keyframe of 59043, Good",
            // Without metadata no more than an object.
            r#"Identification.Model {"Type":22,"Body":{"TypeId":{"Id":0},"Body":{ "Locale": "", "Text": "UTool" }}} Good"#,
            r#"Monitoring.Channel1.FeedOverride {"Type":11,"Body":97.5} Good"#,
            r#"Stacklight.0.SignalOn {"Type":1,"Body":false} Good"#,
        ],
        &[
            "~/Identification.Model",
            "~/Monitoring.Channel1.FeedOverride",
            "~/Stacklight.0.SignalOn",
        ],
    ),
    (
        "umati.metadata.json",
        &["metadata of 59043", "SoftwareClass nsu=http://opcfoundation.org/UA/DI/;i=331"],
        &["/MetaData/Namespaces/0"],
    ),
    (
        "milo.metadata.json",
        &["metadata of 10", "Int32 i=6", "Mode nsu=urn:eclipse:milo:opcua:server;s=Mode"],
        &[],
    ),
    (
        "opc-publisher.structure.json",
        &[
            "ua-event of 3, Good",
            r#"Message {"Type":21,"Body":{"Locale":"en-US","Text":"The system cycle '5' has started."}} Good"#,
            // Its type is no NodeId of JSON; the other fields stay.
            "CurrentStep null BadTypeMismatch",
        ],
        &["~/Message/Type", "~/CurrentStep/Type", "~/CurrentStep/Body/TypeId"],
    ),
    (
        "umati.body.json",
        &[
            "ua-keyframe of 9, Good",
            r#"TypeDefinition {"Type":22,"Body":{"TypeId":{"Id":0},"Body":{ "Id": 32, "Namespace": "http://opcfoundation.org/UA/MachineTool/" }}} Good"#,
            r#"Name {"Type":12,"Body":"Basic Program"} Good"#,
            r#"NumberInList {"Type":8,"Body":"0"} Good"#,
            "NodeVersion null Good",
        ],
        &[
            "~/TypeDefinition",
            "~/TypeDefinition/Body",
            "~/Name",
            "~/Name/Body",
            "~/NumberInList",
            "~/NumberInList/Body",
            "~/NodeVersion",
        ],
    ),
    (
        "umati.data-set.json",
        &[
            "ua-keyframe of 0, Uncertain",
            r#"Name {"Type":12,"Body":"Basic Program"} Good"#,
            r#"NumberInList {"Type":8,"Body":"0"} Good"#,
        ],
        &["/Payload/Name", "/Payload/NumberInList"],
    ),
    ("milo.keep-alive.json", &["ua-keepalive of 17, Good"], &[]),
    ("milo.no-payload.json", &["ua-keepalive of 17, Good"], &[]),
    (
        "milo.delta-frame.json",
        &[
            "ua-deltaframe of 17, Good",
            r#"Mode {"Type":8,"Body":"3"} Good"#,
            r#"Speed {"Type":11,"Body":1.5} Good"#,
        ],
        &["/Payload/Mode", "/Payload/Speed"],
    ),
    (
        "ua-netstandard.raw.json",
        &["ua-keyframe of 0, Good", r#"Temperature {"Type":11,"Body":22.5} Good"#],
        &["~/Temperature"],
    ),
    ("ua-netstandard.metadata.json", &["metadata of 10"], &[]),
    (
        "open62541.reversible.json",
        &[
            "ua-keyframe of 62541, Good",
            r#"Test {"Type":5,"Body":42} Good"#,
            r#"Server localtime {"Type":13,"Body":"2018-06-05T05:58:36Z"} Good"#,
        ],
        &[],
    ),
    (
        "ua-netstandard.minimal.json",
        &[
            "ua-keyframe of 1, Good",
            r#"BoolToggle {"Type":1,"Body":true} Good"#,
            r#"Int32Fast {"Type":6,"Body":5} Good"#,
        ],
        &[],
    ),
    (
        "open62541.two-fields.json",
        &[
            "ua-keyframe of 62541, Good",
            r#"Test {"Type":5,"Body":42} Good"#,
            r#"Server localtime {"Type":13,"Body":"2018-06-05T05:58:36Z"} Good"#,
        ],
        &[],
    ),
    (
        "node-opcua.status-code.json",
        &[
            "ua-keyframe of 4, Good",
            r#"Temperature {"Type":11,"Body":21.5} 0x80310000"#,
            "Pressure null BadSensorFailure",
        ],
        &["~/Temperature/StatusCode", "~/Pressure/StatusCode"],
    ),
];

/// Files that are refused as a whole: their names and the reasons, each after its pointer.
const REFUSED: &[(&str, &str)] = &[
    (
        "opc-publisher.batch.json",
        "/0: NetworkMessages must not be in an array: each is a message of its own",
    ),
    (
        "opc-publisher.metadata-batch.json",
        "/0: NetworkMessages must not be in an array: each is a message of its own",
    ),
    (
        "opc-publisher.metadata-names.json",
        "/MetaData/Fields/0/DataType: expected a NodeId as nsu=urn:press;s=Counter",
    ),
    (
        "opc-publisher.event.json",
        "/Messages/0/DataSetWriterId: expected a DataSetWriterId from 0 to 65535",
    ),
    (
        "open62541.null-payload.json",
        "/Messages/0/Payload: Payload is null; only a keep-alive has none",
    ),
    ("ua-netstandard.header-alone.json", ": Messages is missing"),
];

#[test]
fn they_are_read_as_they_are_meant() {
    for &(name, content, pointers) in TAKEN {
        let (found, noted) = read(name, Leniency::Lenient).unwrap();
        assert_eq!((found, noted), (owned(content), owned(pointers)), "{name}");
    }
    for &(name, reason) in REFUSED {
        assert_eq!(read(name, Leniency::Lenient).unwrap_err(), reason, "{name}");
    }
}

#[test]
fn every_file_is_expected_and_has_a_source() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign-messages");
    let sources = std::fs::read_to_string(folder.join("README.md")).unwrap();
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let mut expected =
            TAKEN.iter().map(|(known, ..)| known).chain(REFUSED.iter().map(|(known, _)| known));
        assert!(name == "README.md" || expected.any(|known| *known == name), "{name}");
        assert!(name == "README.md" || sources.contains(&format!("| `{name}` |")), "{name}");
    }
}

#[test]
fn what_deviates_is_refused_where_strictness_is_wanted() {
    // A field has a Bad status of its own then, metadata is refused as a whole.
    let (found, _) = read("node-opcua.status-code.json", Leniency::Strict).unwrap();
    assert_eq!(found[1], "Temperature null BadTypeMismatch");
    let refused = read("umati.metadata.json", Leniency::Strict).unwrap_err();
    assert!(refused.starts_with("/MetaData/Namespaces/0: "), "{refused}");
    let (found, _) = read("umati.body.json", Leniency::Strict).unwrap();
    assert_eq!(found[2], "Name null BadTypeMismatch");
}

#[test]
fn a_variant_without_its_type_has_that_of_the_metadata() {
    let metadata = r#"{"MessageType":"ua-metadata","DataSetWriterId":9,"MetaData":{"Fields":[
        {"Name":"NumberInList","BuiltInType":5},{"Name":"Override","BuiltInType":11}]}}"#;
    let PubSubMessage::MetaData(known) = decode(metadata.as_bytes()).unwrap().message else {
        panic!("metadata")
    };
    let text = r#"{"Messages":[{"DataSetWriterId":9,"Payload":{
        "NumberInList":{"Body":2},"Override":{"Value":{"Body":103},"Status":1073741824}}}]}"#;
    let decoded = decode_described(text.as_bytes(), Leniency::Lenient, &known.meta_data).unwrap();
    let PubSubMessage::Data(message) = decoded.message else { panic!("data") };
    assert_eq!(
        data_set(&message.messages[0]),
        [
            "ua-keyframe of 9, Good",
            r#"NumberInList {"Type":5,"Body":2} Good"#,
            r#"Override {"Type":11,"Body":103} Uncertain"#,
        ]
    );
}

/// The type of a text's message, or the reason to refuse it.
fn type_of(text: &str) -> String {
    match decode_described(text.as_bytes(), Leniency::Lenient, &()) {
        Ok(decoded) => decoded.message.message_type().to_owned(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn headers_are_read_to_the_letter() {
    let metadata = |writer: &str| {
        format!(r#"{{"MessageType":"ua-metadata","DataSetWriterId":{writer},"MetaData":{{}}}}"#)
    };
    let data = |writer: &str| format!(r#"{{"DataSetWriterId":{writer},"Payload":{{}}}}"#);
    for writer in [r#""+1""#, r#""-1""#, r#"" 1""#, r#""""#, r#""65536""#, "65536", "1.0"] {
        for text in [data(writer), metadata(writer)] {
            assert!(type_of(&text).contains("/DataSetWriterId: "), "{text}");
        }
    }
    assert_eq!(
        (type_of(&data(r#""17""#)), type_of(&metadata("17"))),
        ("ua-data".into(), "ua-metadata".into())
    );
    for (text, expected) in [
        (r#"{"MessageType":"ua-condition","Payload":{}}"#, "ua-condition"),
        (
            r#"{"MessageType":"ua-keyframe","Payload":null}"#,
            "/Payload: Payload is null; only a keep-alive has none",
        ),
        (
            r#"{"MessageType":"order","Messages":[]}"#,
            "/MessageType: the MessageType of a message with Messages must be ua-data",
        ),
        (r#"{"Messages":[{"MessageType":"alarm","Payload":{}}]}"#, "ua-data"),
        (r#"{"Messages":{"MessageType":"ua-condition","Payload":{}}}"#, "ua-data"),
    ] {
        assert_eq!(type_of(text), expected, "{text}");
    }
}

#[test]
fn an_unknown_type_leaves_the_message_of_a_single_one_empty() {
    let text =
        r#"{"MessageType":"ua-data","Messages":{"MessageType":"ua-condition","Payload":{"a":1}}}"#;
    let decoded = decode(text.as_bytes()).unwrap();
    assert_eq!(decoded.message, PubSubMessage::Data(NetworkMessage::default()));
    assert_eq!(decoded.diagnostics[0].pointer, "/Messages/MessageType");
}

fn owned(texts: &[&str]) -> Vec<String> {
    texts.iter().map(|text| (*text).to_owned()).collect()
}
