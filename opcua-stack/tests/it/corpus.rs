//! The fuzz targets and what they have found, once each.

use std::path::Path;

#[path = "../../fuzz/src/edge.rs"]
mod edge;

/// Fuzz target: takes bytes, and fails by a panic.
type Target = fn(&[u8]);

#[test]
fn the_corpus_replays() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus");
    let targets: [(&str, Target); 2] = [("chunks", edge::chunks), ("services", edge::services)];
    for (target, run) in targets {
        let mut count = 0;
        for file in std::fs::read_dir(corpus.join(target)).expect("a folder per target") {
            let bytes = std::fs::read(file.expect("readable").path()).expect("readable");
            run(&bytes);
            // Cut anywhere, it is met as well.
            for end in 0..bytes.len().min(512) {
                run(&bytes[..end]);
            }
            count += 1;
        }
        assert!(count > 10, "{target}: {count} inputs");
    }
}
