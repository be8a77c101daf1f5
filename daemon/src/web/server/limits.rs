//! Bounds of a web server on what any caller can claim.

use std::time::Duration;

use crate::web::address_range::AddressRange;

/// Bounds on connections and on the patience with them.
#[derive(Debug, Clone)]
pub struct ListenerLimits {
    /// Connections at once. One more takes the place of the one that has waited longest without asking
    /// for anything.
    pub connections_max: usize,
    /// Share of one client: an address of IPv4, or a /64 of IPv6.
    pub connections_per_client_max: usize,
    /// Addresses without that bound: proxies, behind which many clients are.
    pub shared_addresses: Vec<AddressRange>,
    /// True where these, and this machine itself, are served alone: a client that goes round the proxy
    /// would speak without TLS.
    pub only_shared: bool,
    /// Longest TLS handshake.
    pub handshake_timeout: Duration,
    /// Longest time between an answer, or the beginning of a connection, and the end of the next
    /// request's head. So long may a connection be idle, too.
    pub head_timeout: Duration,
    /// Patience with the body of a request: time that may pass in waiting for it. Each KiB gives a
    /// quarter of a second back.
    pub body_patience: Duration,
    /// Patience with a client that does not take its answer, likewise.
    pub answer_patience: Duration,
}

impl Default for ListenerLimits {
    fn default() -> Self {
        Self {
            connections_max: 1024,
            connections_per_client_max: 256,
            shared_addresses: Vec::new(),
            only_shared: false,
            handshake_timeout: Duration::from_secs(10),
            head_timeout: Duration::from_secs(20),
            body_patience: Duration::from_secs(15),
            answer_patience: Duration::from_secs(30),
        }
    }
}

/// Most bytes of a request's head: line and header fields. Cookies of other programs on the same host
/// are in it.
pub(super) const HEAD_BYTES_MAX: usize = 32 * 1024;
/// Most bytes read ahead or waiting to be written, per connection.
pub(super) const BUFFER_BYTES_MAX: usize = 64 * 1024;
/// Time that a byte of progress gives back. The bound is on rates below 4 KiB a second.
pub(super) const PATIENCE_PER_BYTE: Duration = Duration::from_nanos(250_000_000 / 1024);
