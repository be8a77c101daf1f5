//! The inputs of the fuzz target, replayed in every run.

use std::collections::BTreeSet;

use platform::api::bodies::OPERATIONS;
use serde_json::Value;

#[path = "../../fuzz/inputs/body.rs"]
mod body;

#[test]
fn the_corpus_of_bodies_replays() {
    testkit::corpus::replay(env!("CARGO_MANIFEST_DIR"), "bodies", 5, body::body);
}

#[test]
fn every_operation_with_a_body_is_among_the_inputs() {
    let description = serde_json::to_value(platform::api::openapi()).expect("JSON");
    let with_body = |operation: &&Value| !operation["requestBody"].is_null();
    let paths = description["paths"].as_object().expect("paths").values();
    let operations = paths.flat_map(|path| path.as_object().expect("operations").values());
    let ids: BTreeSet<&str> =
        operations.filter(with_body).map(|it| it["operationId"].as_str().expect("an id")).collect();
    assert!(ids.len() > 10, "{ids:?}");
    assert_eq!(ids, OPERATIONS.into_iter().collect::<BTreeSet<&str>>());
    let sent: BTreeSet<u8> = testkit::corpus::inputs(env!("CARGO_MANIFEST_DIR"), "bodies")
        .iter()
        .filter_map(|input| Some(input.first()? % u8::try_from(OPERATIONS.len()).expect("few")))
        .collect();
    assert_eq!(sent.len(), OPERATIONS.len(), "a body of each operation: {sent:?}");
}
