//! The inputs of the fuzz target, replayed in every run, and the same cut off and changed.

#[path = "../../fuzz/inputs/peer.rs"]
mod peer;

use std::path::Path;

#[test]
fn the_corpus_of_a_websocket_replays() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/websocket");
    let inputs = std::fs::read_dir(folder).expect("a corpus");
    let inputs: Vec<_> = inputs
        .map(|input| std::fs::read(input.expect("an entry").path()).expect("an input"))
        .collect();
    assert!(inputs.len() >= 10, "{} inputs", inputs.len());
    for input in inputs {
        for end in (0..input.len()).step_by(3).chain([input.len()]) {
            peer::peer(&input[..end]);
        }
        for at in (0..input.len()).step_by(3) {
            for value in [0x00, 0x20, 0x22, 0x7f, 0x80, 0xff] {
                let mut changed = input.clone();
                changed[at] = value;
                peer::peer(&changed);
            }
        }
    }
}
