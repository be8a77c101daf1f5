//! A session whose messages are written byte by byte, without what a client of a library does by itself.

use std::time::Duration;

use opcua_stack::opcua::types::{
    ActivateSessionRequest, ActivateSessionResponse, AnonymousIdentityToken, BinaryDecodable,
    BinaryEncodable, ContextOwned, CreateMonitoredItemsRequest, CreateMonitoredItemsResponse,
    CreateSessionRequest, CreateSessionResponse, CreateSubscriptionRequest,
    CreateSubscriptionResponse, DateTime, ExtensionObject, MonitoredItemCreateRequest, NodeId,
    PublishRequest, PublishResponse, RequestHeader, TimestampsToReturn,
};
use tokio::{
    io::{AsyncRead, AsyncReadExt, AsyncWriteExt},
    net::TcpStream,
    time::error::Elapsed,
};

use crate::{
    harness::{DEADLINE, TestTwin},
    wire::{channel, chunk_header, frame, framed},
};

// Numbers of the requests' binary encodings.
const CREATE_SESSION: u16 = 461;
const ACTIVATE_SESSION: u16 = 467;
const CREATE_MONITORED_ITEMS: u16 = 751;
const CREATE_SUBSCRIPTION: u16 = 787;
const PUBLISH: u16 = 826;
const READ: u16 = 631;

/// Rest of a Read request after its header: any age, no timestamps, no nodes.
const READ_OF_NOTHING: &[u8] = &[0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0];

/// Kinds of chunks: parts of messages, their ends and their aborts, and those that open or close a channel.
const KINDS: [&[u8; 4]; 7] = [b"MSGC", b"MSGF", b"MSGA", b"MSGC", b"OPNF", b"CLOF", b"MSGX"];
/// Begin of the numbers of messages that come in chunks.
const OF_CHUNKS: u32 = 1 << 20;
/// Time for an answer behind chunks.
const PATIENCE: Duration = Duration::from_millis(50);

/// A session of an anonymous client whose messages are written byte by byte.
pub struct RawSession {
    pub stream: TcpStream,
    token: NodeId,
    channel: u32,
    sequence: u32,
}

impl RawSession {
    pub async fn sign_in(twin: &TestTwin) -> Self {
        let (stream, channel) = channel(twin).await;
        let mut session = Self { stream, token: NodeId::null(), channel, sequence: 2 };
        let create = CreateSessionRequest {
            request_header: session.header(),
            endpoint_url: twin.url.as_ref().into(),
            requested_session_timeout: 60_000.0,
            ..CreateSessionRequest::default()
        };
        let created: CreateSessionResponse = session.exchange(CREATE_SESSION, &create).await;
        session.token = created.authentication_token;
        let activate = ActivateSessionRequest {
            request_header: session.header(),
            user_identity_token: ExtensionObject::from_message(AnonymousIdentityToken {
                policy_id: "anonymous".into(),
            }),
            ..ActivateSessionRequest::default()
        };
        let _: ActivateSessionResponse = session.exchange(ACTIVATE_SESSION, &activate).await;
        session
    }

    pub fn header(&self) -> RequestHeader {
        RequestHeader {
            timeout_hint: 20_000,
            ..RequestHeader::new(&self.token, &DateTime::now(), self.sequence)
        }
    }

    /// Creates a subscription of a priority; its id.
    pub async fn subscribe(&mut self, priority: u8) -> u32 {
        let request = CreateSubscriptionRequest {
            request_header: self.header(),
            requested_publishing_interval: 100.0,
            requested_lifetime_count: 1000,
            requested_max_keep_alive_count: 1,
            max_notifications_per_publish: 0,
            publishing_enabled: true,
            priority,
        };
        let created: CreateSubscriptionResponse =
            self.exchange(CREATE_SUBSCRIPTION, &request).await;
        created.subscription_id
    }

    /// Creates one monitored item.
    pub async fn monitor(&mut self, subscription: u32, item: MonitoredItemCreateRequest) {
        let request = CreateMonitoredItemsRequest {
            request_header: self.header(),
            subscription_id: subscription,
            timestamps_to_return: TimestampsToReturn::Both,
            items_to_create: Some(vec![item]),
        };
        let created: CreateMonitoredItemsResponse =
            self.exchange(CREATE_MONITORED_ITEMS, &request).await;
        let result = created.results.unwrap().remove(0);
        assert!(result.status_code.is_good(), "{}", result.status_code);
    }

    /// Takes the next notification.
    pub async fn publish(&mut self) -> PublishResponse {
        let request =
            PublishRequest { request_header: self.header(), subscription_acknowledgements: None };
        self.exchange(PUBLISH, &request).await
    }

    /// Sends a request in one chunk, and waits for its response.
    pub async fn exchange<T: BinaryDecodable>(
        &mut self,
        type_id: u16,
        request: &impl BinaryEncodable,
    ) -> T {
        let context = ContextOwned::default();
        let context = context.context();
        let mut body = [[1, 0], type_id.to_le_bytes()].concat();
        request.encode(&mut body, &context).unwrap();
        self.chunk(b"MSGF", &body).await.unwrap();
        let answer = tokio::time::timeout(DEADLINE, frame(&mut self.stream)).await.unwrap();
        assert_eq!(&answer[..4], b"MSGF", "{answer:02x?}");
        // Not a ServiceFault, whose type is 397.
        assert_ne!(u16::from_le_bytes([answer[26], answer[27]]), 397, "{answer:02x?}");
        T::decode(&mut &answer[28..], &context).unwrap()
    }

    /// Sends requests at once: of each the number of its encoding, and what follows its header. Returns the number of answers
    /// as [`Self::answers_to`] does.
    ///
    /// # Panics
    /// A server that neither answers nor ends the connection.
    pub async fn play(&mut self, requests: &[(u16, &[u8])]) -> Option<usize> {
        let mut bytes = Vec::new();
        for (type_id, rest) in requests {
            let request = self.request(*type_id, rest);
            bytes.extend(self.next_chunk(b"MSGF", self.sequence, &request));
        }
        self.answers_to(bytes, DEADLINE).await.expect("an answer, or an end")
    }

    /// Sends chunks at once: the low byte of the number says of which kind, the high one of which message, and the bytes are
    /// what it holds. A message that they leave open may swallow the request behind them, so that no answer is waited for long.
    pub async fn play_chunks(&mut self, chunks: &[(u16, &[u8])]) {
        let mut bytes = Vec::new();
        for (number, body) in chunks {
            let [low, high] = number.to_le_bytes();
            let kind = KINDS[usize::from(low) % KINDS.len()];
            bytes.extend(self.next_chunk(kind, OF_CHUNKS + u32::from(high), body));
        }
        self.answers_to(bytes, PATIENCE).await.ok();
    }

    /// Sends bytes, and after them a request that reads nothing. Returns the number of answers up to that one's; none where
    /// the server ended the connection before.
    ///
    /// # Errors
    /// [`Elapsed`] of a server that neither answers nor ends the connection in time.
    async fn answers_to(
        &mut self,
        mut bytes: Vec<u8>,
        patience: Duration,
    ) -> Result<Option<usize>, Elapsed> {
        let last = self.sequence;
        let request = self.request(READ, READ_OF_NOTHING);
        bytes.extend(self.next_chunk(b"MSGF", last, &request));
        let (mut reading, mut writing) = self.stream.split();
        // The server may have ended the connection before it has taken all.
        let sending = async { writing.write_all(&bytes).await.is_ok() };
        let taking = async {
            let mut count = 1;
            loop {
                let answer = answer(&mut reading).await.ok()?;
                if answer.get(20..24) == Some(last.to_le_bytes().as_slice()) {
                    return Some(count);
                }
                count += 1;
            }
        };
        let both = async { tokio::join!(sending, taking) };
        tokio::time::timeout(patience, both).await.map(|(_, count)| count)
    }

    /// Returns a request: the number of its encoding, a header, and what follows that.
    fn request(&self, type_id: u16, rest: &[u8]) -> Vec<u8> {
        let context = ContextOwned::default();
        let mut request = [[1, 0], type_id.to_le_bytes()].concat();
        self.header().encode(&mut request, &context.context()).unwrap();
        request.extend(rest);
        request
    }

    /// Returns the next chunk of the channel.
    fn next_chunk(&mut self, kind: &[u8; 4], request: u32, body: &[u8]) -> Vec<u8> {
        let header = chunk_header(self.channel, self.sequence, request);
        self.sequence += 1;
        framed(kind, &[header.as_slice(), body].concat())
    }

    pub async fn chunk(&mut self, kind: &[u8; 4], body: &[u8]) -> std::io::Result<()> {
        let header = chunk_header(self.channel, self.sequence, self.sequence);
        self.sequence += 1;
        self.stream.write_all(&framed(kind, &[header, body.to_vec()].concat())).await
    }
}

/// Reads one frame of a server that may end the connection.
async fn answer(stream: &mut (impl AsyncRead + Unpin)) -> std::io::Result<Vec<u8>> {
    let mut frame = vec![0; 8];
    stream.read_exact(&mut frame).await?;
    let length = u32::from_le_bytes(frame[4..].try_into().unwrap());
    frame.resize(length as usize, 0);
    stream.read_exact(&mut frame[8..]).await?;
    Ok(frame)
}
