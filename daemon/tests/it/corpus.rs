//! The inputs of the fuzz target, replayed in every run.

#[path = "../../fuzz/inputs/client.rs"]
mod client;

#[test]
fn the_corpus_of_http_requests_replays() {
    testkit::corpus::replay(env!("CARGO_MANIFEST_DIR"), "http", 17, client::client);
}
