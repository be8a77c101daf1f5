//! Places of peers that have not signed in yet: bounded for each address and in all.
//!
//! A peer that only waits makes room for one that comes: where all places of an address are taken,
//! the oldest goes, and where all places of the broker are, the oldest of the address that holds
//! most. An address that holds fewer places than another one never waits for it: so a peer that signs
//! in without delay is served while others hold as many places as they can, and come again at once.

use std::{
    cmp::Reverse,
    collections::{HashMap, VecDeque},
    net::{IpAddr, Ipv6Addr},
    sync::Arc,
    time::{Duration, Instant},
};

use parking_lot::Mutex;
use tokio_util::sync::CancellationToken;

/// Time in which nobody has to make room for a peer whose address holds as many places: an honest peer
/// signs in within it, also when many of one address come at once. The shorter it is, the more of those
/// that come find a place while others only wait.
const GRACE: Duration = Duration::from_millis(100);

/// Places of one broker.
pub(crate) struct WaitingRoom {
    in_all_max: usize,
    per_address_max: usize,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    /// Waiting peers by [`network`], the oldest first.
    waiting: HashMap<IpAddr, VecDeque<Waiting>>,
    in_all: usize,
    next_id: u64,
}

struct Waiting {
    id: u64,
    since: Instant,
    displaced: CancellationToken,
}

/// Place of one peer, given back when dropped.
pub(crate) struct Place {
    room: Arc<WaitingRoom>,
    network: IpAddr,
    id: u64,
    /// Cancelled when the peer has to make room.
    pub displaced: CancellationToken,
}

/// Bound that leaves no place to a peer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Taken {
    /// All places of the peer's address are taken by peers who have just come.
    Address,
    /// All places of the broker are.
    InAll,
}

impl WaitingRoom {
    pub(crate) fn new(in_all_max: usize, per_address_max: usize) -> Self {
        Self { in_all_max, per_address_max, state: Mutex::default() }
    }

    /// Gives a place to a peer that has connected at `now`.
    pub(crate) fn enter(self: &Arc<Self>, peer: IpAddr, now: Instant) -> Result<Place, Taken> {
        let network = network(peer);
        let mut state = self.state.lock();
        let of_address = state.waiting.get(&network).map_or(0, VecDeque::len);
        if of_address >= self.per_address_max && !state.displace_oldest(network, GRACE, now) {
            return Err(Taken::Address);
        }
        if state.in_all >= self.in_all_max {
            let (largest, count) = state.largest().ok_or(Taken::InAll)?;
            let grace = if count > of_address + 1 { Duration::ZERO } else { GRACE };
            if !state.displace_oldest(largest, grace, now) {
                return Err(Taken::InAll);
            }
        }
        let id = state.next_id;
        state.next_id += 1;
        state.in_all += 1;
        let displaced = CancellationToken::new();
        state.waiting.entry(network).or_default().push_back(Waiting {
            id,
            since: now,
            displaced: displaced.clone(),
        });
        Ok(Place { room: Arc::clone(self), network, id, displaced })
    }
}

impl State {
    /// Returns the network with the most places, and their number; of several the one whose oldest
    /// peer has waited longest.
    fn largest(&self) -> Option<(IpAddr, usize)> {
        let key = |of_one: &VecDeque<Waiting>| {
            (of_one.len(), of_one.front().map(|oldest| Reverse(oldest.since)))
        };
        let largest = self.waiting.iter().max_by_key(|(_, of_one)| key(of_one));
        largest.map(|(network, of_one)| (*network, of_one.len()))
    }

    /// Takes the place of the oldest peer of a network; false while it is in its time of grace.
    fn displace_oldest(&mut self, network: IpAddr, grace: Duration, now: Instant) -> bool {
        let Some(of_one) = self.waiting.get_mut(&network) else { return false };
        let is_due = |oldest: &Waiting| now.saturating_duration_since(oldest.since) >= grace;
        if !of_one.front().is_some_and(is_due) {
            return false;
        }
        if let Some(oldest) = of_one.pop_front() {
            oldest.displaced.cancel();
            self.in_all -= 1;
        }
        if of_one.is_empty() {
            self.waiting.remove(&network);
        }
        true
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut state = self.room.state.lock();
        let Some(of_one) = state.waiting.get_mut(&self.network) else { return };
        // Not there when it was displaced.
        let Some(at) = of_one.iter().position(|waiting| waiting.id == self.id) else { return };
        of_one.remove(at);
        if of_one.is_empty() {
            state.waiting.remove(&self.network);
        }
        state.in_all -= 1;
    }
}

/// Returns what counts as one address: an IPv4 address, or the 64 bits of an IPv6 address that name
/// a network, since every host has all addresses of one.
pub(crate) fn network(peer: IpAddr) -> IpAddr {
    match peer.to_canonical() {
        IpAddr::V6(address) => {
            let [a, b, c, d, ..] = address.segments();
            IpAddr::V6(Ipv6Addr::new(a, b, c, d, 0, 0, 0, 0))
        }
        v4 @ IpAddr::V4(_) => v4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(last: u8) -> IpAddr {
        IpAddr::from([10, 0, 0, last])
    }

    #[test]
    fn an_ipv6_network_counts_as_one_address() {
        let ip = |text: &str| text.parse::<IpAddr>().expect("an address");
        assert_eq!(network(ip("2001:db8:1:2::1")), network(ip("2001:db8:1:2:ffff::9")));
        assert_ne!(network(ip("2001:db8:1:2::1")), network(ip("2001:db8:1:3::1")));
        assert_eq!(network(ip("::ffff:10.0.0.1")), ip("10.0.0.1"));
        assert_ne!(network(ip("10.0.0.1")), network(ip("10.0.0.2")));
    }

    #[test]
    fn the_oldest_of_an_address_makes_room_after_its_grace() {
        let room = Arc::new(WaitingRoom::new(100, 2));
        let start = Instant::now();
        let first = room.enter(address(1), start).expect("a place");
        let second = room.enter(address(1), start + GRACE / 2).expect("a place");
        assert_eq!(room.enter(address(1), start + GRACE / 2).err(), Some(Taken::Address));
        let other = room.enter(address(2), start + GRACE / 2).expect("a place of its own");
        let third = room.enter(address(1), start + GRACE).expect("the oldest makes room");
        assert!(first.displaced.is_cancelled());
        assert!(!second.displaced.is_cancelled() && !other.displaced.is_cancelled());
        drop((first, second, third, other));
        let state = room.state.lock();
        assert_eq!((state.in_all, state.waiting.len()), (0, 0));
    }

    #[test]
    fn the_address_with_most_places_makes_room_when_all_is_full() {
        let room = Arc::new(WaitingRoom::new(4, 3));
        let start = Instant::now();
        let many: Vec<_> =
            (0..3).map(|_| room.enter(address(1), start).expect("a place")).collect();
        let one = room.enter(address(2), start).expect("a place");
        let _first = room.enter(address(3), start).expect("a place that it need not wait for");
        assert!(many[0].displaced.is_cancelled());
        assert!(!many[1].displaced.is_cancelled() && !one.displaced.is_cancelled());
    }

    #[test]
    fn addresses_with_as_many_places_wait_for_each_other() {
        let room = Arc::new(WaitingRoom::new(2, 2));
        let start = Instant::now();
        let soon = start + GRACE / 2;
        let first = room.enter(address(1), start).expect("a place");
        let second = room.enter(address(2), soon).expect("a place");
        assert_eq!(room.enter(address(3), soon).err(), Some(Taken::InAll));
        let _again = room.enter(address(1), start + GRACE).expect("its own oldest is due");
        let _third = room.enter(address(3), soon + GRACE).expect("the place of the oldest");
        assert!(first.displaced.is_cancelled() && second.displaced.is_cancelled());
    }

    #[test]
    fn who_signs_in_at_once_is_served_beside_a_flood_that_comes_again_at_once() {
        let room = Arc::new(WaitingRoom::new(64, 16));
        let start = Instant::now();
        let mut flood: Vec<_> = (0..64).map(|n| room.enter(address(n % 8), start).ok()).collect();
        for (turn, micros) in (0..2_000_u64).map(|n| (n, n * 50)) {
            let now = start + Duration::from_micros(micros);
            let honest = room.enter(address(200), now).expect("a place");
            let place = usize::try_from(turn % 64).expect("small");
            flood[place] = room.enter(address(u8::try_from(turn % 8).expect("small")), now).ok();
            assert!(!honest.displaced.is_cancelled());
        }
    }

    #[test]
    fn a_place_is_given_back() {
        let room = Arc::new(WaitingRoom::new(1, 1));
        let now = Instant::now();
        drop(room.enter(address(1), now).expect("a place"));
        assert!(room.enter(address(1), now).is_ok());
    }
}
