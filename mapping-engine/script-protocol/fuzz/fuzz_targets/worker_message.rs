//! Bytes of a worker are a message or refused, and a message reads back as it was.
#![no_main]

use libfuzzer_sys::fuzz_target;
use script_protocol::{WorkerMessage, frame};

fuzz_target!(|bytes: &[u8]| {
    let mut stream = bytes;
    while let Ok(Some(body)) = frame::read(&mut stream) {
        if let Ok(message) = WorkerMessage::decode(&body) {
            let again = message.encode();
            // Compared as bytes: NaN is not equal to itself.
            let back = WorkerMessage::decode(&again).expect("what was encoded decodes");
            assert_eq!(back.encode(), again);
        }
    }
});
