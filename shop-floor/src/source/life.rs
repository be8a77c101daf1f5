//! The life of one session, from its first question to its end.

use std::{
    collections::HashMap,
    sync::Arc,
    time::{Duration, Instant},
};

use asi_model::values::{DataValue, DateTime, NodeId, StatusCode};
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
    BrowsePath, InputChange, MonitorRequest, ShopFloorError, SourceConfig, SourceProblem, SourceProblemKind as Kind,
    SourceState, service::Floor,
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
    let connection =
        Connection::new(config.source_id.clone(), Arc::clone(&link.session), facts.namespaces, facts.limits);
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
        asked_at: Instant::now(),
    };
    let ended = tokio::select! {
        biased;
        () = stop.cancelled() => None,
        status = link.lost() => {
            Some(problem(Kind::ConnectionLost, format!("The connection was lost: {status}.")))
        }
        problem = session.work(memory, is_same_server) => Some(problem),
    };
    if ended.is_none() || ended.as_ref().is_some_and(|problem| problem.kind != Kind::ConnectionLost) {
        session.say_goodbye().await;
    }
    let has_flowed = feed.live() > 0;
    feed.close();
    entry.end();
    let value = DataValue::status_only(StatusCode::BAD_NOT_CONNECTED, Some(now()));
    let lost = entry.wanted_inputs().into_iter().map(|input| InputChange { input, value: value.clone() });
    floor.outbox.push(lost.collect());
    match ended {
        None => Ended::Stopped,
        Some(problem) => Ended::Lost { problem, has_flowed },
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
    /// When the server was last asked whether it runs, while there is no subscription.
    asked_at: Instant,
}

impl Session<'_> {
    /// Does what is to be done until something is wrong.
    async fn work(&mut self, memory: &mut Memory, is_same_server: bool) -> SourceProblem {
        match self.try_work(memory, is_same_server).await {
            Ok(problem) => problem,
            Err(ShopFloorError::NotConnected(_)) => problem(Kind::ConnectionLost, "The server closed the session."),
            Err(error @ ShopFloorError::Timeout(_)) => problem(Kind::Stalled, format!("{error}.")),
            Err(error) => problem(Kind::Refused, format!("{error}.")),
        }
    }

    async fn try_work(&mut self, memory: &mut Memory, is_same_server: bool) -> Result<SourceProblem, ShopFloorError> {
        self.entry.set_state(self.floor, SourceState::Subscribing, None);
        let wanted = self.entry.take_all();
        if !is_same_server {
            self.look_for_moved(&wanted, memory).await?;
        }
        let wanted = wanted.into_iter().map(|request| (request.input, Some(request))).collect();
        self.subscriptions.apply(wanted, memory).await?;
        self.entry.set_state(self.floor, SourceState::Connected, None);
        let mut tick = tokio::time::interval(TICK);
        tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Skip);
        let feed = Arc::clone(&self.feed);
        let mut live = 0;
        loop {
            tokio::select! {
                () = self.entry.wanted_changed() => {
                    let changed = self.entry.take_changed();
                    self.subscriptions.apply(changed, memory).await?;
                    self.floor.status_has_changed();
                }
                () = feed.types_needed.notified() => self.decode_held(memory).await?,
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

    /// The regular round: silence, refused items, audit, browse paths.
    async fn look_after(&mut self, memory: &mut Memory) -> Result<Option<SourceProblem>, ShopFloorError> {
        let silence_max = self.config.silence_max();
        match self.subscriptions.silence() {
            Some(silence) if silence > silence_max => {
                let message = format!("Nothing was heard for {:.1} s.", silence.as_secs_f64());
                return Ok(Some(problem(Kind::Stalled, message)));
            }
            Some(_) => {}
            None if self.asked_at.elapsed() > silence_max / 2 => {
                self.asked_at = Instant::now();
                if !facts::is_running(self.connection.session()).await {
                    return Ok(Some(problem(Kind::Stalled, "The server does not run or does not answer.")));
                }
                self.entry.meter.sign_of_life(0);
            }
            None => {}
        }
        self.subscriptions.retry(memory).await?;
        if self.audit.round(&self.connection, &self.feed, &self.subscriptions, memory).await? {
            let message = "Values have changed on the server but were not delivered.";
            return Ok(Some(problem(Kind::Stalled, message)));
        }
        self.learn_paths(memory).await?;
        Ok(None)
    }

    /// Finds nodes that another node's id now names, before they are subscribed.
    async fn look_for_moved(&self, wanted: &[Arc<MonitorRequest>], memory: &mut Memory) -> Result<(), ShopFloorError> {
        let with_path: Vec<_> =
            wanted.iter().filter_map(|request| Some((Arc::clone(request), memory.path_of(request)?))).collect();
        memory.moved = paths::moved(&self.connection, &with_path).await?;
        if !memory.moved.is_empty() {
            tracing::info!(source.id = %self.config.source_id, nodes = memory.moved.len(),
                "Nodes have other ids than before and were found at their browse paths.");
        }
        Ok(())
    }

    /// Learns where monitored nodes hang, a few at a time.
    async fn learn_paths(&self, memory: &mut Memory) -> Result<(), ShopFloorError> {
        if memory.learned.len() >= PATHS_MAX {
            return Ok(());
        }
        let namespaces = self.connection.namespaces();
        let unknown: Vec<_> = self
            .subscriptions
            .monitored()
            .filter(|request| request.options.browse_path.is_none())
            .map(|request| &request.node_id)
            .filter(|node| !memory.learned.contains_key(*node) && !memory.moved.contains_key(*node))
            .filter_map(|node| Some((node.clone(), node_id_to_stack(node, &namespaces).ok()?)))
            .take(PATHS_PER_TICK)
            .collect();
        if unknown.is_empty() {
            return Ok(());
        }
        let ids: Vec<_> = unknown.iter().map(|(_, id)| id.clone()).collect();
        let found = match paths::learn(&self.connection, &ids).await {
            Ok(found) => found,
            // A server that cannot browse upwards is a good source all the same.
            Err(ShopFloorError::Refused { .. }) => vec![None; ids.len()],
            Err(error) => return Err(error),
        };
        memory.learned.extend(unknown.into_iter().map(|(node, _)| node).zip(found));
        Ok(())
    }

    /// Loads the server's data types and delivers the structures that waited for them.
    async fn decode_held(&self, memory: &Memory) -> Result<(), ShopFloorError> {
        self.connection.load_types().await;
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
    async fn say_goodbye(&mut self) {
        let goodbye = async {
            // Refusals do not matter any more.
            let _ = self.subscriptions.delete_all().await;
            let _ = self.connection.session().disconnect().await;
        };
        let _ = tokio::time::timeout(GOODBYE_TIMEOUT, goodbye).await;
    }
}
