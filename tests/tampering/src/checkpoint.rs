//! Bytes and lines of the checkpoints: of the one that was kept, and of the newer one in the file.

use serde_json::{Value, json};

use crate::{file::AuditFile, kinds::Kinds};

pub(crate) fn try_all(file: &AuditFile, kinds: &mut Kinds<'_>) {
    for (name, other) in changes(&file.checkpoint) {
        kinds.attempt(&format!("kept checkpoint: {name}"), &file.lines, &other);
    }
    let start = file.line(0);
    let newest = start["checkpoint"].as_str().expect("the file has a checkpoint");
    let mut attempt = |name: &str, checkpoint: Value| {
        let mut start = start.clone();
        start["checkpoint"] = checkpoint;
        let name = format!("checkpoint in the file: {name}");
        kinds.attempt(&name, &file.with(0, &start), &file.checkpoint);
    };
    for (name, other) in changes(newest) {
        attempt(&name, json!(other));
    }
    attempt("left out", Value::Null);
    attempt("the older one in its place", json!(file.checkpoint));
}

fn changes(note: &str) -> Vec<(String, String)> {
    let mut changes = Vec::new();
    for place in 0..note.len() {
        let mut bytes = note.as_bytes().to_vec();
        bytes[place] ^= 1;
        // All bytes together are one kind.
        let other = String::from_utf8_lossy(&bytes).into_owned();
        changes.push(("a byte changed".to_owned(), other));
        bytes.remove(place);
        let other = String::from_utf8_lossy(&bytes).into_owned();
        changes.push(("a byte removed".to_owned(), other));
    }
    let (text, signatures) = note.rsplit_once("\n\n").expect("a note");
    let [origin, size, root] = text.split('\n').collect::<Vec<_>>()[..] else {
        panic!("a checkpoint has three lines");
    };
    let size: u64 = size.parse().expect("a size");
    let mut put = |name: &str, other: String| changes.push((name.to_owned(), other));
    put("without signature", format!("{text}\n\n"));
    put("with a further line", format!("{text}\nmore\n\n{signatures}"));
    put("smaller", format!("{origin}\n{}\n{root}\n\n{signatures}", size - 1));
    put("larger", format!("{origin}\n{}\n{root}\n\n{signatures}", size + 1));
    put("of another log", format!("{origin}x\n{size}\n{root}\n\n{signatures}"));
    put("empty", String::new());
    changes
}
