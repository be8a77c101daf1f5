//! The inputs of the fuzz targets, replayed in every run.

use std::collections::BTreeSet;

use factory_connector::api::bodies::OPERATIONS;
use serde_json::Value;

#[path = "../../fuzz/inputs/body.rs"]
mod body;
#[path = "../../fuzz/inputs/document.rs"]
mod document;

#[test]
fn the_corpus_of_documents_replays() {
    testkit::corpus::replay(env!("CARGO_MANIFEST_DIR"), "documents", 5, document::document);
}

#[test]
fn the_corpus_of_bodies_replays() {
    testkit::corpus::replay(env!("CARGO_MANIFEST_DIR"), "connector_bodies", 17, body::body);
}

#[test]
fn every_operation_with_a_body_is_among_the_inputs() {
    let description = serde_json::to_value(factory_connector::api::openapi()).expect("JSON");
    let with_body = |operation: &&Value| !operation["requestBody"].is_null();
    let paths = description["paths"].as_object().expect("paths").values();
    let operations = paths.flat_map(|path| path.as_object().expect("operations").values());
    let ids: BTreeSet<&str> =
        operations.filter(with_body).map(|it| it["operationId"].as_str().expect("an id")).collect();
    assert!(ids.len() > 30, "{ids:?}");
    assert_eq!(ids, OPERATIONS.into_iter().collect::<BTreeSet<&str>>());
    // A refused body shows no more than that it was read. Nobody has a certificate for the key of a moment ago.
    let accepted: BTreeSet<&str> =
        testkit::corpus::inputs(env!("CARGO_MANIFEST_DIR"), "connector_bodies")
            .iter()
            .filter_map(|input| body::read(input))
            .filter_map(|(operation, outcome)| match outcome {
                Ok(()) => Some(operation),
                Err(problem) => (&*problem.code == "NOT_USABLE"
                    && operation == "installApplicationCertificate")
                    .then_some(operation),
            })
            .collect();
    assert_eq!(accepted, ids, "a body of each operation that is taken");
}
