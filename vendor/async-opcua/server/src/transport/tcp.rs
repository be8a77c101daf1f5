use std::{
    net::SocketAddr,
    sync::Arc,
    time::{Duration, Instant},
};

use opcua_core::{
    comms::{
        buffer::SendBuffer,
        chunker::Chunker,
        message_chunk::{MessageChunk, MessageIsFinalType},
        message_chunk_info::ChunkInfo,
        secure_channel::SecureChannel,
        sequence_number::SequenceNumberHandle,
        tcp_codec::{Message, TcpCodec},
        tcp_types::{AcknowledgeMessage, ErrorMessage},
    },
    RequestMessage, ResponseMessage,
};
use tracing::error;
use tracing_futures::Instrument;

use crate::{
    info::ServerInfo,
    shares::{ClientShare, Held, SharedResource},
};
use opcua_types::{DecodingOptions, Error, ResponseHeader, ServiceFault, StatusCode};

use futures::StreamExt;
use tokio::{
    io::{AsyncWriteExt, ReadHalf, WriteHalf},
    net::TcpStream,
};
use tokio_util::{codec::FramedRead, sync::CancellationToken};

use super::connect::Connector;

/// Transport implementation for opc.tcp.
pub(crate) struct TcpTransport {
    read: FramedRead<ReadHalf<TcpStream>, TcpCodec>,
    write: WriteHalf<TcpStream>,
    send_buffer: SendBuffer,
    state: TransportState,
    pending_chunks: Vec<MessageChunk>,
    /// Client protocol version set during HELLO
    pub(crate) client_protocol_version: u32,
    /// Last decoded sequence number
    sequence_numbers: SequenceNumberHandle,
    /// Messages that were enqueued since everything was last sent.
    unsent_messages: usize,
    /// Whether a session was activated on this connection. Until then messages may only have a few chunks.
    is_authenticated: bool,
    /// Longest message in bytes that a client may send once it has activated a session, 0 for what was negotiated.
    max_request_size: usize,
    /// When the first chunk of a message came that is not complete.
    unfinished_since: Option<Instant>,
    /// Bytes of the message that is not complete, of the client's share.
    request_bytes: Option<Held>,
    /// Bytes that wait to be sent, of the client's share.
    response_bytes: Option<Held>,
    /// Where the connection comes from.
    pub(crate) peer_address: Option<SocketAddr>,
}

/// Most messages that wait to be sent before no further requests are read. A client that does not take its responses
/// otherwise lets them pile up.
const MAX_UNSENT_MESSAGES: usize = 256;

/// Longest message in chunks that a client may send before it has activated a session. All requests up to then are
/// short, and anybody can send them.
const UNAUTHENTICATED_MAX_CHUNK_COUNT: usize = 8;

/// Longest message in bytes that a client may send before it has activated a session, in one chunk or several.
const UNAUTHENTICATED_MAX_MESSAGE_SIZE: usize = 65_536;

/// Like [`MAX_UNSENT_MESSAGES`], of clients without an activated session. They have no reason to send requests before
/// the answer to the last one, and a description of all endpoints is long.
const UNAUTHENTICATED_MAX_UNSENT_MESSAGES: usize = 4;

/// Bytes that wait to be sent before no further requests are read.
const MAX_UNSENT_BYTES: usize = 8 << 20;

/// Longest time from the first chunk of a message to its last one.
const UNFINISHED_MESSAGE_TIMEOUT: Duration = Duration::from_secs(30);

enum TransportState {
    Running,
    Closing,
}

#[derive(Debug, Clone)]
pub(crate) struct TransportConfig {
    pub send_buffer_size: usize,
    pub receive_buffer_size: usize,
    pub max_message_size: usize,
    pub max_chunk_count: usize,
    pub hello_timeout: Duration,
}

#[derive(Debug)]
pub(crate) struct Request {
    pub message: RequestMessage,
    pub chunk_info: ChunkInfo,
    pub request_id: u32,
    /// Its length, of the client's share for as long as it is in progress.
    pub bytes: Option<Held>,
}

#[derive(Debug)]
/// Result of polling a TCP transport.
pub(crate) enum TransportPollResult {
    OutgoingMessageSent,
    IncomingChunk,
    IncomingMessage(Request),
    Error(StatusCode),
    /// A request to open or renew the secure channel could not be read. When it was received.
    OpenChannelError(StatusCode, Instant),
    RecoverableError(StatusCode, u32, u32),
    Closed,
}

fn min_zero_infinite(server: u32, client: u32) -> u32 {
    if client == 0 {
        server
    } else if server == 0 {
        client
    } else {
        client.min(server)
    }
}

pub(crate) struct TcpConnector {
    read: FramedRead<ReadHalf<TcpStream>, TcpCodec>,
    write: WriteHalf<TcpStream>,
    peer_address: Option<SocketAddr>,
    deadline: Instant,
    config: TransportConfig,
    decoding_options: DecodingOptions,
}

impl TcpConnector {
    pub(crate) fn new(
        stream: TcpStream,
        config: TransportConfig,
        decoding_options: DecodingOptions,
    ) -> Self {
        let peer_address = stream.peer_addr().ok();
        let (read, write) = tokio::io::split(stream);
        let codec = TcpCodec::new(decoding_options.clone())
            .with_max_chunk_size(config.receive_buffer_size);
        let read = FramedRead::new(read, codec);
        TcpConnector {
            read,
            write,
            peer_address,
            deadline: Instant::now() + config.hello_timeout,
            config,
            decoding_options,
        }
    }

    pub(super) fn new_split(
        read: FramedRead<ReadHalf<TcpStream>, TcpCodec>,
        write: WriteHalf<TcpStream>,
        peer_address: SocketAddr,
        config: TransportConfig,
        decoding_options: DecodingOptions,
    ) -> Self {
        TcpConnector {
            read,
            write,
            peer_address: Some(peer_address),
            deadline: Instant::now() + config.hello_timeout,
            config,
            decoding_options,
        }
    }

    async fn connect_inner(&mut self, info: Arc<ServerInfo>) -> Result<SendBuffer, ErrorMessage> {
        let hello = match self.read.next().await {
            Some(Ok(Message::Hello(hello))) => Ok(hello),
            Some(Ok(_)) => Err(ErrorMessage::new(
                StatusCode::BadCommunicationError,
                "Expected a hello message",
            )),
            Some(Err(communication_err)) => Err(ErrorMessage::new(
                TcpCodec::status_of(&communication_err),
                "Communication error while waiting for Hello message",
            )),
            None => Err(ErrorMessage::new(
                StatusCode::BadCommunicationError,
                "Stream closed",
            )),
        }?;

        let mut buffer = SendBuffer::new(
            self.config.send_buffer_size,
            self.config.max_message_size,
            self.config.max_chunk_count,
            true,
        );

        let endpoints = info.endpoints(&hello.endpoint_url, &None);

        if !endpoints.is_some_and(|e| hello.is_endpoint_url_valid(&e)) {
            return Err(ErrorMessage::new(
                StatusCode::BadTcpEndpointUrlInvalid,
                "HELLO endpoint url is invalid",
            ));
        }
        if !hello.is_valid_buffer_sizes() {
            return Err(ErrorMessage::new(
                StatusCode::BadCommunicationError,
                "HELLO buffer sizes are invalid",
            ));
        }

        let server_protocol_version = 0;
        // Validate protocol version
        if hello.protocol_version > server_protocol_version {
            return Err(ErrorMessage::new(
                StatusCode::BadProtocolVersionUnsupported,
                "Client protocol version is unsupported.",
            ));
        }

        let decoding_options = &self.decoding_options;

        let max_message_size = min_zero_infinite(
            decoding_options.max_message_size as u32,
            hello.max_message_size,
        );

        // Send acknowledge
        let acknowledge = AcknowledgeMessage::new(
            server_protocol_version,
            (self.config.receive_buffer_size as u32).min(hello.send_buffer_size),
            (buffer.send_buffer_size as u32).min(hello.receive_buffer_size),
            // That of requests.
            min_zero_infinite(
                info.config.limits.max_request_size as u32,
                max_message_size,
            ),
            min_zero_infinite(
                decoding_options.max_chunk_count as u32,
                hello.max_chunk_count,
            ),
        );
        buffer.revise(
            acknowledge.send_buffer_size as usize,
            max_message_size as usize,
            acknowledge.max_chunk_count as usize,
        );

        let mut buf =
            Vec::with_capacity(opcua_types::SimpleBinaryEncodable::byte_len(&acknowledge));
        opcua_types::SimpleBinaryEncodable::encode(&acknowledge, &mut buf)
            .map_err(|e| ErrorMessage::new(e.into(), "Failed to encode ack"))?;

        self.write.write_all(&buf).await.map_err(|e| {
            ErrorMessage::new(
                StatusCode::BadCommunicationError,
                &format!("Failed to send ack: {e}"),
            )
        })?;

        Ok(buffer)
    }
}

impl Connector for TcpConnector {
    async fn connect(
        mut self,
        info: Arc<ServerInfo>,
        token: CancellationToken,
    ) -> Result<TcpTransport, StatusCode> {
        let err = tokio::select! {
            _ = tokio::time::sleep_until(self.deadline.into()) => {
                ErrorMessage::new(StatusCode::BadTimeout, "Timeout waiting for HELLO")
            }
            _ = token.cancelled() => {
                ErrorMessage::new(StatusCode::BadServerHalted, "Server closed")
            }
            r = self.connect_inner(info).instrument(tracing::info_span!("OPC-UA TCP handshake")) => {
                match r {
                    Ok(r) => return Ok(TcpTransport::new(self.read, self.write, self.peer_address, r)),
                    Err(e) => e,
                }
            }
        };

        // We want to send an error if connection failed for whatever reason, but
        // there's a good chance the channel is closed, so just ignore any errors.
        let mut buf = Vec::with_capacity(opcua_types::SimpleBinaryEncodable::byte_len(&err));
        if opcua_types::SimpleBinaryEncodable::encode(&err, &mut buf).is_ok() {
            let _ = self.write.write_all(&buf).await;
        }

        Err(err.error)
    }
}

impl TcpTransport {
    fn new(
        read: FramedRead<ReadHalf<TcpStream>, TcpCodec>,
        write: WriteHalf<TcpStream>,
        peer_address: Option<SocketAddr>,
        send_buffer: SendBuffer,
    ) -> Self {
        Self {
            read,
            write,
            peer_address,
            state: TransportState::Running,
            pending_chunks: Vec::new(),
            sequence_numbers: SequenceNumberHandle::new(true),
            unsent_messages: 0,
            is_authenticated: false,
            max_request_size: 0,
            unfinished_since: None,
            request_bytes: None,
            response_bytes: None,
            client_protocol_version: 0,
            send_buffer,
        }
    }

    /// Note that a session was activated: the client may send messages up to the negotiated limits from now on, or up to
    /// `max_request_size` where that is not 0, as far as its share goes.
    pub(crate) fn set_authenticated(&mut self, share: &Arc<ClientShare>, max_request_size: usize) {
        self.is_authenticated = true;
        self.max_request_size = max_request_size;
        let is_known = |held: &Held| Arc::ptr_eq(held.share(), share);
        if !self.request_bytes.as_ref().is_some_and(is_known) {
            self.request_bytes = Some(share.none_of(SharedResource::RequestBytes));
            self.response_bytes = Some(share.none_of(SharedResource::ResponseBytes));
        }
    }

    /// When the connection ends unless the rest of an unfinished message comes.
    pub(crate) fn unfinished_message_deadline(&self) -> Option<Instant> {
        self.unfinished_since
            .map(|since| since + UNFINISHED_MESSAGE_TIMEOUT)
    }

    /// Forget the chunks of a message that is complete, or was given up.
    fn clear_pending_chunks(&mut self) {
        self.pending_chunks.clear();
        self.unfinished_since = None;
        if let Some(bytes) = &mut self.request_bytes {
            bytes.resize(0);
        }
    }

    /// Count what waits to be sent. Returns false where it is more than the client's share.
    fn count_unsent(&mut self) -> bool {
        let unsent = self.send_buffer.queued_bytes();
        self.response_bytes
            .as_mut()
            .is_none_or(|bytes| bytes.resize(unsent))
    }

    /// Whether a session was activated on this connection.
    pub(crate) fn is_authenticated(&self) -> bool {
        self.is_authenticated
    }

    /// Set the transport state to closing, once the final message is sent
    /// the connection will be closed.
    pub(crate) fn set_closing(&mut self) {
        self.state = TransportState::Closing;
    }

    pub(crate) fn is_closing(&self) -> bool {
        matches!(self.state, TransportState::Closing)
    }

    pub(crate) fn enqueue_error(&mut self, message: ErrorMessage) {
        self.send_buffer.write_error(message);
        self.count_unsent();
    }

    pub(crate) fn enqueue_message_for_send(
        &mut self,
        channel: &mut SecureChannel,
        message: ResponseMessage,
        request_id: u32,
    ) -> Result<(), StatusCode> {
        self.unsent_messages += 1;
        match self.send_buffer.write(request_id, message, channel) {
            Ok(_) if self.count_unsent() => Ok(()),
            Ok(_) => {
                tracing::warn!("A client takes its responses too slowly");
                Err(StatusCode::BadTcpNotEnoughResources)
            }
            Err(e) => {
                tracing::warn!("Failed to encode outgoing message: {e:?}");
                if let Some((request_id, request_handle)) = e.full_context() {
                    self.send_buffer.write(
                        request_id,
                        ResponseMessage::ServiceFault(Box::new(ServiceFault {
                            response_header: ResponseHeader::new_service_result(
                                request_handle,
                                e.into(),
                            ),
                        })),
                        channel,
                    )?;
                    Ok(())
                } else {
                    Err(e.into())
                }
            }
        }
    }

    /// Send what is enqueued, and receive unless the caller has enough to do already (`may_read`) or the client does
    /// not take its responses.
    pub(crate) async fn poll(
        &mut self,
        channel: &mut SecureChannel,
        may_read: bool,
    ) -> TransportPollResult {
        // Either we've got something in the send buffer, which we can send,
        // or we're waiting for more outgoing messages.
        // We won't wait for outgoing messages while sending, since that
        // could cause the send buffer to fill up.

        // If there's nothing in the send buffer, but there are chunks available,
        // write them to the send buffer before proceeding.
        if self.send_buffer.should_encode_chunks() {
            if let Err(e) = self.send_buffer.encode_next_chunk(channel) {
                return TransportPollResult::Error(e);
            }
            self.count_unsent();
        }

        // If there is something in the send buffer, write to the stream.
        // If not, wait for outgoing messages.
        // Either way, listen to incoming messages while we do this.
        let max_unsent_messages = if self.is_authenticated {
            MAX_UNSENT_MESSAGES
        } else {
            UNAUTHENTICATED_MAX_UNSENT_MESSAGES
        };
        let takes_responses = self.unsent_messages < max_unsent_messages
            && self.send_buffer.queued_bytes() < MAX_UNSENT_BYTES;
        // Nothing more is read once the last message is enqueued: after an error the stream ends, which would end the
        // connection before the client learns of the error.
        let is_closing = self.is_closing();
        if self.send_buffer.can_read() {
            tokio::select! {
                r = self.send_buffer.read_into_async(&mut self.write) => {
                    if let Err(e) = r {
                        error!("write bytes task failed: {}", e);
                        return TransportPollResult::Closed;
                    }
                    TransportPollResult::OutgoingMessageSent
                }
                incoming = self.read.next(), if may_read && takes_responses && !is_closing => {
                    self.handle_incoming_message(incoming, channel)
                }
            }
        } else {
            if self.is_closing() {
                return TransportPollResult::Closed;
            }
            self.unsent_messages = 0;
            if !may_read {
                // Until a request in progress is done.
                return std::future::pending().await;
            }
            let incoming = self.read.next().await;
            self.handle_incoming_message(incoming, channel)
        }
    }

    fn handle_incoming_message(
        &mut self,
        incoming: Option<Result<Message, std::io::Error>>,
        channel: &mut SecureChannel,
    ) -> TransportPollResult {
        let Some(incoming) = incoming else {
            return TransportPollResult::Closed;
        };
        let received_at = Instant::now();
        let is_open_channel = matches!(
            &incoming,
            Ok(Message::Chunk(chunk)) if chunk.is_open_secure_channel(&channel.decoding_options())
        );
        match incoming {
            Ok(message) => match self.process_message(message, channel) {
                Ok(None) => TransportPollResult::IncomingChunk,
                Ok(Some(message)) => {
                    self.clear_pending_chunks();
                    TransportPollResult::IncomingMessage(message)
                }
                Err(e) if is_open_channel => {
                    self.clear_pending_chunks();
                    TransportPollResult::OpenChannelError(e.status(), received_at)
                }
                Err(e) => {
                    self.clear_pending_chunks();
                    if let Some((id, handle)) = e.full_context() {
                        TransportPollResult::RecoverableError(e.status(), id, handle)
                    } else {
                        TransportPollResult::Error(e.status())
                    }
                }
            },
            Err(err) => {
                error!("Error reading from stream {:?}", err);
                TransportPollResult::Error(TcpCodec::status_of(&err))
            }
        }
    }

    fn process_message(
        &mut self,
        message: Message,
        channel: &mut SecureChannel,
    ) -> Result<Option<Request>, Error> {
        match message {
            Message::Chunk(chunk) => {
                let header = chunk.message_header(&channel.decoding_options())?;

                if header.is_final == MessageIsFinalType::FinalError {
                    self.clear_pending_chunks();
                    Ok(None)
                } else {
                    // Counted before anything is decrypted.
                    let pending: usize = self.pending_chunks.iter().map(|c| c.data.len()).sum();
                    let size = pending + chunk.data.len();
                    let max_size = if self.is_authenticated {
                        self.max_request_size
                    } else {
                        UNAUTHENTICATED_MAX_MESSAGE_SIZE
                    };
                    if max_size > 0 && size > max_size {
                        return Err(Error::new(
                            StatusCode::BadTcpMessageTooLarge,
                            "Message is longer than requests may be",
                        ));
                    }
                    if self.request_bytes.as_mut().is_some_and(|bytes| !bytes.resize(size)) {
                        return Err(Error::new(
                            SharedResource::RequestBytes.refusal(),
                            "The client sends more at once than its share",
                        ));
                    }
                    let chunk = channel.verify_and_remove_security_server(chunk.data)?;

                    let max_chunk_count = match self.send_buffer.max_chunk_count {
                        max if self.is_authenticated => max,
                        0 => UNAUTHENTICATED_MAX_CHUNK_COUNT,
                        max => max.min(UNAUTHENTICATED_MAX_CHUNK_COUNT),
                    };
                    if max_chunk_count > 0 && self.pending_chunks.len() >= max_chunk_count {
                        return Err(Error::decoding(format!(
                            "Message has more than {max_chunk_count} chunks, exceeding negotiated limits",
                        )));
                    }
                    let chunk_info = chunk.chunk_info(channel)?;
                    self.sequence_numbers
                        .validate_and_increment(chunk_info.sequence_header.sequence_number)?;
                    self.pending_chunks.push(chunk);

                    if header.is_final == MessageIsFinalType::Intermediate {
                        self.unfinished_since.get_or_insert_with(Instant::now);
                        return Ok(None);
                    }

                    let chunk_info = self.pending_chunks[0].chunk_info(channel)?;

                    Chunker::validate_chunks(channel, &self.pending_chunks)?;

                    let request = Chunker::decode(&self.pending_chunks, channel, None)
                        .map_err(|e| e.with_request_id(chunk_info.sequence_header.request_id))?;
                    let bytes = self.request_bytes.as_mut().map(|bytes| bytes.split(size));
                    Ok(Some(Request {
                        bytes,
                        request_id: chunk_info.sequence_header.request_id,
                        chunk_info,
                        message: request,
                    }))
                }
            }
            _ => Err(Error::new(
                StatusCode::BadUnexpectedError,
                "Received a message that is no chunk",
            )),
        }
    }
}
