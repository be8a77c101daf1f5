//! Bytes between connector and worker, for fuzzing and for the tests that replay its corpus.

use script_protocol::{HostMessage, WorkerMessage, frame};

/// Takes bytes of a host: a message or refused, and a message reads back as it was.
pub fn host(bytes: &[u8]) {
    if let Ok(message) = HostMessage::decode(bytes) {
        let again = message.encode();
        let back = HostMessage::decode(&again).expect("what was encoded decodes");
        assert_eq!(back.encode(), again);
    }
}

/// Takes bytes of a worker: messages or refused, and a message reads back as it was.
pub fn worker(bytes: &[u8]) {
    let mut stream = bytes;
    while let Ok(Some(body)) = frame::read(&mut stream) {
        if let Ok(message) = WorkerMessage::decode(&body) {
            let again = message.encode();
            // Compared as bytes: NaN is not equal to itself.
            let back = WorkerMessage::decode(&again).expect("what was encoded decodes");
            assert_eq!(back.encode(), again);
        }
    }
}
