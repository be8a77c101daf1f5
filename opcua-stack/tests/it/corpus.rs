//! The fuzz targets and what they have found, once each.

#[path = "../../fuzz/src/edge.rs"]
mod edge;

use edge::Side;
pub use edge::services;

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

/// Each is signed and decrypted with keys of its length, which takes its time: they are cut in fewer places.
#[test]
fn the_corpus_of_requests_to_open_a_channel_replays() {
    let package = env!("CARGO_MANIFEST_DIR");
    testkit::corpus::replay(package, "opening", 61, edge::opening);
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/fuzz/corpus/opening");
    for name in ["basic256sha256", "aes128", "aes256pss"] {
        let input = std::fs::read(format!("{folder}/{name}")).expect("an input");
        assert!(edge::opened(&input), "{name}: it gets past signature and padding");
        let (last, rest) = input.split_last().expect("bytes");
        assert!(!edge::opened(&[rest, &[last ^ 1]].concat()), "{name}: padding of another size");
    }
}

/// A body that the fuzzer makes gets past signature and encryption, up to the message that it means.
#[test]
fn what_is_made_of_bytes_reaches_the_services_behind_a_secure_channel() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/fuzz/corpus/services");
    for (name, side) in [("read", Side::Server), ("read_response", Side::Client)] {
        let service = std::fs::read(format!("{folder}/{name}")).expect("an input");
        // The number of the encoding, as the id of a node in four bytes.
        let body = [&[1, 0], service.as_slice()].concat();
        let (first, second) = body.split_at(7);
        let chunk = |kind: u8, body: &[u8]| {
            let length = u16::try_from(body.len()).expect("a short body").to_le_bytes();
            [&[kind, 0], length.as_slice(), body].concat()
        };
        for protection in [128, 129] {
            let one = [vec![protection], chunk(0, &body), chunk(0, &body)].concat();
            assert_eq!(edge::decoded(side, &one), 2, "{name}");
            let two = [vec![protection], chunk(2, first), chunk(0, second)].concat();
            assert_eq!(edge::decoded(side, &two), 1, "{name} in two chunks");
            // What is a request for one side is none for the other.
            assert_eq!(edge::decoded(side.other(), &one), 0, "{name}");
        }
    }
}
