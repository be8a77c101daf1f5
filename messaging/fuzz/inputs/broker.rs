//! An MQTT broker that sends any bytes, for the fuzz target and for the test that replays its corpus.

/// Largest packet, in bytes.
const PACKET_BYTES_MAX: u32 = 64 * 1024;
/// Most memory per byte of a packet: 48 bytes of a property of five, in a list that has doubled.
const MEMORY_PER_BYTE_MAX: usize = 20;
/// Memory of a message without content.
const MEMORY_MIN: usize = 1024;

/// Sends bytes to the reader of packets. The first byte says in parts of which size.
pub fn broker(bytes: &[u8]) {
    let Some((part, rest)) = bytes.split_first() else { return };
    let held = messaging::test_support::read_mqtt(rest, usize::from(*part) + 1, PACKET_BYTES_MAX);
    for message in held {
        assert!(message.memory_bytes <= MEMORY_MIN + MEMORY_PER_BYTE_MAX * rest.len());
    }
}
