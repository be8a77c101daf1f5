//! The fuzz targets and what they have found, once each.

#[path = "../../fuzz/src/edge.rs"]
mod edge;

/// Fuzz target: takes bytes, and fails by a panic.
type Target = fn(&[u8]);

#[test]
fn the_corpus_replays() {
    let package = env!("CARGO_MANIFEST_DIR");
    let targets: [(&str, Target); 2] = [("chunks", edge::chunks), ("services", edge::services)];
    for (target, run) in targets {
        let mut count = 0;
        for bytes in testkit::corpus::inputs(package, target) {
            run(&bytes);
            // Cut anywhere, it is met as well.
            for end in 0..bytes.len().min(512) {
                run(&bytes[..end]);
            }
            count += 1;
        }
        assert!(count > 10, "{target}: {count} inputs");
        testkit::corpus::grown(package, target).iter().for_each(|bytes| run(bytes));
    }
}
