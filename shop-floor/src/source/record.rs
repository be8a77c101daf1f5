//! Shared record of one source: callers write what they want to monitor, the source's task writes
//! its status.

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
    time::Duration,
};

use asi_model::values::{DateTime, StatusCode};
use indexmap::IndexMap;
use parking_lot::{Mutex, RwLock};
use tokio::sync::Notify;

use super::{
    activity::ActivityCounters,
    connection::Connection,
    notification_sink::{FilledGap, NotificationSink},
};
use crate::{
    ChosenEndpoint, CoarseInput, FilledInput, GrantedIntervals, InputKey, InputProblem,
    MonitorRequest, ServerLimits, ServerProduct, SourceConfig, SourceId, SourceProblem,
    SourceState, SourceStatus, clock, context::SourceContext,
};

/// Most inputs named in each list of a [`SourceStatus`].
const NOT_LIVE_MAX: usize = 1000;

pub(crate) struct SourceRecord {
    pub(super) id: SourceId,
    pub(super) activity: Arc<ActivityCounters>,
    config: RwLock<Option<SourceConfig>>,
    requests: Mutex<Requests>,
    requests_changed: Notify,
    retry_requested: Notify,
    connection: RwLock<Option<Connection>>,
    status: Mutex<TaskStatus>,
}

/// Inputs that callers monitor, and those among them that the task has not looked at yet.
#[derive(Default)]
struct Requests {
    by_input: IndexMap<InputKey, Arc<MonitorRequest>>,
    changed: HashSet<InputKey>,
}

/// Status that the source's task reports.
struct TaskStatus {
    state: SourceState,
    since: DateTime,
    problem: Option<SourceProblem>,
    sessions: u64,
    /// Clock and product of the server as of the last session.
    server: Option<ServerFacts>,
    endpoint: Option<ChosenEndpoint>,
    limits: Option<ServerLimits>,
    /// Sink of the running session.
    sink: Option<Arc<NotificationSink>>,
    input_problems: HashMap<InputKey, (StatusCode, String)>,
    findable: usize,
    granted: Option<GrantedIntervals>,
    /// Inputs whose queue is too short for what may come between two publishings.
    overruns: HashMap<InputKey, GrantedItem>,
}

/// Facts about a server that it said at the start of a session.
#[derive(Debug, Clone)]
pub(super) struct ServerFacts {
    /// Milliseconds; negative when the server's clock is behind.
    pub(super) clock_ahead_ms: Option<i64>,
    pub(super) product: ServerProduct,
}

/// Sampling interval and queue of a monitored item as the server revised them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GrantedItem {
    pub(super) sampling_ms: f64,
    pub(super) queue_size: u32,
}

impl SourceRecord {
    pub(crate) fn new(id: SourceId) -> Self {
        Self {
            id,
            activity: Arc::default(),
            config: RwLock::default(),
            requests: Mutex::default(),
            requests_changed: Notify::new(),
            retry_requested: Notify::new(),
            connection: RwLock::default(),
            status: Mutex::new(TaskStatus {
                state: SourceState::Waiting,
                since: clock::now(),
                problem: None,
                sessions: 0,
                server: None,
                endpoint: None,
                limits: None,
                sink: None,
                input_problems: HashMap::new(),
                findable: 0,
                granted: None,
                overruns: HashMap::new(),
            }),
        }
    }

    pub(crate) fn config(&self) -> Option<SourceConfig> {
        self.config.read().clone()
    }

    pub(crate) fn set_config(&self, config: Option<SourceConfig>) {
        *self.config.write() = config;
    }

    pub(crate) fn connection(&self) -> Option<Connection> {
        self.connection.read().clone()
    }

    pub(crate) fn is_connected(&self) -> bool {
        self.connection.read().is_some()
    }

    /// Adds inputs, or replaces their requests.
    pub(crate) fn add_requests(&self, requests: Vec<Arc<MonitorRequest>>) {
        let mut known = self.requests.lock();
        for request in requests {
            known.changed.insert(request.input);
            known.by_input.insert(request.input, request);
        }
        drop(known);
        self.requests_changed.notify_one();
    }

    pub(crate) fn remove_requests(&self, inputs: &[InputKey]) {
        let mut known = self.requests.lock();
        for input in inputs {
            if known.by_input.swap_remove(input).is_some() {
                known.changed.insert(*input);
            }
        }
        drop(known);
        self.requests_changed.notify_one();
    }

    pub(crate) fn has_no_requests(&self) -> bool {
        self.requests.lock().by_input.is_empty()
    }

    /// Ends a running backoff.
    pub(crate) fn request_retry(&self) {
        self.retry_requested.notify_one();
    }

    pub(super) async fn retry_requested(&self) {
        self.retry_requested.notified().await;
    }

    pub(super) async fn requests_changed(&self) {
        self.requests_changed.notified().await;
    }

    /// Returns the inputs that changed since the last call, each with its request; `None` for a
    /// removed one.
    pub(super) fn take_changed_requests(&self) -> Vec<(InputKey, Option<Arc<MonitorRequest>>)> {
        let mut known = self.requests.lock();
        let changed = std::mem::take(&mut known.changed);
        changed.into_iter().map(|input| (input, known.by_input.get(&input).cloned())).collect()
    }

    /// Returns all requests; none of them counts as changed afterwards.
    pub(super) fn take_all_requests(&self) -> Vec<Arc<MonitorRequest>> {
        let mut known = self.requests.lock();
        known.changed.clear();
        known.by_input.values().cloned().collect()
    }

    pub(super) fn requested_inputs(&self) -> Vec<InputKey> {
        self.requests.lock().by_input.keys().copied().collect()
    }

    /// Sets the state and its problem; notifies watchers when one of them is new.
    pub(super) fn set_state(
        &self,
        context: &SourceContext,
        state: SourceState,
        problem: Option<SourceProblem>,
    ) {
        let mut status = self.status.lock();
        if status.state == state && status.problem == problem {
            return;
        }
        if status.state != state {
            status.since = clock::now();
        }
        status.state = state;
        // During the next attempt people still see the last problem.
        if state != SourceState::Connecting {
            status.problem = problem;
        }
        drop(status);
        context.notify_status_changed();
    }

    /// Makes a new session available to callers.
    pub(super) fn begin_session(
        &self,
        connection: Connection,
        endpoint: ChosenEndpoint,
        server: ServerFacts,
        sink: Arc<NotificationSink>,
    ) {
        let mut status = self.status.lock();
        status.sessions += 1;
        status.server = Some(server);
        status.endpoint = Some(endpoint);
        status.limits = Some(connection.limits());
        status.sink = Some(sink);
        status.input_problems.clear();
        status.granted = None;
        status.overruns.clear();
        drop(status);
        *self.connection.write() = Some(connection);
    }

    pub(super) fn end_session(&self) {
        *self.connection.write() = None;
        let mut status = self.status.lock();
        status.sink = None;
        status.input_problems.clear();
    }

    /// Sets what the server granted a subscription; of several, the slowest is shown.
    pub(super) fn set_granted(
        &self,
        publishing: Duration,
        keep_alive: Duration,
        silence: Duration,
    ) {
        let ms = |duration: Duration| u64::try_from(duration.as_millis()).unwrap_or(u64::MAX);
        let mut status = self.status.lock();
        let known = status.granted;
        let slowest =
            |now: Duration, of: fn(GrantedIntervals) -> u64| ms(now).max(known.map_or(0, of));
        status.granted = Some(GrantedIntervals {
            publishing_ms: slowest(publishing, |known| known.publishing_ms),
            keep_alive_ms: slowest(keep_alive, |known| known.keep_alive_ms),
            silence_ms_max: slowest(silence, |known| known.silence_ms_max),
            sampling_ms: known.and_then(|known| known.sampling_ms),
            queue_size: known.and_then(|known| known.queue_size),
        });
    }

    /// Sets what the server granted an input, and if its queue is too short for that.
    pub(super) fn set_granted_item(&self, input: InputKey, item: GrantedItem, overruns: bool) {
        let mut status = self.status.lock();
        if let Some(granted) = &mut status.granted {
            let sampling_ms = granted.sampling_ms.unwrap_or(item.sampling_ms);
            granted.sampling_ms = Some(sampling_ms.max(item.sampling_ms));
            let queue_size = granted.queue_size.unwrap_or(item.queue_size);
            granted.queue_size = Some(queue_size.min(item.queue_size));
        }
        if overruns {
            status.overruns.insert(input, item);
        } else {
            status.overruns.remove(&input);
        }
    }

    /// Sets the number of inputs with a known browse path.
    pub(super) fn set_findable(&self, findable: usize) {
        self.status.lock().findable = findable;
    }

    pub(super) fn set_input_problem(&self, input: InputKey, status: StatusCode, reason: String) {
        self.status.lock().input_problems.insert(input, (status, reason));
    }

    pub(super) fn clear_input_problem(&self, input: InputKey) {
        self.status.lock().input_problems.remove(&input);
    }

    /// Returns the status of the source with all its evidence.
    pub(crate) fn status(&self) -> SourceStatus {
        let (inputs, not_live) = self.not_live();
        let coarse = self.coarse();
        let filled = self.filled();
        let status = self.status.lock();
        SourceStatus {
            source_id: self.id.clone(),
            state: status.state,
            since: status.since,
            problem: status.problem.clone(),
            inputs,
            live: status.sink.as_ref().map_or(0, |sink| sink.live()),
            findable: status.findable,
            not_live,
            last_change_at: self.activity.last_change_at(),
            last_sign_of_life_at: self.activity.last_sign_of_life_at(),
            changes: self.activity.changes(),
            sessions: status.sessions,
            clock_ahead_ms: status.server.as_ref().and_then(|server| server.clock_ahead_ms),
            product: status.server.as_ref().map(|server| server.product.clone()),
            family: status
                .server
                .as_ref()
                .zip(status.endpoint.as_ref())
                .and_then(|(server, endpoint)| server.product.family(endpoint)),
            endpoint: status.endpoint.clone(),
            limits: status.limits,
            granted: status.granted,
            coarse,
            filled,
        }
    }

    /// Returns the first of the inputs of which single changes may not arrive.
    fn coarse(&self) -> Vec<CoarseInput> {
        let (sink, overruns) = {
            let status = self.status.lock();
            (status.sink.clone(), status.overruns.clone())
        };
        let overflows = sink.map(|sink| sink.overflows()).unwrap_or_default();
        if overruns.is_empty() && overflows.is_empty() {
            return Vec::new();
        }
        let requests = self.requests.lock();
        let coarse = requests.by_input.values().filter_map(|request| {
            let granted = overruns.get(&request.input);
            let overflows = overflows.get(&request.input).copied().unwrap_or_default();
            let is_coarse = granted.is_some() || overflows > 0;
            is_coarse.then(|| CoarseInput {
                input: request.input,
                node_id: request.node_id.clone(),
                sampling_ms: granted.map(|granted| granted.sampling_ms),
                queue_size: granted.map(|granted| granted.queue_size),
                overflows,
            })
        });
        coarse.take(NOT_LIVE_MAX).collect()
    }

    /// Returns the first of the inputs of which a gap was filled.
    fn filled(&self) -> Vec<FilledInput> {
        let sink = self.status.lock().sink.clone();
        let filled = sink.map(|sink| sink.filled()).unwrap_or_default();
        if filled.is_empty() {
            return Vec::new();
        }
        let requests = self.requests.lock();
        let inputs = requests.by_input.values().filter_map(|request| {
            let FilledGap { values, since, is_complete } = *filled.get(&request.input)?;
            let node_id = request.node_id.clone();
            Some(FilledInput { input: request.input, node_id, values, since, is_complete })
        });
        inputs.take(NOT_LIVE_MAX).collect()
    }

    /// Returns the number of requested inputs, and the first of those without a value, with the
    /// reason.
    fn not_live(&self) -> (usize, Vec<InputProblem>) {
        let (sink, problems, message) = {
            let status = self.status.lock();
            let requested = self.requests.lock().by_input.len();
            if status.sink.as_ref().is_some_and(|sink| sink.live() == requested) {
                return (requested, Vec::new());
            }
            let message = status
                .problem
                .as_ref()
                .map_or_else(|| "not connected yet".into(), |problem| problem.message.clone());
            (status.sink.clone(), status.input_problems.clone(), message)
        };
        let live = sink.as_ref().map(|sink| sink.live_inputs()).unwrap_or_default();
        let reason_of = |input, is_of_events| match (problems.get(&input), &sink) {
            (Some((status, reason)), _) => (*status, reason.clone()),
            (None, Some(_)) => {
                let status = StatusCode::BAD_WAITING_FOR_INITIAL_DATA;
                let what = if is_of_events { "event" } else { "value" };
                (status, format!("waiting for the first {what}"))
            }
            (None, None) => (StatusCode::BAD_NOT_CONNECTED, message.clone()),
        };
        let requests = self.requests.lock();
        let not_live =
            requests.by_input.values().filter(|request| !live.contains(&request.input)).map(
                |request| {
                    let is_of_events = request.options.events.is_some();
                    let (status, reason) = reason_of(request.input, is_of_events);
                    let node_id = request.node_id.clone();
                    InputProblem { input: request.input, node_id, status, reason }
                },
            );
        (requests.by_input.len(), not_live.take(NOT_LIVE_MAX).collect())
    }
}
