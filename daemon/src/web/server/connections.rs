//! Connections of a server: places for them, and the choice of those that give theirs up.

use std::{
    cmp::Reverse,
    collections::HashMap,
    net::IpAddr,
    sync::Arc,
    time::{Duration, Instant},
};

use parking_lot::Mutex;
use tokio_util::sync::CancellationToken;

use super::limits::ListenerLimits;
use crate::web::address_range::AddressRange;

/// Time in which a body should come, or an answer be taken, when places are short.
const SHORTAGE_PATIENCE: Duration = Duration::from_secs(2);

/// All connections of a server.
pub(super) struct Connections {
    limits: ListenerLimits,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    entries: HashMap<u64, Entry>,
    /// Numbers of the entries of each client.
    by_client: HashMap<AddressRange, usize>,
    last_id: u64,
}

struct Entry {
    client: AddressRange,
    /// True where many clients are behind its address.
    is_shared: bool,
    activity: Activity,
    close: CancellationToken,
}

/// Present activity of a connection. Clones share it.
#[derive(Debug, Clone)]
pub(super) struct Activity(Arc<Mutex<Phase>>);

#[derive(Debug, Clone, Copy)]
enum Phase {
    /// Waiting for a TLS handshake or for the head of a request.
    Waiting(Instant),
    /// Receiving the body of a request.
    Receiving(Instant),
    /// Working on a request, or sending its answer.
    Answering(Instant),
    /// The client does not take its answer, which began before.
    Stalled { since: Instant, begun: Instant },
}

/// A place that ends when this is dropped.
pub(super) struct Admitted {
    connections: Arc<Connections>,
    id: u64,
    pub activity: Activity,
    /// Cancelled when the place goes to another.
    pub close: CancellationToken,
}

impl Connections {
    pub(super) fn new(limits: ListenerLimits) -> Arc<Self> {
        Arc::new(Self { limits, state: Mutex::default() })
    }

    pub(super) const fn limits(&self) -> &ListenerLimits {
        &self.limits
    }

    /// Gives a new connection a place, if need be that of one which asks for nothing. `None` where all
    /// are busy.
    pub(super) fn admit(self: &Arc<Self>, peer: IpAddr) -> Option<Admitted> {
        let client = AddressRange::of_client(peer);
        let is_shared = self.limits.shared_addresses.iter().any(|range| range.contains(peer));
        if self.limits.only_shared && !is_shared && !peer.to_canonical().is_loopback() {
            count_refused("no-proxy");
            return None;
        }
        let mut state = self.state.lock();
        if !is_shared
            && state.of_client(client) >= self.limits.connections_per_client_max
            && !state.evict(|entry| entry.client == client)
        {
            count_refused("client");
            return None;
        }
        if state.entries.len() >= self.limits.connections_max
            && !state.evict(|_| true)
            && (is_shared || !state.evict_unfair(client, self.limits.connections_max))
        {
            count_refused("total");
            return None;
        }
        state.last_id += 1;
        let id = state.last_id;
        let activity = Activity(Arc::new(Mutex::new(Phase::Waiting(Instant::now()))));
        let close = CancellationToken::new();
        let entry = Entry { client, is_shared, activity: activity.clone(), close: close.clone() };
        state.insert(id, entry);
        show_number(state.entries.len());
        Some(Admitted { connections: Arc::clone(self), id, activity, close })
    }
}

impl State {
    fn insert(&mut self, id: u64, entry: Entry) {
        *self.by_client.entry(entry.client).or_default() += 1;
        self.entries.insert(id, entry);
        show_number(self.entries.len());
    }

    fn remove(&mut self, id: u64) -> Option<Entry> {
        let entry = self.entries.remove(&id)?;
        if let Some(count) = self.by_client.get_mut(&entry.client) {
            *count -= 1;
            if *count == 0 {
                self.by_client.remove(&entry.client);
            }
        }
        show_number(self.entries.len());
        Some(entry)
    }

    fn of_client(&self, client: AddressRange) -> usize {
        self.by_client.get(&client).copied().unwrap_or_default()
    }

    /// Closes a connection of those that `may_go` and keep the server waiting: of the client that has
    /// most connections, the one that has waited longest. False where all are busy.
    fn evict(&mut self, may_go: impl Fn(&Entry) -> bool) -> bool {
        let now = Instant::now();
        let idle =
            self.entries.iter().filter(|(_, entry)| may_go(entry)).filter_map(|(id, entry)| {
                let since = entry.activity.idle_since(now)?;
                // Behind a proxy, each may be a client of its own.
                let count = if entry.is_shared { 1 } else { self.of_client(entry.client) };
                Some(((count, Reverse(since)), *id))
            });
        let Some((_, id)) = idle.max() else { return false };
        if let Some(entry) = self.remove(id) {
            entry.close.cancel();
            count_refused("displaced");
        }
        true
    }
}

impl State {
    /// Closes a connection that is busy, for a client that has less than a fair part of all places: of
    /// those with more than that the one that has been busy longest. A client that reads its answers
    /// slowly enough is busy for ever. False where nobody has more than a fair part.
    fn evict_unfair(&mut self, newcomer: AddressRange, connections_max: usize) -> bool {
        let is_new = usize::from(!self.by_client.contains_key(&newcomer));
        let fair_part = connections_max / (self.by_client.len() + is_new).max(1);
        if self.of_client(newcomer) >= fair_part {
            return false;
        }
        let busy =
            self.entries.iter().filter(|(_, entry)| !entry.is_shared).filter_map(|(id, entry)| {
                let count = self.of_client(entry.client);
                (count > fair_part).then(|| ((count, Reverse(entry.activity.begun())), *id))
            });
        let Some((_, id)) = busy.max() else { return false };
        if let Some(entry) = self.remove(id) {
            entry.close.cancel();
            count_refused("unfair");
        }
        true
    }
}

impl Activity {
    pub(super) fn waits(&self) {
        *self.0.lock() = Phase::Waiting(Instant::now());
    }

    pub(super) fn receives(&self) {
        *self.0.lock() = Phase::Receiving(Instant::now());
    }

    pub(super) fn answers(&self) {
        *self.0.lock() = Phase::Answering(Instant::now());
    }

    /// The body was received, or nobody reads on.
    pub(super) fn received(&self) {
        let mut phase = self.0.lock();
        if matches!(*phase, Phase::Receiving(_)) {
            *phase = Phase::Answering(Instant::now());
        }
    }

    pub(super) fn stalls(&self) {
        let mut phase = self.0.lock();
        if let Phase::Answering(begun) = *phase {
            *phase = Phase::Stalled { since: Instant::now(), begun };
        }
    }

    pub(super) fn goes_on(&self) {
        let mut phase = self.0.lock();
        if let Phase::Stalled { begun, .. } = *phase {
            *phase = Phase::Answering(begun);
        }
    }

    /// Returns the time at which the present request or wait began.
    fn begun(&self) -> Instant {
        match *self.0.lock() {
            Phase::Waiting(begun) | Phase::Receiving(begun) | Phase::Answering(begun) => begun,
            Phase::Stalled { begun, .. } => begun,
        }
    }

    /// Returns the time since when the client has kept the server waiting; `None` where it does not.
    fn idle_since(&self, now: Instant) -> Option<Instant> {
        match *self.0.lock() {
            Phase::Waiting(since) => Some(since),
            Phase::Receiving(since) | Phase::Stalled { since, .. } => {
                (now.saturating_duration_since(since) > SHORTAGE_PATIENCE).then_some(since)
            }
            Phase::Answering(_) => None,
        }
    }
}

impl Drop for Admitted {
    fn drop(&mut self) {
        self.connections.state.lock().remove(self.id);
    }
}

/// Counts a connection that was not served, or no longer, by its reason.
pub(super) fn count_refused(reason: &'static str) {
    metrics::counter!("verbund_http_connections_refused_total", "reason" => reason).increment(1);
}

#[expect(clippy::cast_precision_loss, reason = "a thousand connections at most")]
fn show_number(connections: usize) {
    metrics::gauge!("verbund_http_connections").set(connections as f64);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn connections() -> Arc<Connections> {
        let shared_addresses = vec!["10.0.0.1".parse().expect("a range")];
        Connections::new(ListenerLimits {
            connections_max: 4,
            connections_per_client_max: 2,
            shared_addresses,
            ..ListenerLimits::default()
        })
    }

    fn peer(last: u8) -> IpAddr {
        IpAddr::from([10, 0, 0, last])
    }

    #[test]
    fn who_waits_longest_gives_way() {
        let connections = connections();
        let first = connections.admit(peer(2)).expect("a place");
        let second = connections.admit(peer(2)).expect("a place");
        first.activity.answers();
        let third = connections.admit(peer(2)).expect("the second one's place");
        assert!(second.close.is_cancelled() && !first.close.is_cancelled());
        third.activity.answers();
        assert!(connections.admit(peer(2)).is_none(), "both are busy");
        first.activity.waits();
        let other = connections.admit(peer(3)).expect("a place");
        assert!(!first.close.is_cancelled(), "there is room for other clients");
        drop((other, second));
        assert_eq!(connections.state.lock().entries.len(), 2);
    }

    #[test]
    fn who_holds_most_gives_way_first() {
        let connections = connections();
        let quiet = connections.admit(peer(4)).expect("a place");
        let first = connections.admit(peer(2)).expect("a place");
        let second = connections.admit(peer(2)).expect("a place");
        let other = connections.admit(peer(3)).expect("a place");
        let honest = connections.admit(peer(5)).expect("a place");
        assert!(first.close.is_cancelled(), "the older one of the two");
        for kept in [&quiet, &second, &other, &honest] {
            assert!(!kept.close.is_cancelled());
        }
        drop((quiet, first, second, other, honest));
        let state = connections.state.lock();
        assert!(state.entries.is_empty() && state.by_client.is_empty());
    }

    #[test]
    fn slow_readers_with_more_than_a_fair_part_leave_a_place() {
        let connections = connections();
        let slow: Vec<_> = [2, 2, 3, 3]
            .map(|last| {
                let admitted = connections.admit(peer(last)).expect("a place");
                admitted.activity.answers();
                admitted
            })
            .into();
        slow[0].activity.stalls();
        slow[0].activity.goes_on();
        let honest = connections.admit(peer(4)).expect("a place");
        honest.activity.answers();
        let closed: Vec<_> = slow.iter().map(|one| one.close.is_cancelled()).collect();
        assert!(closed[0] || closed[2], "one that has been busy longest: {closed:?}");
        assert_eq!(closed.iter().filter(|closed| **closed).count(), 1);
        assert!(connections.admit(peer(4)).is_none(), "it has its fair part");
        let other = connections.admit(peer(5)).expect("a place of the other client");
        other.activity.answers();
        assert!(!honest.close.is_cancelled());
        assert!(connections.admit(peer(6)).is_none(), "nobody has more than a fair part");
    }

    #[test]
    fn who_goes_round_the_proxy_is_not_served() {
        let shared_addresses = vec!["10.0.0.1".parse().expect("a range")];
        let limits =
            ListenerLimits { shared_addresses, only_shared: true, ..ListenerLimits::default() };
        let connections = Connections::new(limits);
        assert!(connections.admit(peer(1)).is_some());
        assert!(connections.admit(IpAddr::from([127, 0, 0, 1])).is_some());
        assert!(connections.admit(peer(2)).is_none());
        let mapped: IpAddr = "::ffff:10.0.0.2".parse().expect("an address");
        assert!(connections.admit(mapped).is_none());
    }

    #[test]
    fn behind_a_proxy_only_the_whole_is_bounded() {
        let connections = connections();
        let proxied: Vec<_> = (0..4).map(|_| connections.admit(peer(1)).expect("room")).collect();
        for one in &proxied {
            one.activity.answers();
        }
        assert!(connections.admit(peer(1)).is_none());
        drop(proxied);
        assert!(connections.admit(peer(1)).is_some());
    }

    #[test]
    fn slow_bodies_and_stalled_answers_give_way_after_a_while() {
        let connections = connections();
        let one = connections.admit(peer(2)).expect("a place");
        let soon = Instant::now();
        let later = soon + SHORTAGE_PATIENCE + Duration::from_secs(1);
        one.activity.receives();
        assert!(
            one.activity.idle_since(soon).is_none() && one.activity.idle_since(later).is_some()
        );
        one.activity.received();
        assert!(one.activity.idle_since(later).is_none());
        one.activity.stalls();
        assert!(one.activity.idle_since(later).is_some());
        one.activity.goes_on();
        assert!(one.activity.idle_since(later).is_none());
    }
}
