//! The life of one session, from its first question to its end.

use std::{
    collections::{HashMap, HashSet},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use asi_model::values::{DataValue, DateTime, NodeId, StatusCode};
use futures::{
    FutureExt as _,
    future::{BoxFuture, OptionFuture},
};
use opcua_stack::{opcua::types::NodeId as StackNodeId, values::node_id_to_stack};
use tokio_util::sync::CancellationToken;

use super::{
    Connection,
    audit::{Audit, Stalls},
    connect::Link,
    entry::Entry,
    facts,
    feed::Feed,
    now, paths, problem, services,
    subscriptions::Subscriptions,
};
use crate::{
    BrowsePath, InputChange, InputKey, MonitorRequest, ShopFloorError, SourceConfig, SourceProblem,
    SourceProblemKind as Kind, SourceState, service::Floor,
};

/// How often the session is looked after.
const TICK: Duration = Duration::from_millis(250);
/// Longest wait for a polite end of a session.
const GOODBYE_TIMEOUT: Duration = Duration::from_secs(2);
/// Browse paths learned per tick, and kept at most.
const PATHS_PER_TICK: usize = 200;
const PATHS_MAX: usize = 20_000;

/// What is remembered from session to session.
#[derive(Default)]
pub(super) struct Memory {
    /// Where nodes hang, learned while they were there; `None` where they hang nowhere.
    learned: HashMap<NodeId, Option<BrowsePath>>,
    /// Nodes that are found under another id in this session.
    pub(super) moved: HashMap<NodeId, StackNodeId>,
    server: Option<(Option<DateTime>, Vec<Arc<str>>)>,
    pub(super) stalls: Stalls,
}

impl Memory {
    /// Where a request's node hangs, as far as we know.
    pub(super) fn path_of(&self, request: &MonitorRequest) -> Option<BrowsePath> {
        let given = request.options.browse_path.clone();
        given.or_else(|| self.learned.get(&request.node_id).cloned().flatten())
    }

    fn knows_path_of(&self, request: &MonitorRequest) -> bool {
        request.options.browse_path.is_some()
            || self.learned.get(&request.node_id).is_some_and(Option::is_some)
    }

    /// Nodes of these requests that hang nobody knows where, each once.
    fn unknown_of<'r>(
        &self,
        requests: impl Iterator<Item = &'r Arc<MonitorRequest>>,
    ) -> Vec<NodeId> {
        let room = PATHS_MAX.saturating_sub(self.learned.len());
        let nodes = requests
            .filter(|request| request.options.browse_path.is_none())
            .map(|request| &request.node_id);
        let unknown = nodes
            .filter(|node| !self.learned.contains_key(*node) && !self.moved.contains_key(*node));
        unknown.collect::<HashSet<_>>().into_iter().take(room).cloned().collect()
    }
}

/// How a session ended.
pub(super) enum Ended {
    /// We were told to stop.
    Stopped,
    /// Something happened.
    Lost {
        problem: SourceProblem,
        /// Whether it was worth having: then the next attempt is made at once.
        has_flowed: bool,
    },
}

/// Lives through a session. Afterwards all inputs were told that they are not connected.
pub(super) async fn live(
    floor: &Arc<Floor>,
    entry: &Arc<Entry>,
    config: &SourceConfig,
    link: Link,
    memory: &mut Memory,
    stop: &CancellationToken,
) -> Ended {
    let facts = tokio::select! {
        () = stop.cancelled() => return Ended::Stopped,
        facts = facts::read(&link.session) => facts,
    };
    let facts = match facts {
        Ok(facts) => facts,
        Err(problem) => return Ended::Lost { problem, has_flowed: false },
    };
    let server = Some((facts.started_at, facts.namespaces.uris()));
    let is_same_server = memory.server == server;
    memory.server = server;
    let connection = Connection::new(
        config.source_id.clone(),
        Arc::clone(&link.session),
        facts.namespaces,
        facts.limits,
    );
    let feed = Arc::new(Feed::new(Arc::clone(entry), floor.outbox.clone(), connection.clone()));
    entry.begin(connection.clone(), link.endpoint.clone(), facts.clock_ahead_ms, Arc::clone(&feed));
    entry.meter.sign_of_life(0);
    tracing::info!(source.id = %config.source_id, endpoint = %link.endpoint.endpoint_url,
        security = ?link.endpoint.security_policy, "A source is connected.");

    let mut session = Session {
        floor,
        entry,
        config,
        connection: connection.clone(),
        feed: Arc::clone(&feed),
        subscriptions: Subscriptions::new(
            Arc::clone(entry),
            connection.clone(),
            Arc::clone(&feed),
            floor.outbox.clone(),
            config.clone(),
        ),
        audit: Audit::new(config.silence_max(), &memory.stalls),
        is_busy: Arc::new(AtomicBool::new(true)),
        to_learn: None,
        asked_at: Instant::now(),
    };
    let is_busy = Arc::clone(&session.is_busy);
    let ended = tokio::select! {
        biased;
        () = stop.cancelled() => None,
        status = link.lost() => {
            Some(problem(Kind::ConnectionLost, format!("The connection was lost: {status}.")))
        }
        problem = silence(&connection, &feed, config.silence_max(), &is_busy) => Some(problem),
        problem = session.work(memory, is_same_server) => Some(problem),
    };
    match &ended {
        None => session.say_goodbye(GOODBYE_TIMEOUT).await,
        Some(problem) if problem.kind == Kind::ConnectionLost => {}
        // It may well not answer any more.
        Some(_) => session.say_goodbye(GOODBYE_TIMEOUT / 4).await,
    }
    let has_flowed = feed.live() > 0;
    feed.close();
    entry.end();
    let value = DataValue::status_only(StatusCode::BAD_NOT_CONNECTED, Some(now()));
    let lost =
        entry.wanted_inputs().into_iter().map(|input| InputChange { input, value: value.clone() });
    floor.outbox.push(lost.collect());
    match ended {
        None => Ended::Stopped,
        Some(problem) => Ended::Lost { problem, has_flowed },
    }
}

/// Waits until nothing has been heard for too long. While items are created, which keeps servers
/// busy, any answer is a sign of life; else each subscription must send its keep-alives.
async fn silence(
    connection: &Connection,
    feed: &Feed,
    max: Duration,
    is_busy: &AtomicBool,
) -> SourceProblem {
    let mut tick = tokio::time::interval(max / 10);
    tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Skip);
    loop {
        tick.tick().await;
        let Some(silence) = feed.silence() else { continue };
        let is_excused = is_busy.load(Ordering::Relaxed) && connection.silence() <= max;
        if silence > max && !is_excused {
            return problem(
                Kind::Stalled,
                format!("Nothing was heard for {:.1} s.", silence.as_secs_f64()),
            );
        }
    }
}

struct Session<'a> {
    floor: &'a Arc<Floor>,
    entry: &'a Arc<Entry>,
    config: &'a SourceConfig,
    connection: Connection,
    feed: Arc<Feed>,
    subscriptions: Subscriptions,
    audit: Audit,
    /// Set while items are created.
    is_busy: Arc<AtomicBool>,
    /// Nodes whose browse paths are to be learned; `None` where that is to be looked up.
    to_learn: Option<Vec<NodeId>>,
    /// When the server was last asked whether it runs, while there is no subscription.
    asked_at: Instant,
}

impl Session<'_> {
    /// Does what is to be done until something is wrong.
    async fn work(&mut self, memory: &mut Memory, is_same_server: bool) -> SourceProblem {
        match self.try_work(memory, is_same_server).await {
            Ok(problem) => problem,
            Err(ShopFloorError::NotConnected(_)) => {
                problem(Kind::ConnectionLost, "The server closed the session.")
            }
            Err(error @ ShopFloorError::Timeout(_)) => problem(Kind::Stalled, format!("{error}.")),
            Err(error) => problem(Kind::Refused, format!("{error}.")),
        }
    }

    async fn try_work(
        &mut self,
        memory: &mut Memory,
        is_same_server: bool,
    ) -> Result<SourceProblem, ShopFloorError> {
        self.entry.set_state(self.floor, SourceState::Subscribing, None);
        let wanted = self.entry.take_all();
        if !is_same_server {
            self.look_for_moved(&wanted, memory).await?;
        }
        let wanted = wanted.into_iter().map(|request| (request.input, Some(request))).collect();
        self.apply(wanted, memory).await?;
        self.entry.set_state(self.floor, SourceState::Connected, None);
        let mut tick = tokio::time::interval(TICK);
        tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Skip);
        let feed = Arc::clone(&self.feed);
        let mut live = 0;
        let connection = self.connection.clone();
        // Reading all data types of a server takes a while and must not keep us from the rest.
        let mut types_loading: Option<BoxFuture<'_, bool>> = None;
        loop {
            tokio::select! {
                () = self.entry.wanted_changed() => {
                    let changed = self.entry.take_changed();
                    self.apply(changed, memory).await?;
                    self.floor.status_has_changed();
                }
                () = feed.types_needed.notified(), if types_loading.is_none() => {
                    types_loading = Some(connection.load_types().boxed());
                }
                Some(_) = OptionFuture::from(types_loading.as_mut()) => {
                    types_loading = None;
                    self.deliver_held(memory).await?;
                }
                () = feed.subscription_ended.notified() => {
                    return Ok(problem(Kind::Stalled, "The server ended a subscription."));
                }
                _ = tick.tick() => {
                    if let Some(problem) = self.look_after(memory).await? {
                        return Ok(problem);
                    }
                    if std::mem::replace(&mut live, feed.live()) != feed.live() {
                        self.floor.status_has_changed();
                    }
                }
            }
        }
    }

    async fn apply(
        &mut self,
        changed: Vec<(InputKey, Option<Arc<MonitorRequest>>)>,
        memory: &mut Memory,
    ) -> Result<(), ShopFloorError> {
        self.is_busy.store(true, Ordering::Relaxed);
        self.to_learn = None;
        let applied = self.subscriptions.apply(changed, memory).await;
        self.feed.excuse_silence();
        self.is_busy.store(false, Ordering::Relaxed);
        applied
    }

    /// The regular round: is the server there, refused items, audit, browse paths.
    async fn look_after(
        &mut self,
        memory: &mut Memory,
    ) -> Result<Option<SourceProblem>, ShopFloorError> {
        if self.feed.silence().is_none() && self.asked_at.elapsed() > self.config.silence_max() / 2
        {
            self.asked_at = Instant::now();
            if !facts::is_running(self.connection.session()).await {
                return Ok(Some(problem(
                    Kind::Stalled,
                    "The server does not run or does not answer.",
                )));
            }
            self.entry.meter.sign_of_life(0);
        }
        if self.subscriptions.is_retry_due() {
            self.is_busy.store(true, Ordering::Relaxed);
            self.to_learn = None;
            self.subscriptions.retry(memory).await?;
            self.feed.excuse_silence();
            self.is_busy.store(false, Ordering::Relaxed);
        }
        if self.audit.round(&self.connection, &self.feed, &self.subscriptions, memory).await? {
            let message = "Values have changed on the server but were not delivered.";
            return Ok(Some(problem(Kind::Stalled, message)));
        }
        self.learn_paths(memory).await?;
        Ok(None)
    }

    /// Finds nodes that another node's id now names, before they are subscribed.
    async fn look_for_moved(
        &self,
        wanted: &[Arc<MonitorRequest>],
        memory: &mut Memory,
    ) -> Result<(), ShopFloorError> {
        let with_path: Vec<_> = wanted
            .iter()
            .filter_map(|request| Some((Arc::clone(request), memory.path_of(request)?)))
            .collect();
        memory.moved = paths::moved(&self.connection, &with_path).await?;
        if !memory.moved.is_empty() {
            tracing::info!(source.id = %self.config.source_id, nodes = memory.moved.len(),
                "Nodes have other ids than before and were found at their browse paths.");
        }
        Ok(())
    }

    /// Learns where monitored nodes hang, a few at a time.
    async fn learn_paths(&mut self, memory: &mut Memory) -> Result<(), ShopFloorError> {
        let is_new = self.to_learn.is_none();
        let to_learn =
            self.to_learn.get_or_insert_with(|| memory.unknown_of(self.subscriptions.monitored()));
        let few = to_learn.split_off(to_learn.len().saturating_sub(PATHS_PER_TICK));
        let are_last = !few.is_empty() && to_learn.is_empty();
        let namespaces = self.connection.namespaces();
        let known = few
            .into_iter()
            .filter_map(|node| Some((node_id_to_stack(&node, &namespaces).ok()?, node)));
        let (ids, nodes): (Vec<_>, Vec<_>) = known.unzip();
        if !ids.is_empty() {
            let found = match paths::learn(&self.connection, &ids).await {
                Ok(found) => found,
                // A server that cannot browse upwards is a good source all the same.
                Err(ShopFloorError::Refused { .. }) => vec![None; ids.len()],
                Err(error) => return Err(error),
            };
            memory.learned.extend(nodes.into_iter().zip(found));
        }
        // Counting looks at every input: not after each few of many.
        if is_new || are_last {
            let findable = self
                .subscriptions
                .monitored()
                .filter(|request| memory.knows_path_of(request))
                .count();
            self.entry.set_findable(findable);
        }
        Ok(())
    }

    /// Delivers the structures that waited for the server's data types.
    async fn deliver_held(&self, memory: &Memory) -> Result<(), ShopFloorError> {
        let held: Vec<_> = self
            .feed
            .take_held()
            .into_iter()
            .filter_map(|(handle, input)| Some((handle, self.subscriptions.node_of(input)?)))
            .collect();
        let nodes: Vec<_> = held.iter().map(|(_, node)| node.clone()).collect();
        let values = services::read_monitored(&self.connection, &nodes, memory).await?;
        self.feed.deliver(held.into_iter().map(|(handle, _)| handle).zip(values).collect());
        Ok(())
    }

    /// Closes the session so that the server need not keep it.
    async fn say_goodbye(&mut self, timeout: Duration) {
        let goodbye = async {
            // Refusals do not matter any more.
            let _ = self.subscriptions.delete_all().await;
            let _ = self.connection.session().disconnect().await;
        };
        let _ = tokio::time::timeout(timeout, goodbye).await;
    }
}
