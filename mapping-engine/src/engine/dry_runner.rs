//! Dry runs, in a worker of their own: a script that is only tried cannot disturb a published one.

use std::{sync::Arc, time::Duration};

use asi_model::DateTime;
use mapping::{
    DiagnosticCode, FaultKind, MappingDiagnostic, Step, TraceStep, TracedFault, TracedValue,
    TransformState,
    transform::{Plan, Reaction, ScriptCall, ScriptYield, Transform},
};
use script_protocol::{Call, CallValue, InputValue, Load, ScriptId};
use tokio::{
    sync::{mpsc, oneshot},
    time::timeout,
};
use tokio_util::sync::CancellationToken;

use crate::{
    dry_run::{DryRunSample, Trace, TraceRun},
    script::{config::ScriptConfig, status::WorkerPlace, values, worker::ScriptWorker},
};

/// Idle time after which the worker process ends. It takes memory, and its next start milliseconds.
const IDLE_MAX: Duration = Duration::from_secs(60);
/// Most runs of one dry run that timers cause. Short timers over a long gap in the samples would
/// run for ever.
const TIMER_RUNS_MAX: usize = 10_000;

/// Mapping to run on samples.
#[derive(Debug)]
pub(super) struct DryRunRequest {
    pub plan: Arc<Plan>,
    pub diagnostics: Vec<MappingDiagnostic>,
    pub samples: Vec<DryRunSample>,
    /// State of the functions before the first sample.
    pub state: Option<TransformState>,
    pub reply: oneshot::Sender<Trace>,
}

/// Serves dry runs, one after the other, until `shutdown`.
pub(super) async fn serve(
    config: Arc<ScriptConfig>,
    place: WorkerPlace,
    mut requests: mpsc::Receiver<DryRunRequest>,
    shutdown: CancellationToken,
) {
    let mut worker = ScriptWorker::new(config, place);
    loop {
        let next = tokio::select! {
            () = shutdown.cancelled() => break,
            next = timeout(IDLE_MAX, requests.recv()) => next,
        };
        let DryRunRequest { plan, diagnostics, samples, state, mut reply } = match next {
            Err(_) => {
                worker.take_down().await;
                continue;
            }
            Ok(None) => break,
            Ok(Some(request)) => request,
        };
        let mut transform = Transform::new(Arc::clone(&plan), state, None);
        let mut running = RunningDryRun {
            plan,
            worker: &mut worker,
            trace: Trace { diagnostics, runs: Vec::new() },
        };
        tokio::select! {
            () = shutdown.cancelled() => break,
            // Nobody waits for it any more, but others wait for their turn.
            () = reply.closed() => {}
            () = running.run(&mut transform, &samples) => {
                let trace = running.trace;
                // The caller may have dropped its receiver.
                drop(reply.send(trace));
            }
        }
    }
    worker.take_down().await;
}

struct RunningDryRun<'a> {
    plan: Arc<Plan>,
    worker: &'a mut ScriptWorker,
    trace: Trace,
}

impl RunningDryRun<'_> {
    async fn run(&mut self, transform: &mut Transform, samples: &[DryRunSample]) {
        let scripts: Vec<usize> = self.plan.script_steps().collect();
        self.load(transform, &scripts).await;
        if !self.trace.diagnostics.iter().any(MappingDiagnostic::is_error) {
            self.feed(transform, samples).await;
        }
        for step in scripts {
            self.worker.unload(id_of(step)).await;
        }
    }

    async fn load(&mut self, transform: &Transform, steps: &[usize]) {
        let mapping = Arc::clone(&self.plan.made_for);
        for step in steps {
            let Some(Step::Script(script)) = mapping.steps.get(*step) else { continue };
            let load = Load {
                script: id_of(*step),
                name: mapping.mapping_id.as_str().into(),
                source: script.source.as_str().into(),
                inputs: mapping.inputs.iter().map(|input| input.name.as_str().into()).collect(),
                state: transform.script_state(*step),
                values: Vec::new(),
            };
            if let Err(fault) = self.worker.load(load).await {
                let code = match fault.kind {
                    FaultKind::ScriptSyntax => DiagnosticCode::Syntax,
                    FaultKind::WorkerUnavailable => DiagnosticCode::WorkerUnavailable,
                    _ => DiagnosticCode::ScriptFault,
                };
                let pointer = format!("/steps/{step}/source");
                let diagnostic = MappingDiagnostic::error(pointer, code, &*fault.message);
                self.trace.diagnostics.push(diagnostic.at(fault.line, fault.column));
            }
        }
    }

    async fn feed(&mut self, transform: &mut Transform, samples: &[DryRunSample]) {
        let mut steps = Vec::new();
        if let Some(at) = samples.first().map(|sample| sample.at) {
            let reaction = transform.start(at, Some(&mut steps));
            if reaction != Reaction::Quiet {
                self.finish_run(transform, reaction, at, None, steps).await;
            }
        }
        let mut timer_runs = 0;
        for (index, sample) in samples.iter().enumerate() {
            let Some(input) = self.plan.made_for.input_index(&sample.input) else {
                let message = format!("there is no input \"{}\"", sample.input);
                let pointer = format!("/samples/{index}/input");
                self.trace.diagnostics.push(MappingDiagnostic::error(
                    pointer,
                    DiagnosticCode::UnknownName,
                    message,
                ));
                continue;
            };
            self.pass_time(transform, Some(sample.at), &mut timer_runs).await;
            let mut steps = Vec::new();
            let reaction = transform.on(sample.at, input, sample.value.clone(), Some(&mut steps));
            self.finish_run(transform, reaction, sample.at, Some(sample), steps).await;
        }
        self.pass_time(transform, None, &mut timer_runs).await;
    }

    /// Runs the timers that are due until a time, all of them for `None`.
    async fn pass_time(
        &mut self,
        transform: &mut Transform,
        until: Option<DateTime>,
        runs: &mut usize,
    ) {
        while let Some(due) = transform.due().filter(|due| until.is_none_or(|until| *due <= until))
        {
            *runs += 1;
            if *runs > TIMER_RUNS_MAX {
                return;
            }
            let mut steps = Vec::new();
            let reaction = transform.on_timer(due, Some(&mut steps));
            self.finish_run(transform, reaction, due, None, steps).await;
        }
    }

    /// Makes the script calls of a run, and records it.
    async fn finish_run(
        &mut self,
        transform: &mut Transform,
        mut reaction: Reaction,
        at: DateTime,
        sample: Option<&DryRunSample>,
        mut steps: Vec<TraceStep>,
    ) {
        while let Reaction::Call(call) = reaction {
            let called = call_of(&call);
            let outcome = self.worker.run(vec![called]).await.pop();
            let result = match outcome {
                Some(outcome) => outcome
                    .result
                    .and_then(values::yielded)
                    .map(|value| ScriptYield { value, state: outcome.state }),
                None => return,
            };
            reaction = transform.resume(at, call, result, Some(&mut steps));
        }
        let (candidate, fault) = match &reaction {
            Reaction::Candidate(value) => (Some(TracedValue::of(value)), None),
            Reaction::Failed(value, failed) => {
                (Some(TracedValue::of(value)), Some(TracedFault::from(&failed.fault)))
            }
            _ => (None, None),
        };
        self.trace.runs.push(TraceRun {
            at,
            input: sample.map(|sample| sample.input.clone()),
            value: sample.map(|sample| TracedValue::of(&sample.value)),
            steps,
            candidate,
            fault,
        });
    }
}

/// Returns the script id of a step. Dry runs run one at a time, so steps identify scripts.
fn id_of(step: usize) -> ScriptId {
    ScriptId(u32::try_from(step).unwrap_or(u32::MAX))
}

fn call_of(call: &ScriptCall) -> Call {
    let inputs = call.inputs.iter().filter_map(|(index, value)| {
        Some(InputValue { input: u16::try_from(*index).ok()?, spoken: values::spoken(value) })
    });
    Call {
        script: id_of(call.step),
        value: CallValue::Own(values::spoken(&call.flow.clone().into_value())),
        inputs: inputs.collect(),
    }
}
