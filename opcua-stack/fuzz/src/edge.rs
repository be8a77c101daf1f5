//! Work of the fuzz targets; the tests of `opcua-stack` do the same with the corpus.

use std::{
    path::Path,
    sync::{Arc, LazyLock},
};

use bytes::BytesMut;
use opcua_stack::{
    limits,
    notifications::decode_data_changes,
    opcua::{
        core::{
            Message as _, RequestMessage, ResponseMessage,
            comms::{
                chunker::Chunker,
                message_chunk::{MessageChunk, MessageChunkType, MessageIsFinalType},
                secure_channel::{Role, SecureChannel},
                security_header::AsymmetricSecurityHeader,
                tcp_codec::{Message, TcpCodec},
            },
            sync::RwLock,
        },
        crypto::{CertificateStore, KeySize as _, PrivateKey, SecurityPolicy, X509, X509Data},
        types::{
            BinaryEncodable as _, ContextOwned, DecodingOptions, Error, MessageSecurityMode,
            NamespaceMap, ObjectId, SimpleBinaryEncodable,
        },
    },
};
use tokio_util::codec::Decoder as _;

/// Largest chunk, and most of them in a message, before anybody has signed in.
const CHUNK_BYTES_MAX: usize = 65_536;
const CHUNKS_MAX: usize = 8;
/// Most bytes that padding and signature add to a chunk.
const PROTECTION_BYTES_MAX: usize = 1024;

/// No files: the channel has neither a certificate nor a key.
static NO_CERTIFICATES: LazyLock<Arc<RwLock<CertificateStore>>> =
    LazyLock::new(|| Arc::new(RwLock::new(CertificateStore::new(Path::new("/nonexistent")))));

/// Policies of the endpoints, by which anybody may sign and encrypt a request to open a channel.
const POLICIES: [SecurityPolicy; 3] = [
    SecurityPolicy::Basic256Sha256,
    SecurityPolicy::Aes128Sha256RsaOaep,
    SecurityPolicy::Aes256Sha256RsaPss,
];

/// Certificate and key of a server, and of a client that made its own.
static OPENERS: LazyLock<[(X509, PrivateKey); 2]> = LazyLock::new(|| {
    ["server", "client"].map(|name| {
        let description = X509Data {
            key_size: 2048,
            common_name: name.into(),
            organization: "test".into(),
            organizational_unit: String::new(),
            country: String::new(),
            state: String::new(),
            alt_host_names: X509Data::alt_host_names("urn:test", None, false, true, false),
            certificate_duration_days: 10,
        };
        X509::cert_and_pkey(&description).expect("a certificate")
    })
});

/// A request to open a channel, of which the client signs and encrypts any bytes: what is behind the security header, up to
/// the signature.
pub fn opening(bytes: &[u8]) {
    opened(bytes);
}

/// Opens a channel with a policy by the first byte, and the rest. Returns true where signature and padding were right, and
/// what they protect is a request.
pub fn opened(bytes: &[u8]) -> bool {
    let Some((policy, plain)) = bytes.split_first() else { return false };
    let policy = POLICIES[usize::from(*policy) % POLICIES.len()];
    let [(certificate, key), _] = &*OPENERS;
    let data = sealed(policy, plain);
    let mut channel = channel(Side::Server, MessageSecurityMode::None);
    channel.set_cert(Some(certificate.clone()));
    channel.set_private_key(Some(key.clone()));
    channel.set_accepted_policies(POLICIES.to_vec());
    take(&mut channel, MessageChunk { data: data.into() }, &mut Vec::new()).unwrap_or(false)
}

/// Returns the chunk: headers, then the plain bytes and their signature, encrypted.
fn sealed(policy: SecurityPolicy, plain: &[u8]) -> Vec<u8> {
    let [(certificate, _), (own, key)] = &*OPENERS;
    let to = certificate.public_key().expect("a key");
    let header =
        AsymmetricSecurityHeader::new(policy, own, certificate.thumbprint().as_byte_string());
    let mut chunk = [b"OPNF".as_slice(), &[0; 8]].concat();
    SimpleBinaryEncodable::encode(&header, &mut chunk).expect("a header");
    let cipher_size = policy.calculate_cipher_text_size(plain.len() + key.size(), &to);
    let size = u32::try_from(chunk.len() + cipher_size).expect("a short chunk");
    chunk[4..8].copy_from_slice(&size.to_le_bytes());
    let mut signature = vec![0; key.size()];
    let signed = [chunk.as_slice(), plain].concat();
    policy.asymmetric_sign(key, &signed, &mut signature).expect("a signature");
    let mut encrypted = vec![0; cipher_size];
    let text = [plain, &signature].concat();
    policy.asymmetric_encrypt(&to, &text, &mut encrypted).expect("room for it");
    chunk.extend(encrypted);
    chunk
}

/// Bytes of a connection as server and client read them. The first one chooses how the channel is protected: below 128 the
/// bytes are what comes over the wire, which ends at the first signature; from there on they are what the peer puts into the
/// chunks that it signs, or signs and encrypts, with the channel's keys.
pub fn chunks(bytes: &[u8]) {
    for side in [Side::Server, Side::Client] {
        decoded(side, bytes);
    }
}

/// Side of a connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    Server,
    Client,
}

impl Side {
    /// Returns the peer's side.
    pub fn other(self) -> Self {
        match self {
            Self::Server => Self::Client,
            Self::Client => Self::Server,
        }
    }
}

/// Number of messages that a side of the connection decodes.
pub fn decoded(side: Side, bytes: &[u8]) -> usize {
    let Some((protection, bytes)) = bytes.split_first() else { return 0 };
    let mode = match protection {
        0..128 => match protection % 3 {
            0 => MessageSecurityMode::None,
            1 => MessageSecurityMode::Sign,
            _ => MessageSecurityMode::SignAndEncrypt,
        },
        128.. if protection % 2 == 0 => MessageSecurityMode::Sign,
        128.. => MessageSecurityMode::SignAndEncrypt,
    };
    let mut buffer = match protection {
        0..128 => BytesMut::from(bytes),
        128.. => protected(side.other(), mode, bytes),
    };
    let mut channel = channel(side, mode);
    let mut codec = TcpCodec::new(channel.decoding_options()).with_max_chunk_size(CHUNK_BYTES_MAX);
    let (mut pending, mut count) = (Vec::new(), 0);
    loop {
        match codec.decode(&mut buffer) {
            Ok(Some(Message::Chunk(chunk))) => {
                assert!(chunk.data.len() <= CHUNK_BYTES_MAX, "no chunk is larger");
                match take(&mut channel, chunk, &mut pending) {
                    Ok(is_complete) => count += usize::from(is_complete),
                    Err(_) => return count,
                }
            }
            Ok(Some(_)) => {}
            Ok(None) => break,
            Err(_) => return count,
        }
    }
    // What is waited for is no more than a chunk, whatever its header claims.
    if let Some(claimed) = buffer.get(4..8) {
        let claimed = u32::from_le_bytes(claimed.try_into().expect("four bytes"));
        assert!(claimed as usize <= CHUNK_BYTES_MAX, "{claimed} bytes would be buffered");
    }
    count
}

/// Chunks of a peer that has the channel's keys. Each begins with four bytes: what it is, an addition to its sequence
/// number, and the length of its body.
fn protected(side: Side, mode: MessageSecurityMode, mut bytes: &[u8]) -> BytesMut {
    let channel = channel(side, mode);
    let mut stream = BytesMut::new();
    let mut number = 1;
    while let Some((&[kind, addition, low, high], rest)) = bytes.split_first_chunk() {
        let (body, rest) = rest.split_at(rest.len().min(u16::from_le_bytes([low, high]).into()));
        bytes = rest;
        let is_final = match kind % 4 {
            0 | 1 => MessageIsFinalType::Final,
            2 => MessageIsFinalType::Intermediate,
            _ => MessageIsFinalType::FinalError,
        };
        let message_type = if kind & 4 == 0 {
            MessageChunkType::Message
        } else {
            MessageChunkType::CloseSecureChannel
        };
        let sequence = number + u32::from(addition);
        let chunk = MessageChunk::new(sequence, 1, message_type, is_final, &channel, body)
            .expect("a body of any bytes makes a chunk");
        let mut secured = vec![0; chunk.data.len() + PROTECTION_BYTES_MAX];
        let size = channel.apply_security(&chunk, &mut secured).expect("the channel has keys");
        stream.extend_from_slice(&secured[..size]);
        number += 1;
    }
    stream
}

fn channel(side: Side, mode: MessageSecurityMode) -> SecureChannel {
    let context = ContextOwned::new_default(NamespaceMap::new(), DecodingOptions::default());
    let context = Arc::new(RwLock::new(context));
    let role = match side {
        Side::Server => Role::Server,
        Side::Client => Role::Client,
    };
    let mut channel = SecureChannel::new(Arc::clone(&NO_CERTIFICATES), role, context);
    channel.set_accepted_policies(vec![SecurityPolicy::None, SecurityPolicy::Basic256Sha256]);
    if mode != MessageSecurityMode::None {
        channel.set_security_policy(SecurityPolicy::Basic256Sha256);
        channel.set_security_mode(mode);
        channel.set_secure_channel_id(1);
        channel.set_token_id(1);
        channel.set_token_lifetime(60_000);
        // Of the server, and of the client.
        let (mut local, mut remote) = ([1; 32], [2; 32]);
        if side == Side::Client {
            std::mem::swap(&mut local, &mut remote);
        }
        channel.set_local_nonce(&local);
        channel.set_remote_nonce(&remote);
        channel.derive_keys();
    }
    channel
}

/// Adds a chunk to those of its message, and decodes that with the last one. Returns true where it did.
fn take(
    channel: &mut SecureChannel,
    chunk: MessageChunk,
    pending: &mut Vec<MessageChunk>,
) -> Result<bool, Error> {
    let header = chunk.message_header(&channel.decoding_options())?;
    let chunk = if channel.is_client_role() {
        channel.verify_and_remove_security(chunk.data)?
    } else {
        channel.verify_and_remove_security_server(chunk.data)?
    };
    let info = chunk.chunk_info(channel)?;
    match header.is_final {
        MessageIsFinalType::FinalError => {
            pending.clear();
            chunk.final_error_body(&info, &channel.decoding_options()).map(|_| false)
        }
        MessageIsFinalType::Intermediate => {
            pending.push(chunk);
            pending.truncate(CHUNKS_MAX);
            Ok(false)
        }
        MessageIsFinalType::Final => {
            pending.push(chunk);
            let chunks = std::mem::take(pending);
            Chunker::validate_chunks(channel, &chunks)?;
            if channel.is_client_role() {
                Chunker::decode::<ResponseMessage>(&chunks, channel, None).map(|_| true)
            } else {
                Chunker::decode::<RequestMessage>(&chunks, channel, None).map(|_| true)
            }
        }
    }
}

/// The number of a message's encoding, then its body, with the limits of a peer that has signed in.
pub fn services(bytes: &[u8]) {
    let Some((id, body)) = bytes.split_first_chunk() else { return };
    let Ok(id) = ObjectId::try_from(u32::from(u16::from_le_bytes(*id))) else { return };
    let options = DecodingOptions {
        max_message_size: limits::MESSAGE_BYTES_MAX,
        max_chunk_count: limits::CHUNKS_PER_MESSAGE_MAX,
        max_string_length: limits::STRING_BYTES_MAX,
        max_byte_string_length: limits::STRING_BYTES_MAX,
        max_array_length: limits::ARRAY_ELEMENTS_MAX,
        ..DecodingOptions::default()
    };
    let mut owned = ContextOwned::new_default(NamespaceMap::new(), options);
    if let Ok(request) = RequestMessage::decode_by_object_id(&mut &*body, id, &owned.context()) {
        let _ = request.encode_to_vec(&owned.context());
        let _ = request.request_handle();
    }
    // Clients decode data changes themselves, and never write them.
    decode_data_changes(owned.loaders_mut());
    let _ = ResponseMessage::decode_by_object_id(&mut &*body, id, &owned.context());
}
