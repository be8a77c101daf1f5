//! Shares of clients in what the server holds for them. What one client uses up, the others do not feel.

use std::{
    collections::HashMap,
    fmt,
    net::{IpAddr, SocketAddr},
    sync::{
        atomic::{AtomicUsize, Ordering},
        Arc, Weak,
    },
};

use opcua_core::sync::Mutex;
use opcua_crypto::X509;
use opcua_types::StatusCode;

use crate::{authenticator::UserToken, ClientLimits, SessionObserver};

/// Identity by which clients are told apart for their shares.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum ClientKey {
    /// A user, by its token.
    User(String),
    /// An anonymous user, by the thumbprint of its certificate.
    Certificate(String),
    /// An anonymous user without a certificate, by its address where that is known.
    Address(Option<IpAddr>),
}

impl ClientKey {
    /// The key of a session: its user, and for want of one what else is known.
    pub(crate) fn new(
        user: &UserToken,
        certificate: Option<&X509>,
        address: Option<SocketAddr>,
    ) -> Self {
        match certificate {
            _ if !user.is_anonymous() => Self::User(user.0.clone()),
            Some(certificate) => Self::Certificate(certificate.thumbprint().as_hex_string()),
            None => Self::Address(address.map(|address| address.ip())),
        }
    }
}

/// Resource of the server that clients have shares of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SharedResource {
    /// Activated sessions.
    Sessions,
    /// Subscriptions, those whose session is gone included.
    Subscriptions,
    /// Monitored items of all subscriptions.
    MonitoredItems,
    /// Values in queues of monitored items beyond the newest one of each, in notifications that wait for a publish request,
    /// and in those that were not acknowledged.
    QueuedValues,
    /// Continuation points of Browse.
    ContinuationPoints,
    /// Requests in progress but those for publishing, which each session has its own bound of.
    Requests,
    /// Bytes of requests that were not received completely or are in progress.
    RequestBytes,
    /// Bytes of responses that the client does not take.
    ResponseBytes,
}

/// Number of [`SharedResource`]s.
const RESOURCES: usize = 8;

impl SharedResource {
    /// A name for metrics.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sessions => "sessions",
            Self::Subscriptions => "subscriptions",
            Self::MonitoredItems => "monitored_items",
            Self::QueuedValues => "queued_values",
            Self::ContinuationPoints => "continuation_points",
            Self::Requests => "requests",
            Self::RequestBytes => "request_bytes",
            Self::ResponseBytes => "response_bytes",
        }
    }

    /// The answer to a client whose share is used up.
    pub(crate) fn refusal(self) -> StatusCode {
        match self {
            Self::Sessions => StatusCode::BadTooManySessions,
            Self::Subscriptions => StatusCode::BadTooManySubscriptions,
            Self::MonitoredItems => StatusCode::BadTooManyMonitoredItems,
            Self::ContinuationPoints => StatusCode::BadNoContinuationPoints,
            Self::Requests => StatusCode::BadTooManyOperations,
            Self::QueuedValues | Self::RequestBytes | Self::ResponseBytes => {
                StatusCode::BadTcpNotEnoughResources
            }
        }
    }

    fn limit(self, limits: &ClientLimits) -> usize {
        match self {
            Self::Sessions => limits.max_sessions,
            Self::Subscriptions => limits.max_subscriptions,
            Self::MonitoredItems => limits.max_monitored_items,
            Self::QueuedValues => limits.max_queued_values,
            Self::ContinuationPoints => limits.max_continuation_points,
            Self::Requests => limits.max_requests,
            Self::RequestBytes => limits.max_request_bytes,
            Self::ResponseBytes => limits.max_response_bytes,
        }
    }
}

/// The shares of all clients that hold something.
pub(crate) struct ClientShares {
    limits: ClientLimits,
    all: Arc<Total>,
    observer: Option<Arc<dyn SessionObserver>>,
    clients: Mutex<HashMap<ClientKey, Weak<ClientShare>>>,
}

impl ClientShares {
    pub(crate) fn new(
        limits: ClientLimits,
        all: ClientLimits,
        observer: Option<Arc<dyn SessionObserver>>,
    ) -> Self {
        Self {
            limits,
            all: Arc::new(Total::new(all)),
            observer,
            clients: Mutex::default(),
        }
    }

    /// The share of a client.
    pub(crate) fn of(&self, key: ClientKey) -> Arc<ClientShare> {
        let mut clients = self.clients.lock();
        if let Some(share) = clients.get(&key).and_then(Weak::upgrade) {
            return share;
        }
        clients.retain(|_, share| share.strong_count() > 0);
        let share = Arc::new(ClientShare {
            key: key.clone(),
            own: Total::new(self.limits),
            all: self.all.clone(),
            observer: self.observer.clone(),
        });
        clients.insert(key, Arc::downgrade(&share));
        share
    }
}

/// Sums of what is held, with their limits.
#[derive(Debug)]
struct Total {
    limits: ClientLimits,
    used: [AtomicUsize; RESOURCES],
}

impl Total {
    fn new(limits: ClientLimits) -> Self {
        Self {
            limits,
            used: Default::default(),
        }
    }

    fn add(&self, resource: SharedResource, amount: usize) -> bool {
        let limit = resource.limit(&self.limits);
        self.used[resource as usize]
            .fetch_update(Ordering::AcqRel, Ordering::Acquire, |used| {
                let sum = used.checked_add(amount)?;
                (limit == 0 || sum <= limit).then_some(sum)
            })
            .is_ok()
    }

    fn sub(&self, resource: SharedResource, amount: usize) {
        self.used[resource as usize].fetch_sub(amount, Ordering::AcqRel);
    }
}

/// Share of one client: its own sums, which are also part of those of all clients.
pub(crate) struct ClientShare {
    key: ClientKey,
    own: Total,
    all: Arc<Total>,
    observer: Option<Arc<dyn SessionObserver>>,
}

impl fmt::Debug for ClientShare {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ClientShare")
            .field("key", &self.key)
            .field("own", &self.own)
            .finish()
    }
}

impl ClientShare {
    /// Take some of a resource, or learn why not.
    pub(crate) fn take(
        self: &Arc<Self>,
        resource: SharedResource,
        amount: usize,
    ) -> Result<Held, StatusCode> {
        let mut held = self.none_of(resource);
        if held.resize(amount) {
            Ok(held)
        } else {
            Err(resource.refusal())
        }
    }

    /// Nothing of a resource, to be resized.
    pub(crate) fn none_of(self: &Arc<Self>, resource: SharedResource) -> Held {
        Held {
            share: self.clone(),
            resource,
            amount: 0,
        }
    }

    fn add(&self, resource: SharedResource, amount: usize) -> bool {
        let is_within_own = self.own.add(resource, amount);
        let is_added = is_within_own && self.all.add(resource, amount);
        if is_within_own && !is_added {
            self.own.sub(resource, amount);
        }
        if !is_added {
            if let Some(observer) = &self.observer {
                // A client that asks when all together have no more has not used it up.
                observer.share_exhausted((!is_within_own).then_some(&self.key), resource);
            }
        }
        is_added
    }

    fn sub(&self, resource: SharedResource, amount: usize) {
        self.own.sub(resource, amount);
        self.all.sub(resource, amount);
    }
}

/// Some of a client's share, given back when dropped.
#[derive(Debug)]
pub(crate) struct Held {
    share: Arc<ClientShare>,
    resource: SharedResource,
    amount: usize,
}

impl Held {
    pub(crate) fn share(&self) -> &Arc<ClientShare> {
        &self.share
    }

    pub(crate) fn amount(&self) -> usize {
        self.amount
    }

    /// Hold another amount. Returns false and changes nothing where the share has not as much.
    pub(crate) fn resize(&mut self, amount: usize) -> bool {
        if amount > self.amount {
            if !self.share.add(self.resource, amount - self.amount) {
                return false;
            }
        } else {
            self.share.sub(self.resource, self.amount - amount);
        }
        self.amount = amount;
        true
    }

    /// Hand a part over, at most all of it.
    pub(crate) fn split(&mut self, amount: usize) -> Self {
        let amount = amount.min(self.amount);
        self.amount -= amount;
        Self {
            share: self.share.clone(),
            resource: self.resource,
            amount,
        }
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        self.resize(0);
    }
}

#[cfg(test)]
mod tests {
    use opcua_types::NodeId;

    use super::*;
    use crate::{ChannelDescription, SessionEvent};

    fn shares(max_sessions: usize) -> ClientShares {
        let limits = ClientLimits {
            max_sessions,
            ..ClientLimits::default()
        };
        ClientShares::new(limits, ClientLimits::default(), None)
    }

    fn user(name: &str) -> ClientKey {
        ClientKey::User(name.to_owned())
    }

    #[test]
    fn what_a_client_uses_up_others_still_have() {
        let shares = shares(2);
        let (vera, otto) = (shares.of(user("vera")), shares.of(user("otto")));
        let first = vera.take(SharedResource::Sessions, 2).unwrap();
        let refused = vera.take(SharedResource::Sessions, 1).map(drop);
        assert_eq!(refused, Err(StatusCode::BadTooManySessions));
        assert!(otto.take(SharedResource::Sessions, 1).is_ok());
        // A limit of 0 is none.
        assert!(vera.take(SharedResource::Subscriptions, 1000).is_ok());
        drop(first);
        assert!(vera.take(SharedResource::Sessions, 2).is_ok());
    }

    #[test]
    fn all_clients_together_have_a_limit_that_none_of_them_keeps_from_the_others_alone() {
        let own = ClientLimits {
            max_queued_values: 3,
            ..ClientLimits::default()
        };
        let all = ClientLimits {
            max_queued_values: 5,
            ..ClientLimits::default()
        };
        let shares = ClientShares::new(own, all, None);
        let resource = SharedResource::QueuedValues;
        let (vera, otto) = (shares.of(user("vera")), shares.of(user("otto")));
        let of_vera = vera.take(resource, 3).unwrap();
        assert!(vera.take(resource, 1).is_err(), "its own share");
        let mut of_otto = otto.take(resource, 2).unwrap();
        assert!(!of_otto.resize(3), "all together");
        // What was refused is held by none of both sums.
        drop(of_vera);
        assert!(of_otto.resize(3));
        let third = shares.of(user("anna")).take(resource, 2);
        assert!(third.is_ok() && vera.take(resource, 1).is_err());
        drop((third, of_otto));
        assert!(vera.take(resource, 3).is_ok());
    }

    #[derive(Default)]
    struct Exhausted(Mutex<Vec<Option<ClientKey>>>);

    impl SessionObserver for Exhausted {
        fn observe(&self, _: &ChannelDescription, _: SessionEvent, _: StatusCode) {}
        fn session_expired(&self, _: NodeId, _: Option<UserToken>) {}
        fn share_exhausted(&self, client: Option<&ClientKey>, _: SharedResource) {
            self.0.lock().push(client.cloned());
        }
    }

    #[test]
    fn who_asks_when_all_together_have_no_more_is_not_called_the_one_who_used_it_up() {
        let own = ClientLimits {
            max_sessions: 2,
            ..ClientLimits::default()
        };
        let all = ClientLimits {
            max_sessions: 3,
            ..ClientLimits::default()
        };
        let exhausted = Arc::new(Exhausted::default());
        let shares = ClientShares::new(own, all, Some(exhausted.clone()));
        let (vera, otto) = (shares.of(user("vera")), shares.of(user("otto")));
        let resource = SharedResource::Sessions;
        let held = [vera.take(resource, 2).unwrap(), otto.take(resource, 1).unwrap()];
        assert!(vera.take(resource, 1).is_err() && otto.take(resource, 1).is_err());
        assert_eq!(*exhausted.0.lock(), [Some(user("vera")), None]);
        drop(held);
    }

    #[test]
    fn parts_are_given_back_one_by_one() {
        let shares = shares(3);
        let share = shares.of(user("vera"));
        let mut all = share.take(SharedResource::Sessions, 3).unwrap();
        let part = all.split(1);
        assert_eq!((all.amount(), part.amount()), (2, 1));
        drop(all);
        let mut held = share.take(SharedResource::Sessions, 2).unwrap();
        assert!(!held.resize(3));
        drop(part);
        assert!(held.resize(3));
    }

    #[test]
    fn a_client_has_the_same_share_everywhere_and_is_forgotten_when_it_holds_nothing() {
        let shares = shares(1);
        let held = shares.of(user("vera")).take(SharedResource::Sessions, 1).unwrap();
        assert!(shares.of(user("vera")).take(SharedResource::Sessions, 1).is_err());
        drop(held);
        drop(shares.of(user("otto")));
        assert_eq!(shares.clients.lock().len(), 1);
    }
}
