//! Session of a source, from the first request to its end.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use asi_model::values::{DataValue, NodeId, StatusCode};
use futures::{
    FutureExt as _,
    future::{BoxFuture, OptionFuture},
};
use opcua_stack::values::node_id_to_stack;
use tokio_util::sync::CancellationToken;

use super::{
    audit::DeliveryAudit,
    browse_paths::{find_relocated, look_up_paths},
    connect::OpenSession,
    connection::Connection,
    memory::{ServerIdentity, SourceMemory},
    notification_sink::NotificationSink,
    record::{ServerFacts, SourceRecord},
    server_info::{self, ServerProperties},
    subscriptions::Subscriptions,
};
use crate::{
    InputChange, InputKey, MonitorRequest, ShopFloorError, SourceConfig, SourceProblem,
    SourceProblemKind as Kind, SourceState, clock, context::SourceContext,
};

/// Interval of the regular checks.
const TICK: Duration = Duration::from_millis(250);
/// Longest wait until a session is closed on the server.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);
/// Most browse paths looked up per tick.
const PATHS_PER_TICK: usize = 200;

/// End of a session, or of the attempt to establish one.
pub(super) enum SessionEnd {
    /// The source was stopped.
    Stopped,
    Lost {
        problem: SourceProblem,
        /// Values were received: the next attempt is made without backoff.
        has_flowed: bool,
    },
}

/// Runs a session to its end; then reports `BadNotConnected` for every input.
pub(super) async fn run_session(
    context: &Arc<SourceContext>,
    record: &Arc<SourceRecord>,
    config: &SourceConfig,
    opened: OpenSession,
    memory: &mut SourceMemory,
    stop: &CancellationToken,
) -> SessionEnd {
    let read = tokio::select! {
        () = stop.cancelled() => Err(SessionEnd::Stopped),
        read = server_info::read(&opened.session) => read.map_err(|problem| SessionEnd::Lost { problem, has_flowed: false }),
    };
    let properties = match read {
        Ok(properties) => properties,
        Err(end) => {
            opened.close(CLOSE_TIMEOUT / 4).await;
            return end;
        }
    };
    let is_same_server = memory.set_server(ServerIdentity {
        started_at: properties.started_at,
        namespace_uris: properties.namespaces.uris(),
    });
    let mut session = SourceSession::begin(context, record, config, &opened, properties, memory);
    let (connection, sink) = (session.connection.clone(), Arc::clone(&session.sink));
    let is_busy = Arc::clone(&session.is_busy);
    let problem = tokio::select! {
        biased;
        () = stop.cancelled() => None,
        status = opened.lost() => {
            let message = format!("The connection was lost: {status}.");
            Some(SourceProblem::new(Kind::ConnectionLost, message))
        }
        problem = exceeded_silence(&connection, &sink, config.silence_max(), &is_busy) => {
            Some(problem)
        }
        problem = opened.trust_lost(context) => Some(problem),
        problem = session.work(memory, is_same_server) => Some(problem),
    };
    let is_silent = sink.exceeded_silence().is_some();
    let last_values = session.subscriptions.last_values(memory);
    memory.remember(last_values, &record.requested_inputs());
    match &problem {
        None => session.close(CLOSE_TIMEOUT, is_silent).await,
        Some(problem) if problem.kind == Kind::ConnectionLost => {}
        // The server may not respond any more.
        Some(_) => session.close(CLOSE_TIMEOUT / 4, is_silent).await,
    }
    let has_flowed = session.end();
    match problem {
        None => SessionEnd::Stopped,
        Some(problem) => SessionEnd::Lost { problem, has_flowed },
    }
}

/// Waits until a subscription has been silent for longer than what the server granted explains. While items are created any response is a
/// sign of life, because that keeps servers busy; else each subscription must send its keep-alives.
async fn exceeded_silence(
    connection: &Connection,
    sink: &NotificationSink,
    max: Duration,
    is_busy: &AtomicBool,
) -> SourceProblem {
    let mut tick = tokio::time::interval(max / 10);
    tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Skip);
    loop {
        tick.tick().await;
        let Some(silence) = sink.exceeded_silence() else { continue };
        let responds = is_busy.load(Ordering::Relaxed) && connection.silence() <= max;
        if !responds {
            let message = format!("Nothing was heard for {:.1} s.", silence.as_secs_f64());
            return SourceProblem::new(Kind::Stalled, message);
        }
    }
}

struct SourceSession<'a> {
    context: &'a SourceContext,
    record: &'a SourceRecord,
    config: &'a SourceConfig,
    connection: Connection,
    sink: Arc<NotificationSink>,
    subscriptions: Subscriptions,
    audit: DeliveryAudit,
    /// Set while items are created.
    is_busy: Arc<AtomicBool>,
    /// Nodes whose browse paths are still to be looked up; `None` until they are collected.
    paths_missing: Option<Vec<NodeId>>,
    /// Time of the last check that the server runs, made while there is no subscription.
    state_checked_at: Instant,
}

impl<'a> SourceSession<'a> {
    /// Makes the session available to callers.
    fn begin(
        context: &'a Arc<SourceContext>,
        record: &'a Arc<SourceRecord>,
        config: &'a SourceConfig,
        opened: &OpenSession,
        properties: ServerProperties,
        memory: &SourceMemory,
    ) -> Self {
        let connection = Connection::new(
            config.source_id.clone(),
            Arc::clone(&opened.session),
            properties.namespaces,
            properties.limits,
        );
        let sink = Arc::new(NotificationSink::new(
            config.source_id.clone(),
            Arc::clone(&record.activity),
            context.changes.clone(),
            connection.clone(),
        ));
        record.begin_session(
            connection.clone(),
            opened.endpoint.clone(),
            ServerFacts { clock_ahead_ms: properties.clock_ahead_ms, product: properties.product },
            Arc::clone(&sink),
        );
        record.activity.record(0);
        tracing::info!(source.id = %config.source_id, endpoint = %opened.endpoint.endpoint_url,
            security = ?opened.endpoint.security_policy, "A source is connected.");
        let subscriptions = Subscriptions::new(
            Arc::clone(record),
            connection.clone(),
            Arc::clone(&sink),
            context.changes.clone(),
            config.clone(),
        );
        Self {
            context,
            record,
            config,
            connection,
            sink,
            subscriptions,
            audit: DeliveryAudit::new(config.silence_max(), &memory.stalls),
            is_busy: Arc::new(AtomicBool::new(true)),
            paths_missing: None,
            state_checked_at: Instant::now(),
        }
    }

    /// Ends the session for callers and inputs. Returns true when it has delivered values.
    fn end(self) -> bool {
        let has_flowed = self.sink.live() > 0;
        self.sink.close();
        self.record.end_session();
        let value = DataValue::status_only(StatusCode::BAD_NOT_CONNECTED, Some(clock::now()));
        let inputs = self.record.requested_inputs().into_iter();
        let lost = inputs.map(|input| InputChange { input, value: value.clone() }).collect();
        self.context.changes.push(lost);
        has_flowed
    }

    /// Serves the session until a problem ends it.
    async fn work(&mut self, memory: &mut SourceMemory, is_same_server: bool) -> SourceProblem {
        match self.try_work(memory, is_same_server).await {
            Ok(problem) => problem,
            Err(ShopFloorError::NotConnected(_)) => {
                SourceProblem::new(Kind::ConnectionLost, "The server closed the session.")
            }
            Err(error @ ShopFloorError::Timeout(_)) => {
                SourceProblem::new(Kind::Stalled, format!("{error}."))
            }
            Err(error) => SourceProblem::new(Kind::Refused, format!("{error}.")),
        }
    }

    async fn try_work(
        &mut self,
        memory: &mut SourceMemory,
        is_same_server: bool,
    ) -> Result<SourceProblem, ShopFloorError> {
        self.record.set_state(self.context, SourceState::Subscribing, None);
        let requests = self.record.take_all_requests();
        if !is_same_server {
            self.find_relocated(&requests, memory).await?;
        }
        let added = requests.into_iter().map(|request| (request.input, Some(request))).collect();
        self.apply(added, memory).await?;
        self.record.set_state(self.context, SourceState::Connected, None);
        let mut tick = tokio::time::interval(TICK);
        tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Skip);
        let sink = Arc::clone(&self.sink);
        let mut live = 0;
        let connection = self.connection.clone();
        // Reading all data types of a server takes a while: it runs beside the other work.
        let mut types_loading: Option<BoxFuture<'_, bool>> = None;
        loop {
            tokio::select! {
                () = self.record.requests_changed() => {
                    let changed = self.record.take_changed_requests();
                    self.apply(changed, memory).await?;
                    self.context.notify_status_changed();
                }
                () = sink.types_needed.notified(), if types_loading.is_none() => {
                    types_loading = Some(connection.load_types().boxed());
                }
                Some(_) = OptionFuture::from(types_loading.as_mut()) => {
                    types_loading = None;
                    self.deliver_decoded(memory).await?;
                }
                () = sink.refresh_needed.notified() => {
                    self.subscriptions.need_refresh();
                    self.subscriptions.refresh_conditions().await?;
                }
                () = sink.subscription_ended.notified() => {
                    return Ok(SourceProblem::new(Kind::Stalled, "The server ended a subscription."));
                }
                _ = tick.tick() => {
                    if let Some(problem) = self.run_checks(memory).await? {
                        return Ok(problem);
                    }
                    if std::mem::replace(&mut live, sink.live()) != sink.live() {
                        self.context.notify_status_changed();
                    }
                }
            }
        }
    }

    async fn apply(
        &mut self,
        changed: Vec<(InputKey, Option<Arc<MonitorRequest>>)>,
        memory: &mut SourceMemory,
    ) -> Result<(), ShopFloorError> {
        self.is_busy.store(true, Ordering::Relaxed);
        self.paths_missing = None;
        let applied = self.subscriptions.apply(changed, memory).await;
        self.sink.reset_silence();
        self.is_busy.store(false, Ordering::Relaxed);
        applied
    }

    /// Runs the regular checks: server state, refused items, conditions, audit and browse paths.
    async fn run_checks(
        &mut self,
        memory: &mut SourceMemory,
    ) -> Result<Option<SourceProblem>, ShopFloorError> {
        if !self.sink.expects_messages()
            && self.state_checked_at.elapsed() > self.config.silence_max() / 2
        {
            self.state_checked_at = Instant::now();
            if !server_info::is_running(self.connection.session()).await {
                return Ok(Some(SourceProblem::new(
                    Kind::Stalled,
                    "The server does not run or does not answer.",
                )));
            }
            self.record.activity.record(0);
        }
        if self.subscriptions.is_retry_due() {
            self.is_busy.store(true, Ordering::Relaxed);
            self.paths_missing = None;
            self.subscriptions.retry(memory).await?;
            self.sink.reset_silence();
            self.is_busy.store(false, Ordering::Relaxed);
        }
        self.subscriptions.refresh_conditions().await?;
        if self.audit.round(&self.sink, &self.subscriptions, memory).await? {
            let message = "Values have changed on the server but were not delivered.";
            return Ok(Some(SourceProblem::new(Kind::Stalled, message)));
        }
        self.look_up_paths(memory).await?;
        self.subscriptions.look_up_history(memory).await?;
        Ok(None)
    }

    /// Finds nodes with other ids than before, before they are subscribed.
    async fn find_relocated(
        &self,
        requests: &[Arc<MonitorRequest>],
        memory: &mut SourceMemory,
    ) -> Result<(), ShopFloorError> {
        let with_path: Vec<_> = requests
            .iter()
            .filter_map(|request| Some((Arc::clone(request), memory.path_of(request)?)))
            .collect();
        let relocated = find_relocated(&self.connection, &with_path).await?;
        if !relocated.is_empty() {
            tracing::info!(source.id = %self.config.source_id, nodes = relocated.len(),
                "Nodes have other ids than before and were found at their browse paths.");
        }
        memory.set_relocated(relocated);
        Ok(())
    }

    /// Looks up the browse paths of monitored nodes, a few at a time.
    async fn look_up_paths(&mut self, memory: &mut SourceMemory) -> Result<(), ShopFloorError> {
        let is_new = self.paths_missing.is_none();
        let paths_missing = self
            .paths_missing
            .get_or_insert_with(|| memory.nodes_without_path(self.subscriptions.monitored()));
        let batch = paths_missing.split_off(paths_missing.len().saturating_sub(PATHS_PER_TICK));
        let are_last = !batch.is_empty() && paths_missing.is_empty();
        let namespaces = self.connection.namespaces();
        let known = batch
            .into_iter()
            .filter_map(|node| Some((node_id_to_stack(&node, &namespaces).ok()?, node)));
        let (ids, nodes): (Vec<_>, Vec<_>) = known.unzip();
        if !ids.is_empty() {
            let found = match look_up_paths(&self.connection, &ids).await {
                Ok(found) => found,
                // A server that refuses to browse upwards still delivers values.
                Err(ShopFloorError::Refused { .. }) => vec![None; ids.len()],
                Err(error) => return Err(error),
            };
            memory.learn_paths(nodes.into_iter().zip(found));
        }
        // Counting visits every input, so it is not done after each of many batches.
        if is_new || are_last {
            let findable = self
                .subscriptions
                .monitored()
                .filter(|request| memory.knows_path_of(request))
                .count();
            self.record.set_findable(findable);
        }
        Ok(())
    }

    /// Reads and delivers the structures that awaited the server's data types.
    async fn deliver_decoded(&self, memory: &SourceMemory) -> Result<(), ShopFloorError> {
        let awaiting: Vec<_> = self
            .sink
            .take_awaiting_type()
            .into_iter()
            .filter_map(|(handle, input)| Some((handle, self.subscriptions.node_of(input)?)))
            .collect();
        let nodes: Vec<_> = awaiting.iter().map(|(_, node)| node.clone()).collect();
        let values = self.subscriptions.read_monitored(&nodes, memory).await?;
        self.sink.accept(awaiting.into_iter().map(|(handle, _)| handle).zip(values).collect());
        Ok(())
    }

    /// Closes the session on the server, which else stores it until its timeout; devices have room for few. A silent
    /// server gets this one request only, and at once: it reads it when it goes on, although nobody waits by then.
    async fn close(&mut self, timeout: Duration, is_silent: bool) {
        // The session ends in any case.
        if !is_silent {
            let _ = tokio::time::timeout(timeout / 2, self.subscriptions.delete_all()).await;
        }
        let _ = tokio::time::timeout(timeout / 2, self.connection.session().disconnect()).await;
    }
}
