//! The inputs of the fuzz target, replayed in every run.

#[path = "../../fuzz/inputs/document.rs"]
mod document;

#[test]
fn the_corpus_of_documents_replays() {
    testkit::corpus::replay(env!("CARGO_MANIFEST_DIR"), "documents", 5, document::document);
}
