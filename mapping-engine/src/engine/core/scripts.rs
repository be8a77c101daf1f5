//! Scripts of mappings: where they run, what they are asked, and what comes back.

use asi_model::DateTime;
use mapping::{
    Fault, FaultKind, Mapping, Step,
    transform::{ScriptCall, ScriptYield, Transform},
};
use script_protocol::{Call, CallValue, Load, ScriptId, Yielded};

use super::{
    super::{EngineError, inventory::Script},
    Core,
};
use crate::script::{
    CallOutcome,
    breaker::Admission,
    lane::{Done, Lane, Report, Waiting},
    values,
};

impl Core {
    /// Loads the scripts of a mapping into the worker that has the fewest.
    pub(super) fn place_scripts(
        &mut self,
        mapping: &Mapping,
        transform: &Transform,
        place: usize,
    ) -> Result<Box<[Script]>, EngineError> {
        let steps: Vec<usize> = transform.plan().script_steps().collect();
        let Some((lane, _)) = self.lanes.iter().enumerate().min_by_key(|(_, lane)| lane.scripts)
        else {
            return Ok(Box::default());
        };
        let most = self.config.script.scripts_per_worker_max;
        if !steps.is_empty()
            && self.lanes.get(lane).is_some_and(|lane| lane.scripts + steps.len() > most)
        {
            return Err(EngineError::TooManyScripts(most * self.lanes.len()));
        }
        let mut scripts = Vec::with_capacity(steps.len());
        for (index, step) in steps.into_iter().enumerate() {
            let Some(Step::Script(script)) = mapping.steps.get(step) else { continue };
            self.last_script = self.last_script.wrapping_add(1);
            let id = ScriptId(self.last_script);
            self.scripts.insert(id, (place, index));
            if let Some(lane) = self.lanes.get_mut(lane) {
                lane.load(Load {
                    script: id,
                    name: mapping.mapping_id.as_str().into(),
                    source: script.source.as_str().into(),
                    inputs: mapping.inputs.iter().map(|input| input.name.as_str().into()).collect(),
                    state: transform.script_state(step),
                    values: Vec::new(),
                });
            }
            scripts.push(Script { id, step, lane, breaker: Default::default() });
        }
        Ok(scripts.into())
    }

    /// Asks a worker to run a script.
    pub(super) fn call(&mut self, place: usize, call: ScriptCall, now: DateTime) {
        let Some(entry) = self.inventory.get_mut(place) else { return };
        let Some(script) = entry.scripts.iter_mut().find(|script| script.step == call.step) else {
            return;
        };
        // That it rests was said when it began to.
        if script.breaker.admit(now) == Admission::Resting {
            entry.superseded += 1;
            return;
        }
        let is_input = call.step == 0 && !entry.inputs.is_empty();
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
        if let Some(lane) = self.lanes.get_mut(script.lane)
            && lane.call(waiting)
        {
            entry.superseded += 1;
        }
    }

    /// A worker is done with its job.
    pub fn reported(&mut self, report: Report, now: DateTime) {
        let Report { lane: index, done } = report;
        let Some(lane) = self.lanes.get_mut(index) else { return };
        let under_way = lane.done();
        match done {
            Done::Unloaded | Done::Loaded(_, Ok(())) => {}
            Done::Loaded(script, Err(fault)) => self.not_loaded(script, &fault, now),
            Done::Called(outcomes) => {
                for ((script, call), outcome) in under_way.into_iter().zip(outcomes) {
                    self.called(script, call, outcome, now);
                }
            }
        }
        self.lanes.iter_mut().for_each(Lane::feed);
    }

    fn not_loaded(&mut self, script: ScriptId, fault: &Fault, now: DateTime) {
        let Some(&(place, index)) = self.scripts.get(&script) else { return };
        let Some(entry) = self.inventory.get_mut(place) else { return };
        let Some(script) = entry.scripts.get_mut(index) else { return };
        let call = ScriptCall::without_value(script.step);
        if let Some(lane) = self.lanes.get_mut(script.lane) {
            lane.forget(script.id);
        }
        let reaction = entry.transform.resume(now, call, Err(fault.clone()), None);
        self.react(place, reaction, now);
    }

    fn called(&mut self, script: ScriptId, call: ScriptCall, outcome: CallOutcome, now: DateTime) {
        let Some(&(place, index)) = self.scripts.get(&script) else { return };
        let config = &self.config.script;
        let Some(entry) = self.inventory.get_mut(place) else { return };
        let CallOutcome { result, state, spent, is_fatal } = outcome;
        entry.spent += spent;
        let Some(script) = entry.scripts.get_mut(index) else { return };
        let rests = match &result {
            Ok(_) => {
                script.breaker.succeeded();
                false
            }
            Err(_) if is_fatal => {
                script.breaker.open(now, config.rest());
                true
            }
            Err(fault)
                if matches!(
                    fault.kind,
                    FaultKind::ScriptTimeout | FaultKind::ScriptOutOfMemory
                ) =>
            {
                script.breaker.exhausted(now, config.exhausted_in_a_row_max, config.rest())
            }
            Err(_) => {
                script.breaker.failed();
                false
            }
        };
        if rests {
            metrics::counter!("mapping_engine_scripts_rested_total").increment(1);
            tracing::warn!(
                mapping.id = entry.mapping.mapping_id.as_str(),
                "A script rests because it did not keep to its budget."
            );
            if let Some(lane) = self.lanes.get_mut(script.lane) {
                entry.superseded += lane.forget(script.id) as u64;
            }
        }
        let result = result.and_then(yielded_of).map(|value| ScriptYield { value, state });
        let reaction = entry.transform.resume(now, call, result, None);
        self.react(place, reaction, now);
    }
}

/// A script's result in the engine's words.
pub(in crate::engine) fn yielded_of(
    yielded: Yielded,
) -> Result<Option<(asi_model::Variant, asi_model::StatusCode)>, Fault> {
    Ok(match yielded {
        Yielded::Nothing => None,
        Yielded::Value { value, status } => {
            Some((values::from_script(value)?, asi_model::StatusCode(status)))
        }
    })
}
