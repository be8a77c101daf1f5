//! The way of a broker's bytes to messages, without a connection: for the fuzz target.

use bytes::BytesMut;
use futures::FutureExt;
use rumqttc::v5::mqttbytes::v5::Packet;
use tokio::sync::OwnedSemaphorePermit;
use tokio_util::codec::Decoder;

use super::{
    codec,
    framing::{Incoming, PacketCodec},
    held::Memory,
};
use crate::clock;

/// A message that was read.
#[derive(Debug, Clone, Copy)]
pub struct ReadMessage {
    /// Memory that it is counted with, in bytes.
    pub memory_bytes: usize,
    /// True if it can be handed to the inbox.
    pub is_delivery: bool,
}

/// Reads the bytes of a broker in parts of `part_bytes`, until they cannot be read. Packets may have
/// up to `packet_bytes_max` bytes.
pub fn read_mqtt(bytes: &[u8], part_bytes: usize, packet_bytes_max: u32) -> Vec<ReadMessage> {
    let (mut codec, mut buffer) = (PacketCodec::new(packet_bytes_max), BytesMut::new());
    let mut read = Vec::new();
    for part in bytes.chunks(part_bytes.max(1)) {
        buffer.extend_from_slice(part);
        loop {
            let packet = match codec.decode(&mut buffer) {
                Ok(Some(Incoming::Packet(packet))) => packet,
                Ok(Some(Incoming::Overlong { .. })) => continue,
                Ok(None) => break,
                Err(_) => return read,
            };
            let Packet::Publish(publish) = packet else { continue };
            // Alone it never waits for memory.
            let memory = Memory::new(u64::from(packet_bytes_max));
            let Some(held) = memory.hold(publish).now_or_never() else { continue };
            read.push(ReadMessage {
                memory_bytes: held
                    .memory
                    .iter()
                    .map(OwnedSemaphorePermit::num_permits)
                    .max()
                    .unwrap_or(0),
                is_delivery: codec::to_delivery(held.publish, clock::now()).is_ok(),
            });
        }
    }
    read
}
