//! AMQP frames written byte by byte, as no library would.

use std::{io, time::Duration};

use fe2o3_amqp_types::performatives::Performative;
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::TcpStream,
    time::timeout,
};

use crate::support::SECRET;

/// Time in which a peer has to answer or to close.
const ANSWER: Duration = Duration::from_secs(10);

pub const SASL_HEADER: &[u8] = b"AMQP\x03\x01\x00\x00";
pub const AMQP_HEADER: &[u8] = b"AMQP\x00\x01\x00\x00";
pub const AMQP: u8 = 0;
pub const SASL: u8 = 1;
pub const NULL: &[u8] = &[0x40];
/// A described type whose descriptor is 0, without its value.
const DESCRIBED: [u8; 2] = [0x00, 0x44];

pub fn text(code: u8, text: &str) -> Vec<u8> {
    let mut bytes = vec![code];
    bytes.extend(u32::try_from(text.len()).expect("a short text").to_be_bytes());
    bytes.extend(text.as_bytes());
    bytes
}

pub fn string(value: &str) -> Vec<u8> {
    text(0xb1, value)
}

pub fn symbol(value: &str) -> Vec<u8> {
    text(0xb3, value)
}

pub fn binary(value: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0xb0];
    bytes.extend(u32::try_from(value.len()).expect("few bytes").to_be_bytes());
    bytes.extend(value);
    bytes
}

pub fn uint(value: u32) -> Vec<u8> {
    [&[0x70][..], &value.to_be_bytes()].concat()
}

pub fn boolean(value: bool) -> Vec<u8> {
    vec![if value { 0x41 } else { 0x42 }]
}

fn compound(code: u8, fields: &[Vec<u8>]) -> Vec<u8> {
    let body = fields.concat();
    let mut bytes = vec![code];
    bytes.extend(u32::try_from(body.len() + 4).expect("a size").to_be_bytes());
    bytes.extend(u32::try_from(fields.len()).expect("a count").to_be_bytes());
    bytes.extend(body);
    bytes
}

pub fn map(fields: &[Vec<u8>]) -> Vec<u8> {
    compound(0xd1, fields)
}

/// A described list, such as a performative.
pub fn described(code: u8, fields: &[Vec<u8>]) -> Vec<u8> {
    section(code, &compound(0xd0, fields))
}

/// A described value, such as a section of a message.
pub fn section(code: u8, value: &[u8]) -> Vec<u8> {
    [&[0x00, 0x53, code][..], value].concat()
}

/// A value inside as many described types.
pub fn nested(levels: usize) -> Vec<u8> {
    [&DESCRIBED.repeat(levels)[..], NULL].concat()
}

/// A map with one symbol and one value.
pub fn entry(value: Vec<u8>) -> Vec<u8> {
    map(&[symbol("k"), value])
}

pub fn frame(kind: u8, channel: u16, body: &[u8]) -> Vec<u8> {
    let mut bytes = u32::try_from(body.len() + 8).expect("a frame").to_be_bytes().to_vec();
    bytes.extend([2, kind]);
    bytes.extend(channel.to_be_bytes());
    bytes.extend(body);
    bytes
}

pub fn sasl_init(user: &str) -> Vec<u8> {
    let response = [b"\0", user.as_bytes(), b"\0", SECRET.as_bytes()].concat();
    described(0x41, &[symbol("PLAIN"), binary(&response)])
}

pub fn begin(properties: Vec<u8>) -> Vec<u8> {
    let null = || NULL.to_vec();
    let counts = [null(), uint(0), uint(1000), uint(1000)];
    described(0x11, &[&counts[..], &[null(), null(), null(), properties]].concat())
}

/// An attach of a sender to an address.
pub fn attach(address: &str, handle: u32, properties: Vec<u8>) -> Vec<u8> {
    let null = || NULL.to_vec();
    let (source, target) =
        (described(0x28, &[string(address)]), described(0x29, &[string(address)]));
    let role = boolean(false);
    let link = [string(&format!("l{handle}")), uint(handle), role, null(), null(), source, target];
    let rest = [null(), null(), uint(0), null(), null(), null(), properties];
    described(0x12, &[&link[..], &rest].concat())
}

/// The performative of a delivery, to be followed by its payload.
pub fn transfer(handle: u32, id: u32, more: bool) -> Vec<u8> {
    let tag = binary(&id.to_be_bytes());
    described(0x14, &[uint(handle), uint(id), tag, uint(0), boolean(false), boolean(more)])
}

/// One end of a connection.
pub struct RawPeer(pub TcpStream);

impl RawPeer {
    pub async fn connect(port: u16) -> Self {
        Self(TcpStream::connect(("127.0.0.1", port)).await.expect("a connection"))
    }

    /// Connects, signs in, opens, begins a session, and attaches a sender if there is an address.
    pub async fn open(port: u16, user: &str, address: Option<&str>) -> Self {
        let mut peer = Self::connect(port).await;
        peer.send(SASL_HEADER).await;
        peer.send(&frame(SASL, 0, &sasl_init(user))).await;
        peer.send(AMQP_HEADER).await;
        peer.send(&frame(AMQP, 0, &described(0x10, &[string(user)]))).await;
        peer.send(&frame(AMQP, 0, &begin(NULL.to_vec()))).await;
        let mut header = [0; 8];
        peer.0.read_exact(&mut header).await.expect("a header of SASL");
        peer.read().await.expect("mechanisms");
        peer.read().await.expect("an outcome");
        peer.0.read_exact(&mut header).await.expect("a header of AMQP");
        assert_eq!(header, AMQP_HEADER);
        peer.until("open", |p| matches!(p, Performative::Open(_))).await;
        peer.until("begin", |p| matches!(p, Performative::Begin(_))).await;
        if let Some(address) = address {
            peer.send(&frame(AMQP, 0, &attach(address, 0, NULL.to_vec()))).await;
            peer.until("attach", |p| matches!(p, Performative::Attach(_))).await;
        }
        peer
    }

    /// Sends, if the other end still reads.
    pub async fn send(&mut self, bytes: &[u8]) {
        let _ = self.0.write_all(bytes).await;
    }

    /// Reads a frame: type and body.
    pub async fn read(&mut self) -> io::Result<(u8, Vec<u8>)> {
        let reading = async {
            let mut head = [0; 8];
            self.0.read_exact(&mut head).await?;
            let size = u32::from_be_bytes([head[0], head[1], head[2], head[3]]);
            let mut body = vec![0; size as usize - 8];
            self.0.read_exact(&mut body).await?;
            Ok((head[5], body))
        };
        timeout(ANSWER, reading).await.map_err(|_| io::ErrorKind::TimedOut)?
    }

    /// Reads up to the performative that is looked for.
    pub async fn until(
        &mut self,
        what: &str,
        mut is_it: impl FnMut(&Performative) -> bool,
    ) -> Performative {
        loop {
            let (_, body) = self.read().await.unwrap_or_else(|e| panic!("no {what}: {e}"));
            if body.is_empty() {
                continue;
            }
            let performative = serde_amqp::from_slice(&body).expect("a performative");
            if is_it(&performative) {
                return performative;
            }
        }
    }

    /// Waits until the other end closes, and returns the AMQP error that it closes with.
    pub async fn closed(&mut self) -> Option<String> {
        let mut error = None;
        loop {
            match self.read().await {
                Ok((AMQP, body)) if !body.is_empty() => {
                    if let Ok(Performative::Close(close)) = serde_amqp::from_slice(&body) {
                        error = close.error.map(|e| format!("{:?}", e.condition));
                    }
                }
                Ok(_) => {}
                Err(e) => {
                    assert_ne!(e.kind(), io::ErrorKind::TimedOut, "the connection is held open");
                    return error;
                }
            }
        }
    }
}
