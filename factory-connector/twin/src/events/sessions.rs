//! Sessions of clients, for events that not every user may hear.

use std::{collections::BTreeMap, sync::Arc};

use opcua_stack::opcua::{
    nodes::{DefaultTypeTree, Event},
    server::{SessionSubscriptions, SubscriptionCache},
    types::{AttributeId, Identifier, NodeId, ObjectId},
};
use parking_lot::{Mutex, RwLock};

use crate::{access::Role, session_token::user_of};

/// Sessions that may have subscriptions. A subscription outlives its session until another session of
/// the same user takes it over or it expires, so an ended session stays as long as it has one.
pub(super) struct Sessions {
    subscriptions: Arc<SubscriptionCache>,
    types: Arc<RwLock<DefaultTypeTree>>,
    /// Number of a session, and whether it is open.
    known: Mutex<BTreeMap<u32, bool>>,
}

impl Sessions {
    /// Knows no session yet.
    pub fn new(subscriptions: Arc<SubscriptionCache>, types: Arc<RwLock<DefaultTypeTree>>) -> Self {
        Self { subscriptions, types, known: Mutex::default() }
    }

    /// Remembers a session whose user signed in.
    pub fn activated(&self, session: &NodeId) {
        if let Identifier::Numeric(number) = session.identifier {
            self.known.lock().insert(number, true);
        }
    }

    /// Remembers an ended session for as long as it has subscriptions.
    pub fn ended(&self, session: &NodeId) {
        let mut known = self.known.lock();
        if let Identifier::Numeric(number) = session.identifier {
            known.insert(number, false);
        }
        known.retain(|number, is_open| {
            *is_open || self.subscriptions.get_session_subscriptions(*number).is_some()
        });
    }

    /// Sends an event of the Server object to the sessions of roles that `admits` accepts.
    pub fn send(&self, event: &dyn Event, admits: fn(Role) -> bool) {
        let known: Vec<u32> = self.known.lock().keys().copied().collect();
        for number in known {
            let Some(subscriptions) = self.subscriptions.get_session_subscriptions(number) else {
                continue;
            };
            let session = Arc::clone(subscriptions.lock().session());
            // The role at present: a session may be activated again for another user.
            let role = session.read().user_token().map(|token| user_of(token).role);
            if role.is_some_and(admits) {
                self.notify(&mut subscriptions.lock(), event);
            }
        }
    }

    fn notify(&self, subscriptions: &mut SessionSubscriptions, event: &dyn Event) {
        let types = self.types.read();
        for id in subscriptions.subscription_ids() {
            let Some(subscription) = subscriptions.get_mut(id) else { continue };
            let listening: Vec<u32> = subscription
                .items()
                .filter(|item| {
                    let target = item.item_to_monitor();
                    target.attribute_id == AttributeId::EventNotifier
                        && target.node_id == ObjectId::Server
                })
                .map(|item| item.id())
                .collect();
            for item in listening {
                subscription.notify_event(&item, event, &*types);
            }
        }
    }
}
