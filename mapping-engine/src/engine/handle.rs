//! Handle through which callers publish, withdraw, watch and try mappings.

use std::sync::Arc;

use mapping::{
    Mapping, MappingDiagnostic, MappingId, MappingInput, PublishRequest, TransformState,
    transform::compile,
};
use tokio::sync::{mpsc, oneshot};

use super::{
    command::{Compiled, MappingCommand},
    dry_runner::DryRunRequest,
    error::EngineError,
    recording::VariableRecording,
    status::MappingStatus,
    survey::{MappingHealth, MappingSurvey},
};
use crate::{
    dry_run::{DryRunSample, SAMPLES_MAX, Trace},
    script::status::{ScriptWorkerStatus, ScriptWorkers},
    unreleased::Unreleased,
};

/// Cloneable handle to the engine's task.
#[derive(Debug, Clone)]
pub struct MappingEngineHandle {
    pub(super) commands: mpsc::Sender<MappingCommand>,
    pub(super) dry_runs: mpsc::Sender<DryRunRequest>,
    pub(super) workers: ScriptWorkers,
}

impl MappingEngineHandle {
    /// Publishes mappings, each in place of the one with the same id and with the state of a former
    /// run; one that may go on replaces none that is the same. Returns for each its warnings, or the reason it is not published:
    /// [`EngineError::Rejected`] with all diagnostics, or a limit.
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
        for request in requests {
            let PublishRequest { mapping, target, state, last, is_shadow, goes_on } = request;
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
                        goes_on,
                    });
                    Ok(diagnostics)
                }
                None => Err(EngineError::Rejected(diagnostics)),
            });
        }
        let (reply, answer) = oneshot::channel();
        self.send(MappingCommand::Put(compiled, reply)).await?;
        let mut put = answer.await.map_err(|_| EngineError::Stopped)?.into_iter();
        for result in results.iter_mut().filter(|result| result.is_ok()) {
            if let Some(Err(error)) = put.next() {
                *result = Err(error);
            }
        }
        Ok(results)
    }

    /// Withdraws a mapping. Returns false if there is none with this id.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn remove(&self, mapping_id: &MappingId) -> Result<bool, EngineError> {
        let (reply, answer) = oneshot::channel();
        self.send(MappingCommand::Remove(mapping_id.clone(), reply)).await?;
        answer.await.map_err(|_| EngineError::Stopped)
    }

    /// Returns the numbers of published mappings by health, and the worst of those with this
    /// health, of all where it is `None`; at most `most`.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn survey(
        &self,
        wanted: Option<MappingHealth>,
        most: usize,
    ) -> Result<Unreleased<MappingSurvey>, EngineError> {
        let (reply, answer) = oneshot::channel();
        self.send(MappingCommand::Survey(wanted, most, reply)).await?;
        answer.await.map(Unreleased::new).map_err(|_| EngineError::Stopped)
    }

    /// Returns the counters, inputs and last candidate of one mapping.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn status(
        &self,
        mapping_id: &MappingId,
    ) -> Result<Option<Unreleased<MappingStatus>>, EngineError> {
        let (reply, answer) = oneshot::channel();
        self.send(MappingCommand::Status(mapping_id.clone(), reply)).await?;
        let status = answer.await.map_err(|_| EngineError::Stopped)?;
        Ok(status.map(Unreleased::new))
    }

    /// Returns the workers of scripts that were started or could not be, with the walls around each.
    #[must_use]
    pub fn script_workers(&self) -> Vec<ScriptWorkerStatus> {
        self.workers.list()
    }

    /// Closes the circuit breakers of a mapping's scripts, so that they run again at once. Returns
    /// false if there is no such mapping.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn reset(&self, mapping_id: &MappingId) -> Result<bool, EngineError> {
        let (reply, answer) = oneshot::channel();
        self.send(MappingCommand::Reset(mapping_id.clone(), reply)).await?;
        answer.await.map_err(|_| EngineError::Stopped)
    }

    /// Returns all diagnostics of a mapping; its scripts are loaded in the worker for dry runs.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn check(&self, mapping: Mapping) -> Result<Vec<MappingDiagnostic>, EngineError> {
        self.run(mapping, Vec::new(), None).await.map(|trace| trace.diagnostics)
    }

    /// Returns the recorded values of these inputs, oldest first. Variables are recorded while a
    /// published mapping uses them.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn recorded(
        &self,
        inputs: Vec<MappingInput>,
    ) -> Result<Vec<DryRunSample>, EngineError> {
        let (reply, answer) = oneshot::channel();
        self.send(MappingCommand::Recorded(inputs, reply)).await?;
        answer.await.map_err(|_| EngineError::Stopped)
    }

    /// Returns the newest values of all variables in use, at most `most`: what
    /// [`MappingEngine::resume`](crate::MappingEngine::resume) takes at the next start.
    ///
    /// # Errors
    /// [`EngineError::Stopped`].
    pub async fn recordings(&self, most: usize) -> Result<Vec<VariableRecording>, EngineError> {
        let (reply, answer) = oneshot::channel();
        self.send(MappingCommand::Recordings(most, reply)).await?;
        answer.await.map_err(|_| EngineError::Stopped)
    }

    /// Runs a mapping on samples and returns every intermediate value. Nothing is published; scripts
    /// run in a worker of their own. The functions start with `state`, where there is one, as if
    /// the mapping had run before.
    ///
    /// # Errors
    /// [`EngineError::TooManySamples`], [`EngineError::Stopped`].
    pub async fn dry_run(
        &self,
        mapping: Mapping,
        samples: Vec<DryRunSample>,
        state: Option<TransformState>,
    ) -> Result<Unreleased<Trace>, EngineError> {
        self.run(mapping, samples, state).await.map(Unreleased::new)
    }

    async fn run(
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
        let request = DryRunRequest { plan: Arc::new(plan), diagnostics, samples, state, reply };
        self.dry_runs.send(request).await.map_err(|_| EngineError::Stopped)?;
        answer.await.map_err(|_| EngineError::Stopped)
    }

    async fn send(&self, command: MappingCommand) -> Result<(), EngineError> {
        self.commands.send(command).await.map_err(|_| EngineError::Stopped)
    }
}
