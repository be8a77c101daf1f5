//! The task around the engine's decisions.

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
    Command, MappingEngineConfig,
    core::Core,
    trial::{self, Trial},
};
use crate::{dry_run::SAMPLES_MAX, inputs::Inputs, script::lane::Lane};

/// How long the consumer may take for what is left at shutdown.
const FAREWELL_BUDGET: Duration = Duration::from_secs(2);

/// The service: takes changes of inputs, runs the chains, yields candidates.
pub struct MappingEngine {
    config: MappingEngineConfig,
    inputs: Box<dyn Inputs>,
    changes: mpsc::Receiver<Vec<InputChange>>,
    commands: mpsc::Receiver<Command>,
    trials: mpsc::Receiver<Trial>,
    candidates: mpsc::Sender<Vec<Candidate>>,
}

impl MappingEngine {
    pub(super) fn assemble(
        config: MappingEngineConfig,
        inputs: Box<dyn Inputs>,
        changes: mpsc::Receiver<Vec<InputChange>>,
        commands: mpsc::Receiver<Command>,
        trials: mpsc::Receiver<Trial>,
        candidates: mpsc::Sender<Vec<Candidate>>,
    ) -> Self {
        Self { config, inputs, changes, commands, trials, candidates }
    }

    /// Runs until told to stop, or until nobody takes candidates any more. Then what was made is
    /// handed over and the workers are ended.
    pub async fn run(self, shutdown: CancellationToken) {
        let Self { config, inputs, mut changes, mut commands, trials, candidates } = self;
        let workers_stop = CancellationToken::new();
        let mut tasks = JoinSet::new();
        let script = Arc::new(config.script.clone());
        let workers = config.script.workers.clamp(1, 64);
        let (report, mut reports) = mpsc::channel(workers);
        let mut lanes = Vec::with_capacity(workers);
        for index in 0..workers {
            let (lane, serving) =
                Lane::new(index, Arc::clone(&script), report.clone(), workers_stop.clone());
            lanes.push(lane);
            tasks.spawn(serving);
        }
        tasks.spawn(trial::serve(script, trials, workers_stop.clone()));
        let mut core = Core::new(config, inputs, lanes);
        let (mut has_changes, mut has_handles) = (true, true);
        loop {
            let timer = core.next_timer();
            tokio::select! {
                () = shutdown.cancelled() => break,
                command = commands.recv(), if has_handles => match command {
                    Some(command) => obey(&mut core, command),
                    // Handles may go; the mappings stay.
                    None => has_handles = false,
                },
                batch = changes.recv(), if has_changes && core.has_room() => match batch {
                    Some(batch) => core.changed(batch, now()),
                    None => has_changes = false,
                },
                Some(report) = reports.recv() => core.reported(report, now()),
                permit = candidates.reserve(), if core.has_candidates() => match permit {
                    Ok(permit) => permit.send(core.candidates()),
                    Err(_) => break,
                },
                () = until(timer), if timer.is_some() => core.wake(now()),
            }
            // Without a turn through the loop where there is room anyway.
            if core.has_candidates()
                && let Ok(permit) = candidates.try_reserve()
            {
                permit.send(core.candidates());
            }
        }
        if core.has_candidates() {
            let left = core.candidates();
            if timeout(FAREWELL_BUDGET, candidates.send(left)).await.is_err() {
                tracing::warn!("The consumer did not take the last candidates.");
            }
        }
        workers_stop.cancel();
        while let Some(ended) = tasks.join_next().await {
            if let Err(error) = ended {
                tracing::error!(
                    error = &error as &dyn std::error::Error,
                    "A task of the mapping engine failed."
                );
            }
        }
    }
}

fn obey(core: &mut Core, command: Command) {
    // Whoever asked may have gone; what was asked is done all the same.
    match command {
        Command::Put(compiled, reply) => drop(reply.send(core.put_many(compiled, now()))),
        Command::Remove(id, reply) => drop(reply.send(core.remove(&id))),
        Command::Status(id, reply) => drop(reply.send(core.status(&id))),
        Command::Survey(wanted, most, reply) => drop(reply.send(core.survey(wanted, most))),
        Command::Reset(id, reply) => drop(reply.send(core.reset(&id))),
        Command::Recorded(inputs, reply) => drop(reply.send(core.recorded(&inputs, SAMPLES_MAX))),
    }
}

fn now() -> DateTime {
    SystemTime::now().into()
}

async fn until(due: Option<DateTime>) {
    if let Some(due) = due {
        sleep(due.since(now())).await;
    }
}
