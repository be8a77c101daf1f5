//! What is known of a source by all sides: callers put in what they want, the source's task how it
//! is doing.

use std::{
    collections::HashSet,
    sync::{
        Arc,
        atomic::{AtomicI64, AtomicU64, Ordering},
    },
};

use asi_model::values::{DateTime, StatusCode};
use indexmap::IndexMap;
use parking_lot::{Mutex, RwLock};
use tokio::sync::Notify;

use super::{Connection, feed::Feed, now};
use crate::{
    ChosenEndpoint, InputKey, InputProblem, MonitorRequest, ServerLimits, SourceConfig, SourceId,
    SourceProblem, SourceState, SourceStatus, service::Floor,
};

/// Most inputs named in [`SourceStatus::not_live`].
const NOT_LIVE_MAX: usize = 1000;

pub(crate) struct Entry {
    pub(super) id: SourceId,
    config: RwLock<Option<SourceConfig>>,
    wanted: Mutex<Wanted>,
    wanted_changed: Notify,
    try_now: Notify,
    connection: RwLock<Option<Connection>>,
    board: Mutex<Board>,
    pub(super) meter: Meter,
}

#[derive(Default)]
struct Wanted {
    inputs: IndexMap<InputKey, Arc<MonitorRequest>>,
    changed: HashSet<InputKey>,
}

/// What the source's task says about itself.
struct Board {
    state: SourceState,
    since: DateTime,
    problem: Option<SourceProblem>,
    sessions: u64,
    clock_ahead_ms: Option<i64>,
    endpoint: Option<ChosenEndpoint>,
    limits: Option<ServerLimits>,
    feed: Option<Arc<Feed>>,
    problems: IndexMap<InputKey, (StatusCode, String)>,
    findable: usize,
}

/// Counts and times that change with every notification; zero ticks mean never.
#[derive(Default)]
pub(super) struct Meter {
    changes: AtomicU64,
    last_change_ticks: AtomicI64,
    last_sign_ticks: AtomicI64,
}

impl Meter {
    pub(super) fn sign_of_life(&self, changes: u64) {
        let ticks = now().ticks();
        self.last_sign_ticks.store(ticks, Ordering::Relaxed);
        if changes > 0 {
            self.changes.fetch_add(changes, Ordering::Relaxed);
            self.last_change_ticks.store(ticks, Ordering::Relaxed);
        }
    }
}

impl Entry {
    pub(crate) fn new(id: SourceId) -> Self {
        Self {
            id,
            config: RwLock::default(),
            wanted: Mutex::default(),
            wanted_changed: Notify::new(),
            try_now: Notify::new(),
            connection: RwLock::default(),
            board: Mutex::new(Board {
                state: SourceState::Waiting,
                since: now(),
                problem: None,
                sessions: 0,
                clock_ahead_ms: None,
                endpoint: None,
                limits: None,
                feed: None,
                problems: IndexMap::new(),
                findable: 0,
            }),
            meter: Meter::default(),
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

    /// Callers want these inputs.
    pub(crate) fn want(&self, requests: Vec<Arc<MonitorRequest>>) {
        let mut wanted = self.wanted.lock();
        for request in requests {
            wanted.changed.insert(request.input);
            wanted.inputs.insert(request.input, request);
        }
        drop(wanted);
        self.wanted_changed.notify_one();
    }

    /// Callers do not want these inputs any more.
    pub(crate) fn release(&self, inputs: &[InputKey]) {
        let mut wanted = self.wanted.lock();
        for input in inputs {
            if wanted.inputs.swap_remove(input).is_some() {
                wanted.changed.insert(*input);
            }
        }
        drop(wanted);
        self.wanted_changed.notify_one();
    }

    pub(crate) fn is_unwanted(&self) -> bool {
        self.wanted.lock().inputs.is_empty()
    }

    /// Do not wait for the next attempt.
    pub(crate) fn try_now(&self) {
        self.try_now.notify_one();
    }

    pub(super) async fn tried_now(&self) {
        self.try_now.notified().await;
    }

    pub(super) async fn wanted_changed(&self) {
        self.wanted_changed.notified().await;
    }

    /// What changed since the last call: each input with its request, `None` where it is not wanted
    /// any more.
    pub(super) fn take_changed(&self) -> Vec<(InputKey, Option<Arc<MonitorRequest>>)> {
        let mut wanted = self.wanted.lock();
        let changed = std::mem::take(&mut wanted.changed);
        changed.into_iter().map(|input| (input, wanted.inputs.get(&input).cloned())).collect()
    }

    /// Everything that is wanted; nothing counts as changed afterwards.
    pub(super) fn take_all(&self) -> Vec<Arc<MonitorRequest>> {
        let mut wanted = self.wanted.lock();
        wanted.changed.clear();
        wanted.inputs.values().cloned().collect()
    }

    pub(super) fn wanted_inputs(&self) -> Vec<InputKey> {
        self.wanted.lock().inputs.keys().copied().collect()
    }

    pub(super) fn set_state(
        &self,
        floor: &Floor,
        state: SourceState,
        problem: Option<SourceProblem>,
    ) {
        let mut board = self.board.lock();
        if board.state != state || board.problem != problem {
            if board.state != state {
                board.since = now();
            }
            board.state = state;
            // While trying again the last problem stays visible.
            if state != SourceState::Connecting {
                board.problem = problem;
            }
            drop(board);
            floor.status_has_changed();
        }
    }

    /// A session begins.
    pub(super) fn begin(
        &self,
        connection: Connection,
        endpoint: ChosenEndpoint,
        clock_ahead_ms: Option<i64>,
        feed: Arc<Feed>,
    ) {
        let mut board = self.board.lock();
        board.sessions += 1;
        board.clock_ahead_ms = clock_ahead_ms;
        board.endpoint = Some(endpoint);
        board.limits = Some(connection.limits());
        board.feed = Some(feed);
        board.problems.clear();
        drop(board);
        *self.connection.write() = Some(connection);
    }

    /// The session has ended.
    pub(super) fn end(&self) {
        *self.connection.write() = None;
        let mut board = self.board.lock();
        board.feed = None;
        board.problems.clear();
    }

    /// Says of how many inputs the browse path is known.
    pub(super) fn set_findable(&self, findable: usize) {
        self.board.lock().findable = findable;
    }

    /// Says why inputs are not live; `None` where that is over.
    pub(super) fn note(
        &self,
        notes: impl IntoIterator<Item = (InputKey, Option<(StatusCode, String)>)>,
    ) {
        let mut board = self.board.lock();
        for (input, problem) in notes {
            match problem {
                Some(problem) => board.problems.insert(input, problem),
                None => board.problems.swap_remove(&input),
            };
        }
    }

    /// How the source is doing, with all evidence.
    pub(crate) fn status(&self) -> SourceStatus {
        let time = |ticks: &AtomicI64| {
            let ticks = ticks.load(Ordering::Relaxed);
            (ticks != 0).then(|| DateTime::from_ticks(ticks))
        };
        let (inputs, not_live) = self.not_live();
        let board = self.board.lock();
        SourceStatus {
            source_id: self.id.clone(),
            state: board.state,
            since: board.since,
            problem: board.problem.clone(),
            inputs,
            live: board.feed.as_ref().map_or(0, |feed| feed.live()),
            findable: board.findable,
            not_live,
            last_change_at: time(&self.meter.last_change_ticks),
            last_sign_of_life_at: time(&self.meter.last_sign_ticks),
            changes: self.meter.changes.load(Ordering::Relaxed),
            sessions: board.sessions,
            clock_ahead_ms: board.clock_ahead_ms,
            endpoint: board.endpoint.clone(),
            limits: board.limits,
        }
    }

    /// How many inputs are wanted, and why the first of those that are not live are not.
    fn not_live(&self) -> (usize, Vec<InputProblem>) {
        let (feed, problems, message) = {
            let board = self.board.lock();
            let wanted = self.wanted.lock().inputs.len();
            if board.feed.as_ref().is_some_and(|feed| feed.live() == wanted) {
                return (wanted, Vec::new());
            }
            let message = board
                .problem
                .as_ref()
                .map_or_else(|| "not connected yet".into(), |p| p.message.clone());
            (board.feed.clone(), board.problems.clone(), message)
        };
        let wanted = self.wanted.lock();
        let live = feed.as_ref().map(|feed| feed.live_inputs()).unwrap_or_default();
        let not_live = wanted.inputs.values().filter(|request| !live.contains(&request.input)).map(
            |request| {
                let (status, reason) = match (problems.get(&request.input), &feed) {
                    (Some((status, reason)), _) => (*status, reason.clone()),
                    (None, Some(_)) => (
                        StatusCode::BAD_WAITING_FOR_INITIAL_DATA,
                        "waiting for the first value".to_owned(),
                    ),
                    (None, None) => (StatusCode::BAD_NOT_CONNECTED, message.clone()),
                };
                InputProblem {
                    input: request.input,
                    node_id: request.node_id.clone(),
                    status,
                    reason,
                }
            },
        );
        (wanted.inputs.len(), not_live.take(NOT_LIVE_MAX).collect())
    }
}
