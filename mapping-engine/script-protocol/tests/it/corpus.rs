//! The inputs of the fuzz targets, replayed in every run.

#[path = "../../fuzz/inputs/messages.rs"]
mod messages;

#[test]
fn the_corpus_of_host_messages_replays() {
    testkit::corpus::replay(env!("CARGO_MANIFEST_DIR"), "host_message", 1, messages::host);
}

#[test]
fn the_corpus_of_worker_messages_replays() {
    testkit::corpus::replay(env!("CARGO_MANIFEST_DIR"), "worker_message", 1, messages::worker);
}
