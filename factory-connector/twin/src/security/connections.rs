//! Limits on connections: in total and from one address, so that one misbehaving client does not
//! block the others.

use std::{
    any::Any,
    collections::HashMap,
    net::{IpAddr, SocketAddr},
    sync::Arc,
};

use opcua_stack::opcua::server::ConnectionFilter;
use parking_lot::Mutex;

use crate::config::TwinLimits;

/// Admits connections up to the limits.
pub(crate) struct ConnectionLimits {
    total_max: usize,
    per_address_max: usize,
    open: Arc<Mutex<HashMap<IpAddr, usize>>>,
}

impl ConnectionLimits {
    /// Creates a filter without open connections.
    pub fn new(limits: &TwinLimits) -> Self {
        Self {
            total_max: limits.connections_max,
            per_address_max: limits.connections_per_address_max,
            open: Arc::default(),
        }
    }
}

impl ConnectionFilter for ConnectionLimits {
    fn admit(&self, peer: SocketAddr) -> Option<Box<dyn Any + Send>> {
        let address = peer.ip().to_canonical();
        let mut open = self.open.lock();
        let (total, from_here) =
            (open.values().sum::<usize>(), open.get(&address).copied().unwrap_or(0));
        let limit = match () {
            () if total >= self.total_max => "total",
            () if from_here >= self.per_address_max => "address",
            () => {
                open.insert(address, from_here + 1);
                return Some(Box::new(Permit { address, open: Arc::clone(&self.open) }));
            }
        };
        metrics::counter!("twin_connections_refused_total", "limit" => limit).increment(1);
        tracing::warn!(peer.address = %address, limit, "The twin refused a connection beyond its limit.");
        None
    }
}

/// Counts one connection while it is open.
struct Permit {
    address: IpAddr,
    open: Arc<Mutex<HashMap<IpAddr, usize>>>,
}

impl Drop for Permit {
    fn drop(&mut self) {
        let mut open = self.open.lock();
        if let Some(count) = open.get_mut(&self.address) {
            *count -= 1;
            if *count == 0 {
                open.remove(&self.address);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn connections_are_refused_at_a_limit_until_one_is_closed() {
        let limits = TwinLimits {
            connections_max: 3,
            connections_per_address_max: 2,
            ..TwinLimits::default()
        };
        let filter = ConnectionLimits::new(&limits);
        let peer = |host: u8| SocketAddr::from(([10, 0, 0, host], 5000));
        let first = filter.admit(peer(1));
        let second = filter.admit(peer(1));
        assert!(first.is_some() && second.is_some());
        assert!(filter.admit(peer(1)).is_none(), "two from one address");
        let third = filter.admit(peer(2));
        assert!(third.is_some());
        assert!(filter.admit(peer(3)).is_none(), "three in total");
        drop(first);
        assert!(filter.admit(peer(3)).is_some());
    }
}
