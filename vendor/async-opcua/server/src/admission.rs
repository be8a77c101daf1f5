//! Hooks that decide who may connect, before and while a session is created, and that are told who did.

use std::{net::SocketAddr, sync::Arc};

use opcua_crypto::{PrivateKey, SecurityPolicy, X509};
use opcua_types::{
    ApplicationDescription, Error, ExtensionObject, MessageSecurityMode, NodeId, SecurityTokenRequestType, StatusCode,
};

use tokio_util::sync::CancellationToken;

use crate::{authenticator::UserToken, ClientKey, SharedResource};

/// Decides about incoming connections, for limits per address or in total.
pub trait ConnectionFilter: Send + Sync + 'static {
    /// Called for each accepted socket. `None` closes it at once; a permit is kept until the connection ends, so that
    /// dropping it can count. Cancelling `close` ends the connection at any time, to make room for another one.
    fn admit(&self, peer: SocketAddr, close: &CancellationToken) -> Option<Arc<dyn ConnectionPermit>>;
}

/// Kept while a connection is open.
pub trait ConnectionPermit: Send + Sync + 'static {
    /// Called when a session was activated on the connection for the first time: its client is known.
    fn session_activated(&self);
}

/// Decides about the certificates of clients in place of the certificate store's exact file match, for example with
/// certificate chains and revocation lists.
pub trait CertificateValidator: Send + Sync + 'static {
    /// Called when a client creates or activates a session on a secured channel, or renews the channel of one.
    fn validate(
        &self,
        certificate: &X509,
        security_policy: SecurityPolicy,
        bearer: &CertificateBearer<'_>,
    ) -> Result<(), Error>;
}

/// Who shows a certificate.
#[derive(Debug, Clone, Copy)]
pub struct CertificateBearer<'a> {
    /// Where the connection comes from, as far as that is known.
    pub address: Option<SocketAddr>,
    /// What the application says of itself; nothing of it is proven.
    pub application: &'a ApplicationDescription,
}

/// The application instance certificate of the server with its key. A connection keeps the one it began with.
#[derive(Clone, Default)]
pub struct ServerIdentity {
    /// The certificate; encrypted endpoints do not work without.
    pub certificate: Option<X509>,
    /// The private key of the certificate.
    pub private_key: Option<PrivateKey>,
}

/// The secure channel on which something happened.
#[derive(Clone)]
pub struct ChannelDescription {
    /// Its id; 0 before it was opened.
    pub secure_channel_id: u32,
    /// Its security policy.
    pub security_policy: SecurityPolicy,
    /// Its security mode.
    pub security_mode: MessageSecurityMode,
    /// The certificate of the client.
    pub client_certificate: Option<X509>,
}

/// What happened to a secure channel or session.
#[derive(Debug, Clone)]
pub enum SessionEvent {
    /// A secure channel was opened or renewed, or was not.
    ChannelOpened {
        /// Whether it is a new one; `None` where the request could not be read.
        request_type: Option<SecurityTokenRequestType>,
        /// The lifetime the client asked for, in milliseconds.
        requested_lifetime: u32,
    },
    /// A session was created, or was not.
    SessionCreated {
        /// The session; null where it was not created.
        session_id: NodeId,
        /// The name that the client gave the session.
        session_name: String,
        /// The revised timeout in milliseconds.
        revised_timeout: f64,
    },
    /// A user signed in, or did not.
    SessionActivated {
        /// The session; null where there is no such session.
        session_id: NodeId,
        /// Who.
        user_identity_token: ExtensionObject,
    },
    /// A session was closed by its client, or was not.
    SessionClosed {
        /// The session; null where there is no such session.
        session_id: NodeId,
        /// Whose it was, where it was activated.
        user_token: Option<UserToken>,
    },
}

/// Told about secure channels and sessions, for an audit trail (OPC 10000-4 §6.5).
pub trait SessionObserver: Send + Sync + 'static {
    /// Called after each attempt with its outcome. Must not block.
    fn observe(&self, channel: &ChannelDescription, event: SessionEvent, outcome: StatusCode);

    /// Called when the server ends a session, because its client was silent for longer than the session's timeout or
    /// because it makes room for another one. There may be no channel any more, and no user where it was never activated.
    fn session_expired(&self, session_id: NodeId, user_token: Option<UserToken>);

    /// Called when a client wants more of a resource than its share, or, without a client, than all together may have.
    /// Must not block.
    fn share_exhausted(&self, client: Option<&ClientKey>, resource: SharedResource) {
        let _ = (client, resource);
    }
}
