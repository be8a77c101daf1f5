//! The inputs of the fuzz target, replayed in every run.

#[path = "../../fuzz/inputs/broker.rs"]
mod broker;

#[test]
fn the_corpus_of_a_broker_replays() {
    testkit::corpus::replay(env!("CARGO_MANIFEST_DIR"), "mqtt", 1, broker::broker);
}
