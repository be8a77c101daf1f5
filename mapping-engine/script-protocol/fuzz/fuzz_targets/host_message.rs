//! Bytes of a host are a message or refused, and a message reads back as it was.
#![no_main]

use libfuzzer_sys::fuzz_target;
use script_protocol::HostMessage;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(message) = HostMessage::decode(bytes) {
        let again = message.encode();
        let back = HostMessage::decode(&again).expect("what was encoded decodes");
        assert_eq!(back.encode(), again);
    }
});
