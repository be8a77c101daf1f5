//! Framing of packets: the library's codec, with a correction for one packet that it cannot read.

use bytes::{Buf, BytesMut};
use rumqttc::v5::mqttbytes::{
    Error,
    v5::{Codec, Disconnect, DisconnectReasonCode, Packet},
};
use tokio_util::codec::{Decoder, Encoder};

/// First byte of a DISCONNECT packet.
const DISCONNECT: u8 = 0xE0;

/// Reads and writes packets.
#[derive(Debug)]
pub(super) struct PacketCodec(pub Codec);

impl Decoder for PacketCodec {
    type Item = Packet;
    type Error = Error;

    fn decode(&mut self, source: &mut BytesMut) -> Result<Option<Packet>, Error> {
        // The properties may be absent (MQTT 5 §3.14.2.2). The library takes such a packet for an
        // incomplete one.
        if let [DISCONNECT, length @ (0 | 1), rest @ ..] = &source[..] {
            let length = usize::from(*length);
            let Some(body) = rest.get(..length) else { return Ok(None) };
            let reason = body
                .first()
                .map_or(Ok(DisconnectReasonCode::NormalDisconnection), |code| (*code).try_into())?;
            source.advance(2 + length);
            return Ok(Some(Packet::Disconnect(Disconnect::new(reason))));
        }
        self.0.decode(source)
    }
}

impl Encoder<Packet> for PacketCodec {
    type Error = Error;

    fn encode(&mut self, packet: Packet, target: &mut BytesMut) -> Result<(), Error> {
        self.0.encode(packet, target)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_disconnect_is_read() {
        let mut codec =
            PacketCodec(Codec { max_incoming_size: Some(1000), max_outgoing_size: None });
        let mut bytes = BytesMut::from(&[0xE0, 0x01][..]);
        let mut next = |more: &[u8]| {
            bytes.extend_from_slice(more);
            codec.decode(&mut bytes).expect("reads")
        };
        assert_eq!(next(&[]), None);
        let taken_over =
            Packet::Disconnect(Disconnect::new(DisconnectReasonCode::SessionTakenOver));
        assert_eq!(next(&[0x8E, 0xD0, 0x00, 0xE0, 0x00]), Some(taken_over));
        assert!(matches!(next(&[]), Some(Packet::PingResp(_))));
        assert!(matches!(next(&[]), Some(Packet::Disconnect(_))));
        assert!(bytes.is_empty());
    }
}
