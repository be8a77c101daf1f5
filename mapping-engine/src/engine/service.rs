//! Task around the engine's decisions: channels, time and shutdown.

use std::{sync::Arc, time::SystemTime};

use asi_model::DateTime;
use mapping::Candidate;
use shop_floor::InputChange;
use tokio::{
    sync::mpsc,
    task::JoinSet,
    time::{Duration, sleep, timeout},
};
use tokio_util::sync::CancellationToken;

use super::{
    command::MappingCommand,
    config::MappingEngineConfig,
    core::Core,
    dry_runner::{self, DryRunRequest},
    handle::MappingEngineHandle,
    recording::VariableRecording,
};
use crate::{
    dry_run::SAMPLES_MAX,
    inputs::Inputs,
    script::{
        config::ScriptConfig,
        status::{ScriptWorkers, WorkerPurpose},
        worker_queue::{Completion, WorkerQueue},
    },
};

/// Time that the consumer has at shutdown to take the candidates that wait. A consumer that has
/// ended takes none.
const SHUTDOWN_DRAIN_TIMEOUT: Duration = Duration::from_secs(2);
/// Most worker processes, whatever is configured.
const WORKERS_MAX: usize = 64;

/// The engine's task: takes changes of inputs, runs the chains, yields candidates.
pub struct MappingEngine {
    config: MappingEngineConfig,
    inputs: Box<dyn Inputs>,
    changes: mpsc::Receiver<Vec<InputChange>>,
    commands: mpsc::Receiver<MappingCommand>,
    dry_runs: mpsc::Receiver<DryRunRequest>,
    workers: ScriptWorkers,
    candidates: mpsc::Sender<Vec<Candidate>>,
    former: Vec<VariableRecording>,
}

impl MappingEngine {
    /// Returns an engine, its handle, and the receiver of its candidates.
    ///
    /// The engine monitors variables through `inputs`; their changes arrive through `changes`.
    #[must_use]
    pub fn new(
        config: MappingEngineConfig,
        inputs: impl Inputs,
        changes: mpsc::Receiver<Vec<InputChange>>,
    ) -> (Self, MappingEngineHandle, mpsc::Receiver<Vec<Candidate>>) {
        let (commands, for_commands) = mpsc::channel(64);
        let (dry_runs, for_dry_runs) = mpsc::channel(16);
        let (candidates, consumer) = mpsc::channel(config.waiting_batches_max.max(1));
        let workers = ScriptWorkers::default();
        let handle = MappingEngineHandle { commands, dry_runs, workers: workers.clone() };
        let engine = Self {
            config,
            inputs: Box::new(inputs),
            changes,
            commands: for_commands,
            dry_runs: for_dry_runs,
            workers,
            candidates,
            former: Vec::new(),
        };
        (engine, handle, consumer)
    }

    /// Gives dry runs the values that were recorded before the start. No mapping runs on them.
    pub fn resume(&mut self, former: Vec<VariableRecording>) {
        self.former = former;
    }

    /// Runs until `shutdown`, or until the receiver of candidates is dropped. Then it sends the
    /// candidates that wait and ends the workers.
    pub async fn run(self, shutdown: CancellationToken) {
        let Self {
            config,
            inputs,
            mut changes,
            mut commands,
            dry_runs,
            workers,
            candidates,
            former,
        } = self;
        let workers_stop = CancellationToken::new();
        let mut tasks = JoinSet::new();
        let script = Arc::new(config.script.clone());
        let (queues, mut completions) = start_workers(&script, &workers, &mut tasks, &workers_stop);
        tasks.spawn(dry_runner::serve(
            script,
            workers.place(WorkerPurpose::DryRuns, 0),
            dry_runs,
            workers_stop.clone(),
        ));
        let mut core = Core::new(config, inputs, queues);
        core.resume(former);
        let (mut has_changes, mut has_handles) = (true, true);
        loop {
            let timer = core.next_timer();
            tokio::select! {
                () = shutdown.cancelled() => break,
                command = commands.recv(), if has_handles => match command {
                    Some(command) => handle_command(&mut core, command),
                    // Without a handle the published mappings still run.
                    None => has_handles = false,
                },
                // Without room changes wait at the shop floor, which coalesces them.
                batch = changes.recv(), if has_changes && core.has_room() => match batch {
                    Some(batch) => core.changed(batch, now()),
                    None => has_changes = false,
                },
                Some(completion) = completions.recv() => core.completed(completion, now()),
                permit = candidates.reserve(), if core.has_candidates() => match permit {
                    Ok(permit) => permit.send(core.candidates()),
                    Err(_) => break,
                },
                () = until(timer), if timer.is_some() => core.wake(now()),
            }
            // Saves a turn of the loop where the channel has room.
            if core.has_candidates()
                && let Ok(permit) = candidates.try_reserve()
            {
                permit.send(core.candidates());
            }
        }
        if core.has_candidates() {
            let left = core.candidates();
            if timeout(SHUTDOWN_DRAIN_TIMEOUT, candidates.send(left)).await.is_err() {
                tracing::warn!("The consumer did not take the last candidates.");
            }
        }
        workers_stop.cancel();
        join_all(tasks).await;
    }
}

fn start_workers(
    config: &Arc<ScriptConfig>,
    statuses: &ScriptWorkers,
    tasks: &mut JoinSet<()>,
    stop: &CancellationToken,
) -> (Vec<WorkerQueue>, mpsc::Receiver<Completion>) {
    let workers = config.workers.clamp(1, WORKERS_MAX);
    let (completion, completions) = mpsc::channel(workers);
    let mut queues = Vec::with_capacity(workers);
    for index in 0..workers {
        let place = statuses.place(WorkerPurpose::Mappings, index);
        let (queue, serving) =
            WorkerQueue::new(index, Arc::clone(config), place, completion.clone(), stop.clone());
        queues.push(queue);
        tasks.spawn(serving);
    }
    (queues, completions)
}

async fn join_all(mut tasks: JoinSet<()>) {
    while let Some(ended) = tasks.join_next().await {
        if let Err(error) = ended {
            tracing::error!(
                error = &error as &dyn std::error::Error,
                "A task of the mapping engine failed."
            );
        }
    }
}

fn handle_command(core: &mut Core, command: MappingCommand) {
    // The caller may have dropped its receiver; the command is carried out nevertheless.
    match command {
        MappingCommand::Put(compiled, reply) => drop(reply.send(core.put_many(compiled, now()))),
        MappingCommand::Remove(id, reply) => drop(reply.send(core.remove(&id))),
        MappingCommand::Status(id, reply) => drop(reply.send(core.status(&id))),
        MappingCommand::Survey(wanted, most, reply) => drop(reply.send(core.survey(wanted, most))),
        MappingCommand::Reset(id, reply) => drop(reply.send(core.reset(&id))),
        MappingCommand::Recorded(inputs, reply) => {
            drop(reply.send(core.recorded(&inputs, SAMPLES_MAX)))
        }
        MappingCommand::Recordings(most, reply) => drop(reply.send(core.recordings(most))),
    }
}

#[expect(clippy::disallowed_methods, reason = "the clock of the engine")]
fn now() -> DateTime {
    SystemTime::now().into()
}

async fn until(due: Option<DateTime>) {
    if let Some(due) = due {
        sleep(due.since(now())).await;
    }
}
