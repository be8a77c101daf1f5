//! Routes from variables to the mappings that use them.
//!
//! A variable that several mappings use in the same way is monitored once.

use std::{collections::HashMap, hash::BuildHasher as _, sync::Arc};

use asi_model::NodeId;
use foldhash::fast::RandomState;
use hashbrown::HashTable;
use mapping::MappingInput;
use shop_floor::{InputKey, MonitorOptions, MonitorRequest, SourceId};
use smallvec::SmallVec;

use super::history::History;

/// Input of a mapping that takes the values of a route.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Subscriber {
    /// Slot of the mapping.
    pub slot: u32,
    /// Position among its inputs.
    pub input: u32,
}

/// Monitored variable with the inputs that its values go to.
#[derive(Debug)]
pub(super) struct Route {
    pub subscribers: SmallVec<[Subscriber; 2]>,
    /// The newest is given to mappings that come later.
    pub history: History,
    /// Request under which the shop floor monitors it.
    request: Arc<MonitorRequest>,
}

/// Table of monitored variables. Inputs that take a variable in the same way share a route.
#[derive(Debug, Default)]
pub(super) struct Routes {
    routes: HashMap<InputKey, Route, RandomState>,
    /// The keys under which a variable is monitored, by its source and node: one way of monitoring
    /// is the rule.
    variables: HashTable<InputKey>,
    last_key: u64,
}

impl Routes {
    /// Returns the route of a monitored variable.
    pub fn get_mut(&mut self, key: InputKey) -> Option<&mut Route> {
        self.routes.get_mut(&key)
    }

    /// Returns the number of monitored variables.
    pub fn len(&self) -> usize {
        self.routes.len()
    }

    /// The route of a variable that is read in the same way as an input, however it is monitored.
    pub fn like<'r>(&'r self, input: &'r MappingInput) -> Option<&'r Route> {
        let of_variable = || self.of_variable(&input.source_id, &input.node_id);
        let same = of_variable().find(|route| route.request.options == input.monitor);
        let is_like = |route: &&Route| {
            let MonitorOptions { index_range, events, .. } = &route.request.options;
            *index_range == input.monitor.index_range && *events == input.monitor.events
        };
        same.or_else(|| of_variable().find(is_like))
    }

    fn of_variable<'r>(
        &'r self,
        source: &'r SourceId,
        node_id: &'r NodeId,
    ) -> impl Iterator<Item = &'r Route> {
        let keys = self.variables.iter_hash(self.hash_of(source, node_id));
        let routes = keys.filter_map(|key| self.routes.get(key));
        routes.filter(move |route| {
            route.request.source == *source && route.request.node_id == *node_id
        })
    }

    fn hash_of(&self, source: &SourceId, node_id: &NodeId) -> u64 {
        self.routes.hasher().hash_one((source, node_id))
    }

    /// Subscribes a mapping's input to a variable. Returns the request to monitor it where it is
    /// not monitored yet.
    pub fn subscribe(
        &mut self,
        input: &MappingInput,
        subscriber: Subscriber,
    ) -> (InputKey, Option<Arc<MonitorRequest>>) {
        let known = self.of_variable(&input.source_id, &input.node_id);
        let known =
            known.map(|route| &route.request).find(|request| request.options == input.monitor);
        if let Some(key) = known.map(|request| request.input) {
            if let Some(route) = self.routes.get_mut(&key) {
                route.subscribers.push(subscriber);
            }
            return (key, None);
        }
        // Keys are never used again: a late change of a former variable finds nobody.
        self.last_key += 1;
        let key = InputKey(self.last_key);
        let request = Arc::new(MonitorRequest {
            input: key,
            source: input.source_id.clone(),
            node_id: input.node_id.clone(),
            options: input.monitor.clone(),
        });
        let (hash, hasher) =
            (self.hash_of(&request.source, &request.node_id), self.routes.hasher());
        let rehash = |key: &InputKey| {
            let request = self.routes.get(key).map(|route| &route.request);
            request.map_or(0, |request| hasher.hash_one((&request.source, &request.node_id)))
        };
        self.variables.insert_unique(hash, key, rehash);
        let subscribers = SmallVec::from_iter([subscriber]);
        self.routes.insert(
            key,
            Route { subscribers, history: History::default(), request: Arc::clone(&request) },
        );
        (key, Some(request))
    }

    /// Ends a subscription. Returns true if it was the variable's last.
    pub fn unsubscribe(&mut self, key: InputKey, subscriber: Subscriber) -> bool {
        let Some(route) = self.routes.get_mut(&key) else { return false };
        route.subscribers.retain(|other| *other != subscriber);
        if !route.subscribers.is_empty() {
            return false;
        }
        let hash = self
            .routes
            .get(&key)
            .map(|route| self.hash_of(&route.request.source, &route.request.node_id));
        if let Some(Ok(found)) =
            hash.map(|hash| self.variables.find_entry(hash, |other| *other == key))
        {
            found.remove();
        }
        self.routes.remove(&key);
        true
    }
}
