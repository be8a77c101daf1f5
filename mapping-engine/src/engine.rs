//! The engine: inputs in, candidates out.
//!
//! One task routes changes to the mappings that use them and runs the chains up to a script or
//! their end; script calls go to worker processes through [`crate::script::lane`]. It never waits
//! for a consumer while it holds work: what was made waits in a bounded list, and while that is
//! full no changes are taken, which the shop floor notices and coalesces.

mod core;
mod history;
mod inventory;
mod plans;
mod routes;
mod service;
mod status;
mod survey;
mod timers;
mod trial;

use std::sync::Arc;

use asi_model::DataValue;
use mapping::{
    Candidate, Mapping, MappingDiagnostic, MappingId, MappingInput, PublishRequest, TargetKey,
    TransformState,
    transform::{Plan, compile},
};
use serde::{Deserialize, Serialize};
use shop_floor::{InputChange, ShopFloorError};
use tokio::sync::{mpsc, oneshot};

use crate::{
    dry_run::{DryRunSample, SAMPLES_MAX, Trace},
    inputs::Inputs,
    script::config::ScriptConfig,
};
pub use history::HistoryConfig;
pub use service::MappingEngine;
pub use status::{CircuitState, InputStatus, MappingStatus};
pub use survey::{HealthCounts, MappingHealth, MappingSurvey, SurveyedMapping};
use trial::Trial;

/// What the engine may use.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", default, deny_unknown_fields)]
pub struct MappingEngineConfig {
    /// Most mappings.
    pub mappings_max: usize,
    /// Most candidates that wait for the consumer before no more changes are taken.
    pub waiting_candidates_max: usize,
    /// Most batches of candidates in the channel to the consumer.
    pub waiting_batches_max: usize,
    /// What is kept to try mappings on.
    pub history: HistoryConfig,
    /// Scripts.
    pub script: ScriptConfig,
}

impl Default for MappingEngineConfig {
    fn default() -> Self {
        Self {
            mappings_max: 200_000,
            waiting_candidates_max: 65_536,
            waiting_batches_max: 64,
            history: HistoryConfig::default(),
            script: ScriptConfig::default(),
        }
    }
}

/// Why the engine did not do what was asked.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The mapping has errors; all that is to be said about it.
    #[error("the mapping has errors")]
    Rejected(Vec<MappingDiagnostic>),
    /// There are as many mappings as allowed.
    #[error("there are {0} mappings already, which is the limit")]
    TooManyMappings(usize),
    /// There are as many scripts as the workers may hold.
    #[error("there are {0} scripts already, which is the limit: raise script.workers")]
    TooManyScripts(usize),
    /// More samples than a dry run takes.
    #[error("a dry run takes at most {SAMPLES_MAX} samples")]
    TooManySamples,
    /// The inputs cannot be monitored.
    #[error("the inputs cannot be monitored")]
    Inputs(#[source] ShopFloorError),
    /// The engine has ended.
    #[error("the mapping engine has ended")]
    Stopped,
}

/// A cloneable handle to the [`MappingEngine`].
#[derive(Debug, Clone)]
pub struct MappingEngineHandle {
    commands: mpsc::Sender<Command>,
    trials: mpsc::Sender<Trial>,
}

/// What handles ask of the service.
#[derive(Debug)]
enum Command {
    Put(Vec<Compiled>, oneshot::Sender<Vec<Result<(), EngineError>>>),
    Remove(MappingId, oneshot::Sender<bool>),
    Status(MappingId, oneshot::Sender<Option<MappingStatus>>),
    Survey(Option<MappingHealth>, usize, oneshot::Sender<MappingSurvey>),
    Reset(MappingId, oneshot::Sender<bool>),
    Recorded(Vec<MappingInput>, oneshot::Sender<Vec<DryRunSample>>),
}

#[derive(Debug)]
struct Compiled {
    mapping: Arc<Mapping>,
    plan: Arc<Plan>,
    target: TargetKey,
    state: Option<TransformState>,
    last: Option<DataValue>,
    is_shadow: bool,
}

impl MappingEngineHandle {
    /// Publishes mappings, each in place of the one with the same id and with what a former run
    /// left. For each what is doubtful about it, or why it is not published:
    /// [`EngineError::Rejected`] with everything that is wrong, or a limit.
    ///
    /// A script is checked by loading it in the background; a fault there shows in the status and
    /// as a candidate. Use [`Self::check`] to see it before.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn put_many(
        &self,
        requests: Vec<PublishRequest>,
    ) -> Result<Vec<Result<Vec<MappingDiagnostic>, EngineError>>, EngineError> {
        let mut results = Vec::with_capacity(requests.len());
        let mut compiled = Vec::with_capacity(requests.len());
        for PublishRequest { mapping, target, state, last, is_shadow } in requests {
            let (plan, diagnostics) = compile(&mapping);
            results.push(match plan {
                Some(plan) => {
                    compiled.push(Compiled {
                        mapping,
                        plan: Arc::new(plan),
                        target,
                        state,
                        last,
                        is_shadow,
                    });
                    Ok(diagnostics)
                }
                None => Err(EngineError::Rejected(diagnostics)),
            });
        }
        let (reply, answer) = oneshot::channel();
        self.send(Command::Put(compiled, reply)).await?;
        let mut put = answer.await.map_err(|_| EngineError::Stopped)?.into_iter();
        for result in results.iter_mut().filter(|result| result.is_ok()) {
            if let Some(Err(error)) = put.next() {
                *result = Err(error);
            }
        }
        Ok(results)
    }

    /// Withdraws a mapping. False if there is none with this id.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn remove(&self, mapping_id: &MappingId) -> Result<bool, EngineError> {
        let (reply, answer) = oneshot::channel();
        self.send(Command::Remove(mapping_id.clone(), reply)).await?;
        answer.await.map_err(|_| EngineError::Stopped)
    }

    /// How the published mappings are doing: counts of all, and the worst of those with this
    /// health, or of all.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn survey(
        &self,
        wanted: Option<MappingHealth>,
        most: usize,
    ) -> Result<MappingSurvey, EngineError> {
        let (reply, answer) = oneshot::channel();
        self.send(Command::Survey(wanted, most, reply)).await?;
        answer.await.map_err(|_| EngineError::Stopped)
    }

    /// How one mapping is doing.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn status(
        &self,
        mapping_id: &MappingId,
    ) -> Result<Option<MappingStatus>, EngineError> {
        let (reply, answer) = oneshot::channel();
        self.send(Command::Status(mapping_id.clone(), reply)).await?;
        answer.await.map_err(|_| EngineError::Stopped)
    }

    /// Ends the rest of a mapping's scripts, by hand. False if there is no such mapping.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn reset(&self, mapping_id: &MappingId) -> Result<bool, EngineError> {
        let (reply, answer) = oneshot::channel();
        self.send(Command::Reset(mapping_id.clone(), reply)).await?;
        answer.await.map_err(|_| EngineError::Stopped)
    }

    /// Everything that is wrong or doubtful about a mapping, its scripts loaded in a worker for
    /// trials.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn check(&self, mapping: Mapping) -> Result<Vec<MappingDiagnostic>, EngineError> {
        self.dry_run(mapping, Vec::new(), None).await.map(|trace| trace.diagnostics)
    }

    /// The last values of these variables, in the order they came: those that a mapping at work
    /// uses are recorded.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn recorded(
        &self,
        inputs: Vec<MappingInput>,
    ) -> Result<Vec<DryRunSample>, EngineError> {
        let (reply, answer) = oneshot::channel();
        self.send(Command::Recorded(inputs, reply)).await?;
        answer.await.map_err(|_| EngineError::Stopped)
    }

    /// Runs a mapping on samples, in a worker for trials, and shows every intermediate value.
    /// Nothing is published. Its functions start with `state`, where there is one, as if the
    /// mapping had run before.
    ///
    /// # Errors
    /// [`EngineError::TooManySamples`], [`EngineError::Stopped`].
    pub async fn dry_run(
        &self,
        mapping: Mapping,
        samples: Vec<DryRunSample>,
        state: Option<TransformState>,
    ) -> Result<Trace, EngineError> {
        if samples.len() > SAMPLES_MAX {
            return Err(EngineError::TooManySamples);
        }
        let (plan, diagnostics) = compile(&Arc::new(mapping));
        let Some(plan) = plan else { return Ok(Trace { diagnostics, runs: Vec::new() }) };
        let (reply, answer) = oneshot::channel();
        let trial = Trial { plan: Arc::new(plan), diagnostics, samples, state, reply };
        self.trials.send(trial).await.map_err(|_| EngineError::Stopped)?;
        answer.await.map_err(|_| EngineError::Stopped)
    }

    async fn send(&self, command: Command) -> Result<(), EngineError> {
        self.commands.send(command).await.map_err(|_| EngineError::Stopped)
    }
}

impl MappingEngine {
    /// An engine, its handle, and the candidates it will yield.
    ///
    /// `inputs` is told which variables to monitor; their changes come through `changes`.
    #[must_use]
    pub fn new(
        config: MappingEngineConfig,
        inputs: impl Inputs,
        changes: mpsc::Receiver<Vec<InputChange>>,
    ) -> (Self, MappingEngineHandle, mpsc::Receiver<Vec<Candidate>>) {
        let (commands, for_commands) = mpsc::channel(64);
        let (trials, for_trials) = mpsc::channel(16);
        let (candidates, consumer) = mpsc::channel(config.waiting_batches_max.max(1));
        let handle = MappingEngineHandle { commands, trials };
        let engine =
            Self::assemble(config, Box::new(inputs), changes, for_commands, for_trials, candidates);
        (engine, handle, consumer)
    }
}
