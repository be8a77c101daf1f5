//! Requests of clients that have signed in, to a running twin, for the fuzz target and for the test that replays its
//! corpus.

use std::{sync::OnceLock, time::Duration};

use opcua_stack::opcua::{
    core::{Message as _, RequestMessage, ResponseMessage},
    crypto::SecurityPolicy,
    types::{
        AttributeId, BinaryEncodable as _, ByteString, ContextOwned, ExtensionObject,
        MessageSecurityMode, NodeId, ObjectId, ReadRequest, ReadValueId, StatusCode,
        TimestampsToReturn, UAString, UserNameIdentityToken,
    },
};
use tokio::{runtime::Runtime, sync::Mutex};

use crate::{
    harness::{Client, TestTwin, document, external, field, instance, message},
    raw_client::{RawChannel, RawClient, SessionKey},
    raw_session::RawSession,
};

/// Time for an answer before the next request is sent. A Publish has none until something changes.
const PATIENCE: Duration = Duration::from_millis(200);
const PUBLISH_PATIENCE: Duration = Duration::from_millis(1);
/// Inputs after which the engineer signs in again, so that what they have left behind is no longer there.
const INPUTS_PER_SESSION: usize = 100;

/// The twin of this process, with an honest client, and a client of an engineer for the inputs.
struct RequestBench {
    runtime: Runtime,
    twin: TestTwin,
    honest: Client,
    engineer: RawClient,
    session: Mutex<Option<EngineerSession>>,
}

struct EngineerSession {
    channel: RawChannel,
    key: SessionKey,
    inputs: usize,
}

/// Sends requests to the one twin of this process, and asks it for a value afterwards. The first byte says who does: an
/// anonymous client whose bytes come as they are; an engineer, whose library writes them behind encryption; or an anonymous
/// client again, whose bytes are what its chunks hold.
pub fn requests(bytes: &[u8]) {
    static BENCH: OnceLock<RequestBench> = OnceLock::new();
    let bench = BENCH.get_or_init(start);
    let Some((client, rest)) = bytes.split_first() else { return };
    let requests = split(rest);
    bench.runtime.block_on(async {
        match client % 3 {
            1 => bench.as_engineer(&requests).await,
            sender => bench.as_anybody(&requests, sender == 2).await,
        }
        let value = bench.honest.read("net#Revision").await;
        assert!(value.value.is_some(), "others are served: {value:?}");
    });
    bench.twin.connector.writes.lock().clear();
    bench.twin.connector.decisions.lock().clear();
}

/// Returns the requests of an input: each has the number of its encoding, a length, and what follows its header.
pub fn split(mut bytes: &[u8]) -> Vec<(u16, &[u8])> {
    let mut requests = Vec::new();
    while let Some((&[low, high, short, long], rest)) = bytes.split_first_chunk() {
        let length = usize::from(u16::from_le_bytes([short, long]));
        let (body, rest) = rest.split_at(rest.len().min(length));
        requests.push((u16::from_le_bytes([low, high]), body));
        bytes = rest;
    }
    requests
}

/// Decodes a request with a token in its header; none where that is no request, or opens or closes a channel.
pub fn decoded(
    channel: &RawChannel,
    token: &NodeId,
    id: u16,
    rest: &[u8],
) -> Option<RequestMessage> {
    let id = ObjectId::try_from(u32::from(id)).ok()?;
    let context = ContextOwned::default();
    let context = context.context();
    let mut bytes = Vec::new();
    channel.header(token).encode(&mut bytes, &context).expect("a header");
    bytes.extend(rest);
    let request = RequestMessage::decode_by_object_id(&mut bytes.as_slice(), id, &context).ok()?;
    let is_of_channel = matches!(
        request,
        RequestMessage::OpenSecureChannel(_) | RequestMessage::CloseSecureChannel(_)
    );
    (!is_of_channel).then_some(request)
}

fn start() -> RequestBench {
    let runtime = Runtime::new().expect("a runtime");
    let (twin, honest, engineer) = runtime.block_on(async {
        let twin = TestTwin::start_with(|config| {
            config.security.allow_anonymous_unencrypted = true;
            config.security.trust_unknown_certificates = true;
            // Inputs that guess passwords must not keep the next ones out.
            config.security.login_failures_max = u32::MAX;
            config.limits.subscriptions_per_client_max = 10;
            config.limits.monitored_items_per_client_max = 1000;
        })
        .await;
        twin.handle.apply(document(message("net", 1)));
        twin.handle.publish_decision(&field("net", "progressStatus"), external());
        let honest = twin.client("vera").await;
        // The first connection makes a certificate.
        twin.client("anna").await.close().await;
        let pki = twin.folder.path().join("client-anna");
        let (policy, mode) = (SecurityPolicy::Basic256Sha256, MessageSecurityMode::SignAndEncrypt);
        let engineer = RawClient::of(&twin, pki, policy, mode).await;
        (twin, honest, engineer)
    });
    RequestBench { runtime, twin, honest, engineer, session: Mutex::new(None) }
}

impl RequestBench {
    async fn as_anybody(&self, requests: &[(u16, &[u8])], in_chunks: bool) {
        let mut session = RawSession::sign_in(&self.twin).await;
        if in_chunks {
            session.play_chunks(requests).await;
        } else {
            session.play(requests).await;
        }
        self.twin.handle.end_sessions_of("anonymous").await;
    }

    async fn as_engineer(&self, requests: &[(u16, &[u8])]) {
        let mut session = self.session.lock().await;
        if session.as_ref().is_none_or(|session| session.inputs >= INPUTS_PER_SESSION) {
            drop(session.take());
            self.twin.handle.end_sessions_of("anna").await;
            *session = Some(self.sign_in().await);
        }
        let Some(current) = session.as_mut() else { return };
        current.inputs += 1;
        for (id, rest) in requests {
            let Some(request) = decoded(&current.channel, &current.key.token, *id, rest) else {
                continue;
            };
            let patience = match request {
                RequestMessage::Publish(_) => PUBLISH_PATIENCE,
                _ => PATIENCE,
            };
            // An answer comes, or does not: it counts that others are served.
            drop(current.channel.exchange_within(request, patience).await);
        }
        let read = ReadRequest {
            request_header: current.channel.header(&current.key.token),
            max_age: 0.0,
            timestamps_to_return: TimestampsToReturn::Neither,
            nodes_to_read: Some(vec![ReadValueId {
                node_id: instance("net#Revision"),
                attribute_id: AttributeId::Value as u32,
                ..ReadValueId::default()
            }]),
        };
        let answer = current.channel.try_exchange(read.into()).await;
        if !matches!(answer, Ok(ResponseMessage::Read(_))) {
            *session = None;
        }
    }

    async fn sign_in(&self) -> EngineerSession {
        let channel = self.engineer.open_channel().await;
        let mut key = self.engineer.create_session(&channel).await.expect("a session");
        let policy = self.engineer.endpoint.user_identity_tokens.iter().flatten().next();
        let user = ExtensionObject::from_message(UserNameIdentityToken {
            policy_id: policy.expect("a policy for users").policy_id.clone(),
            user_name: "anna".into(),
            password: ByteString::from(b"anna-secret"),
            encryption_algorithm: UAString::null(),
        });
        let status = self.engineer.activate(&channel, &mut key, user).await;
        assert_eq!(status, StatusCode::Good);
        EngineerSession { channel, key, inputs: 0 }
    }
}
