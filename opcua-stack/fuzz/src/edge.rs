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
                message_chunk::{MessageChunk, MessageIsFinalType},
                secure_channel::{Role, SecureChannel},
                tcp_codec::{Message, TcpCodec},
            },
            sync::RwLock,
        },
        crypto::{CertificateStore, SecurityPolicy},
        types::{
            BinaryEncodable as _, ContextOwned, DecodingOptions, Error, MessageSecurityMode,
            NamespaceMap, ObjectId,
        },
    },
};
use tokio_util::codec::Decoder as _;

/// Largest chunk, and most of them in a message, before anybody has signed in.
const CHUNK_BYTES_MAX: usize = 65_536;
const CHUNKS_MAX: usize = 8;

/// No files: the channel has neither a certificate nor a key.
static NO_CERTIFICATES: LazyLock<Arc<RwLock<CertificateStore>>> =
    LazyLock::new(|| Arc::new(RwLock::new(CertificateStore::new(Path::new("/nonexistent")))));

/// Bytes of a connection as server and client read them. The first one chooses how the channel is protected.
pub fn chunks(bytes: &[u8]) {
    let Some((protection, bytes)) = bytes.split_first() else { return };
    let mode = match protection % 3 {
        0 => MessageSecurityMode::None,
        1 => MessageSecurityMode::Sign,
        _ => MessageSecurityMode::SignAndEncrypt,
    };
    for role in [Role::Server, Role::Client] {
        let mut channel = channel(role, mode);
        let mut codec = TcpCodec::new(channel.decoding_options());
        let mut buffer = BytesMut::from(bytes);
        let mut pending = Vec::new();
        while let Ok(Some(message)) = codec.decode(&mut buffer) {
            let Message::Chunk(chunk) = message else { continue };
            assert!(chunk.data.len() <= CHUNK_BYTES_MAX, "no chunk is larger");
            if take(&mut channel, chunk, &mut pending).is_err() {
                break;
            }
        }
    }
}

fn channel(role: Role, mode: MessageSecurityMode) -> SecureChannel {
    let context = ContextOwned::new_default(NamespaceMap::new(), DecodingOptions::default());
    let context = Arc::new(RwLock::new(context));
    let mut channel = SecureChannel::new(Arc::clone(&NO_CERTIFICATES), role, context);
    channel.set_accepted_policies(vec![SecurityPolicy::None, SecurityPolicy::Basic256Sha256]);
    if mode != MessageSecurityMode::None {
        channel.set_security_policy(SecurityPolicy::Basic256Sha256);
        channel.set_security_mode(mode);
        channel.set_secure_channel_id(1);
        channel.set_token_id(1);
        channel.set_token_lifetime(60_000);
        channel.set_local_nonce(&[1; 32]);
        channel.set_remote_nonce(&[2; 32]);
        channel.derive_keys();
    }
    channel
}

/// Adds a chunk to those of its message, and decodes that with the last one.
fn take(
    channel: &mut SecureChannel,
    chunk: MessageChunk,
    pending: &mut Vec<MessageChunk>,
) -> Result<(), Error> {
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
            chunk.final_error_body(&info, &channel.decoding_options()).map(|_| ())
        }
        MessageIsFinalType::Intermediate => {
            pending.push(chunk);
            pending.truncate(CHUNKS_MAX);
            Ok(())
        }
        MessageIsFinalType::Final => {
            pending.push(chunk);
            let chunks = std::mem::take(pending);
            Chunker::validate_chunks(channel, &chunks)?;
            if channel.is_client_role() {
                Chunker::decode::<ResponseMessage>(&chunks, channel, None).map(|_| ())
            } else {
                Chunker::decode::<RequestMessage>(&chunks, channel, None).map(|_| ())
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
