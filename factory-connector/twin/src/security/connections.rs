//! Limits on connections: in total and from one address, and among them on those without a session, which anybody can
//! open. Beyond the limits a new connection takes the place of the oldest one whose client is not known yet, of the
//! address that has most of them, so that silent connections keep no honest client out.

use std::{
    cmp::Reverse,
    collections::{BTreeSet, HashMap},
    net::{IpAddr, Ipv6Addr, SocketAddr},
    sync::Arc,
};

use opcua_stack::opcua::server::{ConnectionFilter, ConnectionPermit};
use parking_lot::Mutex;
use tokio_util::sync::CancellationToken;

use crate::config::TwinLimits;

/// Admits connections up to the limits.
pub(crate) struct ConnectionLimits {
    open: Arc<Mutex<OpenConnections>>,
}

impl ConnectionLimits {
    /// Creates a filter without open connections.
    pub fn new(limits: &TwinLimits) -> Self {
        Self { open: Arc::new(Mutex::new(OpenConnections::new(limits))) }
    }
}

impl ConnectionFilter for ConnectionLimits {
    fn admit(
        &self,
        peer: SocketAddr,
        close: &CancellationToken,
    ) -> Option<Arc<dyn ConnectionPermit>> {
        let address = network_of(peer.ip());
        let mut open = self.open.lock();
        let admission = open.admit(address, close.clone());
        let limit = match &admission {
            Admission::Admitted { .. } => None,
            Admission::InPlaceOfAnother { limit, .. } | Admission::Refused { limit } => {
                Some(*limit)
            }
        };
        if let Some(limit) = limit {
            metrics::counter!("twin_connections_refused_total", "limit" => limit).increment(1);
            tracing::warn!(peer.address = %address, limit, "The twin closed a connection beyond its limit.");
        }
        match admission {
            Admission::Admitted { id } | Admission::InPlaceOfAnother { id, .. } => {
                Some(Arc::new(Permit { id, open: Arc::clone(&self.open) }))
            }
            Admission::Refused { .. } => None,
        }
    }
}

/// The address that limits count: of IPv6 the network of one customer, within which addresses are free.
pub(crate) fn network_of(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => {
            IpAddr::V6(Ipv6Addr::from_bits(address.to_bits() & (u128::MAX << 64)))
        }
        address @ IpAddr::V4(_) => address,
    }
}

/// Counts one connection while it is open.
struct Permit {
    id: u64,
    open: Arc<Mutex<OpenConnections>>,
}

impl ConnectionPermit for Permit {
    fn session_activated(&self) {
        self.open.lock().session_activated(self.id);
    }
}

impl Drop for Permit {
    fn drop(&mut self) {
        self.open.lock().closed(self.id);
    }
}

#[derive(Debug)]
enum Admission {
    Admitted {
        id: u64,
    },
    /// Another connection was closed for it.
    InPlaceOfAnother {
        id: u64,
        limit: &'static str,
    },
    Refused {
        limit: &'static str,
    },
}

/// The open connections of each address.
struct OpenConnections {
    total_max: usize,
    per_address_max: usize,
    unknown_max: usize,
    next_id: u64,
    by_id: HashMap<u64, Connection>,
    by_address: HashMap<IpAddr, OfAddress>,
    /// Connections without a session.
    unknown: usize,
}

struct Connection {
    address: IpAddr,
    close: CancellationToken,
}

/// Connections of one address.
#[derive(Default)]
struct OfAddress {
    /// Number of those on which a session was activated once.
    known: usize,
    /// All others, the oldest first.
    unknown: BTreeSet<u64>,
}

impl OpenConnections {
    fn new(limits: &TwinLimits) -> Self {
        Self {
            total_max: limits.connections_max,
            per_address_max: limits.connections_per_address_max,
            // The other half stays for clients that signed in.
            unknown_max: limits.connections_max.div_ceil(2),
            next_id: 0,
            by_id: HashMap::new(),
            by_address: HashMap::new(),
            unknown: 0,
        }
    }

    fn admit(&mut self, address: IpAddr, close: CancellationToken) -> Admission {
        let here = self.by_address.get(&address);
        let (limit, victim) = if here.is_some_and(|here| here.count() >= self.per_address_max) {
            (Some("address"), here.and_then(OfAddress::oldest_unknown))
        } else if self.by_id.len() >= self.total_max {
            (Some("total"), self.oldest_unknown_of_busiest())
        } else if self.unknown >= self.unknown_max {
            (Some("unknown"), self.oldest_unknown_of_busiest())
        } else {
            (None, None)
        };
        let Some(limit) = limit else {
            return Admission::Admitted { id: self.insert(address, close) };
        };
        // At once, and not when its task has ended: that would let in more than the limit.
        let Some(victim) = victim.and_then(|id| self.closed(id)) else {
            return Admission::Refused { limit };
        };
        victim.close.cancel();
        Admission::InPlaceOfAnother { id: self.insert(address, close), limit }
    }

    fn insert(&mut self, address: IpAddr, close: CancellationToken) -> u64 {
        let id = self.next_id;
        self.next_id += 1;
        self.by_id.insert(id, Connection { address, close });
        self.by_address.entry(address).or_default().unknown.insert(id);
        self.unknown += 1;
        id
    }

    fn session_activated(&mut self, id: u64) {
        let Some(connection) = self.by_id.get(&id) else { return };
        if let Some(here) = self.by_address.get_mut(&connection.address)
            && here.unknown.remove(&id)
        {
            here.known += 1;
            self.unknown -= 1;
        }
    }

    fn closed(&mut self, id: u64) -> Option<Connection> {
        let connection = self.by_id.remove(&id)?;
        if let Some(here) = self.by_address.get_mut(&connection.address) {
            if here.unknown.remove(&id) {
                self.unknown -= 1;
            } else {
                here.known -= 1;
            }
            if here.count() == 0 {
                self.by_address.remove(&connection.address);
            }
        }
        Some(connection)
    }

    /// The address with the most unknown connections gives way, and not who came first. Of several it is the one whose
    /// oldest has waited longest.
    fn oldest_unknown_of_busiest(&self) -> Option<u64> {
        let oldest = self.by_address.values().filter_map(|here| {
            here.oldest_unknown().map(|oldest| (here.unknown.len(), Reverse(oldest)))
        });
        oldest.max().map(|(_, Reverse(oldest))| oldest)
    }
}

impl OfAddress {
    fn count(&self) -> usize {
        self.known + self.unknown.len()
    }

    fn oldest_unknown(&self) -> Option<u64> {
        self.unknown.first().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peer(host: u8) -> SocketAddr {
        SocketAddr::from(([10, 0, 0, host], 5000))
    }

    fn filter(connections_max: usize, connections_per_address_max: usize) -> ConnectionLimits {
        ConnectionLimits::new(&TwinLimits {
            connections_max,
            connections_per_address_max,
            ..TwinLimits::default()
        })
    }

    /// Connects; whether the connection is open.
    struct Client(Option<Arc<dyn ConnectionPermit>>, CancellationToken);

    impl Client {
        fn new(filter: &ConnectionLimits, host: u8) -> Self {
            let close = CancellationToken::new();
            Self(filter.admit(peer(host), &close), close)
        }

        fn known(filter: &ConnectionLimits, host: u8) -> Self {
            let client = Self::new(filter, host);
            client.0.as_ref().expect("admitted").session_activated();
            client
        }

        fn is_open(&self) -> bool {
            self.0.is_some() && !self.1.is_cancelled()
        }
    }

    #[test]
    fn known_clients_are_refused_at_a_limit_until_one_is_closed() {
        let filter = filter(3, 2);
        let first = Client::known(&filter, 1);
        let second = Client::known(&filter, 1);
        assert!(!Client::new(&filter, 1).is_open(), "two from one address");
        let third = Client::known(&filter, 2);
        assert!(!Client::new(&filter, 3).is_open(), "three in total");
        drop(first);
        assert!(Client::new(&filter, 3).is_open());
        assert!(second.is_open() && third.is_open());
    }

    #[test]
    fn a_new_connection_takes_the_place_of_the_oldest_silent_one_of_the_busiest_address() {
        let filter = filter(8, 8);
        let known = Client::known(&filter, 1);
        let quiet = Client::new(&filter, 2);
        let flood: Vec<_> = (0..40).map(|_| Client::new(&filter, 3)).collect();
        let honest = Client::new(&filter, 4);
        assert!(known.is_open() && quiet.is_open() && honest.is_open());
        let open: Vec<_> =
            flood.iter().enumerate().filter(|(_, one)| one.is_open()).map(|(at, _)| at).collect();
        assert_eq!(open, [38, 39], "the newest of the flood, and half of the room is for others");
    }

    #[test]
    fn of_addresses_with_as_many_the_one_that_came_first_makes_room() {
        let filter = filter(8, 8);
        let all: Vec<_> = (0..8).map(|host| Client::new(&filter, host)).collect();
        let open: Vec<_> = all.iter().map(Client::is_open).collect();
        assert_eq!(open, [false, false, false, false, true, true, true, true]);
    }

    #[test]
    fn what_ends_is_counted_no_longer() {
        let filter = filter(4, 4);
        let (silent, known) = (Client::new(&filter, 1), Client::known(&filter, 1));
        drop((silent, known));
        let open = filter.open.lock();
        assert!(open.by_id.is_empty() && open.by_address.is_empty());
        assert_eq!(open.unknown, 0);
    }

    #[test]
    fn an_address_that_is_full_makes_room_in_itself_only() {
        let filter = filter(100, 2);
        let (other, first) = (Client::new(&filter, 1), Client::new(&filter, 2));
        let second = Client::known(&filter, 2);
        let third = Client::new(&filter, 2);
        assert!(other.is_open() && !first.is_open() && second.is_open() && third.is_open());
    }

    #[test]
    fn addresses_of_one_network_count_together() {
        let (a, b) = ("2001:db8:1:2::1", "2001:db8:1:2:ffff::9");
        let parsed = |text: &str| network_of(text.parse().expect("an address"));
        assert_eq!(parsed(a), parsed(b));
        assert_ne!(parsed(a), parsed("2001:db8:1:3::1"));
        assert_eq!(parsed("::ffff:10.0.0.7"), parsed("10.0.0.7"));
    }
}
