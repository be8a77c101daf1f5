//! The inputs of the fuzz target, replayed in every run.

#[path = "../../fuzz/inputs/peer.rs"]
mod peer;

#[test]
fn the_corpus_of_a_websocket_replays() {
    testkit::corpus::replay(env!("CARGO_MANIFEST_DIR"), "websocket", 3, peer::peer);
}
