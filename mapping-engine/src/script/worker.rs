//! Worker that restarts itself: started when needed, restarted when lost, loaded with its scripts
//! again.

use std::{
    collections::HashMap,
    sync::Arc,
    time::{Duration, Instant},
};

use script_protocol::{Call, CallResult, HostMessage, Load, ScriptId, WorkerMessage};

use super::{
    ScriptOutcome,
    config::ScriptConfig,
    fault_of,
    process::{Process, ProcessError},
    status::WorkerPlace,
    unavailable,
};
use asi_model::StatusCode;
use mapping::{Fault, FaultKind};

/// After a start that failed, the next is tried no sooner. A binary that fails at once must not be
/// started in a loop.
const RESTART_PAUSE: Duration = Duration::from_secs(1);

/// Worker process with the scripts that belong to it.
#[derive(Debug)]
pub(crate) struct ScriptWorker {
    config: Arc<ScriptConfig>,
    place: WorkerPlace,
    process: Option<Process>,
    /// Scripts to load again after a restart, with their newest state and inputs.
    scripts: HashMap<ScriptId, Load>,
    /// Time and error of the last failed start.
    broken: Option<(Instant, Arc<str>)>,
}

impl ScriptWorker {
    /// Creates a worker without a process; the first script starts it.
    pub fn new(config: Arc<ScriptConfig>, place: WorkerPlace) -> Self {
        Self { config, place, process: None, scripts: HashMap::new(), broken: None }
    }

    /// Loads a script. On a fault it is not there afterwards.
    pub async fn load(&mut self, load: Load) -> Result<(), Fault> {
        let script = load.script;
        // So that a process that starts now does not load the former version.
        self.scripts.remove(&script);
        self.ready().await?;
        let result = self.load_now(&load).await;
        if result.is_ok() {
            self.scripts.insert(script, load);
        }
        result
    }

    /// Tells the worker to drop a compiled script and its state.
    pub async fn unload(&mut self, script: ScriptId) {
        if self.scripts.remove(&script).is_some()
            && let Some(process) = &mut self.process
            && process.send(&HostMessage::Unload(script)).await.is_err()
        {
            self.take_down().await;
        }
    }

    /// Makes calls, in order. There is one outcome for each.
    pub async fn run(&mut self, calls: Vec<Call>) -> Vec<ScriptOutcome> {
        let mut outcomes = Vec::with_capacity(calls.len());
        // After an end without a word the culprit is found by making the calls one by one.
        let mut singly = false;
        while let Some(rest) = calls.get(outcomes.len()..).filter(|rest| !rest.is_empty()) {
            if let Err(fault) = self.ready().await {
                outcomes.extend(rest.iter().map(|_| ScriptOutcome::failed(fault.clone(), false)));
                break;
            }
            let batch = if singly { &rest[..1] } else { rest };
            match self.ask(&HostMessage::encode_batch(batch), self.config.answer_budget()).await {
                Ok(WorkerMessage::Results(results))
                    if !results.is_empty() && results.len() <= batch.len() =>
                {
                    self.finish(batch, &mut outcomes, results);
                }
                Ok(WorkerMessage::Overrun(results)) if results.len() < batch.len() => {
                    self.take_down().await;
                    let culprit = &batch[results.len()];
                    self.finish(batch, &mut outcomes, results);
                    // Its inputs count as known though it yielded nothing: later calls carry only
                    // what changed since.
                    self.note(culprit, None);
                    let message = "the script computed longer than it may and could not be stopped";
                    let (kind, status) = (FaultKind::ScriptTimeout, StatusCode::BAD_TIMEOUT);
                    let is_fatal = !self.config.engine.ends_at_limits();
                    let fault = Fault::new(kind, status, message);
                    outcomes.push(ScriptOutcome::failed(fault, is_fatal));
                }
                other => {
                    let error = other.map_or_else(|error| error, |_| ProcessError::Unexpected);
                    tracing::warn!(
                        error = &error as &dyn std::error::Error,
                        "A script worker was lost."
                    );
                    let was_full = self.take_down().await;
                    // Memory may be what other scripts have kept: alone in a new process the culprit fills it again.
                    let is_certain = singly || !was_full;
                    if let [culprit] = batch
                        && is_certain
                    {
                        self.note(culprit, None);
                        let fault = lost(was_full, "the script took its worker process down");
                        outcomes.push(ScriptOutcome::failed(fault, !was_full));
                    } else {
                        singly = true;
                    }
                }
            }
        }
        outcomes
    }

    /// Ends the process; the scripts stay known. True where its engine had ended it for want of memory, and said so.
    pub async fn take_down(&mut self) -> bool {
        match self.process.take() {
            Some(process) => process.kill().await.contains("out of memory"),
            None => false,
        }
    }

    /// Takes the results of the first of these calls.
    fn finish(
        &mut self,
        calls: &[Call],
        outcomes: &mut Vec<ScriptOutcome>,
        results: Vec<CallResult>,
    ) {
        for (call, CallResult { outcome, state, spent }) in calls.iter().zip(results) {
            self.note(call, state.clone());
            outcomes.push(ScriptOutcome {
                result: outcome.map_err(fault_of),
                state,
                spent,
                is_fatal: false,
            });
        }
    }

    /// Records state and inputs for a restart.
    fn note(&mut self, call: &Call, state: Option<Arc<str>>) {
        let Some(load) = self.scripts.get_mut(&call.script) else { return };
        if state.is_some() {
            load.state = state;
        }
        load.set_values(&call.inputs);
    }

    /// Starts a process with all scripts where there is none.
    async fn ready(&mut self) -> Result<(), Fault> {
        while self.process.is_none() {
            if let Some((since, message)) = &self.broken
                && since.elapsed() < RESTART_PAUSE
            {
                return Err(unavailable(Arc::clone(message)));
            }
            match Process::start(&self.config, &self.place).await {
                Ok(process) => {
                    self.process = Some(process);
                    self.broken = None;
                }
                Err(error) => {
                    tracing::error!(
                        error = &error as &dyn std::error::Error,
                        "A script worker does not start."
                    );
                    let message = Arc::<str>::from(chain(&error));
                    self.place.failed(&message);
                    self.broken = Some((Instant::now(), Arc::clone(&message)));
                    return Err(unavailable(message));
                }
            }
            let scripts: Vec<ScriptId> = self.scripts.keys().copied().collect();
            for script in scripts {
                let Some(load) = self.scripts.get(&script).cloned() else { continue };
                if let Err(fault) = self.load_now(&load).await {
                    // It loaded before, but does not from its present state: calls say that it is
                    // not there. The message may be a script's own text, with a value in it.
                    tracing::warn!(
                        script.name = &*load.name,
                        fault.kind = ?fault.kind,
                        fault.line = fault.line,
                        fault.column = fault.column,
                        "A script does not load again."
                    );
                    self.scripts.remove(&script);
                }
                // Taken down by this script, which is forgotten by now: the others are loaded once
                // more.
                if self.process.is_none() {
                    break;
                }
            }
        }
        Ok(())
    }

    async fn load_now(&mut self, load: &Load) -> Result<(), Fault> {
        match self.ask(&HostMessage::Load(load.clone()).encode(), self.config.answer_budget()).await
        {
            Ok(WorkerMessage::Loaded { script, fault }) if script == load.script => {
                fault.map_or(Ok(()), |f| Err(fault_of(f)))
            }
            Ok(WorkerMessage::LoadOverrun(script)) if script == load.script => {
                self.take_down().await;
                let message = "loading the script took longer than it may and could not be stopped";
                Err(Fault::new(FaultKind::ScriptTimeout, StatusCode::BAD_TIMEOUT, message))
            }
            other => {
                let error = other.map_or_else(|error| error, |_| ProcessError::Unexpected);
                tracing::warn!(
                    error = &error as &dyn std::error::Error,
                    "A script worker was lost while loading."
                );
                let was_full = self.take_down().await;
                Err(lost(was_full, "loading the script took its worker process down"))
            }
        }
    }

    async fn ask(
        &mut self,
        message: &[u8],
        budget: Duration,
    ) -> Result<WorkerMessage, ProcessError> {
        match &mut self.process {
            Some(process) => process.ask(message, budget).await,
            None => Err(ProcessError::Silent),
        }
    }
}

/// Returns the fault of a script that ended its worker: by filling its memory, or in another way.
fn lost(was_full: bool, message: &'static str) -> Fault {
    if was_full {
        let message = "the script used more memory than there is; its worker starts again";
        return Fault::new(
            FaultKind::ScriptOutOfMemory,
            StatusCode::BAD_RESOURCE_UNAVAILABLE,
            message,
        );
    }
    Fault::new(FaultKind::ScriptCrash, StatusCode::BAD_UNEXPECTED_ERROR, message)
}

fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        text.push_str(": ");
        text.push_str(&cause.to_string());
        source = cause.source();
    }
    text
}
