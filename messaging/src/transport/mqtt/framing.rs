//! Framing of packets: the library's codec, with a correction for one packet that it cannot read, and
//! with bounds for what it would read at the price of much memory.

use bytes::{Buf, BytesMut};
use rumqttc::v5::mqttbytes::{
    Error, QoS,
    v5::{Codec, Disconnect, DisconnectReasonCode, Packet},
};
use tokio_util::codec::{Decoder, Encoder, Framed};

use crate::transport::dial::Stream;

/// First byte of a DISCONNECT packet.
const DISCONNECT: u8 = 0xE0;
/// Type of a PUBLISH packet: the upper half of its first byte.
const PUBLISH: u8 = 3;
/// Longest property block that is decoded, in bytes. The library makes 48 bytes of memory of an
/// empty user property, which has five.
pub(super) const PROPERTY_BYTES_MAX: usize = 16 * 1024;
/// Longest packet of any other type than PUBLISH, in bytes: nearly all of it is properties.
const CONTROL_BYTES_MAX: u32 = 16 * 1024;
/// Most bytes of a variable byte integer (MQTT 5 §1.5.5).
const VARIABLE_BYTES_MAX: usize = 4;

/// Packets over the bytes of a connection.
pub(super) type PacketStream = Framed<Box<dyn Stream>, PacketCodec>;

/// Reads and writes packets.
#[derive(Debug)]
pub(super) struct PacketCodec {
    codec: Codec,
}

/// A packet that the broker has sent.
#[derive(Debug, PartialEq, Eq)]
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all are packets, which would be allocated each"
)]
pub(super) enum Incoming {
    Packet(Packet),
    /// A message whose properties are longer than [`PROPERTY_BYTES_MAX`]. Any other client of the
    /// broker may have published it, so it is to be rejected, and the connection to stay.
    Overlong {
        /// Packet identifier; none of a message that asks for no acknowledgement.
        id: Option<u16>,
    },
}

impl PacketCodec {
    /// A codec for packets of up to `bytes_max` bytes from the broker.
    pub(super) fn new(bytes_max: u32) -> Self {
        Self { codec: Codec { max_incoming_size: Some(bytes_max), max_outgoing_size: None } }
    }

    /// The limit for a packet that begins with `first`, in bytes.
    fn bytes_max(&self, first: u8) -> Option<u32> {
        let limit = self.codec.max_incoming_size;
        if first >> 4 == PUBLISH { limit } else { limit.map(|limit| limit.min(CONTROL_BYTES_MAX)) }
    }
}

impl Decoder for PacketCodec {
    type Item = Incoming;
    type Error = Error;

    fn decode(&mut self, source: &mut BytesMut) -> Result<Option<Incoming>, Error> {
        // The properties may be absent (MQTT 5 §3.14.2.2). The library takes such a packet for an
        // incomplete one.
        if let [DISCONNECT, length @ (0 | 1), rest @ ..] = &source[..] {
            let length = usize::from(*length);
            let Some(body) = rest.get(..length) else { return Ok(None) };
            let reason = body
                .first()
                .map_or(Ok(DisconnectReasonCode::NormalDisconnection), |code| (*code).try_into())?;
            source.advance(2 + length);
            return Ok(Some(Incoming::Packet(Packet::Disconnect(Disconnect::new(reason)))));
        }
        let Some(first) = source.first().copied() else { return Ok(None) };
        if let Some((length, id)) = overlong(source) {
            if self.bytes_max(first).is_some_and(|limit| length > limit as usize) {
                return Err(Error::MalformedPacket);
            }
            if source.len() < length {
                source.reserve(length - source.len());
                return Ok(None);
            }
            source.advance(length);
            return Ok(Some(Incoming::Overlong { id }));
        }
        let mut codec = Codec { max_incoming_size: self.bytes_max(first), ..self.codec };
        Ok(codec.decode(source)?.map(Incoming::Packet))
    }
}

impl Encoder<Packet> for PacketCodec {
    type Error = Error;

    fn encode(&mut self, packet: Packet, target: &mut BytesMut) -> Result<(), Error> {
        self.codec.encode(packet, target)
    }
}

/// Length in bytes and packet identifier of a PUBLISH that has too long a property block. None for
/// other packets, and until the length of the block has arrived.
fn overlong(source: &[u8]) -> Option<(usize, Option<u16>)> {
    let (first, rest) = source.split_first()?;
    if first >> 4 != PUBLISH {
        return None;
    }
    let (remaining, rest) = variable(rest)?;
    let length = source.len() - rest.len() + remaining;
    let (topic, rest) = rest.split_first_chunk()?;
    let mut rest = rest.get(usize::from(u16::from_be_bytes(*topic))..)?;
    let mut id = None;
    if first & 0b0110 != QoS::AtMostOnce as u8 {
        let bytes;
        (bytes, rest) = rest.split_first_chunk()?;
        id = Some(u16::from_be_bytes(*bytes));
    }
    let (properties, _) = variable(rest)?;
    (properties > PROPERTY_BYTES_MAX).then_some((length, id))
}

/// A variable byte integer and what follows it; none for an incomplete or too long one.
fn variable(bytes: &[u8]) -> Option<(usize, &[u8])> {
    let end = bytes.iter().take(VARIABLE_BYTES_MAX).position(|byte| byte & 0x80 == 0)?;
    let (digits, rest) = bytes.split_at(end + 1);
    let value = digits.iter().rev().fold(0, |value, byte| value << 7 | usize::from(byte & 0x7F));
    Some((value, rest))
}

#[cfg(test)]
mod tests {
    use rumqttc::v5::mqttbytes::v5::{PubAck, PubAckProperties, Publish, PublishProperties};

    use super::*;

    const BYTES_MAX: u32 = 1 << 20;

    /// Encodes for a client without limits.
    fn encoded(packet: Packet) -> BytesMut {
        let mut bytes = BytesMut::new();
        PacketCodec::new(u32::MAX).encode(packet, &mut bytes).expect("encodes");
        bytes
    }

    fn publish(properties: usize, qos: QoS, payload: usize) -> Packet {
        let properties = PublishProperties {
            user_properties: vec![Default::default(); properties],
            ..PublishProperties::default()
        };
        let mut publish = Publish::new("a/b", qos, vec![0; payload], Some(properties));
        publish.pkid = 7;
        Packet::Publish(publish)
    }

    #[test]
    fn a_short_disconnect_is_read() {
        let mut codec = PacketCodec::new(1000);
        let mut bytes = BytesMut::from(&[0xE0, 0x01][..]);
        let mut next = |more: &[u8]| {
            bytes.extend_from_slice(more);
            codec.decode(&mut bytes).expect("reads")
        };
        assert_eq!(next(&[]), None);
        let taken_over =
            Packet::Disconnect(Disconnect::new(DisconnectReasonCode::SessionTakenOver));
        assert_eq!(next(&[0x8E, 0xD0, 0x00, 0xE0, 0x00]), Some(Incoming::Packet(taken_over)));
        assert!(matches!(next(&[]), Some(Incoming::Packet(Packet::PingResp(_)))));
        assert!(matches!(next(&[]), Some(Incoming::Packet(Packet::Disconnect(_)))));
        assert!(bytes.is_empty());
    }

    #[test]
    fn a_message_with_too_long_properties_is_passed_over_in_whatever_parts_it_comes() {
        let overlong = PROPERTY_BYTES_MAX / 5 + 1;
        for (qos, id) in [(QoS::AtLeastOnce, Some(7)), (QoS::AtMostOnce, None)] {
            let mut sent = encoded(publish(overlong, qos, 100));
            let last = publish(overlong - 1, QoS::AtLeastOnce, 3);
            sent.extend_from_slice(&encoded(last.clone()));
            for part in [1, 7, sent.len()] {
                let (mut codec, mut bytes) = (PacketCodec::new(BYTES_MAX), BytesMut::new());
                let mut read = Vec::new();
                for part in sent.chunks(part) {
                    bytes.extend_from_slice(part);
                    while let Some(packet) = codec.decode(&mut bytes).expect("reads") {
                        read.push(packet);
                    }
                }
                let expected = [Incoming::Overlong { id }, Incoming::Packet(last.clone())];
                assert_eq!(read, expected, "in parts of {part} bytes");
            }
        }
    }

    #[test]
    fn what_is_too_long_in_all_is_refused_with_its_first_bytes() {
        let acknowledgement = PubAck::new(
            1,
            Some(PubAckProperties {
                reason_string: None,
                user_properties: vec![Default::default(); CONTROL_BYTES_MAX as usize / 5 + 1],
            }),
        );
        for (packet, what) in [
            (Packet::PubAck(acknowledgement), "an acknowledgement"),
            (publish(0, QoS::AtLeastOnce, BYTES_MAX as usize), "a message"),
            (publish(BYTES_MAX as usize / 5 + 1, QoS::AtLeastOnce, 0), "properties"),
        ] {
            let mut bytes = BytesMut::from(&encoded(packet)[..20]);
            assert!(PacketCodec::new(BYTES_MAX).decode(&mut bytes).is_err(), "{what}");
        }
    }
}
