//! Freshness of the published schemas, and the examples under them.

use std::path::Path;

use serde_json::json;

use super::*;
use crate::{
    messages::{FactoryMessage, PlatformMessage},
    pubsub::{
        PubSubMessage,
        json::{Encoding, decode, encode_message},
    },
    validation,
};

fn files(folder: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder)
        .expect("the folder exists")
        .map(|entry| {
            let path = entry.expect("readable").path();
            let name = path.file_name().expect("a file").to_string_lossy().into_owned();
            (name, std::fs::read(&path).expect("readable"))
        })
        .collect();
    files.sort();
    files
}

// `asi schema asi-model/schema` writes them again.
#[test]
fn the_published_schemas_are_fresh() {
    let mut wanted: Vec<(String, Vec<u8>)> = all()
        .iter()
        .map(|(name, schema)| ((*name).to_owned(), text(schema).into_bytes()))
        .collect();
    wanted.sort();
    for ((name, text), (wanted_name, wanted_text)) in files("schema").iter().zip(&wanted) {
        assert_eq!(name, wanted_name);
        assert!(text == wanted_text, "{name} is stale: run `asi schema asi-model/schema`");
    }
    assert_eq!(files("schema").len(), wanted.len());
}

#[test]
fn every_example_validates() {
    let mut uncovered: Vec<String> =
        all().iter().map(|(name, _)| name.trim_end_matches(".schema.json").to_owned()).collect();
    uncovered.retain(|name| name != "network");
    for (name, bytes) in files("examples").iter().filter(|(name, _)| name.ends_with(".json")) {
        let message_type = name.split('.').next().expect("a name");
        let schema = all()
            .into_iter()
            .find(|(file, _)| file.trim_end_matches(".schema.json") == message_type)
            .unwrap_or_else(|| panic!("{name} has no schema"))
            .1;
        let validator = jsonschema::draft202012::new(&schema).expect("a valid schema");
        let instance: Value = serde_json::from_slice(bytes).expect("JSON");
        let errors: Vec<String> =
            validator.iter_errors(&instance).map(|error| error.to_string()).collect();
        assert_eq!(errors, Vec::<String>::new(), "{name}");
        assert!(
            !validator.is_valid(&json!({ "messageType": message_type })),
            "{name}: the schema asks for nothing"
        );
        check_readable(name, message_type, bytes, &instance);
        uncovered.retain(|kind| kind != message_type);
    }
    assert_eq!(uncovered, Vec::<String>::new(), "message types without example");
}

fn check_readable(name: &str, message_type: &str, bytes: &[u8], instance: &Value) {
    match message_type {
        "operation-network" | "withdraw" | "comment" | "asset-request" | "receipt" | "lease"
        | "ledger-cosignature" => {
            let message = validation::parse_any_platform_message(bytes).expect(name);
            assert_eq!(message.message_type(), message_type);
            let again = serde_json::to_vec(&message).expect("writable");
            assert_eq!(validation::parse_any_platform_message(&again).as_ref(), Ok(&message));
            // serde reads the same from its own text, as the stores do.
            assert_eq!(serde_json::from_slice::<PlatformMessage>(&again).expect(name), message);
        }
        "acknowledgement" | "decision" | "gap" | "asset-offer" | "lease-request" | "revocation"
        | "ledger-checkpoint" | "past-release" | "receipt-request" => {
            let message = validation::parse_factory_message(bytes).expect(name);
            let again = serde_json::to_vec(&message).expect("writable");
            assert_eq!(validation::parse_factory_message(&again).as_ref(), Ok(&message));
            assert_eq!(serde_json::from_slice::<FactoryMessage>(&again).expect(name), message);
        }
        _ => check_pubsub(name, message_type, bytes, instance),
    }
}

fn check_pubsub(name: &str, message_type: &str, bytes: &[u8], instance: &Value) {
    let decoded = decode(bytes).expect(name);
    assert_eq!(decoded.message.message_type(), message_type);
    // Verbose leaves out types, which only metadata could give back.
    if name.contains("1.05-verbose") {
        return;
    }
    assert_eq!(decoded.diagnostics, [], "{name}");
    let encoding = if name.contains("1.05") { Encoding::Compact105 } else { Encoding::Digicor };
    assert!(!matches!(decoded.message, PubSubMessage::Other { .. }), "{name} is of unknown type");
    let again = encode_message(&decoded.message, encoding);
    let again: Value = serde_json::from_slice(&again).expect("JSON");
    assert_eq!(&again, instance, "{name} is not written as it was read");
}
