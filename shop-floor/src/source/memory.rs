//! State of a source that outlives its sessions: where nodes are, and how often sessions stalled.

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
    time::{Duration, Instant},
};

use asi_model::values::{DataValue, DateTime, NodeId};
use opcua_stack::opcua::types::NodeId as StackNodeId;

use crate::{BrowsePath, InputKey, MonitorRequest};

/// Most nodes of which browse path and history are remembered.
const PATHS_MAX: usize = 20_000;
/// Longest pause between checks that found stalled subscriptions, once new sessions proved useless:
/// some servers return on read what they do not notify.
const STALL_PAUSE_MAX: Duration = Duration::from_secs(3600);

#[derive(Default)]
pub(super) struct SourceMemory {
    /// Browse paths of nodes, looked up while the nodes were there; `None` for a node without one.
    learned_paths: HashMap<NodeId, Option<BrowsePath>>,
    /// Ids under which requested nodes are found in this session, where those differ.
    relocated: HashMap<NodeId, StackNodeId>,
    server: Option<ServerIdentity>,
    /// Nodes of variables with whether the server keeps their past values.
    histories: HashMap<NodeId, bool>,
    /// Last values that earlier sessions delivered, with the requests that they answered.
    last_values: HashMap<InputKey, (Arc<MonitorRequest>, DataValue)>,
    pub(super) stalls: StallHistory,
}

/// Start time and namespaces of a server. When they are as before, node ids are as before.
#[derive(PartialEq, Eq)]
pub(super) struct ServerIdentity {
    pub(super) started_at: Option<DateTime>,
    pub(super) namespace_uris: Vec<Arc<str>>,
}

/// Sessions of a source that were replaced because their subscriptions stalled.
#[derive(Debug, Default)]
pub(super) struct StallHistory {
    count: u32,
    last: Option<Instant>,
}

impl SourceMemory {
    /// Remembers the server of a new session. Returns true when it is the one of the last session.
    pub(super) fn set_server(&mut self, server: ServerIdentity) -> bool {
        let is_same = self.server.as_ref() == Some(&server);
        self.server = Some(server);
        is_same
    }

    /// Returns true for a request whose last value outlives a session.
    pub(super) fn is_remembered(&self, request: &MonitorRequest) -> bool {
        is_last_event(request) || self.has_history(request)
    }

    /// Returns the time since which values of a request were missed, where the server has them.
    pub(super) fn gap_since(&self, request: &MonitorRequest) -> Option<DateTime> {
        let (known, value) = self.last_values.get(&request.input)?;
        if **known != *request || !self.has_history(request) {
            return None;
        }
        value.source_timestamp
    }

    /// Returns true for a request for a variable whose past values the server keeps.
    fn has_history(&self, request: &MonitorRequest) -> bool {
        is_whole_variable(request) && self.histories.get(&request.node_id).is_some_and(|has| *has)
    }

    /// Returns the distinct nodes of these requests of which it is not known whether the server keeps their past
    /// values, no more than can be remembered.
    pub(super) fn nodes_of_unknown_history<'r>(
        &self,
        requests: impl Iterator<Item = &'r Arc<MonitorRequest>>,
    ) -> Vec<NodeId> {
        let room = PATHS_MAX.saturating_sub(self.histories.len());
        let nodes = requests.filter(|request| is_whole_variable(request));
        let nodes = nodes.map(|request| &request.node_id);
        let unknown = nodes.filter(|node| !self.histories.contains_key(*node));
        unknown.collect::<HashSet<_>>().into_iter().take(room).cloned().collect()
    }

    pub(super) fn learn_history(&mut self, histories: impl IntoIterator<Item = (NodeId, bool)>) {
        self.histories.extend(histories);
    }

    /// Remembers the last values of a session that ends, and forgets the inputs that are not `requested` any more.
    pub(super) fn remember(
        &mut self,
        last_values: Vec<(Arc<MonitorRequest>, DataValue)>,
        requested: &[InputKey],
    ) {
        let last_values = last_values.into_iter();
        self.last_values
            .extend(last_values.map(|(request, value)| (request.input, (request, value))));
        if !self.last_values.is_empty() {
            let requested: HashSet<_> = requested.iter().collect();
            self.last_values.retain(|input, _| requested.contains(input));
        }
    }

    /// Forgets the last value of an input.
    pub(super) fn forget(&mut self, input: InputKey) {
        self.last_values.remove(&input);
    }

    /// Returns the value of the last event that earlier sessions delivered for a request.
    pub(super) fn last_event(&self, request: &MonitorRequest) -> Option<&DataValue> {
        let (known, value) = self.last_values.get(&request.input)?;
        (**known == *request && is_last_event(request) && !value.status.is_bad()).then_some(value)
    }

    /// Returns the browse path of a request's node: the given one, else the learned one.
    pub(super) fn path_of(&self, request: &MonitorRequest) -> Option<BrowsePath> {
        let given = request.options.browse_path.clone();
        given.or_else(|| self.learned_paths.get(&request.node_id).cloned().flatten())
    }

    pub(super) fn knows_path_of(&self, request: &MonitorRequest) -> bool {
        request.options.browse_path.is_some()
            || self.learned_paths.get(&request.node_id).is_some_and(Option::is_some)
    }

    /// Returns the distinct nodes of these requests whose browse path is unknown, no more than can
    /// be remembered.
    pub(super) fn nodes_without_path<'r>(
        &self,
        requests: impl Iterator<Item = &'r Arc<MonitorRequest>>,
    ) -> Vec<NodeId> {
        let room = PATHS_MAX.saturating_sub(self.learned_paths.len());
        let nodes = requests
            .filter(|request| request.options.browse_path.is_none())
            .map(|request| &request.node_id);
        let unknown = nodes.filter(|node| {
            !self.learned_paths.contains_key(*node) && !self.relocated.contains_key(*node)
        });
        unknown.collect::<HashSet<_>>().into_iter().take(room).cloned().collect()
    }

    pub(super) fn learn_paths(
        &mut self,
        paths: impl IntoIterator<Item = (NodeId, Option<BrowsePath>)>,
    ) {
        self.learned_paths.extend(paths);
    }

    /// Returns the id under which a requested node was found in this session.
    pub(super) fn relocated(&self, node: &NodeId) -> Option<&StackNodeId> {
        self.relocated.get(node)
    }

    pub(super) fn set_relocated(&mut self, relocated: HashMap<NodeId, StackNodeId>) {
        self.relocated = relocated;
    }

    pub(super) fn add_relocated(&mut self, node: NodeId, found: StackNodeId) {
        self.relocated.insert(node, found);
    }
}

/// Returns true for a request for the whole value of a variable.
fn is_whole_variable(request: &MonitorRequest) -> bool {
    request.options.events.is_none() && request.options.index_range.is_none()
}

/// Returns true for a request whose value is that of the last event. What conditions are active, the server says again.
fn is_last_event(request: &MonitorRequest) -> bool {
    request.options.events.as_ref().is_some_and(|events| !events.value.is_of_conditions())
}

impl StallHistory {
    /// Returns the pause before the next check: doubles with each recent stall.
    pub(super) fn pause(&self, interval: Duration) -> Duration {
        if self.count == 0 {
            interval
        } else {
            interval.saturating_mul(1 << self.count.min(16)).min(STALL_PAUSE_MAX)
        }
    }

    pub(super) fn record_stall(&mut self) {
        // After an hour without stalls a stall is a new event, not proof that a new session does
        // not help.
        let is_recent = self.last.is_some_and(|last| last.elapsed() < STALL_PAUSE_MAX);
        self.count = if is_recent { self.count.saturating_add(1) } else { 1 };
        self.last = Some(Instant::now());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pause_doubles_with_each_stall_up_to_its_maximum() {
        let mut stalls = StallHistory::default();
        let interval = Duration::from_secs(5);
        assert_eq!(stalls.pause(interval), interval);
        stalls.record_stall();
        stalls.record_stall();
        assert_eq!(stalls.pause(interval), 4 * interval);
        stalls.count = 40;
        assert_eq!(stalls.pause(interval), STALL_PAUSE_MAX);
    }
}
