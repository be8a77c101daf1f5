//! The inputs of the fuzz targets, replayed in every run.

#[path = "../../fuzz/inputs/factory_message.rs"]
mod factory_message;
#[path = "../../fuzz/inputs/node_set.rs"]
mod node_set;
#[path = "../../fuzz/inputs/platform_message.rs"]
mod platform_message;
#[path = "../../fuzz/inputs/pubsub.rs"]
mod pubsub;
#[path = "../../fuzz/inputs/texts.rs"]
mod texts;
#[path = "../../fuzz/inputs/value.rs"]
mod value;

fn replay(target: &str, play: impl Fn(&[u8])) {
    let package = env!("CARGO_MANIFEST_DIR");
    let inputs = testkit::corpus::inputs(package, target);
    assert!(inputs.len() >= 2, "{} inputs of {target}", inputs.len());
    for input in inputs.into_iter().chain(testkit::corpus::grown(package, target)) {
        play(&input);
        play(&input[..input.len() / 2]);
    }
}

#[test]
fn the_corpus_of_factory_messages_replays() {
    replay("factory_message", factory_message::factory_message);
}

#[test]
fn the_corpus_of_platform_messages_replays() {
    replay("platform_message", platform_message::platform_message);
}

#[test]
fn the_corpus_of_node_sets_replays() {
    replay("node_set", node_set::node_set);
}

#[test]
fn the_corpus_of_pubsub_messages_replays() {
    replay("pubsub", pubsub::pubsub);
}

#[test]
fn the_corpus_of_values_replays() {
    replay("value", value::value);
}

#[test]
fn the_corpus_of_texts_replays() {
    replay("texts", |bytes| texts::texts(&String::from_utf8_lossy(bytes)));
}
