//! Scripts of mappings: assignment to workers, calls and their results.

use asi_model::DateTime;
use mapping::{
    Fault, FaultKind, Mapping, Step,
    transform::{ScriptCall, ScriptYield, Transform},
};
use script_protocol::{Call, CallValue, Load, ScriptId};

use super::{
    super::{error::EngineError, inventory::ScriptStep},
    Core,
};
use crate::script::{
    ScriptOutcome,
    breaker::Admission,
    values,
    worker_queue::{Completion, Done, Waiting, WorkerQueue},
};

impl Core {
    /// Loads the scripts of a mapping into the worker that has the fewest.
    pub(super) fn assign_scripts(
        &mut self,
        mapping: &Mapping,
        transform: &Transform,
        slot: usize,
    ) -> Result<Box<[ScriptStep]>, EngineError> {
        let steps: Vec<usize> = transform.plan().script_steps().collect();
        let Some((worker, _)) =
            self.queues.iter().enumerate().min_by_key(|(_, queue)| queue.scripts)
        else {
            return Ok(Box::default());
        };
        let most = self.config.script.scripts_per_worker_max;
        if !steps.is_empty()
            && self.queues.get(worker).is_some_and(|queue| queue.scripts + steps.len() > most)
        {
            return Err(EngineError::TooManyScripts(most * self.queues.len()));
        }
        let mut scripts = Vec::with_capacity(steps.len());
        for (index, step) in steps.into_iter().enumerate() {
            let Some(Step::Script(script)) = mapping.steps.get(step) else { continue };
            self.last_script = self.last_script.wrapping_add(1);
            let id = ScriptId(self.last_script);
            self.scripts.insert(id, (slot, index));
            if let Some(queue) = self.queues.get_mut(worker) {
                queue.load(Load {
                    script: id,
                    name: mapping.mapping_id.as_str().into(),
                    source: script.source.as_str().into(),
                    inputs: mapping.inputs.iter().map(|input| input.name.as_str().into()).collect(),
                    state: transform.script_state(step),
                    values: Vec::new(),
                });
            }
            scripts.push(ScriptStep { id, step, worker, breaker: Default::default() });
        }
        Ok(scripts.into())
    }

    /// Queues a call at the script's worker.
    pub(super) fn call(&mut self, slot: usize, call: ScriptCall, now: DateTime) {
        let Some(running) = self.inventory.get_mut(slot) else { return };
        let Some(script) = running.scripts.iter_mut().find(|script| script.step == call.step)
        else {
            return;
        };
        // The fault that opened the breaker has been yielded already.
        if script.breaker.admit(now) == Admission::Open {
            running.counters.superseded += 1;
            return;
        }
        let is_input = call.step == 0 && !running.inputs.is_empty();
        let value = if is_input {
            CallValue::Input(0)
        } else {
            CallValue::Own(values::spoken(&call.flow.clone().into_value()))
        };
        let inputs = call.inputs.iter().filter_map(|(index, value)| {
            Some(script_protocol::InputValue {
                input: u16::try_from(*index).ok()?,
                spoken: values::spoken(value),
            })
        });
        let waiting = Waiting {
            call: Call { script: script.id, value, inputs: inputs.collect() },
            resume: ScriptCall { inputs: Vec::new(), ..call },
        };
        if let Some(queue) = self.queues.get_mut(script.worker)
            && queue.call(waiting)
        {
            running.counters.superseded += 1;
        }
    }

    /// Takes a worker's completion, resumes the transforms and gives the worker its next job.
    pub fn completed(&mut self, completion: Completion, now: DateTime) {
        let Completion { worker: index, done } = completion;
        let Some(queue) = self.queues.get_mut(index) else { return };
        let under_way = queue.done();
        match done {
            Done::Unloaded | Done::Loaded(_, Ok(())) => {}
            Done::Loaded(script, Err(fault)) => self.not_loaded(script, &fault, now),
            Done::Called(outcomes) => {
                for ((script, call), outcome) in under_way.into_iter().zip(outcomes) {
                    self.called(script, call, outcome, now);
                }
            }
        }
        self.queues.iter_mut().for_each(WorkerQueue::feed);
    }

    fn not_loaded(&mut self, script: ScriptId, fault: &Fault, now: DateTime) {
        let Some(&(slot, index)) = self.scripts.get(&script) else { return };
        let Some(running) = self.inventory.get_mut(slot) else { return };
        let Some(script) = running.scripts.get_mut(index) else { return };
        let call = ScriptCall::without_value(script.step);
        if let Some(queue) = self.queues.get_mut(script.worker) {
            queue.drop_waiting(script.id);
        }
        let reaction = running.transform.resume(now, call, Err(fault.clone()), None);
        self.react(slot, reaction, now);
    }

    fn called(
        &mut self,
        script: ScriptId,
        call: ScriptCall,
        outcome: ScriptOutcome,
        now: DateTime,
    ) {
        let Some(&(slot, index)) = self.scripts.get(&script) else { return };
        let config = &self.config.script;
        let Some(running) = self.inventory.get_mut(slot) else { return };
        let ScriptOutcome { result, state, spent, is_fatal } = outcome;
        running.counters.spent += spent;
        let Some(script) = running.scripts.get_mut(index) else { return };
        let opens = match &result {
            Ok(_) => {
                script.breaker.succeeded();
                false
            }
            Err(_) if is_fatal => {
                script.breaker.open(now, config.first_backoff());
                true
            }
            Err(fault)
                if matches!(
                    fault.kind,
                    FaultKind::ScriptTimeout | FaultKind::ScriptOutOfMemory
                ) =>
            {
                script.breaker.exhausted(now, config.exhausted_in_a_row_max, config.first_backoff())
            }
            Err(_) => {
                script.breaker.failed();
                false
            }
        };
        if opens {
            metrics::counter!("mapping_engine_scripts_rested_total").increment(1);
            tracing::warn!(
                mapping.id = running.mapping.mapping_id.as_str(),
                "The circuit of a script was opened: it did not keep to its budget."
            );
            if let Some(queue) = self.queues.get_mut(script.worker) {
                running.counters.superseded += queue.drop_waiting(script.id) as u64;
            }
        }
        let result = result.and_then(values::yielded).map(|value| ScriptYield { value, state });
        let reaction = running.transform.resume(now, call, result, None);
        self.react(slot, reaction, now);
    }
}
