//! Decisions of the engine, without waiting for anything.

mod scripts;

use std::{collections::HashMap, sync::Arc, time::Instant};

use asi_model::{DataValue, DateTime};
use mapping::{
    Candidate, FaultRecord, MappingId, MappingInput,
    transform::{Reaction, Transform},
};
use script_protocol::ScriptId;
use shop_floor::{InputChange, InputKey, MonitorRequest};
use smallvec::SmallVec;

use super::{
    command::Compiled,
    config::MappingEngineConfig,
    error::EngineError,
    history::History,
    inventory::{Inventory, RunningMapping},
    plans::Plans,
    recording::VariableRecording,
    routes::{Routes, Subscriber},
    status::MappingStatus,
    survey::{MappingHealth, MappingSurvey},
    timers::Timers,
};
use crate::{dry_run::DryRunSample, inputs::Inputs, script::worker_queue::WorkerQueue};

/// Placeholder subscriber that keeps variables monitored while a mapping is replaced.
const HELD: u32 = u32::MAX;

/// State of the engine: mappings, routes, timers, and candidates that wait for the consumer.
pub(super) struct Core {
    config: MappingEngineConfig,
    inputs: Box<dyn Inputs>,
    inventory: Inventory,
    plans: Plans,
    routes: Routes,
    timers: Timers,
    queues: Vec<WorkerQueue>,
    /// Slot of a script's mapping, and index among the mapping's scripts.
    scripts: HashMap<ScriptId, (usize, usize)>,
    last_script: u32,
    pending: Vec<Candidate>,
    /// Slots of the mappings that yielded them.
    pending_slots: Vec<u32>,
    batches: u64,
}

impl Core {
    /// Creates an engine without mappings; `queues` has one entry per worker.
    pub fn new(
        config: MappingEngineConfig,
        inputs: Box<dyn Inputs>,
        queues: Vec<WorkerQueue>,
    ) -> Self {
        Self {
            config,
            inputs,
            inventory: Inventory::default(),
            plans: Plans::default(),
            routes: Routes::default(),
            timers: Timers::default(),
            queues,
            scripts: HashMap::new(),
            last_script: 0,
            pending: Vec::new(),
            pending_slots: Vec::new(),
            batches: 0,
        }
    }

    /// Publishes mappings. Returns one result for each.
    pub fn put_many(
        &mut self,
        compiled: Vec<Compiled>,
        now: DateTime,
    ) -> Vec<Result<(), EngineError>> {
        let mut requests = Vec::new();
        let mut results = Vec::with_capacity(compiled.len());
        let mut put = Vec::new();
        for mapping in compiled {
            let id = mapping.mapping.mapping_id.clone();
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
                    *result = Err(EngineError::Inputs(shop_floor::ShopFloorError::Invalid(
                        message.to_string(),
                    )));
                }
            }
        }
        self.queues.iter_mut().for_each(WorkerQueue::feed);
        metrics::gauge!("mapping_engine_mappings").set(count(self.inventory.len()));
        results
    }

    /// Replaces a mapping. Variables that both versions use stay monitored and keep their history.
    fn put(
        &mut self,
        compiled: Compiled,
        requests: &mut Vec<Arc<MonitorRequest>>,
        now: DateTime,
    ) -> Result<(), EngineError> {
        if compiled.goes_on && self.runs(&compiled) {
            return Ok(());
        }
        let mapping = Arc::clone(&compiled.mapping);
        let mut held = Vec::with_capacity(mapping.inputs.len());
        for (input, wanted) in (0..).zip(&mapping.inputs) {
            let subscriber = Subscriber { slot: HELD, input };
            let (key, request) = self.routes.subscribe(wanted, subscriber);
            requests.extend(request);
            held.push((key, subscriber));
        }
        let result = self.insert(compiled, now);
        for (key, subscriber) in held {
            if self.routes.unsubscribe(key, subscriber) {
                requests.retain(|request| request.input != key);
                self.inputs.unmonitor(&[key]);
            }
        }
        result
    }

    /// Returns true where a mapping runs already, for the same target.
    fn runs(&self, wanted: &Compiled) -> bool {
        let slot = self.inventory.slot_of(&wanted.mapping.mapping_id);
        slot.and_then(|slot| self.inventory.get(slot)).is_some_and(|running| {
            running.target == wanted.target
                && running.is_shadow == wanted.is_shadow
                && running.mapping == wanted.mapping
        })
    }

    fn insert(&mut self, compiled: Compiled, now: DateTime) -> Result<(), EngineError> {
        let Compiled { mapping, plan, target, state, last, is_shadow, .. } = compiled;
        let id = mapping.mapping_id.clone();
        self.remove(&id);
        if self.inventory.len() >= self.config.mappings_max {
            return Err(EngineError::TooManyMappings(self.config.mappings_max));
        }
        let transform = Transform::new(self.plans.shared(&mapping, plan), state, last);
        let slot = self.inventory.next_slot();
        let scripts = self.assign_scripts(&mapping, &transform, slot)?;
        let follower = |input| Subscriber { slot: narrow(slot), input };
        // They are held already, so there is nothing to request.
        let inputs = (0..).zip(&mapping.inputs);
        let keys: SmallVec<_> = inputs
            .map(|(input, wanted)| self.routes.subscribe(wanted, follower(input)).0)
            .collect();
        self.inventory.insert(
            id,
            RunningMapping::new(mapping, transform, target, keys.clone(), scripts, is_shadow),
        );
        let reaction =
            self.inventory.get_mut(slot).map(|running| running.transform.start(now, None));
        if let Some(reaction) = reaction {
            self.react(slot, reaction, now);
        }
        for (input, key) in (0..).zip(keys) {
            // A variable that is monitored already sends nothing until it changes, so its last
            // value comes from the history.
            let last = self.routes.get_mut(key).and_then(|route| route.history.newest().cloned());
            if let Some(last) = last {
                self.take(follower(input), last, now, &mut Instant::now());
            }
        }
        Ok(())
    }

    /// Withdraws a mapping and drops its candidates that wait. Returns false if there is none with
    /// this id.
    pub fn remove(&mut self, id: &MappingId) -> bool {
        let Some((slot, running)) = self.inventory.remove(id) else { return false };
        let mut unwanted = Vec::new();
        for (input, key) in (0..).zip(&running.inputs) {
            if self.routes.unsubscribe(*key, Subscriber { slot: narrow(slot), input }) {
                unwanted.push(*key);
            }
        }
        if !unwanted.is_empty() {
            self.inputs.unmonitor(&unwanted);
        }
        for script in &running.scripts {
            self.scripts.remove(&script.id);
            if let Some(queue) = self.queues.get_mut(script.worker) {
                queue.unload(script.id);
            }
        }
        let mut slots = self.pending_slots.iter();
        // Candidates of the old version must not arrive under the new one.
        self.pending.retain(|_| slots.next().is_none_or(|pending| *pending != narrow(slot)));
        self.pending_slots.retain(|pending| *pending != narrow(slot));
        metrics::gauge!("mapping_engine_mappings").set(count(self.inventory.len()));
        true
    }

    /// Returns the last values of a mapping's inputs, oldest first, at most `most`.
    pub fn recorded(&self, inputs: &[MappingInput], most: usize) -> Vec<DryRunSample> {
        let mut samples: Vec<DryRunSample> = Vec::new();
        for input in inputs {
            let values = self.routes.like(input).map(|route| &route.history);
            samples.extend(values.into_iter().flat_map(History::iter).map(|(at, value)| {
                DryRunSample { input: input.name.clone(), at: *at, value: value.clone() }
            }));
        }
        samples.sort_by_key(|sample| sample.at);
        samples.split_off(samples.len().saturating_sub(most))
    }

    /// Takes the values that were recorded before the start.
    pub fn resume(&mut self, recordings: Vec<VariableRecording>) {
        self.routes.resume(recordings);
    }

    /// Returns the newest recorded values of all variables in use, at most `most`.
    pub fn recordings(&self, most: usize) -> Vec<VariableRecording> {
        self.routes.recordings(most)
    }

    /// Returns the status of one mapping.
    pub fn status(&self, id: &MappingId) -> Option<MappingStatus> {
        self.inventory.get(self.inventory.slot_of(id)?).map(MappingStatus::of)
    }

    /// Returns the numbers of mappings by health and the worst `most` of them.
    pub fn survey(&self, wanted: Option<MappingHealth>, most: usize) -> MappingSurvey {
        MappingSurvey::of(&self.inventory, wanted, most)
    }

    /// Closes the circuit breakers of a mapping's scripts. Returns false if there is none with this
    /// id.
    pub fn reset(&mut self, id: &MappingId) -> bool {
        let Some(slot) = self.inventory.slot_of(id) else { return false };
        let Some(running) = self.inventory.get_mut(slot) else { return false };
        running.scripts.iter_mut().for_each(|script| script.breaker.succeeded());
        true
    }

    /// Routes a batch of changes to the mappings that use them.
    pub fn changed(&mut self, changes: Vec<InputChange>, now: DateTime) {
        metrics::counter!("mapping_engine_changes_total").increment(changes.len() as u64);
        let mut begun = Instant::now();
        let share = self.config.history.share(self.routes.len());
        self.pending.reserve(changes.len());
        self.pending_slots.reserve(changes.len());
        for InputChange { input, value } in changes {
            self.change(input, value, share, now, &mut begun);
        }
        self.queues.iter_mut().for_each(WorkerQueue::feed);
    }

    fn change(
        &mut self,
        key: InputKey,
        value: DataValue,
        share: usize,
        now: DateTime,
        begun: &mut Instant,
    ) {
        let Some(route) = self.routes.get_mut(key) else { return };
        route.history.push(now, value.clone(), share);
        if let [only] = *route.subscribers.as_slice() {
            return self.take(only, value, now, begun);
        }
        // A copy of the list, since `take` needs all of the engine.
        for subscriber in route.subscribers.clone() {
            self.take(subscriber, value.clone(), now, begun);
        }
    }

    /// Runs one subscriber. `begun` is the end of the one before: reading the clock costs as much
    /// as a small function.
    fn take(
        &mut self,
        subscriber: Subscriber,
        value: DataValue,
        now: DateTime,
        begun: &mut Instant,
    ) {
        let (slot, input) = (subscriber.slot as usize, subscriber.input as usize);
        let Some(running) = self.inventory.get_mut(slot) else { return };
        running.counters.received += 1;
        let reaction = running.transform.on(now, input, value, None);
        let ended = Instant::now();
        running.counters.spent += ended - std::mem::replace(begun, ended);
        self.react(slot, reaction, now);
    }

    /// Returns the time of the next [`Self::wake`].
    pub fn next_timer(&self) -> Option<DateTime> {
        self.timers.next()
    }

    /// Runs the timers that are due.
    pub fn wake(&mut self, now: DateTime) {
        while let Some((slot, due)) = self.timers.pop(now) {
            let Some(running) =
                self.inventory.get_mut(slot).filter(|running| running.scheduled == Some(due))
            else {
                continue;
            };
            running.scheduled = None;
            let reaction = running.transform.on_timer(now, None);
            self.react(slot, reaction, now);
        }
        self.queues.iter_mut().for_each(WorkerQueue::feed);
    }

    fn react(&mut self, slot: usize, reaction: Reaction, now: DateTime) {
        let Some(running) = self.inventory.get_mut(slot) else { return };
        if let Some(due) = running.transform.due() {
            self.timers.schedule(&mut running.scheduled, due, slot);
        }
        match reaction {
            Reaction::Quiet => {}
            Reaction::Candidate(value) => self.yielded(slot, value, now),
            Reaction::Failed(value, failed) => {
                running.counters.faults += 1;
                running.counters.last_fault =
                    Some(Box::new(FaultRecord::new(now, failed.step, &failed.fault)));
                self.yielded(slot, value, now);
            }
            Reaction::Call(call) => self.call(slot, call, now),
        }
    }

    fn yielded(&mut self, slot: usize, value: DataValue, now: DateTime) {
        let Some(running) = self.inventory.get_mut(slot) else { return };
        running.counters.yielded += 1;
        running.counters.last_yielded_at = Some(now);
        // A shadow mapping yields for its status only: nothing of it reaches the gate.
        if !running.is_shadow {
            self.pending.push(Candidate { target: running.target, value, state: None });
            self.pending_slots.push(narrow(slot));
        }
    }

    /// Returns true while changes may be taken.
    pub fn has_room(&self) -> bool {
        self.pending.len() < self.config.waiting_candidates_max
    }

    /// Returns true while candidates wait for the consumer.
    pub fn has_candidates(&self) -> bool {
        !self.pending.is_empty()
    }

    /// Takes the candidates that wait, each mapping's state with its last one.
    pub fn candidates(&mut self) -> Vec<Candidate> {
        self.batches += 1;
        metrics::counter!("mapping_engine_candidates_total").increment(self.pending.len() as u64);
        for (candidate, slot) in self.pending.iter_mut().zip(self.pending_slots.drain(..)).rev() {
            let running = self.inventory.get_mut(slot as usize);
            let Some(running) = running.filter(|running| running.state_carried_in != self.batches)
            else {
                continue;
            };
            running.state_carried_in = self.batches;
            candidate.state = running.transform.state();
        }
        std::mem::take(&mut self.pending)
    }
}

/// Returns a slot in the form that is stored per candidate: mappings are limited far below 2^32.
fn narrow(slot: usize) -> u32 {
    u32::try_from(slot).unwrap_or(HELD)
}

#[allow(clippy::cast_precision_loss)]
const fn count(value: usize) -> f64 {
    value as f64
}
