use std::{
    collections::HashMap,
    net::SocketAddr,
    sync::{
        atomic::{AtomicU32, Ordering},
        Arc,
    },
    time::{Duration, Instant},
};

use opcua_core::{comms::secure_channel::SecureChannel, trace_read_lock, trace_write_lock};
use opcua_crypto::{random, CertificateStore, SecurityPolicy, X509};
use parking_lot::RwLock;
use tokio::sync::Notify;
use tracing::{error, info};

use crate::{
    authenticator::UserToken, identity_token::IdentityToken, info::ServerInfo, CertificateBearer,
    node_manager::NodeManagers,
    server_handle::SessionDescription,
    shares::{ClientShare, Held, SharedResource},
    subscriptions::SubscriptionCache,
    ClientKey, ServerIdentity,
};
use opcua_types::{
    ActivateSessionRequest, ActivateSessionResponse, ApplicationDescription, ByteString, CloseSessionRequest, CloseSessionResponse,
    CreateSessionRequest, CreateSessionResponse, Error, NodeId, ResponseHeader, SignatureData,
    StatusCode,
};

use super::{instance::Session, message_handler::MessageHandler};

static NEXT_SESSION_ID: AtomicU32 = AtomicU32::new(1);

pub(super) fn next_session_id() -> (NodeId, u32) {
    // Session id will be a string identifier
    let session_id = NEXT_SESSION_ID.fetch_add(1, Ordering::Relaxed);
    (NodeId::new(1, session_id), session_id)
}

/// Manages all sessions on the server.
pub struct SessionManager {
    sessions: HashMap<NodeId, Arc<RwLock<Session>>>,
    info: Arc<ServerInfo>,
    notify: Arc<Notify>,
}

impl SessionManager {
    pub(crate) fn new(info: Arc<ServerInfo>, notify: Arc<Notify>) -> Self {
        Self {
            sessions: Default::default(),
            info,
            notify,
        }
    }

    /// Get a session by its authentication token.
    pub fn find_by_token(&self, authentication_token: &NodeId) -> Option<Arc<RwLock<Session>>> {
        Self::find_by_token_int(&self.sessions, authentication_token)
    }

    /// All activated sessions.
    pub(crate) fn descriptions(&self) -> Vec<SessionDescription> {
        self.sessions
            .values()
            .filter_map(|session| session.read().description())
            .collect()
    }

    /// The certificates of all sessions that have one.
    pub(crate) fn certificates(&self) -> Vec<X509> {
        self.sessions
            .values()
            .filter_map(|session| session.read().client_certificate().cloned())
            .collect()
    }

    fn find_by_token_int(
        sessions: &HashMap<NodeId, Arc<RwLock<Session>>>,
        authentication_token: &NodeId,
    ) -> Option<Arc<RwLock<Session>>> {
        sessions
            .iter()
            .find(|(_, s)| &s.read().authentication_token == authentication_token)
            .map(|p| p.1.clone())
    }

    pub(crate) fn create_session(
        &mut self,
        channel: &mut SecureChannel,
        client_certificate: Option<X509>,
        identity: &ServerIdentity,
        request: &CreateSessionRequest,
    ) -> Result<CreateSessionResponse, StatusCode> {
        self.limit_inactive_sessions(client_certificate.as_ref());
        if self.sessions.len() >= self.info.config.limits.max_sessions
            && !self.close_oldest_inactive_session()
        {
            return Err(StatusCode::BadTooManySessions);
        }

        // TODO: Auditing and diagnostics.
        let endpoints = self
            .info
            .new_endpoint_descriptions(request.endpoint_url.as_ref());
        // TODO request.endpoint_url should match hostname of server application certificate
        // Find matching end points for this url
        if request.endpoint_url.is_empty() {
            error!("Create session was passed an null endpoint url");
            return Err(StatusCode::BadTcpEndpointUrlInvalid);
        }

        let Some(endpoints) = endpoints else {
            return Err(StatusCode::BadTcpEndpointUrlInvalid);
        };

        let security_policy = channel.security_policy();

        if !matches!(security_policy, SecurityPolicy::None)
            && request.client_nonce.len() < self.info.config.session_nonce_length
        {
            error!("Create session was passed a client nonce that is too short, expected at least {} bytes, got {}", 
                self.info.config.session_nonce_length, request.client_nonce.len()
            );
            return Err(StatusCode::BadNonceInvalid);
        }

        // Without a wish, and for what is no duration, it is the longest, as for the session itself.
        let session_timeout_max = self.info.config.max_session_timeout_ms;
        let session_timeout = match request.requested_session_timeout.floor() as u64 {
            0 => session_timeout_max,
            requested => requested.min(session_timeout_max),
        };
        let max_request_message_size = self.info.config.limits.max_request_message_size() as u32;

        let server_signature = if let Some(ref pkey) = identity.private_key {
            opcua_crypto::create_signature_data(
                pkey,
                security_policy,
                &request.client_certificate,
                &request.client_nonce,
            )
            .unwrap_or_else(|err| {
                error!(
                    "Cannot create signature data from private key, check log and error {:?}",
                    err
                );
                SignatureData::null()
            })
        } else {
            SignatureData::null()
        };

        let authentication_token = NodeId::new(0, random::byte_string(32));
        let server_nonce = random::byte_string(self.info.config.session_nonce_length);
        let server_certificate = match &identity.certificate {
            Some(certificate) => certificate.as_byte_string(),
            None => ByteString::null(),
        };
        let server_endpoints = Some(endpoints);

        let session = Session::create(
            &self.info,
            authentication_token.clone(),
            channel.secure_channel_id(),
            session_timeout,
            max_request_message_size,
            request.max_response_message_size,
            request.endpoint_url.clone(),
            security_policy.to_uri().to_string(),
            IdentityToken::None,
            client_certificate,
            server_nonce.clone(),
            request.session_name.clone(),
            request.client_description.clone(),
            channel.security_mode(),
        );
        info!("Created new session with ID {}", session.session_id());

        let session_id = session.session_id().clone();
        self.sessions
            .insert(session_id.clone(), Arc::new(RwLock::new(session)));

        // Increment metrics.
        self.info
            .diagnostics
            .set_current_session_count(self.sessions.len() as u32);
        self.info.diagnostics.inc_session_count();

        self.notify.notify_waiters();

        Ok(CreateSessionResponse {
            response_header: ResponseHeader::new_good(&request.request_header),
            session_id,
            authentication_token,
            revised_session_timeout: session_timeout as f64,
            server_nonce,
            server_certificate,
            server_endpoints,
            server_software_certificates: None,
            server_signature,
            max_request_message_size,
        })
    }

    fn verify_client_signature(
        security_policy: SecurityPolicy,
        identity: &ServerIdentity,
        session: &Session,
        client_signature: &SignatureData,
    ) -> Result<(), Error> {
        if let Some(client_certificate) = session.client_certificate() {
            if let Some(ref server_certificate) = identity.certificate {
                opcua_crypto::verify_signature_data(
                    client_signature,
                    security_policy,
                    client_certificate,
                    server_certificate,
                    session.session_nonce().as_ref(),
                )?;
                Ok(())
            } else {
                Err(Error::new(
                    StatusCode::BadUnexpectedError,
                    "Client signature verification failed, server has no server certificate",
                ))
            }
        } else {
            Err(Error::new(
                StatusCode::BadUnexpectedError,
                "Client signature verification failed, session has no client certificate",
            ))
        }
    }

    /// Make room by closing the session that has waited longest for its activation (OPC 10000-4 §5.7.2), so that
    /// creating sessions without activating them locks nobody out. Returns whether there was one.
    fn close_oldest_inactive_session(&mut self) -> bool {
        let oldest = self
            .sessions
            .iter()
            .filter(|(_, session)| !session.read().is_activated())
            .min_by_key(|(_, session)| session.read().deadline())
            .map(|(id, _)| id.clone());
        if let Some(id) = &oldest {
            self.expire_session(id);
        }
        oldest.is_some()
    }

    /// Make room among the sessions that were not activated yet, of one certificate, so that who creates sessions without end
    /// takes those of others not away between their creation and activation.
    fn limit_inactive_sessions(&mut self, certificate: Option<&X509>) {
        let max = self.info.config.limits.client.max_sessions;
        if max == 0 {
            return;
        }
        let certificate = certificate.map(X509::as_byte_string);
        let mut inactive: Vec<_> = self
            .sessions
            .iter()
            .filter_map(|(id, session)| {
                let session = session.read();
                let is_meant = !session.is_activated()
                    && session.client_certificate().map(X509::as_byte_string) == certificate;
                is_meant.then(|| (session.session_id_numeric(), id.clone()))
            })
            .collect();
        inactive.sort_by_key(|(number, _)| *number);
        // With the one that is about to be created.
        let surplus = (inactive.len() + 1).saturating_sub(max);
        for (_, id) in inactive.into_iter().take(surplus) {
            self.expire_session(&id);
        }
    }

    /// Close the first session of a client whose connection is gone. Returns whether there was one.
    fn close_disconnected_session_of(&mut self, share: &Arc<ClientShare>) -> bool {
        let first = self
            .sessions
            .iter()
            .filter_map(|(id, session)| {
                let session = session.read();
                let is_meant = !session.is_connected()
                    && session.share().is_some_and(|own| Arc::ptr_eq(own, share));
                is_meant.then(|| (session.session_id_numeric(), id.clone()))
            })
            .min_by_key(|(number, _)| *number);
        if let Some((_, id)) = &first {
            self.expire_session(id);
        }
        first.is_some()
    }

    pub(crate) fn expire_session(&mut self, id: &NodeId) {
        let Some(session) = self.sessions.remove(id) else {
            return;
        };
        self.info
            .diagnostics
            .set_current_session_count(self.sessions.len() as u32);
        self.info.diagnostics.inc_session_timeout_count();

        info!("Session {id} has expired, removing it from the session map. Subscriptions will remain until they individually expire");

        let user_token = {
            let mut session = trace_write_lock!(session);
            session.close();
            session.user_token().cloned()
        };
        // The observer may look at sessions.
        if let Some(observer) = &self.info.session_observer {
            observer.session_expired(id.clone(), user_token);
        }
    }

    pub(crate) fn check_session_expiry(&self) -> (Instant, Vec<NodeId>) {
        let now = Instant::now();
        let mut expired = Vec::new();
        let mut expiry = now + Duration::from_millis(self.info.config.max_session_timeout_ms);
        for (id, session) in &self.sessions {
            let deadline = session.read().deadline();
            if deadline < now {
                expired.push(id.clone());
            } else if deadline < expiry {
                expiry = deadline;
            }
        }

        (expiry, expired)
    }
}

/// Check whether a client may create a session on its channel, with the certificate that it shows. Apart from the creation,
/// since it may take long: the sessions of others must not wait for it.
pub(crate) fn check_client(
    info: &ServerInfo,
    channel: &SecureChannel,
    certificate_store: &RwLock<CertificateStore>,
    peer_address: Option<SocketAddr>,
    request: &CreateSessionRequest,
) -> Result<Option<X509>, StatusCode> {
    let security_policy = channel.security_policy();
    if !info.endpoint_exists(
        request.endpoint_url.as_ref(),
        security_policy,
        channel.security_mode(),
    ) {
        // Discovery may use any channel, sessions only what an endpoint offers.
        error!("Create session on a channel whose security no endpoint offers");
        return Err(StatusCode::BadSecurityPolicyRejected);
    }
    if security_policy == SecurityPolicy::None {
        return Ok(None);
    }
    let cert = X509::from_byte_string(&request.client_certificate)?;
    // Before the trust list is asked: whoever opened the channel must own what it shows (OPC 10000-4 §5.7.2).
    let is_of_channel = channel
        .remote_cert()
        .is_some_and(|of_channel| of_channel.as_byte_string() == cert.as_byte_string());
    if !is_of_channel {
        error!("Create session with another certificate than that of the channel");
        return Err(StatusCode::BadCertificateInvalid);
    }
    check_certificate(
        info,
        certificate_store,
        &cert,
        security_policy,
        peer_address,
        &request.client_description,
    )?;
    Ok(Some(cert))
}

/// Check whether a client's certificate is trusted at present, by the validator or the certificate store.
pub(crate) fn check_certificate(
    info: &ServerInfo,
    certificate_store: &RwLock<CertificateStore>,
    certificate: &X509,
    security_policy: SecurityPolicy,
    peer_address: Option<SocketAddr>,
    application: &ApplicationDescription,
) -> Result<(), StatusCode> {
    match &info.certificate_validator {
        Some(validator) => {
            let bearer = CertificateBearer {
                address: peer_address,
                application,
            };
            validator.validate(certificate, security_policy, &bearer)?
        }
        None => {
            let store = trace_read_lock!(certificate_store);
            store.validate_or_reject_application_instance_cert(
                certificate,
                security_policy,
                None,
                None,
            )?;
        }
    }
    Ok(())
}

/// Check the certificate of a session that is about to be activated: the channel must show the one with which the
/// session was created (OPC 10000-4 §5.7.3), and it must still be trusted, since much time may have passed.
fn check_session_certificate(
    info: &ServerInfo,
    channel: &SecureChannel,
    certificate_store: &RwLock<CertificateStore>,
    peer_address: Option<SocketAddr>,
    certificate: Option<&X509>,
    application: &ApplicationDescription,
) -> Result<(), StatusCode> {
    let Some(certificate) = certificate else {
        // Created without security; a channel with it has another bearer.
        return match channel.security_policy() {
            SecurityPolicy::None => Ok(()),
            _ => Err(StatusCode::BadSecurityChecksFailed),
        };
    };
    let is_of_channel = channel
        .remote_cert()
        .is_some_and(|of_channel| of_channel.as_byte_string() == certificate.as_byte_string());
    if !is_of_channel {
        error!("activate_session on a channel with another certificate than that of the session");
        return Err(StatusCode::BadSecurityChecksFailed);
    }
    check_certificate(
        info,
        certificate_store,
        certificate,
        channel.security_policy(),
        peer_address,
        application,
    )
}

/// Take a place among the sessions of a client. One whose connection is gone makes room; its subscriptions stay for the
/// client to take over.
fn take_place(
    mgr_lck: &RwLock<SessionManager>,
    share: &Arc<ClientShare>,
) -> Result<Held, StatusCode> {
    share.take(SharedResource::Sessions, 1).or_else(|refusal| {
        if trace_write_lock!(mgr_lck).close_disconnected_session_of(share) {
            share.take(SharedResource::Sessions, 1)
        } else {
            error!("A client has as many sessions as its share");
            Err(refusal)
        }
    })
}

// This is a non-self method to avoid holding the manager
// across an await point.
pub(crate) async fn close_session(
    mgr_lck: &RwLock<SessionManager>,
    channel: &mut SecureChannel,
    handler: &mut MessageHandler,
    request: &CloseSessionRequest,
) -> Result<CloseSessionResponse, StatusCode> {
    let (session, id, token) = {
        let mut mgr = trace_write_lock!(mgr_lck);
        let Some(session) = mgr.find_by_token(&request.request_header.authentication_token) else {
            return Err(StatusCode::BadSessionIdInvalid);
        };
        let (id, token, session_id) = {
            let session = trace_read_lock!(session);
            let id = session.session_id_numeric();
            let token = session.user_token().cloned();

            let secure_channel_id = channel.secure_channel_id();
            if !session.is_activated() && session.secure_channel_id() != secure_channel_id {
                error!("close_session rejected, secure channel id {} for inactive session does not match one used to create session, {}", secure_channel_id, session.secure_channel_id());
                return Err(StatusCode::BadSecureChannelIdInvalid);
            }
            let session_id = session.session_id().clone();
            (id, token, session_id)
        };

        info!("Closed session with ID {}", session_id);
        let session = mgr.sessions.remove(&session_id).unwrap();
        {
            let mut session_lck = trace_write_lock!(session);
            session_lck.close();
        }
        mgr.info
            .diagnostics
            .set_current_session_count(mgr.sessions.len() as u32);
        (session, id, token)
    };

    if request.delete_subscriptions {
        if let Some(token) = token {
            handler
                .delete_session_subscriptions(id, session, token)
                .await;
        }
        // The token might be None if the session was never activated. No need to delete subscriptions in that case.
    }

    Ok(CloseSessionResponse {
        response_header: ResponseHeader::new_good(&request.request_header),
    })
}

/// Close the sessions that are meant, and delete their subscriptions. The session ids with their users, `None` where a
/// session was never activated.
pub(crate) async fn terminate_sessions(
    mgr_lck: &RwLock<SessionManager>,
    node_managers: NodeManagers,
    subscriptions: Arc<SubscriptionCache>,
    is_meant: impl Fn(&Session) -> bool,
) -> Vec<(NodeId, Option<UserToken>)> {
    let (info, closed): (_, Vec<_>) = {
        let mut mgr = trace_write_lock!(mgr_lck);
        let meant: Vec<_> = mgr
            .sessions
            .iter()
            .filter(|(_, session)| is_meant(&session.read()))
            .map(|(id, session)| (id.clone(), session.clone()))
            .collect();
        for (id, session) in &meant {
            info!("Closed session with ID {}, which is no longer wanted", id);
            mgr.sessions.remove(id);
            trace_write_lock!(session).close();
        }
        mgr.info
            .diagnostics
            .set_current_session_count(mgr.sessions.len() as u32);
        (mgr.info.clone(), meant)
    };
    let mut handler = MessageHandler::new(info, node_managers, subscriptions);
    let mut ended = Vec::with_capacity(closed.len());
    for (session_id, session) in closed {
        let (id, token) = {
            let session = trace_read_lock!(session);
            (session.session_id_numeric(), session.user_token().cloned())
        };
        if let Some(token) = &token {
            handler
                .delete_session_subscriptions(id, session, token.clone())
                .await;
        }
        ended.push((session_id, token));
    }
    ended
}

#[allow(clippy::too_many_arguments)]
pub(crate) async fn activate_session(
    mgr_lck: &RwLock<SessionManager>,
    connection: &Arc<()>,
    channel: &mut SecureChannel,
    identity: &ServerIdentity,
    certificate_store: &RwLock<CertificateStore>,
    peer_address: Option<SocketAddr>,
    request: &ActivateSessionRequest,
    handler: &mut MessageHandler,
) -> Result<(ActivateSessionResponse, Arc<ClientShare>), StatusCode> {
    let security_policy = channel.security_policy();
    let security_mode = channel.security_mode();
    let secure_channel_id = channel.secure_channel_id();
    let server_nonce = security_policy.random_nonce();
    let (endpoint_url, session_nonce, bearer, session_lck, info) = {
        let mgr = trace_read_lock!(mgr_lck);
        let Some(session_lck) = mgr.find_by_token(&request.request_header.authentication_token)
        else {
            return Err(StatusCode::BadSessionIdInvalid);
        };

        let (endpoint_url, session_nonce, bearer) = {
            let session = trace_read_lock!(session_lck);
            session.validate_timed_out()?;

            let endpoint_url = session.endpoint_url().to_string();

            if !mgr
                .info
                .endpoint_exists(&endpoint_url, security_policy, security_mode)
            {
                error!("activate_session, Endpoint dues not exist for requested url & mode {}, {:?} / {:?}",
                endpoint_url, security_policy, security_mode);
                return Err(StatusCode::BadTcpEndpointUrlInvalid);
            }

            if security_policy != SecurityPolicy::None {
                SessionManager::verify_client_signature(
                    security_policy,
                    identity,
                    &session,
                    &request.client_signature,
                )?;
            }
            let bearer = (
                session.client_certificate().cloned(),
                session.application_description().clone(),
            );
            (endpoint_url, session.session_nonce().clone(), bearer)
        };
        (endpoint_url, session_nonce, bearer, session_lck, mgr.info.clone())
    };

    // Without the lock, and before a password is looked at.
    check_session_certificate(
        &info,
        channel,
        certificate_store,
        peer_address,
        bearer.0.as_ref(),
        &bearer.1,
    )?;

    let user_token = info
        .authenticate_endpoint(
            identity,
            request,
            &endpoint_url,
            security_policy,
            security_mode,
            request.user_identity_token.clone(),
            &session_nonce,
            peer_address,
        )
        .await?;

    let share = info.client_shares.of(ClientKey::new(
        &user_token,
        bearer.0.as_ref(),
        peer_address,
    ));
    let has_place = trace_read_lock!(session_lck)
        .share()
        .is_some_and(|own| Arc::ptr_eq(own, &share));
    let place = if has_place {
        None
    } else {
        Some(take_place(mgr_lck, &share)?)
    };

    let (server_nonce, session_id) = {
        let mut session = trace_write_lock!(session_lck);

        if session.is_closed() {
            // Terminated while its user was authenticated.
            return Err(StatusCode::BadSessionClosed);
        }
        if !session.is_activated() && session.secure_channel_id() != secure_channel_id {
            error!("activate session, rejected secure channel id {} for inactive session does not match one used to create session, {}", secure_channel_id, session.secure_channel_id());
            return Err(StatusCode::BadSecureChannelIdInvalid);
        }

        // TODO: If the user identity changed here, we need to re-check permissions for any created monitored items.
        // It may be possible to just create a "fake" UserAccessLevel for each monitored item and pass it to the auth manager.
        // The standard also mentions that a server may need to
        // "Tear down connections to an underlying system and re-establish them using the new credentials". We need some way to
        // handle this eventuality, perhaps a dedicated node-manager endpoint that can be called here.
        session.activate(
            Arc::downgrade(connection),
            peer_address,
            place,
            secure_channel_id,
            server_nonce,
            IdentityToken::new(request.user_identity_token.clone()),
            request.locale_ids.clone(),
            user_token.clone(),
        );
        (
            session.session_nonce().clone(),
            session.session_id_numeric(),
        )
    };

    let namespaces = handler.get_namespaces_for_user(session_lck.clone(), session_id, user_token);
    {
        channel.set_namespaces(namespaces);
    }

    // TODO: Audit

    let response = ActivateSessionResponse {
        response_header: ResponseHeader::new_good(&request.request_header),
        server_nonce,
        results: None,
        diagnostic_infos: None,
    };
    Ok((response, share))
}
