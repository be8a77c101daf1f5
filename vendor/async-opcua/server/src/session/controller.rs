use std::{
    pin::Pin,
    sync::Arc,
    time::{Duration, Instant},
};

use futures::{future::Either, stream::FuturesUnordered, Future, StreamExt};
use opcua_core::{trace_read_lock, trace_write_lock, Message, RequestMessage, ResponseMessage};
use tracing::{debug, debug_span, error, trace, warn};

use opcua_core::{
    comms::{
        secure_channel::SecureChannel, security_header::SecurityHeader, tcp_types::ErrorMessage,
    },
    config::Config,
    handle::AtomicHandle,
    sync::RwLock,
};
use opcua_crypto::{CertificateStore, SecurityPolicy};
use opcua_types::{
    ApplicationDescription, ChannelSecurityToken, DateTime, DecodingOptions, FindServersResponse, GetEndpointsResponse, MessageSecurityMode, NodeId,
    OpenSecureChannelRequest, OpenSecureChannelResponse, ResponseHeader, SecurityTokenRequestType,
    ServiceFault, StatusCode,
};
use tokio_util::sync::CancellationToken;
use tracing_futures::Instrument;

use crate::{
    authenticator::UserToken,
    info::ServerInfo,
    node_manager::NodeManagers,
    shares::{ClientShare, SharedResource},
    subscriptions::SubscriptionCache,
    transport::tcp::{Request, TcpTransport, TransportPollResult},
    transport::Connector,
    ChannelDescription, ConnectionPermit, ServerIdentity, SessionEvent,
};

use super::{
    instance::Session,
    manager::{activate_session, check_certificate, check_client, close_session, SessionManager},
    message_handler::MessageHandler,
};

pub(crate) struct Response {
    pub message: ResponseMessage,
    pub request_id: u32,
}

impl Response {
    pub(super) fn from_result(
        result: Result<impl Into<ResponseMessage>, StatusCode>,
        request_handle: u32,
        request_id: u32,
    ) -> Self {
        match result {
            Ok(r) => Self {
                message: r.into(),
                request_id,
            },
            Err(e) => Self {
                message: ServiceFault::new(request_handle, e).into(),
                request_id,
            },
        }
    }
}

pub(crate) enum ControllerCommand {
    Close,
}

/// Most requests of one connection in progress at a time, waiting publish requests included. Further ones stay in the
/// client's send window.
const MAX_PENDING_MESSAGES: usize = 1024;

/// Longest time from an accepted connection until a session is activated on it. Whoever only looks for endpoints needs
/// less, and anybody can connect.
const ACTIVATION_TIMEOUT: Duration = Duration::from_secs(30);

/// Longest time in which a client takes the last message of a connection.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);

/// Time from the arrival of a request to open a channel until its refusal, and of a refused sign-in; longer than any
/// such request takes to check. With the same answer to all of them, nobody learns at which check one failed, so that
/// the server's private key answers no questions about messages of others.
const REFUSAL_DELAY: Duration = Duration::from_millis(200);

/// A random part of up to this many milliseconds is added to [`REFUSAL_DELAY`], for requests that took longer.
const REFUSAL_JITTER_MS: u8 = 64;

/// Most renewals of a channel before a session is activated; each costs operations with the private key.
const UNAUTHENTICATED_MAX_RENEWALS: usize = 4;

/// Wait until a refusal may be told.
async fn delay_refusal(received_at: Instant) {
    let mut jitter = [0u8; 1];
    opcua_crypto::random::bytes(&mut jitter);
    let jitter = Duration::from_millis((jitter[0] % REFUSAL_JITTER_MS).into());
    tokio::time::sleep_until((received_at + REFUSAL_DELAY + jitter).into()).await;
}

type PendingMessageResponse = dyn Future<Output = Result<Response, String>> + Send + Sync + 'static;

/// Master type managing a single connection.
pub(crate) struct SessionController {
    channel: SecureChannel,
    transport: TcpTransport,
    secure_channel_state: SecureChannelState,
    session_manager: Arc<RwLock<SessionManager>>,
    certificate_store: Arc<RwLock<CertificateStore>>,
    message_handler: MessageHandler,
    pending_messages: FuturesUnordered<Pin<Box<PendingMessageResponse>>>,
    info: Arc<ServerInfo>,
    /// The certificate and key of this connection.
    identity: Arc<ServerIdentity>,
    deadline: Instant,
    /// When the connection ends unless a session was activated on it.
    activation_deadline: Option<Instant>,
    permit: Option<Arc<dyn ConnectionPermit>>,
    /// Alive as long as the connection, for its sessions.
    alive: Arc<()>,
    /// The share of the client that signed in last on the connection.
    share: Option<Arc<ClientShare>>,
}

enum RequestProcessResult {
    Ok,
    Close,
}

pub(crate) struct SessionStarter<T> {
    connector: T,
    info: Arc<ServerInfo>,
    session_manager: Arc<RwLock<SessionManager>>,
    certificate_store: Arc<RwLock<CertificateStore>>,
    node_managers: NodeManagers,
    subscriptions: Arc<SubscriptionCache>,
    permit: Option<Arc<dyn ConnectionPermit>>,
}

impl<T: Connector> SessionStarter<T> {
    pub(crate) fn new(
        connector: T,
        info: Arc<ServerInfo>,
        session_manager: Arc<RwLock<SessionManager>>,
        certificate_store: Arc<RwLock<CertificateStore>>,
        node_managers: NodeManagers,
        subscriptions: Arc<SubscriptionCache>,
        permit: Option<Arc<dyn ConnectionPermit>>,
    ) -> Self {
        Self {
            connector,
            info,
            session_manager,
            certificate_store,
            node_managers,
            subscriptions,
            permit,
        }
    }

    pub(crate) async fn run(
        self,
        mut command: tokio::sync::mpsc::Receiver<ControllerCommand>,
        on_connect: impl FnOnce(StatusCode) + Send,
    ) {
        let token = CancellationToken::new();
        let span = tracing::info_span!("Establish TCP channel");
        let fut = self
            .connector
            .connect(self.info.clone(), token.clone())
            .instrument(span.clone());
        tokio::pin!(fut);
        let transport = tokio::select! {
            cmd = command.recv() => {
                match cmd {
                    Some(ControllerCommand::Close) | None => {
                        token.cancel();
                        let _ = fut.await;
                        return;
                    }
                }
            }
            r = &mut fut => {
                match r {
                    Ok(t) => t,
                    Err(e) => {
                        on_connect(e);
                        span.in_scope(|| {
                            tracing::error!("Connection failed while waiting for channel to be established: {e}");
                        });
                        return;
                    }
                }
            }
        };

        let controller = SessionController::new(
            transport,
            self.session_manager,
            self.certificate_store,
            self.info,
            self.node_managers,
            self.subscriptions,
            self.permit,
        );
        controller.run(command).await
    }
}

impl SessionController {
    fn new(
        transport: TcpTransport,
        session_manager: Arc<RwLock<SessionManager>>,
        certificate_store: Arc<RwLock<CertificateStore>>,
        info: Arc<ServerInfo>,
        node_managers: NodeManagers,
        subscriptions: Arc<SubscriptionCache>,
        permit: Option<Arc<dyn ConnectionPermit>>,
    ) -> Self {
        let mut channel = SecureChannel::new(
            certificate_store.clone(),
            opcua_core::comms::secure_channel::Role::Server,
            Arc::new(RwLock::new(info.initial_encoding_context())),
        );
        // The files may be replaced at any time; channel and sessions must use the same pair.
        let identity = info.identity.load_full();
        channel.set_cert(identity.certificate.clone());
        channel.set_private_key(identity.private_key.clone());
        channel.set_accepted_policies(info.channel_policies());
        channel.set_decoding_options(unauthenticated_options(info.decoding_options()));

        Self {
            channel,
            transport,
            secure_channel_state: SecureChannelState::new(info.secure_channel_id_handle.clone()),
            session_manager,
            certificate_store,
            message_handler: MessageHandler::new(info.clone(), node_managers, subscriptions),
            deadline: Instant::now()
                + Duration::from_secs(info.config.tcp_config.hello_timeout as u64),
            activation_deadline: Some(Instant::now() + ACTIVATION_TIMEOUT),
            info,
            identity,
            pending_messages: FuturesUnordered::new(),
            permit,
            alive: Arc::new(()),
            share: None,
        }
    }

    async fn run(mut self, mut command: tokio::sync::mpsc::Receiver<ControllerCommand>) {
        loop {
            let may_read = self.pending_messages.len() < MAX_PENDING_MESSAGES;
            let resp_fut = if self.pending_messages.is_empty() {
                Either::Left(futures::future::pending::<Option<Result<Response, String>>>())
            } else {
                Either::Right(self.pending_messages.next())
            };

            let deadline = match self.activation_deadline {
                Some(limit) => self.deadline.min(limit),
                None => self.deadline,
            };
            let deadline = match self.transport.unfinished_message_deadline() {
                Some(limit) if !self.transport.is_closing() => deadline.min(limit),
                _ => deadline,
            };

            tokio::select! {
                _ = tokio::time::sleep_until(deadline.into()) => {
                    if self.transport.is_closing() {
                        // The client does not take the last message either.
                        break;
                    }
                    warn!("Connection timed out, closing");
                    self.fatal_error(StatusCode::BadTimeout, "Connection timeout");
                }
                cmd = command.recv() => {
                    match cmd {
                        Some(ControllerCommand::Close) | None => {
                            self.fatal_error(StatusCode::BadServerHalted, "Server stopped");
                        }
                    }
                }
                msg = resp_fut => {
                    let msg = match msg {
                        Some(Ok(x)) => x,
                        Some(Err(e)) => {
                            error!("Unexpected error in message handler: {e}");
                            self.fatal_error(StatusCode::BadInternalError, &e);
                            continue;
                        }
                        // Cannot happen, pending_messages is non-empty or this future never returns.
                        None => unreachable!(),
                    };
                    self.response_metrics(&msg);

                    if let Err(e) = self.transport.enqueue_message_for_send(
                        &mut self.channel,
                        msg.message,
                        msg.request_id
                    ) {
                        error!("Failed to send response: {e}");
                        self.fatal_error(e, "Encoding error");
                    }
                }
                res = self.transport.poll(&mut self.channel, may_read) => {
                    match res {
                        TransportPollResult::IncomingMessage(req) => {
                            if matches!(self.process_request(req).await, RequestProcessResult::Close) {
                                self.begin_closing();
                            }
                        }
                        TransportPollResult::RecoverableError(s, id, handle) => {
                            warn!("Non-fatal transport error: {s}, with request id {id}, request handle {handle}");
                            let msg = ServiceFault::new(handle, s).into();
                            if let Err(e) = self.transport.enqueue_message_for_send(&mut self.channel, msg, id) {
                                error!("Failed to send response: {e}");
                                self.fatal_error(e, "Encoding error");
                            }
                        }
                        TransportPollResult::OpenChannelError(s, received_at) => {
                            error!("A request to open a secure channel was refused: {s}");
                            let event = SessionEvent::ChannelOpened {
                                request_type: None,
                                requested_lifetime: 0,
                            };
                            self.observe(event, s);
                            self.info.diagnostics.inc_rejected_requests();
                            self.info.diagnostics.inc_security_rejected_requests();
                            delay_refusal(received_at).await;
                            self.fatal_error(
                                StatusCode::BadSecurityChecksFailed,
                                "The secure channel was not opened",
                            );
                        }
                        TransportPollResult::Error(s) => {
                            error!("Fatal transport error: {s}");
                            if !self.secure_channel_state.issued {
                                let event = SessionEvent::ChannelOpened {
                                    request_type: None,
                                    requested_lifetime: 0,
                                };
                                self.observe(event, s);
                            }
                            self.fatal_error(s, "Transport error");
                        }
                        TransportPollResult::Closed => break,
                        _ => (),
                    }
                }
            }
        }
    }

    fn response_metrics(&self, msg: &Response) {
        if self.info.diagnostics.enabled {
            let status = msg.message.response_header().service_result;
            if status.is_bad() {
                self.info.diagnostics.inc_rejected_requests();
                if matches!(
                    status,
                    StatusCode::BadSessionIdInvalid
                        | StatusCode::BadSecurityChecksFailed
                        | StatusCode::BadUserAccessDenied
                ) {
                    self.info.diagnostics.inc_security_rejected_requests();
                }
            }
        }
    }

    fn fatal_error(&mut self, err: StatusCode, msg: &str) {
        if !self.transport.is_closing() {
            self.transport.enqueue_error(ErrorMessage::new(err, msg));
        }
        self.begin_closing();
    }

    /// Close the connection once the last message is sent, or could not be sent in time.
    fn begin_closing(&mut self) {
        if !self.transport.is_closing() {
            self.activation_deadline = None;
            self.deadline = Instant::now() + CLOSE_TIMEOUT;
        }
        self.transport.set_closing();
    }

    async fn process_request(&mut self, req: Request) -> RequestProcessResult {
        let span = debug_span!(
            "Incoming request",
            request_id = req.request_id,
            request_type = %req.message.type_name(),
            request_handle = req.message.request_handle(),
        );

        let id = req.request_id;
        let request_bytes = req.bytes;
        match req.message {
            RequestMessage::OpenSecureChannel(r) => {
                let _h = span.enter();
                let res = self.open_secure_channel(
                    &req.chunk_info.security_header,
                    self.transport.client_protocol_version,
                    &r,
                );
                let outcome = match &res {
                    Ok(response) => response.response_header().service_result,
                    Err(e) => *e,
                };
                let event = SessionEvent::ChannelOpened {
                    request_type: Some(r.request_type),
                    requested_lifetime: r.requested_lifetime,
                };
                self.observe(event, outcome);
                if outcome.is_good() {
                    self.deadline = self.channel.token_renewal_deadline();
                } else {
                    self.info.diagnostics.inc_rejected_requests();
                    self.info.diagnostics.inc_security_rejected_requests();
                }
                match res {
                    Ok(r) => match self
                        .transport
                        .enqueue_message_for_send(&mut self.channel, r, id)
                    {
                        Ok(_) => RequestProcessResult::Ok,
                        Err(e) => {
                            error!("Failed to send open secure channel response: {e}");
                            RequestProcessResult::Close
                        }
                    },
                    Err(e) => {
                        let _ = self.transport.enqueue_message_for_send(
                            &mut self.channel,
                            ServiceFault::new(&r.request_header, e).into(),
                            id,
                        );
                        RequestProcessResult::Close
                    }
                }
            }

            RequestMessage::CloseSecureChannel(_r) => RequestProcessResult::Close,

            RequestMessage::CreateSession(request) => {
                let received_at = Instant::now();
                let res = check_client(
                    &self.info,
                    &self.channel,
                    &self.certificate_store,
                    self.transport.peer_address,
                    &request,
                )
                .and_then(|client_certificate| {
                    let mut mgr = trace_write_lock!(self.session_manager);
                    mgr.create_session(
                        &mut self.channel,
                        client_certificate,
                        &self.identity,
                        &request,
                    )
                });
                if res.is_err() && !self.transport.is_authenticated() {
                    // Whoever is not trusted may ask again, but not in a loop.
                    delay_refusal(received_at).await;
                }
                let _h = span.enter();
                let event = SessionEvent::SessionCreated {
                    session_id: res.as_ref().map_or_else(|_| NodeId::null(), |r| r.session_id.clone()),
                    session_name: request.session_name.to_string(),
                    revised_timeout: res.as_ref().map_or(0.0, |r| r.revised_session_timeout),
                };
                self.observe(event, res.as_ref().err().copied().unwrap_or(StatusCode::Good));
                self.process_service_result(res, request.request_header.request_handle, id)
            }

            RequestMessage::ActivateSession(request) => {
                let received_at = Instant::now();
                let res = activate_session(
                    &self.session_manager,
                    &self.alive,
                    &mut self.channel,
                    &self.identity,
                    &self.certificate_store,
                    self.transport.peer_address,
                    &request,
                    &mut self.message_handler,
                )
                .instrument(span.clone())
                .await;
                if res.is_err() {
                    delay_refusal(received_at).await;
                }
                let _h = span.enter();
                let is_first = !self.transport.is_authenticated();
                let res = res.map(|(response, share)| {
                    self.transport
                        .set_authenticated(&share, self.info.config.limits.max_request_size);
                    self.share = Some(share);
                    response
                });
                if res.is_ok() && is_first {
                    self.channel.set_decoding_options(self.info.decoding_options());
                    self.activation_deadline = None;
                    if let Some(permit) = &self.permit {
                        permit.session_activated();
                    }
                }
                let event = SessionEvent::SessionActivated {
                    session_id: self.session_of(&request.request_header.authentication_token).0,
                    user_identity_token: request.user_identity_token.clone(),
                };
                self.observe(event, res.as_ref().err().copied().unwrap_or(StatusCode::Good));
                self.process_service_result(res, request.request_header.request_handle, id)
            }

            RequestMessage::CloseSession(request) => {
                let (session_id, user_token) =
                    self.session_of(&request.request_header.authentication_token);
                let res = close_session(
                    &self.session_manager,
                    &mut self.channel,
                    &mut self.message_handler,
                    &request,
                )
                .instrument(span.clone())
                .await;
                let _h = span.enter();
                let outcome = res.as_ref().err().copied().unwrap_or(StatusCode::Good);
                self.observe(SessionEvent::SessionClosed { session_id, user_token }, outcome);
                self.process_service_result(res, request.request_header.request_handle, id)
            }
            RequestMessage::GetEndpoints(request) => {
                // TODO some of the arguments in the request are ignored
                //  localeIds - list of locales to use for human readable strings (in the endpoint descriptions)

                // TODO audit - generate event for failed service invocation

                let _h = span.enter();
                let endpoints = self
                    .info
                    .endpoints(&request.endpoint_url, &request.profile_uris);
                self.process_service_result(
                    Ok(GetEndpointsResponse {
                        response_header: ResponseHeader::new_good(&request.request_header),
                        endpoints,
                    }),
                    request.request_header.request_handle,
                    id,
                )
            }
            RequestMessage::FindServers(request) => {
                let _h = span.enter();
                let desc = self.info.config.application_description();
                let mut servers = vec![desc];

                // TODO endpoint URL

                // TODO localeids, filter out servers that do not support locale ids

                // Filter servers that do not have a matching application uri
                if let Some(ref server_uris) = request.server_uris {
                    if !server_uris.is_empty() {
                        // Filter the servers down
                        servers.retain(|server| server_uris.contains(&server.application_uri));
                    }
                }

                let servers = Some(servers);

                self.process_service_result(
                    Ok(FindServersResponse {
                        response_header: ResponseHeader::new_good(&request.request_header),
                        servers,
                    }),
                    request.request_header.request_handle,
                    id,
                )
            }
            RequestMessage::FindServersOnNetwork(request) => {
                let _h = span.enter();
                if let Err(e) = self.transport.enqueue_message_for_send(
                    &mut self.channel,
                    ServiceFault::new(&request.request_header, StatusCode::BadServiceUnsupported)
                        .into(),
                    id,
                ) {
                    error!("Failed to send request response: {e}");
                    RequestProcessResult::Close
                } else {
                    RequestProcessResult::Ok
                }
            }
            RequestMessage::RegisterServer(request) => {
                let _h = span.enter();
                if let Err(e) = self.transport.enqueue_message_for_send(
                    &mut self.channel,
                    ServiceFault::new(&request.request_header, StatusCode::BadServiceUnsupported)
                        .into(),
                    id,
                ) {
                    error!("Failed to send request response: {e}");
                    RequestProcessResult::Close
                } else {
                    RequestProcessResult::Ok
                }
            }
            RequestMessage::RegisterServer2(request) => {
                let _h = span.enter();
                if let Err(e) = self.transport.enqueue_message_for_send(
                    &mut self.channel,
                    ServiceFault::new(&request.request_header, StatusCode::BadServiceUnsupported)
                        .into(),
                    id,
                ) {
                    error!("Failed to send request response: {e}");
                    RequestProcessResult::Close
                } else {
                    RequestProcessResult::Ok
                }
            }

            message => {
                let _h = span.enter();
                let now = Instant::now();
                let mgr = trace_read_lock!(self.session_manager);
                let session = mgr.find_by_token(&message.request_header().authentication_token);

                let (session_id, session, user_token) =
                    match Self::validate_request(&message, session, &self.channel) {
                        Ok(s) => s,
                        Err(e) => {
                            self.info.diagnostics.inc_rejected_requests();
                            self.info.diagnostics.inc_security_rejected_requests();
                            match self
                                .transport
                                .enqueue_message_for_send(&mut self.channel, e, id)
                            {
                                Ok(_) => return RequestProcessResult::Ok,
                                Err(e) => {
                                    error!("Failed to send request response: {e}");
                                    return RequestProcessResult::Close;
                                }
                            }
                        }
                    };

                debug!("Received request on session {session_id}");

                let deadline = {
                    let timeout = message.request_header().timeout_hint;
                    let max_timeout = self.info.config.max_timeout_ms;
                    let timeout = if max_timeout == 0 {
                        timeout
                    } else {
                        max_timeout.max(timeout)
                    };
                    if timeout == 0 {
                        // Just set some huge value. A request taking a day can probably
                        // be safely canceled...
                        now + Duration::from_secs(60 * 60 * 24)
                    } else {
                        now + Duration::from_millis(timeout.into())
                    }
                };
                let request_handle = message.request_handle();
                // Publish requests wait for long, and each session has a bound of its own for them.
                let place = match &self.share {
                    Some(share) if !matches!(message, RequestMessage::Publish(_)) => {
                        match share.take(SharedResource::Requests, 1) {
                            Ok(place) => Some(place),
                            Err(refusal) => {
                                drop(mgr);
                                return self.process_service_result(
                                    Err::<ServiceFault, _>(refusal),
                                    request_handle,
                                    id,
                                );
                            }
                        }
                    }
                    _ => None,
                };

                match self
                    .message_handler
                    .handle_message(message, session_id, session, user_token, id)
                {
                    super::message_handler::HandleMessageResult::AsyncMessage(mut handle) => {
                        self.pending_messages
                            .push(Box::pin(async move {
                                let _held = (place, request_bytes);
                                // Select biased because if for some reason there's a long time between polls,
                                // we want to return the response even if the timeout expired. We only want to send a timeout
                                // if the call has not been finished yet.
                                tokio::select! {
                                    biased;
                                    r = &mut handle => {
                                        match r {
                                            Ok(r) => {
                                                debug!(
                                                    status_code = %r.message.response_header().service_result,
                                                    "Sending response of type {}", r.message.type_name()
                                                );
                                                Ok(r)
                                            }
                                            Err(e) => {
                                                error!("Request panic! {e}");
                                                Err(e.to_string())
                                            }
                                        }
                                    }
                                    _ = tokio::time::sleep_until(deadline.into()) => {
                                        handle.abort();
                                        Ok(Response { message: ServiceFault::new(request_handle, StatusCode::BadTimeout).into(), request_id: id })
                                    }
                                }
                            }.instrument(span.clone())));
                        RequestProcessResult::Ok
                    }
                    super::message_handler::HandleMessageResult::SyncMessage(s) => {
                        debug!(
                            status_code = %s.message.response_header().service_result,
                            "Sending response of type {}", s.message.type_name()
                        );
                        self.response_metrics(&s);

                        if let Err(e) = self.transport.enqueue_message_for_send(
                            &mut self.channel,
                            s.message,
                            s.request_id,
                        ) {
                            error!("Failed to send response: {e}");
                            return RequestProcessResult::Close;
                        }
                        RequestProcessResult::Ok
                    }
                    super::message_handler::HandleMessageResult::PublishResponse(resp) => {
                        self.pending_messages.push(Box::pin(resp.recv()));
                        RequestProcessResult::Ok
                    }
                }
            }
        }
    }

    /// Check that the client that renews its channel is still trusted. A client without a session is checked when it
    /// asks for one.
    fn check_renewal(&self) -> Result<(), StatusCode> {
        let Some(certificate) = self.channel.remote_cert() else {
            return Ok(());
        };
        check_certificate(
            &self.info,
            &self.certificate_store,
            &certificate,
            self.channel.security_policy(),
            self.transport.peer_address,
            &ApplicationDescription::default(),
        )
    }

    /// The session behind an authentication token, null where there is none, and its user.
    fn session_of(&self, authentication_token: &NodeId) -> (NodeId, Option<UserToken>) {
        let mgr = trace_read_lock!(self.session_manager);
        match mgr.find_by_token(authentication_token) {
            Some(session) => {
                let session = trace_read_lock!(session);
                (session.session_id().clone(), session.user_token().cloned())
            }
            None => (NodeId::null(), None),
        }
    }

    fn observe(&self, event: SessionEvent, outcome: StatusCode) {
        let Some(observer) = &self.info.session_observer else {
            return;
        };
        let channel = ChannelDescription {
            secure_channel_id: self.channel.secure_channel_id(),
            security_policy: self.channel.security_policy(),
            security_mode: self.channel.security_mode(),
            client_certificate: self.channel.remote_cert(),
        };
        observer.observe(&channel, event, outcome);
    }

    fn process_service_result(
        &mut self,
        res: Result<impl Into<ResponseMessage>, StatusCode>,
        request_handle: u32,
        request_id: u32,
    ) -> RequestProcessResult {
        let message = match res {
            Ok(m) => m.into(),
            Err(e) => {
                self.info.diagnostics.inc_rejected_requests();
                if matches!(
                    e,
                    StatusCode::BadSessionIdInvalid
                        | StatusCode::BadSecurityChecksFailed
                        | StatusCode::BadUserAccessDenied
                ) {
                    self.info.diagnostics.inc_security_rejected_requests();
                }

                ServiceFault::new(request_handle, e).into()
            }
        };
        if let Err(e) =
            self.transport
                .enqueue_message_for_send(&mut self.channel, message, request_id)
        {
            error!("Failed to send request response: {e}");
            RequestProcessResult::Close
        } else {
            RequestProcessResult::Ok
        }
    }

    fn validate_request(
        message: &RequestMessage,
        session: Option<Arc<RwLock<Session>>>,
        channel: &SecureChannel,
    ) -> Result<(u32, Arc<RwLock<Session>>, UserToken), ResponseMessage> {
        let header = message.request_header();

        let Some(session) = session else {
            return Err(ServiceFault::new(header, StatusCode::BadSessionIdInvalid).into());
        };

        let session_lock = trace_read_lock!(session);
        let id = session_lock.session_id_numeric();

        let user_token = (move || {
            let token = session_lock.validate_activated()?;
            session_lock.validate_secure_channel_id(channel.secure_channel_id())?;
            session_lock.validate_timed_out()?;
            Ok(token.clone())
        })()
        .map_err(|e| ServiceFault::new(header, e))?;
        Ok((id, session, user_token))
    }

    fn open_secure_channel(
        &mut self,
        security_header: &SecurityHeader,
        client_protocol_version: u32,
        request: &OpenSecureChannelRequest,
    ) -> Result<ResponseMessage, StatusCode> {
        let security_header = match security_header {
            SecurityHeader::Asymmetric(security_header) => security_header,
            _ => {
                error!("Secure channel request message does not have asymmetric security header");
                return Err(StatusCode::BadUnexpectedError);
            }
        };

        // Must compare protocol version to the one from HELLO
        if request.client_protocol_version != client_protocol_version {
            error!(
                "Client sent a different protocol version than it did in the HELLO - {} vs {}",
                request.client_protocol_version, client_protocol_version
            );
            return Ok(ServiceFault::new(
                &request.request_header,
                StatusCode::BadProtocolVersionUnsupported,
            )
            .into());
        }

        // Test the request type
        let secure_channel_id = match request.request_type {
            SecurityTokenRequestType::Issue => {
                trace!("Request type == Issue");
                // A connection has one channel, and a channel keeps its keys' owner.
                if self.secure_channel_state.issued {
                    error!("Asked to issue a token on a channel that has one");
                    return Err(StatusCode::BadRequestTypeInvalid);
                }
                self.secure_channel_state.create_secure_channel_id()
            }
            SecurityTokenRequestType::Renew => {
                trace!("Request type == Renew");

                // Check for a duplicate nonce. It is invalid for the renew to use the same nonce
                // as was used for last issue/renew. It doesn't matter when policy is none.
                if self.channel.security_policy() != SecurityPolicy::None
                    && request.client_nonce.as_ref() == self.channel.remote_nonce()
                {
                    error!("Client reused a nonce for a renew");
                    return Ok(ServiceFault::new(
                        &request.request_header,
                        StatusCode::BadNonceInvalid,
                    )
                    .into());
                }

                // check to see if the secure channel has been issued before or not
                if !self.secure_channel_state.issued {
                    error!("Asked to renew token on session that has never issued token");
                    return Err(StatusCode::BadUnexpectedError);
                }
                // Only who opened the channel may renew it, as it was opened. The policy was checked by the header.
                let is_same_client = self.channel.remote_cert_as_byte_string().as_ref()
                    == security_header.sender_certificate.as_ref();
                if !is_same_client || request.security_mode != self.channel.security_mode() {
                    error!("Asked to renew a token with another certificate or security mode");
                    return Err(StatusCode::BadSecurityChecksFailed);
                }
                if !self.transport.is_authenticated()
                    && self.secure_channel_state.renew_count >= UNAUTHENTICATED_MAX_RENEWALS
                {
                    error!("Asked to renew a token again without a session");
                    return Err(StatusCode::BadTooManyOperations);
                }
                if self.transport.is_authenticated() {
                    self.check_renewal()?;
                }
                self.secure_channel_state.renew_count += 1;
                self.channel.secure_channel_id()
            }
        };

        // Check the requested security mode
        debug!("Message security mode == {:?}", request.security_mode);
        if matches!(request.security_mode, MessageSecurityMode::Invalid) {
            error!("Security mode is invalid");
            return Ok(ServiceFault::new(
                &request.request_header,
                StatusCode::BadSecurityModeRejected,
            )
            .into());
        }

        // Process the request
        self.secure_channel_state.issued = true;

        // Create a new secure channel info
        let security_mode = request.security_mode;
        self.channel.set_security_mode(security_mode);
        self.channel
            .set_remote_cert_from_byte_string(&security_header.sender_certificate)?;

        let max_lifetime = self.info.config.max_secure_channel_token_lifetime_ms;
        let revised_lifetime = match request.requested_lifetime {
            0 => max_lifetime,
            requested => max_lifetime.min(requested),
        };
        // With the time of this token: its keys and the channel end when it is too old, not when the connection is.
        let token = ChannelSecurityToken {
            channel_id: secure_channel_id,
            token_id: self.secure_channel_state.create_token_id(),
            created_at: DateTime::now(),
            revised_lifetime,
        };
        self.channel.set_security_token(token.clone());

        self.channel
            .validate_secure_channel_nonce_length(&request.client_nonce)?;
        self.channel
            .set_remote_nonce_from_byte_string(&request.client_nonce)?;
        self.channel.create_random_nonce();

        let security_policy = self.channel.security_policy();
        if security_policy != SecurityPolicy::None
            && (security_mode == MessageSecurityMode::Sign
                || security_mode == MessageSecurityMode::SignAndEncrypt)
        {
            self.channel.derive_keys();
        }

        let response = OpenSecureChannelResponse {
            response_header: ResponseHeader::new_good(&request.request_header),
            server_protocol_version: 0,
            security_token: token,
            server_nonce: self.channel.local_nonce_as_byte_string(),
        };
        Ok(response.into())
    }
}

/// The decoding limits before a session is activated: at most the defaults, which hold any request up to then.
fn unauthenticated_options(options: DecodingOptions) -> DecodingOptions {
    let default = DecodingOptions::default();
    DecodingOptions {
        max_string_length: options.max_string_length.min(default.max_string_length),
        max_byte_string_length: options
            .max_byte_string_length
            .min(default.max_byte_string_length),
        max_array_length: options.max_array_length.min(default.max_array_length),
        ..options
    }
}

struct SecureChannelState {
    // Issued flag
    issued: bool,
    // Renew count, debugging
    renew_count: usize,
    // Last secure channel id
    secure_channel_id: Arc<AtomicHandle>,
    /// Last token id number
    last_token_id: u32,
}

impl SecureChannelState {
    fn new(handle: Arc<AtomicHandle>) -> SecureChannelState {
        SecureChannelState {
            secure_channel_id: handle,
            issued: false,
            renew_count: 0,
            last_token_id: 0,
        }
    }

    fn create_secure_channel_id(&mut self) -> u32 {
        self.secure_channel_id.next()
    }

    fn create_token_id(&mut self) -> u32 {
        self.last_token_id += 1;
        self.last_token_id
    }
}
