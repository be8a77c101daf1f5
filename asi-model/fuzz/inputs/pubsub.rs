//! Any bytes are met without panic, and what is read is read alike again after it was written.

use asi_model::pubsub::{
    FieldRepresentation, PubSubMessage,
    json::{Encoding, decode, encode_message},
};

/// Plays one input.
pub fn pubsub(bytes: &[u8]) {
    let Ok(first) = decode(bytes) else { return };
    let PubSubMessage::Data(mut message) = first.message else {
        let _ = encode_message(&first.message, Encoding::Digicor);
        return;
    };
    // Without metadata, bare values are guesses, and values that are not Good lose what a Variant
    // cannot carry; as data values all of it stays.
    for part in &mut message.messages {
        part.representation = FieldRepresentation::DataValue;
    }
    let message = PubSubMessage::Data(message);
    let once = encode_message(&message, Encoding::Digicor);
    let Ok(second) = decode(&once) else {
        panic!("our own message is not read: {}", String::from_utf8_lossy(&once))
    };
    let twice = encode_message(&second.message, Encoding::Digicor);
    if let Ok(third) = decode(&twice) {
        assert_eq!(encode_message(&third.message, Encoding::Digicor), twice);
    }
}
