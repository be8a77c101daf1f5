//! AMQP frames written byte by byte, as no library would (OASIS AMQP 1.0, parts 1, 2 and 5).

#![allow(clippy::missing_panics_doc, reason = "tests write few bytes")]

/// Header of the security layer.
pub const SASL_HEADER: &[u8] = b"AMQP\x03\x01\x00\x00";
/// Header of AMQP 1.0.
pub const AMQP_HEADER: &[u8] = b"AMQP\x00\x01\x00\x00";
/// Type of an AMQP frame.
pub const AMQP: u8 = 0;
/// Type of a frame of the security layer.
pub const SASL: u8 = 1;
/// The value null.
pub const NULL: &[u8] = &[0x40];
/// A described type whose descriptor is 0, without its value.
const DESCRIBED: [u8; 2] = [0x00, 0x44];

/// A text or symbol with a length of 32 bits.
#[must_use]
pub fn text(code: u8, text: &str) -> Vec<u8> {
    let mut bytes = vec![code];
    bytes.extend(u32::try_from(text.len()).expect("a short text").to_be_bytes());
    bytes.extend(text.as_bytes());
    bytes
}

/// A string.
#[must_use]
pub fn string(value: &str) -> Vec<u8> {
    text(0xb1, value)
}

/// A symbol.
#[must_use]
pub fn symbol(value: &str) -> Vec<u8> {
    text(0xb3, value)
}

/// Binary data.
#[must_use]
pub fn binary(value: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0xb0];
    bytes.extend(u32::try_from(value.len()).expect("few bytes").to_be_bytes());
    bytes.extend(value);
    bytes
}

/// An unsigned integer.
#[must_use]
pub fn uint(value: u32) -> Vec<u8> {
    [&[0x70][..], &value.to_be_bytes()].concat()
}

/// A truth value.
#[must_use]
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

/// A map of these keys and values, by turns.
#[must_use]
pub fn map(fields: &[Vec<u8>]) -> Vec<u8> {
    compound(0xd1, fields)
}

/// A described list, such as a performative.
#[must_use]
pub fn described(code: u8, fields: &[Vec<u8>]) -> Vec<u8> {
    section(code, &compound(0xd0, fields))
}

/// A described value, such as a section of a message.
#[must_use]
pub fn section(code: u8, value: &[u8]) -> Vec<u8> {
    [&[0x00, 0x53, code][..], value].concat()
}

/// A value inside as many described types.
#[must_use]
pub fn nested(levels: usize) -> Vec<u8> {
    [&DESCRIBED.repeat(levels)[..], NULL].concat()
}

/// A map with one symbol and one value.
#[must_use]
pub fn entry(value: Vec<u8>) -> Vec<u8> {
    map(&[symbol("k"), value])
}

/// A frame of a type on a channel.
#[must_use]
pub fn frame(kind: u8, channel: u16, body: &[u8]) -> Vec<u8> {
    let mut bytes = u32::try_from(body.len() + 8).expect("a frame").to_be_bytes().to_vec();
    bytes.extend([2, kind]);
    bytes.extend(channel.to_be_bytes());
    bytes.extend(body);
    bytes
}

/// The user name and password of SASL PLAIN (RFC 4616).
#[must_use]
pub fn sasl_init(user: &str, secret: &str) -> Vec<u8> {
    let response = [b"\0", user.as_bytes(), b"\0", secret.as_bytes()].concat();
    described(0x41, &[symbol("PLAIN"), binary(&response)])
}

/// The begin of a session with properties.
#[must_use]
pub fn begin(properties: Vec<u8>) -> Vec<u8> {
    let null = || NULL.to_vec();
    let counts = [null(), uint(0), uint(1000), uint(1000)];
    described(0x11, &[&counts[..], &[null(), null(), null(), properties]].concat())
}

/// An attach of a sender to an address.
#[must_use]
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
#[must_use]
pub fn transfer(handle: u32, id: u32, more: bool) -> Vec<u8> {
    let tag = binary(&id.to_be_bytes());
    described(0x14, &[uint(handle), uint(id), tag, uint(0), boolean(false), boolean(more)])
}
