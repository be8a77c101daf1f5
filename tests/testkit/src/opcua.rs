//! Messages of OPC UA clients byte by byte, as no client of a library sends them (OPC 10000-6, 6.7 and 7.1).

#![allow(clippy::missing_panics_doc, reason = "tests write few bytes")]

/// The additional header of a request that has none.
pub const NO_HEADER: [u8; 3] = [0, 0, 0];

/// Returns a Hello message for this endpoint.
#[must_use]
pub fn hello(url: &str, buffer_size: u32) -> Vec<u8> {
    let mut body = Vec::new();
    for number in [0, buffer_size, buffer_size, 0, 0] {
        body.extend(number.to_le_bytes());
    }
    body.extend(u32::try_from(url.len()).expect("few bytes").to_le_bytes());
    body.extend(url.as_bytes());
    framed(b"HELF", &body)
}

/// An OpenSecureChannel request without security.
#[must_use]
pub fn open_channel() -> Vec<u8> {
    let policy = b"http://opcfoundation.org/UA/SecurityPolicy#None";
    let mut body = 0_u32.to_le_bytes().to_vec();
    body.extend(u32::try_from(policy.len()).expect("few bytes").to_le_bytes());
    body.extend(policy);
    for absent in [-1_i32, -1] {
        body.extend(absent.to_le_bytes());
    }
    // Sequence number, request id, then the request:
    // OpenSecureChannelRequest_Encoding_DefaultBinary.
    body.extend(1_u32.to_le_bytes());
    body.extend(1_u32.to_le_bytes());
    body.extend([1, 0, 0xBE, 0x01]);
    // Request header: null token, time, handle, diagnostics, null audit id, timeout, no additional
    // header.
    body.extend([0, 0]);
    body.extend(0_i64.to_le_bytes());
    body.extend(1_u32.to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend((-1_i32).to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend([0, 0, 0]);
    // Version, issue, no security, no nonce, an hour.
    body.extend(0_u32.to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend(1_u32.to_le_bytes());
    body.extend((-1_i32).to_le_bytes());
    body.extend(3_600_000_u32.to_le_bytes());
    framed(b"OPNF", &body)
}

/// A message of a type, with its size.
#[must_use]
pub fn framed(kind: &[u8; 4], body: &[u8]) -> Vec<u8> {
    let length = u32::try_from(body.len() + 8).expect("few bytes");
    [kind.as_slice(), &length.to_le_bytes(), body].concat()
}

/// Returns the header of a chunk: channel, token, sequence number, request id.
#[must_use]
pub fn chunk_header(channel: u32, sequence: u32, request: u32) -> Vec<u8> {
    [channel, 1, sequence, request].iter().flat_map(|n| n.to_le_bytes()).collect()
}

/// The body of a chunk with a GetEndpoints request, whose additional header anybody may fill.
#[must_use]
pub fn get_endpoints(url: &str, channel: u32, sequence: u32, additional_header: &[u8]) -> Vec<u8> {
    let mut body = chunk_header(channel, sequence, sequence);
    // GetEndpointsRequest_Encoding_DefaultBinary; then null token, time, handle, diagnostics, null audit id, timeout.
    body.extend([1, 0, 0xAC, 0x01, 0, 0]);
    body.extend(0_i64.to_le_bytes());
    body.extend(sequence.to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend((-1_i32).to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend(additional_header);
    body.extend(u32::try_from(url.len()).expect("few bytes").to_le_bytes());
    body.extend(url.as_bytes());
    body.extend((-1_i32).to_le_bytes());
    body.extend((-1_i32).to_le_bytes());
    body
}

/// A chunk that claims a size, and only its beginning.
#[must_use]
pub fn claimed_chunk(size: u32, sent: usize) -> Vec<u8> {
    [b"MSGC".as_slice(), &size.to_le_bytes(), &vec![0; sent - 8]].concat()
}

/// The header of a message that claims to be longer than what follows.
#[must_use]
pub fn claiming(kind: &[u8; 4], size: u32) -> Vec<u8> {
    [kind.as_slice(), &size.to_le_bytes()].concat()
}

/// A request to open a channel with a policy, whose encrypted part is noise of that many bytes.
#[must_use]
pub fn opening(policy: &str, sender: &[u8], receiver: &[u8], noise: usize) -> Vec<u8> {
    let mut body = 0_u32.to_le_bytes().to_vec();
    for part in [policy.as_bytes(), sender, receiver] {
        body.extend(u32::try_from(part.len()).expect("few bytes").to_le_bytes());
        body.extend(part);
    }
    body.extend((0..noise).map(|at| u8::try_from(at * 7 % 256).expect("a byte")));
    framed(b"OPNF", &body)
}

/// An additional header of a known structure with a variant, which holds one thing inside the other.
#[must_use]
pub fn nested_header(variant: u8, level: &[u8], depth: usize) -> Vec<u8> {
    let mut value = vec![variant];
    for _ in 0..depth {
        value.extend(level);
    }
    value.push(0);
    // LiteralOperand_Encoding_DefaultBinary, which has a variant and nothing else.
    let mut header = vec![1, 0];
    header.extend(597_u16.to_le_bytes());
    header.push(1);
    header.extend(u32::try_from(value.len()).expect("few bytes").to_le_bytes());
    [header, value].concat()
}
