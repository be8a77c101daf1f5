//! Corpora of fuzz targets, replayed: what was found or written by hand as it is, cut off and with bytes
//! changed; what fuzzing has grown as it is.

use std::path::{Path, PathBuf};

use base64::{Engine as _, engine::general_purpose::STANDARD};

/// Bytes that take the place of another one: ends, blanks, quotes, and what is no text.
const CHANGED: [u8; 6] = [0x00, 0x20, 0x22, 0x7f, 0x80, 0xff];

fn folder(package: &str) -> PathBuf {
    Path::new(package).join("fuzz/corpus")
}

/// Reads the inputs of a target that have a file each: found, or written by hand.
///
/// # Panics
/// A folder that cannot be read.
#[must_use]
pub fn inputs(package: &str, target: &str) -> Vec<Vec<u8>> {
    let inputs = std::fs::read_dir(folder(package).join(target)).expect("a corpus");
    inputs.map(|input| std::fs::read(input.expect("an entry").path()).expect("an input")).collect()
}

/// Reads the inputs of a target that fuzzing has grown, as `tools/fuzz.sh keep` stores them: a line of
/// base64 each.
///
/// # Panics
/// Fewer than a hundred, or a line of another form.
#[must_use]
pub fn grown(package: &str, target: &str) -> Vec<Vec<u8>> {
    let lines = std::fs::read_to_string(folder(package).join(format!("{target}.base64")))
        .expect("a grown corpus");
    let inputs: Vec<_> =
        lines.lines().map(|line| STANDARD.decode(line).expect("a line of base64")).collect();
    assert!(inputs.len() >= 100, "{} grown inputs of {target}", inputs.len());
    inputs
}

/// Plays each input of a package's corpus, cut off and changed at each `step`th byte, and what has grown.
///
/// # Panics
/// A corpus of fewer than ten inputs, and what `play` panics at.
pub fn replay(package: &str, target: &str, step: usize, play: impl Fn(&[u8])) {
    let inputs = inputs(package, target);
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
    grown(package, target).iter().for_each(|input| play(input));
}
