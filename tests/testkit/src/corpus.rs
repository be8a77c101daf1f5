//! Corpora of fuzz targets, replayed: each input as it is, cut off, and with bytes changed.

use std::path::Path;

/// Bytes that take the place of another one: ends, blanks, quotes, and what is no text.
const CHANGED: [u8; 6] = [0x00, 0x20, 0x22, 0x7f, 0x80, 0xff];

/// Plays each input of a package's corpus, cut off and changed at each `step`th byte.
///
/// # Panics
/// A corpus of fewer than ten inputs, and what `play` panics at.
pub fn replay(package: &str, target: &str, step: usize, play: impl Fn(&[u8])) {
    let folder = Path::new(package).join("fuzz/corpus").join(target);
    let inputs = std::fs::read_dir(folder).expect("a corpus");
    let inputs: Vec<_> = inputs
        .map(|input| std::fs::read(input.expect("an entry").path()).expect("an input"))
        .collect();
    assert!(inputs.len() >= 10, "{} inputs of {target}", inputs.len());
    for input in inputs {
        for end in (0..input.len()).step_by(step).chain([input.len()]) {
            play(&input[..end]);
        }
        for at in (0..input.len()).step_by(step) {
            for value in CHANGED {
                let mut changed = input.clone();
                changed[at] = value;
                play(&changed);
            }
        }
    }
}
