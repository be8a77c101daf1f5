//! Any value is met without panic in both leniencies, and written in all encodings.

use asi_model::opcua_json::{
    DataEncoding, DecodedValue, Leniency, decode_value, encode_data_value, encode_variant,
};

/// Plays one input.
pub fn value(bytes: &[u8]) {
    let strict = decode_value(bytes, Leniency::Strict, &[], &[]);
    let Ok((value, _)) = decode_value(bytes, Leniency::Lenient, &[], &[]) else {
        assert!(strict.is_err(), "strictness takes what leniency refuses");
        return;
    };
    for encoding in [
        DataEncoding::Reversible104,
        DataEncoding::NonReversible104,
        DataEncoding::Compact105,
        DataEncoding::Verbose105,
    ] {
        let written = match &value {
            DecodedValue::Variant(value) | DecodedValue::Bare(value) => {
                encode_variant(value, encoding)
            }
            DecodedValue::DataValue(value) => encode_data_value(value, encoding),
        };
        assert!(std::str::from_utf8(&written).is_ok());
    }
}
