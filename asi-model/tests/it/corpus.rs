//! The fuzz targets' committed inputs, replayed in every run: no panic, and what is read is read
//! alike once written.

use std::path::Path;

use asi_model::{
    instance, node_set,
    opcua_json::{DataEncoding, DecodedValue, Leniency, decode_value, encode_variant},
    pubsub::json::{Encoding, decode, encode_message},
    validation::{parse_any_platform_message, parse_factory_message},
};

#[test]
fn the_corpus_replays() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus");
    let mut count = 0;
    for target in std::fs::read_dir(corpus).unwrap() {
        for input in std::fs::read_dir(target.unwrap().path()).unwrap() {
            let bytes = std::fs::read(input.unwrap().path()).unwrap();
            replay(&bytes);
            count += 1;
        }
    }
    assert!(count > 100, "{count} inputs");
}

fn replay(bytes: &[u8]) {
    let _ = parse_factory_message(bytes);
    if let Ok(message) = parse_any_platform_message(bytes) {
        let text = serde_json::to_vec(&message).unwrap();
        assert_eq!(parse_any_platform_message(&text), Ok(message));
    }
    if let Ok(nodes) = node_set::read(bytes) {
        let _ = instance::to_json(&nodes, "m");
        assert!(node_set::read(node_set::write(&nodes).as_bytes()).is_ok());
    }
    if let Ok((DecodedValue::Variant(value), _)) = decode_value(bytes, Leniency::Lenient, &[], &[])
    {
        let text = encode_variant(&value, DataEncoding::Reversible104);
        let again = decode_value(&text, Leniency::Lenient, &[], &[]).unwrap().0;
        let (DecodedValue::Variant(again) | DecodedValue::Bare(again)) = again else {
            panic!("a variant")
        };
        // As text, since NaN is no equal of itself.
        assert_eq!(encode_variant(&again, DataEncoding::Reversible104), text);
    }
    if let Ok(decoded) = decode(bytes) {
        let text = encode_message(&decoded.message, Encoding::Digicor);
        assert!(decode(&text).is_ok());
    }
}
