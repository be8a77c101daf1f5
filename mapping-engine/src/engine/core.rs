//! What the engine decides, without waiting for anything.

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
    Compiled, EngineError, MappingEngineConfig,
    history::History,
    inventory::{Entry, Inventory},
    plans::Plans,
    routes::{Routes, Subscriber},
    status::MappingStatus,
    survey::{MappingHealth, MappingSurvey},
    timers::Timers,
};
use crate::{dry_run::DryRunSample, inputs::Inputs, script::lane::Lane};

pub(super) use scripts::yielded_of;

/// The place of nobody: holds variables while their mapping is replaced.
const HELD: u32 = u32::MAX;

/// Mappings, routes, timers, and what waits for the consumer.
pub(super) struct Core {
    config: MappingEngineConfig,
    inputs: Box<dyn Inputs>,
    inventory: Inventory,
    plans: Plans,
    routes: Routes,
    timers: Timers,
    lanes: Vec<Lane>,
    /// Where a script belongs: its mapping's place, and which of its scripts it is.
    scripts: HashMap<ScriptId, (usize, usize)>,
    last_script: u32,
    pending: Vec<Candidate>,
    /// The places of the mappings that made them.
    pending_places: Vec<u32>,
    batches: u64,
}

impl Core {
    pub fn new(config: MappingEngineConfig, inputs: Box<dyn Inputs>, lanes: Vec<Lane>) -> Self {
        Self {
            config,
            inputs,
            inventory: Inventory::default(),
            plans: Plans::default(),
            routes: Routes::default(),
            timers: Timers::default(),
            lanes,
            scripts: HashMap::new(),
            last_script: 0,
            pending: Vec::new(),
            pending_places: Vec::new(),
            batches: 0,
        }
    }

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
        self.lanes.iter_mut().for_each(Lane::feed);
        metrics::gauge!("mapping_engine_mappings").set(count(self.inventory.len()));
        results
    }

    /// What both the mapping so far and the new one use stays monitored, and keeps what was
    /// recorded of it.
    fn put(
        &mut self,
        compiled: Compiled,
        requests: &mut Vec<Arc<MonitorRequest>>,
        now: DateTime,
    ) -> Result<(), EngineError> {
        let mapping = Arc::clone(&compiled.mapping);
        let mut held = Vec::with_capacity(mapping.inputs.len());
        for (input, wanted) in (0..).zip(&mapping.inputs) {
            let subscriber = Subscriber { place: HELD, input };
            let (key, request) = self.routes.subscribe(wanted, subscriber);
            requests.extend(request);
            held.push((key, subscriber));
        }
        let result = self.put_in_place(compiled, now);
        for (key, subscriber) in held {
            if self.routes.unsubscribe(key, subscriber) {
                requests.retain(|request| request.input != key);
                self.inputs.unmonitor(&[key]);
            }
        }
        result
    }

    fn put_in_place(&mut self, compiled: Compiled, now: DateTime) -> Result<(), EngineError> {
        let Compiled { mapping, plan, target, state, last, is_shadow } = compiled;
        let id = mapping.mapping_id.clone();
        self.remove(&id);
        if self.inventory.len() >= self.config.mappings_max {
            return Err(EngineError::TooManyMappings(self.config.mappings_max));
        }
        let transform = Transform::new(self.plans.shared(&mapping, plan), state, last);
        let place = self.inventory.next_place();
        let scripts = self.place_scripts(&mapping, &transform, place)?;
        let follower = |input| Subscriber { place: narrow(place), input };
        // They are held already, so there is nothing to request.
        let inputs = (0..).zip(&mapping.inputs);
        let keys: SmallVec<_> = inputs
            .map(|(input, wanted)| self.routes.subscribe(wanted, follower(input)).0)
            .collect();
        self.inventory
            .insert(id, Entry::new(mapping, transform, target, keys.clone(), scripts, is_shadow));
        let reaction = self.inventory.get_mut(place).map(|entry| entry.transform.start(now, None));
        if let Some(reaction) = reaction {
            self.react(place, reaction, now);
        }
        for (input, key) in (0..).zip(keys) {
            let last = self.routes.get_mut(key).and_then(|route| route.history.newest().cloned());
            if let Some(last) = last {
                self.take(follower(input), last, now, &mut Instant::now());
            }
        }
        Ok(())
    }

    pub fn remove(&mut self, id: &MappingId) -> bool {
        let Some((place, entry)) = self.inventory.remove(id) else { return false };
        let mut unwanted = Vec::new();
        for (input, key) in (0..).zip(&entry.inputs) {
            if self.routes.unsubscribe(*key, Subscriber { place: narrow(place), input }) {
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
        let mut places = self.pending_places.iter();
        self.pending.retain(|_| places.next().is_none_or(|pending| *pending != narrow(place)));
        self.pending_places.retain(|pending| *pending != narrow(place));
        metrics::gauge!("mapping_engine_mappings").set(count(self.inventory.len()));
        true
    }

    /// The last values of a mapping's inputs, in the order they came, at most so many.
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

    pub fn status(&self, id: &MappingId) -> Option<MappingStatus> {
        self.inventory.get(self.inventory.place_of(id)?).map(MappingStatus::of)
    }

    pub fn survey(&self, wanted: Option<MappingHealth>, most: usize) -> MappingSurvey {
        MappingSurvey::of(&self.inventory, wanted, most)
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
        let share = self.config.history.share(self.routes.len());
        self.pending.reserve(changes.len());
        self.pending_places.reserve(changes.len());
        for InputChange { input, value } in changes {
            self.change(input, value, share, now, &mut begun);
        }
        self.lanes.iter_mut().for_each(Lane::feed);
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
        for subscriber in route.subscribers.clone() {
            self.take(subscriber, value.clone(), now, begun);
        }
    }

    /// What one subscriber has done is where the next begins: asking for the time costs as much as
    /// a small function.
    fn take(
        &mut self,
        subscriber: Subscriber,
        value: DataValue,
        now: DateTime,
        begun: &mut Instant,
    ) {
        let (place, input) = (subscriber.place as usize, subscriber.input as usize);
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
            let Some(entry) =
                self.inventory.get_mut(place).filter(|entry| entry.scheduled == Some(due))
            else {
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
                entry.last_fault =
                    Some(Box::new(FaultRecord::new(now, failed.step, &failed.fault)));
                self.yielded(place, value, now);
            }
            Reaction::Call(call) => self.call(place, call, now),
        }
    }

    fn yielded(&mut self, place: usize, value: DataValue, now: DateTime) {
        let Some(entry) = self.inventory.get_mut(place) else { return };
        entry.yielded += 1;
        entry.last_yielded_at = Some(now);
        if !entry.is_shadow {
            self.pending.push(Candidate { target: entry.target, value, state: None });
            self.pending_places.push(narrow(place));
        }
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
        for (candidate, place) in self.pending.iter_mut().zip(self.pending_places.drain(..)).rev() {
            let entry = self.inventory.get_mut(place as usize);
            let Some(entry) = entry.filter(|entry| entry.state_carried_in != self.batches) else {
                continue;
            };
            entry.state_carried_in = self.batches;
            candidate.state = entry.transform.state();
        }
        std::mem::take(&mut self.pending)
    }
}

/// A place as it is noted where there are many: mappings are limited far below 2^32.
fn narrow(place: usize) -> u32 {
    u32::try_from(place).unwrap_or(HELD)
}

#[allow(clippy::cast_precision_loss)]
const fn count(value: usize) -> f64 {
    value as f64
}
