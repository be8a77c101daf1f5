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

use super::{history::History, recording::VariableRecording};

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
    /// Recordings of before the start whose variables no mapping uses yet.
    former: HashMap<(SourceId, NodeId), Vec<VariableRecording>>,
    last_key: u64,
}

impl Routes {
    /// Returns the route of a monitored variable.
    pub fn get_mut(&mut self, key: InputKey) -> Option<&mut Route> {
        self.routes.get_mut(&key)
    }

    /// Takes the recordings of before the start, for the variables that mappings will use.
    pub fn resume(&mut self, recordings: Vec<VariableRecording>) {
        for recording in recordings {
            let variable = (recording.source_id.clone(), recording.node_id.clone());
            self.former.entry(variable).or_default().push(recording);
        }
    }

    /// Returns the newest values of the monitored variables, at most `most` together.
    pub fn recordings(&self, most: usize) -> Vec<VariableRecording> {
        let share = (most / self.routes.len().max(1)).max(1);
        let recordings = self.routes.values().map(|route| VariableRecording {
            source_id: route.request.source.clone(),
            node_id: route.request.node_id.clone(),
            monitor: route.request.options.clone(),
            values: route.history.kept(share),
        });
        recordings.filter(|recording| !recording.values.is_empty()).take(most).collect()
    }

    /// Returns the history of an input that is monitored from now on.
    fn begun_history(&mut self, input: &MappingInput) -> History {
        if self.former.is_empty() {
            return History::default();
        }
        let variable = (input.source_id.clone(), input.node_id.clone());
        let Some(recordings) = self.former.get_mut(&variable) else { return History::default() };
        let same = recordings.iter().position(|recording| recording.monitor == input.monitor);
        let found = same.map(|index| recordings.swap_remove(index).values);
        if recordings.is_empty() {
            self.former.remove(&variable);
        }
        found.map(History::after).unwrap_or_default()
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
        let history = self.begun_history(input);
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
        self.routes.insert(key, Route { subscribers, history, request: Arc::clone(&request) });
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
