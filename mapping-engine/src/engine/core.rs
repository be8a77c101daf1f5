//! What the engine decides, without waiting for anything.

use std::{collections::HashMap, sync::Arc, time::Instant};

use asi_model::{DataValue, DateTime};
use script_protocol::{Call, CallValue, Load, ScriptId, Yielded};
use shop_floor::{InputChange, InputKey};

use super::{
    Candidate, Compiled, EngineError, MappingEngineConfig,
    history::History,
    inventory::{Entry, Inventory, Script},
    routes::{Routes, Subscriber},
    status::MappingStatus,
    timers::Timers,
};
use crate::{
    dry_run::DryRunSample,
    fault::{Fault, FaultKind, FaultRecord},
    inputs::Inputs,
    mapping::{MappingId, MappingInput, Step},
    script::{
        CallOutcome,
        breaker::Admission,
        lane::{Done, Lane, Report, Waiting},
        values,
    },
    transform::{Plan, Reaction, ScriptCall, ScriptYield, Transform},
};

/// The place of nobody: holds variables while their mapping is replaced.
const HELD: usize = usize::MAX;

/// Mappings, routes, timers, and what waits for the consumer.
pub(super) struct Core {
    config: MappingEngineConfig,
    inputs: Box<dyn Inputs>,
    inventory: Inventory,
    routes: Routes,
    timers: Timers,
    lanes: Vec<Lane>,
    /// Where a script belongs: its mapping's place, and which of its scripts it is.
    scripts: HashMap<ScriptId, (usize, usize)>,
    last_script: u32,
    pending: Vec<(usize, Candidate)>,
    batches: u64,
}

impl Core {
    pub fn new(config: MappingEngineConfig, inputs: Box<dyn Inputs>, lanes: Vec<Lane>) -> Self {
        Self {
            config,
            inputs,
            inventory: Inventory::default(),
            routes: Routes::default(),
            timers: Timers::default(),
            lanes,
            scripts: HashMap::new(),
            last_script: 0,
            pending: Vec::new(),
            batches: 0,
        }
    }

    pub fn put_many(&mut self, compiled: Vec<Compiled>, now: DateTime) -> Vec<Result<(), EngineError>> {
        let mut requests = Vec::new();
        let mut results = Vec::with_capacity(compiled.len());
        let mut put = Vec::new();
        for mapping in compiled {
            let id = mapping.plan.mapping.mapping_id.clone();
            let result = self.put(mapping, &mut requests, now);
            if result.is_ok() {
                put.push((results.len(), id));
            }
            results.push(result);
        }
        // All mappings of a call at once: a server is asked in few, large requests.
        if !requests.is_empty()
            && let Err(error) = self.inputs.monitor(requests)
        {
            let message = Arc::<str>::from(error.to_string());
            for (index, id) in put {
                self.remove(&id);
                if let Some(result) = results.get_mut(index) {
                    *result = Err(EngineError::Inputs(shop_floor::ShopFloorError::Invalid(message.to_string())));
                }
            }
        }
        self.lanes.iter_mut().for_each(Lane::feed);
        metrics::gauge!("mapping_engine_mappings").set(count(self.inventory.len()));
        results
    }

    /// What both the mapping so far and the new one use stays monitored, and keeps what was recorded of it.
    fn put(
        &mut self,
        compiled: Compiled,
        requests: &mut Vec<shop_floor::MonitorRequest>,
        now: DateTime,
    ) -> Result<(), EngineError> {
        let mapping = Arc::clone(&compiled.plan.mapping);
        let mut held = Vec::with_capacity(mapping.inputs.len());
        for (input, wanted) in mapping.inputs.iter().enumerate() {
            let subscriber = Subscriber { place: HELD, input };
            let (key, request) = self.routes.subscribe(wanted, subscriber);
            requests.extend(request);
            held.push((key, wanted, subscriber));
        }
        let result = self.put_in_place(compiled, now);
        for (key, wanted, subscriber) in held {
            if self.routes.unsubscribe(key, wanted, subscriber) {
                requests.retain(|request| request.input != key);
                self.inputs.unmonitor(&[key]);
            }
        }
        result
    }

    fn put_in_place(&mut self, compiled: Compiled, now: DateTime) -> Result<(), EngineError> {
        let Compiled { plan, state, last, is_shadow } = compiled;
        let id = plan.mapping.mapping_id.clone();
        self.remove(&id);
        if self.inventory.len() >= self.config.mappings_max {
            return Err(EngineError::TooManyMappings(self.config.mappings_max));
        }
        let transform = Transform::new(Arc::clone(&plan), state, last);
        let place = self.inventory.next_place();
        let scripts = self.place_scripts(&plan, &transform, place)?;
        let mut keys = Vec::with_capacity(plan.mapping.inputs.len());
        for (input, wanted) in plan.mapping.inputs.iter().enumerate() {
            // It is held already, so there is nothing to request.
            let (key, _) = self.routes.subscribe(wanted, Subscriber { place, input });
            keys.push(key);
        }
        self.inventory.insert(id, Entry::new(transform, keys.clone().into(), scripts, is_shadow));
        let reaction = self.inventory.get_mut(place).map(|entry| entry.transform.start(now, None));
        if let Some(reaction) = reaction {
            self.react(place, reaction, now);
        }
        for (input, key) in keys.into_iter().enumerate() {
            let last = self.routes.get_mut(key).and_then(|route| route.history.newest().cloned());
            if let Some(last) = last {
                self.take(Subscriber { place, input }, last, now, &mut Instant::now());
            }
        }
        Ok(())
    }

    /// Loads the scripts of a mapping into the worker that has the fewest.
    fn place_scripts(
        &mut self,
        plan: &Plan,
        transform: &Transform,
        place: usize,
    ) -> Result<Box<[Script]>, EngineError> {
        let steps: Vec<usize> = plan.script_steps().collect();
        let Some((lane, _)) = self.lanes.iter().enumerate().min_by_key(|(_, lane)| lane.scripts) else {
            return Ok(Box::default());
        };
        let most = self.config.script.scripts_per_worker_max;
        if !steps.is_empty() && self.lanes.get(lane).is_some_and(|lane| lane.scripts + steps.len() > most) {
            return Err(EngineError::TooManyScripts(most * self.lanes.len()));
        }
        let mut scripts = Vec::with_capacity(steps.len());
        for (index, step) in steps.into_iter().enumerate() {
            let Some(Step::Script(script)) = plan.mapping.steps.get(step) else { continue };
            self.last_script = self.last_script.wrapping_add(1);
            let id = ScriptId(self.last_script);
            self.scripts.insert(id, (place, index));
            if let Some(lane) = self.lanes.get_mut(lane) {
                lane.load(Load {
                    script: id,
                    name: plan.mapping.mapping_id.as_str().into(),
                    source: script.source.as_str().into(),
                    inputs: plan.mapping.inputs.iter().map(|input| input.name.as_str().into()).collect(),
                    state: transform.script_state(step),
                    values: Vec::new(),
                });
            }
            scripts.push(Script { id, step, lane, breaker: Default::default() });
        }
        Ok(scripts.into())
    }

    pub fn remove(&mut self, id: &MappingId) -> bool {
        let Some((place, entry)) = self.inventory.remove(id) else { return false };
        let mut unwanted = Vec::new();
        let wanted = &entry.transform.plan().mapping.inputs;
        for (input, (key, wanted)) in entry.inputs.iter().zip(wanted).enumerate() {
            if self.routes.unsubscribe(*key, wanted, Subscriber { place, input }) {
                unwanted.push(*key);
            }
        }
        if !unwanted.is_empty() {
            self.inputs.unmonitor(&unwanted);
        }
        for script in &entry.scripts {
            self.scripts.remove(&script.id);
            if let Some(lane) = self.lanes.get_mut(script.lane) {
                lane.unload(script.id);
            }
        }
        self.pending.retain(|(_, candidate)| candidate.mapping.mapping_id != *id);
        metrics::gauge!("mapping_engine_mappings").set(count(self.inventory.len()));
        true
    }

    /// The last values of a mapping's inputs, in the order they came, at most so many.
    pub fn recorded(&self, inputs: &[MappingInput], most: usize) -> Vec<DryRunSample> {
        let mut samples: Vec<DryRunSample> = Vec::new();
        for input in inputs {
            let values = self.routes.like(input).map(|route| &route.history);
            samples.extend(values.into_iter().flat_map(History::iter).map(|(at, value)| DryRunSample {
                input: input.name.clone(),
                at: *at,
                value: value.clone(),
            }));
        }
        samples.sort_by_key(|sample| sample.at);
        samples.split_off(samples.len().saturating_sub(most))
    }

    pub fn statuses(&self, id: Option<&MappingId>) -> Vec<MappingStatus> {
        match id {
            Some(id) => {
                let place = self.inventory.place_of(id);
                place.and_then(|place| self.inventory.get(place)).map(MappingStatus::of).into_iter().collect()
            }
            None => self.inventory.iter().map(MappingStatus::of).collect(),
        }
    }

    pub fn reset(&mut self, id: &MappingId) -> bool {
        let Some(place) = self.inventory.place_of(id) else { return false };
        let Some(entry) = self.inventory.get_mut(place) else { return false };
        entry.scripts.iter_mut().for_each(|script| script.breaker.succeeded());
        true
    }

    pub fn changed(&mut self, changes: Vec<InputChange>, now: DateTime) {
        metrics::counter!("mapping_engine_changes_total").increment(changes.len() as u64);
        let mut begun = Instant::now();
        for InputChange { input, value } in changes {
            self.change(input, value, now, &mut begun);
        }
        self.lanes.iter_mut().for_each(Lane::feed);
    }

    fn change(&mut self, key: InputKey, value: DataValue, now: DateTime, begun: &mut Instant) {
        let share = self.config.history.share(self.routes.len());
        let Some(route) = self.routes.get_mut(key) else { return };
        route.history.push(now, value.clone(), share);
        if let [only] = *route.subscribers.as_slice() {
            return self.take(only, value, now, begun);
        }
        for subscriber in route.subscribers.clone() {
            self.take(subscriber, value.clone(), now, begun);
        }
    }

    /// What one subscriber has done is where the next begins: asking for the time costs as much as a small function.
    fn take(&mut self, subscriber: Subscriber, value: DataValue, now: DateTime, begun: &mut Instant) {
        let Subscriber { place, input } = subscriber;
        let Some(entry) = self.inventory.get_mut(place) else { return };
        entry.received += 1;
        let reaction = entry.transform.on(now, input, value, None);
        let ended = Instant::now();
        entry.spent += ended - std::mem::replace(begun, ended);
        self.react(place, reaction, now);
    }

    pub fn next_timer(&self) -> Option<DateTime> {
        self.timers.next()
    }

    pub fn wake(&mut self, now: DateTime) {
        while let Some((place, due)) = self.timers.pop(now) {
            let Some(entry) = self.inventory.get_mut(place).filter(|entry| entry.scheduled == Some(due)) else {
                continue;
            };
            entry.scheduled = None;
            let reaction = entry.transform.on_timer(now, None);
            self.react(place, reaction, now);
        }
        self.lanes.iter_mut().for_each(Lane::feed);
    }

    fn react(&mut self, place: usize, reaction: Reaction, now: DateTime) {
        let Some(entry) = self.inventory.get_mut(place) else { return };
        if let Some(due) = entry.transform.due() {
            self.timers.schedule(&mut entry.scheduled, due, place);
        }
        match reaction {
            Reaction::Quiet => {}
            Reaction::Candidate(value) => self.yielded(place, value, now),
            Reaction::Failed(value, failed) => {
                entry.faults += 1;
                entry.last_fault = Some(Box::new(FaultRecord::new(now, failed.step, &failed.fault)));
                self.yielded(place, value, now);
            }
            Reaction::Call(call) => self.call(place, call, now),
        }
    }

    fn yielded(&mut self, place: usize, value: DataValue, now: DateTime) {
        let Some(entry) = self.inventory.get_mut(place) else { return };
        entry.yielded += 1;
        entry.last_yielded_at = Some(now);
        match &mut entry.last_candidate {
            Some(last) => (**last).clone_from(&value),
            none => *none = Some(Box::new(value.clone())),
        }
        if entry.is_shadow {
            return;
        }
        let mapping = Arc::clone(&entry.transform.plan().mapping);
        self.pending.push((place, Candidate { mapping, value, state: None }));
    }

    fn call(&mut self, place: usize, call: ScriptCall, now: DateTime) {
        let Some(entry) = self.inventory.get_mut(place) else { return };
        let Some(script) = entry.scripts.iter_mut().find(|script| script.step == call.step) else { return };
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
            Some(script_protocol::InputValue { input: u16::try_from(*index).ok()?, spoken: values::spoken(value) })
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
            Err(fault) if matches!(fault.kind, FaultKind::ScriptTimeout | FaultKind::ScriptOutOfMemory) => {
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
                mapping.id = entry.transform.plan().mapping.mapping_id.as_str(),
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

    /// Whether changes are to be taken.
    pub fn has_room(&self) -> bool {
        self.pending.len() < self.config.waiting_candidates_max
    }

    pub fn has_candidates(&self) -> bool {
        !self.pending.is_empty()
    }

    /// What waits for the consumer, each mapping's state with its last candidate.
    pub fn candidates(&mut self) -> Vec<Candidate> {
        self.batches += 1;
        metrics::counter!("mapping_engine_candidates_total").increment(self.pending.len() as u64);
        for (place, candidate) in self.pending.iter_mut().rev() {
            let Some(entry) = self.inventory.get_mut(*place).filter(|entry| entry.state_carried_in != self.batches)
            else {
                continue;
            };
            entry.state_carried_in = self.batches;
            candidate.state = entry.transform.state();
        }
        std::mem::take(&mut self.pending).into_iter().map(|(_, candidate)| candidate).collect()
    }
}

/// A script's result in the engine's words.
pub(super) fn yielded_of(yielded: Yielded) -> Result<Option<(asi_model::Variant, asi_model::StatusCode)>, Fault> {
    Ok(match yielded {
        Yielded::Nothing => None,
        Yielded::Value { value, status } => Some((values::from_script(value)?, asi_model::StatusCode(status))),
    })
}

#[allow(clippy::cast_precision_loss)]
const fn count(value: usize) -> f64 {
    value as f64
}
