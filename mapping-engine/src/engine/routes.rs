//! Which mappings a change concerns.
//!
//! A variable that several mappings use in the same way is monitored once.

use std::collections::HashMap;

use asi_model::NodeId;
use shop_floor::{InputKey, MonitorOptions, MonitorRequest, SourceId};

use super::history::History;
use crate::mapping::MappingInput;

/// A mapping's input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Subscriber {
    /// The mapping's place.
    pub place: usize,
    /// Position among its inputs.
    pub input: usize,
}

/// A monitored variable.
#[derive(Debug)]
pub(super) struct Route {
    pub subscribers: Vec<Subscriber>,
    /// The newest is given to mappings that come later.
    pub history: History,
}

/// All monitored variables.
#[derive(Debug, Default)]
pub(super) struct Routes {
    routes: HashMap<InputKey, Route>,
    keys: HashMap<(SourceId, NodeId), Vec<(MonitorOptions, InputKey)>>,
    last_key: u64,
}

impl Routes {
    pub fn get_mut(&mut self, key: InputKey) -> Option<&mut Route> {
        self.routes.get_mut(&key)
    }

    /// How many variables are monitored.
    pub fn len(&self) -> usize {
        self.routes.len()
    }

    /// The route of a variable that is read in the same way as an input, however it is monitored.
    pub fn like(&self, input: &MappingInput) -> Option<&Route> {
        let keys = self.keys.get(&(input.source_id.clone(), input.node_id.clone()))?;
        let same = keys.iter().find(|(options, _)| *options == input.monitor);
        let alike = keys.iter().find(|(options, _)| options.index_range == input.monitor.index_range);
        let (_, key) = same.or(alike)?;
        self.routes.get(key)
    }

    /// Lets a mapping's input follow a variable. The request to monitor it, if nobody has so far.
    pub fn subscribe(&mut self, input: &MappingInput, subscriber: Subscriber) -> (InputKey, Option<MonitorRequest>) {
        let (source, node_id) = (input.source_id.clone(), input.node_id.clone());
        // One way of monitoring is the rule.
        let keys = self.keys.entry((source.clone(), node_id.clone())).or_insert_with(|| Vec::with_capacity(1));
        if let Some((_, key)) = keys.iter().find(|(options, _)| *options == input.monitor) {
            let key = *key;
            if let Some(route) = self.routes.get_mut(&key) {
                route.subscribers.push(subscriber);
            }
            return (key, None);
        }
        // Keys are never used again: a late change of a former variable finds nobody.
        self.last_key += 1;
        let key = InputKey(self.last_key);
        keys.push((input.monitor.clone(), key));
        // A mapping that is put is held while it finds its place, so there are two at first.
        let mut subscribers = Vec::with_capacity(2);
        subscribers.push(subscriber);
        self.routes.insert(key, Route { subscribers, history: History::default() });
        (key, Some(MonitorRequest { input: key, source, node_id, options: input.monitor.clone() }))
    }

    /// Ends what [`Self::subscribe`] began. True if nobody follows the variable any more.
    pub fn unsubscribe(&mut self, key: InputKey, input: &MappingInput, subscriber: Subscriber) -> bool {
        let Some(route) = self.routes.get_mut(&key) else { return false };
        route.subscribers.retain(|other| *other != subscriber);
        if !route.subscribers.is_empty() {
            return false;
        }
        self.routes.remove(&key);
        let variable = (input.source_id.clone(), input.node_id.clone());
        if let Some(keys) = self.keys.get_mut(&variable) {
            keys.retain(|(_, other)| *other != key);
            if keys.is_empty() {
                self.keys.remove(&variable);
            }
        }
        true
    }
}
