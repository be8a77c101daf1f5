//! The inputs of the fuzz targets, replayed in every run, and the same with bytes cut off and changed.

#[path = "../../fuzz/inputs/decode.rs"]
mod decode;
#[path = "../../fuzz/inputs/session.rs"]
mod session;

const PACKAGE: &str = env!("CARGO_MANIFEST_DIR");

fn corpus(target: &str) -> Vec<Vec<u8>> {
    let inputs = testkit::corpus::inputs(PACKAGE, target);
    assert!(inputs.len() >= 10, "{} inputs of {target}", inputs.len());
    inputs
}

#[test]
fn the_corpus_of_frames_replays() {
    for input in corpus("decode") {
        for end in 0..=input.len() {
            decode::decode(&input[..end]);
        }
        for at in 0..input.len() {
            for value in [0x00, 0x40, 0x45, 0x80, 0xc0, 0xd0, 0xe0, 0xf0, 0xff] {
                let mut changed = input.clone();
                changed[at] = value;
                decode::decode(&changed);
            }
        }
    }
    testkit::corpus::grown(PACKAGE, "decode").iter().for_each(|input| decode::decode(input));
}

#[test]
fn the_corpus_of_sessions_replays() {
    for input in corpus("session") {
        session::session(&input);
        session::session(&input[..input.len() / 2]);
    }
    testkit::corpus::grown(PACKAGE, "session").iter().for_each(|input| session::session(input));
}
