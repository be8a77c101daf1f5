//! Sessions of people at the server, as pages list them.

use std::net::IpAddr;

use asi_model::DateTime;
use opcua_stack::opcua::{
    server::SessionDescription,
    types::{Identifier, NodeId},
};

use crate::clock;

/// Longest name that is listed: clients choose it.
const NAME_CHARS_MAX: usize = 200;

/// Open session of a person.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TwinSession {
    /// Number by which it is ended, unique while the server runs.
    pub number: u32,
    /// Address of the client; none if the server had opened the connection.
    pub address: Option<IpAddr>,
    /// Name that the application gave itself, unproven.
    pub application_name: String,
    /// Subject of the client's certificate; none over a connection without protection.
    pub certificate_subject: Option<String>,
    pub started_at: DateTime,
    /// Time of the last request.
    pub last_used_at: DateTime,
}

impl TwinSession {
    /// Describes a session; `None` for an id that the server does not give.
    pub(crate) fn of(session: SessionDescription) -> Option<Self> {
        let Identifier::Numeric(number) = session.session_id.identifier else { return None };
        Some(Self {
            number,
            address: session.client_address.map(|address| address.ip()),
            application_name: shortened(&session.application_name),
            certificate_subject: session
                .client_certificate
                .map(|certificate| shortened(&certificate.subject_name())),
            started_at: clock::ago(session.age),
            last_used_at: clock::ago(session.idle),
        })
    }
}

/// Returns the id of the session with a number.
pub(crate) fn session_id(number: u32) -> NodeId {
    NodeId::new(1, number)
}

fn shortened(name: &str) -> String {
    name.chars().take(NAME_CHARS_MAX).collect()
}
