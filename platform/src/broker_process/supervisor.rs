//! The platform's side: starts the process, starts it again when it has died, and orders.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    convert::Infallible,
    io,
    net::SocketAddr,
    path::{Path, PathBuf},
    process::Stdio,
    sync::Arc,
    time::{Duration, Instant},
};

use broker::{BrokerUser, QueueName, QueueOptions};
use parking_lot::Mutex;
use tokio::{
    io::{AsyncWriteExt, BufReader},
    process::{Child, ChildStdin, ChildStdout, Command},
    sync::{mpsc, oneshot, watch},
    time::timeout,
};
use tokio_util::sync::CancellationToken;

use super::lines::BoundedLines;
use super::wire::{self, Answer, BrokerRequest, Line, Order, Setup};

/// Time for a new process to listen.
const START_TIMEOUT: Duration = Duration::from_secs(30);
/// Time in which the first process may fail: the one of a platform that was killed may still hold
/// the addresses.
const FIRST_START_TIMEOUT: Duration = Duration::from_secs(10);
/// First pause before a process is started again; doubled with each failure.
const RESTART_MIN: Duration = Duration::from_millis(500);
/// Longest pause before a process is started again.
const RESTART_MAX: Duration = Duration::from_secs(30);
/// Life of a process after which its end counts as the first failure.
const STABLE_AFTER: Duration = Duration::from_secs(60);
/// Time for the process to answer an order.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(10);
/// Time for the process to close its connections and to end.
const STOP_TIMEOUT: Duration = Duration::from_secs(8);
/// Interval in which the metrics of the process are fetched.
const METRICS_INTERVAL: Duration = Duration::from_secs(5);
/// Orders that may wait for the process.
const ORDERS_MAX: usize = 1024;

/// The process could not be started.
#[derive(Debug, thiserror::Error)]
pub enum BrokerProcessError {
    #[error("the program {} cannot be started", program.display())]
    Spawn { program: PathBuf, source: io::Error },
    /// The reason is on standard error.
    #[error("the broker's process ended before it listened; the log says why")]
    Ended,
    #[error("the broker's process did not listen in time")]
    TooLate,
}

/// A process that listens, to be kept alive by [`run`](Self::run).
pub struct BrokerProcess {
    shared: Arc<ProcessState>,
    running: Running,
}

/// Handle to the broker's process, whichever runs at the moment; clones share it.
#[derive(Clone)]
pub struct BrokerProcessHandle(Arc<ProcessState>);

struct ProcessState {
    program: PathBuf,
    addresses: Vec<SocketAddr>,
    desired: Mutex<Desired>,
    /// Orders to the running process; none while there is none.
    orders: Mutex<Option<mpsc::Sender<Asked>>>,
    is_up: watch::Sender<bool>,
    metrics: Arc<Mutex<String>>,
}

/// State that every new process gets.
struct Desired {
    setup: Setup,
    queues: BTreeMap<QueueName, QueueOptions>,
    /// Queues that are not to be there, of which an earlier process may have left some on the disk.
    deleted: BTreeSet<QueueName>,
}

struct Asked {
    request: BrokerRequest,
    /// None for the metrics, whose answer is kept.
    reply: Option<oneshot::Sender<Answer>>,
}

/// One life of the process.
struct Running {
    child: Child,
    input: ChildStdin,
    output: BoundedLines<BufReader<ChildStdout>>,
    addresses: Vec<SocketAddr>,
    /// Users that it began with.
    users: Vec<String>,
    since: Instant,
}

impl BrokerProcess {
    /// Starts the process and waits until it listens.
    ///
    /// # Errors
    /// [`BrokerProcessError`].
    pub async fn start(
        program: PathBuf,
        mut setup: Setup,
        users: &HashMap<String, BrokerUser>,
    ) -> Result<(Self, BrokerProcessHandle), BrokerProcessError> {
        setup.users = wire::to_wire(users);
        let begun = Instant::now();
        let running = loop {
            match Running::start(&program, &setup).await {
                Ok(running) => break running,
                Err(error) if begun.elapsed() > FIRST_START_TIMEOUT => return Err(error),
                Err(error) => {
                    tracing::warn!(%error, "The broker did not start; trying again.");
                    tokio::time::sleep(RESTART_MIN).await;
                }
            }
        };
        // The ports that were free at the first start stay the broker's.
        for (listener, address) in setup.listeners.iter_mut().zip(&running.addresses) {
            listener.address = *address;
        }
        let shared = Arc::new(ProcessState {
            program,
            addresses: running.addresses.clone(),
            desired: Mutex::new(Desired {
                setup,
                queues: BTreeMap::new(),
                deleted: BTreeSet::new(),
            }),
            orders: Mutex::default(),
            is_up: watch::Sender::new(true),
            metrics: Arc::default(),
        });
        let handle = BrokerProcessHandle(Arc::clone(&shared));
        Ok((Self { shared, running }, handle))
    }

    /// Keeps a process running until `shutdown`, then ends it in order.
    ///
    /// # Errors
    /// Never; a process that cannot be started is tried again.
    pub async fn run(self, shutdown: CancellationToken) -> Result<(), Infallible> {
        let Self { shared, mut running } = self;
        let mut pause = RESTART_MIN;
        loop {
            let since = running.since;
            running.serve(&shared, &shutdown).await;
            shared.orders.lock().take();
            shared.is_up.send_replace(false);
            shared.metrics.lock().clear();
            if shutdown.is_cancelled() {
                return Ok(());
            }
            metrics::counter!("platform_broker_restarts_total").increment(1);
            if since.elapsed() > STABLE_AFTER {
                pause = RESTART_MIN;
            }
            running = loop {
                tracing::error!(?pause, "The broker has died; it is started again.");
                if shutdown.run_until_cancelled(tokio::time::sleep(pause)).await.is_none() {
                    return Ok(());
                }
                pause = (pause * 2).min(RESTART_MAX);
                let setup = shared.desired.lock().setup.clone();
                match Running::start(&shared.program, &setup).await {
                    Ok(running) => break running,
                    Err(error) => tracing::error!(%error, "The broker does not start."),
                }
            };
            shared.is_up.send_replace(true);
        }
    }
}

impl Running {
    async fn start(program: &Path, setup: &Setup) -> Result<Self, BrokerProcessError> {
        let spawned = Command::new(program)
            .args(["broker", "--supervised"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .kill_on_drop(true)
            .spawn();
        let failed = |source| BrokerProcessError::Spawn { program: program.to_owned(), source };
        let mut child = spawned.map_err(failed)?;
        let (Some(mut input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(BrokerProcessError::Ended);
        };
        let mut output = BoundedLines::new(BufReader::new(output));
        let first = async {
            input.write_all(&line(setup)).await.ok()?;
            let first = output.next_line().await.ok()??;
            match serde_json::from_str(&first).ok()? {
                Line::Listening(addresses) => Some(addresses),
                Line::Answer { .. } => None,
            }
        };
        let addresses = timeout(START_TIMEOUT, first).await;
        let addresses = addresses.map_err(|_| BrokerProcessError::TooLate)?;
        let addresses = addresses.ok_or(BrokerProcessError::Ended)?;
        let users = setup.users.iter().map(|user| user.name.clone()).collect();
        Ok(Self { child, input, output, addresses, users, since: Instant::now() })
    }

    /// Carries orders and answers until the process ends, or is told to.
    async fn serve(self, shared: &ProcessState, shutdown: &CancellationToken) {
        let Self { mut child, mut input, mut output, users: first_users, .. } = self;
        let (orders, mut asked) = mpsc::channel(ORDERS_MAX);
        // A task of its own writes, so that a process that waits for its answers to be read never
        // keeps them from being read.
        let (lines, mut to_write) = mpsc::channel::<Vec<u8>>(ORDERS_MAX);
        let writing = tokio::spawn(async move {
            while let Some(line) = to_write.recv().await {
                if input.write_all(&line).await.is_err() {
                    break;
                }
            }
        });
        // What was said while there was no process comes before whatever is said from now on.
        {
            let desired = shared.desired.lock();
            let users = BrokerRequest::SetUsers(desired.setup.users.clone());
            let queues = desired.queues.iter().map(|(queue, options)| {
                BrokerRequest::DeclareQueue { queue: queue.clone(), options: *options }
            });
            // A user that was removed while the process started may have signed in to it.
            let is_gone = |name: &&String| !desired.setup.users.iter().any(|u| u.name == **name);
            let removed = first_users.iter().filter(is_gone);
            let removed = removed.map(|name| BrokerRequest::Disconnect { user_name: name.clone() });
            let deleted = desired.deleted.iter().cloned();
            let deleted = deleted.map(|queue| BrokerRequest::DeleteQueue { queue });
            for request in std::iter::once(users).chain(removed).chain(queues).chain(deleted) {
                let _ = lines.try_send(line(&Order { id: 0, request }));
            }
            *shared.orders.lock() = Some(orders);
        }
        let mut waiting: HashMap<u64, Option<oneshot::Sender<Answer>>> = HashMap::new();
        let mut next_id = 1;
        let mut ticks = tokio::time::interval(METRICS_INTERVAL);
        loop {
            let next = tokio::select! {
                () = shutdown.cancelled() => break,
                _ = ticks.tick() => Asked { request: BrokerRequest::Metrics, reply: None },
                Some(next) = asked.recv() => next,
                answered = output.next_line() => {
                    let Ok(Some(text)) = answered else { break };
                    if let Ok(Line::Answer { id, answer }) = serde_json::from_str(&text) {
                        match (waiting.remove(&id), answer) {
                            (Some(None), Answer::Metrics(text)) => *shared.metrics.lock() = text,
                            (Some(Some(reply)), answer) => drop(reply.send(answer)),
                            _ => {}
                        }
                    }
                    continue;
                }
            };
            if lines.try_send(line(&Order { id: next_id, request: next.request })).is_ok() {
                waiting.insert(next_id, next.reply);
                next_id += 1;
            }
        }
        if shutdown.is_cancelled() {
            let _ = lines.send(line(&Order { id: 0, request: BrokerRequest::Stop })).await;
        }
        // Ends the writer, and with it the input of the process.
        drop(lines);
        let ending = async {
            let _ = writing.await;
            // Whatever it still says must not block it.
            while let Ok(Some(_)) = output.next_line().await {}
            child.wait().await
        };
        if timeout(STOP_TIMEOUT, ending).await.is_err() {
            tracing::warn!("The broker did not end in time; it is killed.");
            let _ = child.kill().await;
        }
    }
}

impl BrokerProcessHandle {
    pub(super) fn addresses(&self) -> &[SocketAddr] {
        &self.0.addresses
    }

    /// Tells whether the process runs.
    #[must_use]
    pub fn is_up(&self) -> watch::Receiver<bool> {
        self.0.is_up.subscribe()
    }

    /// Returns the metrics of the process in the text format, as they were a few seconds ago.
    #[must_use]
    pub fn metrics(&self) -> Arc<Mutex<String>> {
        Arc::clone(&self.0.metrics)
    }

    /// Replaces the users, of this process and of those to come.
    pub(super) async fn set_users(&self, users: &HashMap<String, BrokerUser>) {
        let users = wire::to_wire(users);
        self.0.desired.lock().setup.users.clone_from(&users);
        // Without an answer there is no process that knows the old ones.
        self.ask(BrokerRequest::SetUsers(users)).await;
    }

    /// Declares a queue, in this process and in those to come.
    pub(super) async fn declare_queue(&self, queue: &QueueName, options: QueueOptions) -> Answer {
        let known = {
            let mut desired = self.0.desired.lock();
            desired.deleted.remove(queue);
            desired.queues.insert(queue.clone(), options)
        };
        if known == Some(options) {
            return Answer::Done;
        }
        let request = BrokerRequest::DeclareQueue { queue: queue.clone(), options };
        self.ask(request).await.unwrap_or(Answer::Done)
    }

    /// Deletes a queue, in this process and in those to come. None where that was said before, or there is
    /// no process at the moment.
    pub(super) async fn delete_queue(&self, queue: &QueueName) -> Option<Answer> {
        {
            let mut desired = self.0.desired.lock();
            desired.queues.remove(queue);
            if !desired.deleted.insert(queue.clone()) {
                return None;
            }
        }
        let answer = self.ask(BrokerRequest::DeleteQueue { queue: queue.clone() }).await;
        if matches!(answer, Some(Answer::Failed(_))) {
            // The next run tries again.
            self.0.desired.lock().deleted.remove(queue);
        }
        answer
    }

    /// Orders and waits for the answer; none while there is no process.
    pub(super) async fn ask(&self, request: BrokerRequest) -> Option<Answer> {
        let orders = self.0.orders.lock().clone()?;
        let (reply, answer) = oneshot::channel();
        orders.send(Asked { request, reply: Some(reply) }).await.ok()?;
        timeout(ANSWER_TIMEOUT, answer).await.ok()?.ok()
    }
}

fn line(value: &impl serde::Serialize) -> Vec<u8> {
    let mut text = serde_json::to_vec(value).expect("texts and numbers are JSON");
    text.push(b'\n');
    text
}
