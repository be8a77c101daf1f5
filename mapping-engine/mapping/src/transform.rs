//! A mapping at work: a state machine without I/O.
//!
//! A change of an input enters the chain at the first function that uses that input and runs from
//! there. Each function passes a value on, holds it back, fails, or - a script - asks for a call
//! whose result comes back through [`Transform::resume`]. How status and time travel is stated in
//! `quality.rs`.

mod apply;
mod compile;
mod counting;
mod flow;
mod last_candidate;
mod merging;
mod operand;
mod plan;
mod reaction;
mod slots;
mod table;
mod windows;

use std::sync::Arc;

use asi_model::{DataValue, DateTime, StatusCode, Variant};
use smallvec::SmallVec;

use crate::{
    fault::Fault,
    quality::{Meta, severity, worst},
    state::{StepState, TransformState},
    trace::TraceStep,
};
pub use compile::compile;
use flow::Applied;
pub use flow::Flow;
use last_candidate::LastCandidate;
use plan::Function;
pub use plan::Plan;
pub use reaction::{FailedStep, Reaction, ScriptCall, ScriptYield};
pub use slots::Counters;
use slots::{Arrival, Slot};

/// A compiled mapping with its state.
#[derive(Debug)]
pub struct Transform {
    plan: Arc<Plan>,
    /// One input is the rule, and it is at hand then.
    slots: SmallVec<[Slot; 1]>,
    state: TransformState,
    /// The value before each function at which another input than the first enters.
    carried: Vec<(usize, Flow)>,
    last: LastCandidate,
    /// Per script step, which inputs changed since its last call.
    unsent: Vec<(usize, u32)>,
    pub counters: Counters,
}

impl Transform {
    /// A transform, with what a former run left: its state, and the last value it yielded.
    pub fn new(plan: Arc<Plan>, state: Option<TransformState>, last: Option<DataValue>) -> Self {
        let mut steps = plan.fresh_state();
        if let Some(former) = state {
            for (fresh, kept) in steps.iter_mut().zip(former.0.iter()) {
                if kept.is_like(fresh) {
                    fresh.clone_from(kept);
                }
            }
        }
        Self {
            slots: plan.inputs.iter().map(|_| Slot::default()).collect(),
            unsent: plan.script_steps().map(|step| (step, u32::MAX)).collect(),
            carried: Vec::new(),
            last: LastCandidate::restored(last),
            state: TransformState::new(steps),
            plan,
            counters: Counters::default(),
        }
    }

    /// Returns the plan that it runs.
    pub fn plan(&self) -> &Arc<Plan> {
        &self.plan
    }

    /// The state, if any function has one.
    pub fn state(&self) -> Option<TransformState> {
        (!self.state.0.is_empty()).then(|| self.state.clone())
    }

    /// The last candidate, that of a former run included.
    pub fn shown(&self) -> Option<DataValue> {
        self.last.value()
    }

    /// The status of the last candidate.
    pub fn shown_status(&self) -> Option<StatusCode> {
        self.last.status()
    }

    /// The last value of an input and when it came by the local clock.
    pub fn input(&self, index: usize) -> Option<(&DataValue, DateTime)> {
        let slot = self.slots.get(index)?;
        slot.value.as_ref().map(|value| (value, slot.received_at))
    }

    /// The remembered `ctx.state` of a script.
    pub fn script_state(&self, step: usize) -> Option<Arc<str>> {
        match self.state.0.get(step) {
            Some(StepState::Script { state }) => state.clone(),
            _ => None,
        }
    }

    /// A mapping that uses no input speaks once, when it is put.
    pub fn start(&mut self, now: DateTime, trace: Option<&mut Vec<TraceStep>>) -> Reaction {
        if self.plan.inputs.iter().any(|input| input.entry.is_some()) {
            return Reaction::Quiet;
        }
        let meta = Meta { source_timestamp: Some(now), ..Meta::default() };
        self.run(0, Flow { value: Variant::Null, meta }, None, now, trace)
    }

    /// Takes a value of an input, by its index in the document, and runs the functions it triggers.
    pub fn on(
        &mut self,
        now: DateTime,
        input: usize,
        value: DataValue,
        trace: Option<&mut Vec<TraceStep>>,
    ) -> Reaction {
        let (Some(slot), Some(planned)) = (self.slots.get_mut(input), self.plan.inputs.get(input))
        else {
            return Reaction::Quiet;
        };
        let Some(entry) = planned.entry else { return Reaction::Quiet };
        let (triggers, picked) = (planned.triggers, planned.is_picked);
        let arrival = slot.take(value, now, self.plan.late_values, &mut self.counters);
        self.unsent.iter_mut().for_each(|(_, mask)| *mask |= 1 << input);
        match arrival {
            Arrival::Ignored => Reaction::Quiet,
            // What is already known is not evaluated again, but its source may have been away in
            // between.
            Arrival::Repeated | Arrival::SourceAway if !picked => self.show_again(),
            _ if !triggers => self.show_again(),
            _ => self.enter(entry, input, now, trace),
        }
    }

    /// Returns the time of the next [`Self::on_timer`], by the local clock.
    pub fn due(&self) -> Option<DateTime> {
        self.state
            .0
            .iter()
            .zip(&self.plan.functions)
            .filter_map(|(state, function)| function.due(state))
            .min()
    }

    /// Runs the first function whose time has come.
    pub fn on_timer(&mut self, now: DateTime, mut trace: Option<&mut Vec<TraceStep>>) -> Reaction {
        let plan = Arc::clone(&self.plan);
        let is_due = |state: &StepState, function: &Function| {
            function.due(state).is_some_and(|due| due <= now)
        };
        let step = self
            .state
            .0
            .iter()
            .zip(&plan.functions)
            .position(|(state, function)| is_due(state, function));
        let Some((step, function)) = step.and_then(|step| Some((step, plan.functions.get(step)?)))
        else {
            return Reaction::Quiet;
        };
        let state = &mut Arc::make_mut(&mut self.state.0)[step];
        match function.on_timer(state, now) {
            Applied::Pass(flow) => {
                trace_passed(trace.as_deref_mut(), &plan, step, &flow);
                self.run(step + 1, flow, None, now, trace)
            }
            _ => Reaction::Quiet,
        }
    }

    /// Goes on with the functions after a script call, with its result or its fault.
    pub fn resume(
        &mut self,
        now: DateTime,
        call: ScriptCall,
        result: Result<ScriptYield, Fault>,
        mut trace: Option<&mut Vec<TraceStep>>,
    ) -> Reaction {
        let mut meta = call.flow.meta;
        meta.combine(&call.input_meta);
        let yielded = match result {
            Ok(yielded) => yielded,
            Err(fault) => return self.fail(Some(call.step), fault, meta, trace),
        };
        // Candidates share the state: it is copied only where it changes.
        if let Some(new) = yielded.state
            && let Some(StepState::Script { state }) =
                Arc::make_mut(&mut self.state.0).get_mut(call.step)
        {
            *state = Some(new);
        }
        match yielded.value {
            None => {
                TraceStep::held(trace.as_deref_mut(), call.step, self.plan.name_of(call.step));
                self.show_again()
            }
            Some((_, status)) if severity(status) == 2 => self.say_bad(meta.failed(status)),
            Some((Variant::Null, _)) => self.say_bad(meta.failed(StatusCode::BAD_NO_DATA)),
            Some((value, status)) => {
                meta.status = worst(meta.status, status);
                let flow = Flow { value, meta };
                trace_passed(trace.as_deref_mut(), &self.plan, call.step, &flow);
                self.run(call.step + 1, flow, None, now, trace)
            }
        }
    }

    /// Enters the chain because an input changed.
    fn enter(
        &mut self,
        entry: usize,
        input: usize,
        now: DateTime,
        trace: Option<&mut Vec<TraceStep>>,
    ) -> Reaction {
        let slots = self.slots.iter().zip(&self.plan.inputs);
        for (slot, _) in slots.filter(|(_, planned)| planned.is_required) {
            if let Some(bad) = slot.bad(self.last.is_usable()) {
                return self.say_bad(bad);
            }
            if slot.is_waiting() {
                return Reaction::Quiet;
            }
            if slot.is_away_unseen() {
                return self.show_again();
            }
        }
        let is_head = entry == 0;
        let carried =
            self.carried.iter().find(|(step, _)| *step == entry).map(|(_, flow)| flow.clone());
        let flow = match carried {
            Some(flow) => flow,
            None if is_head => match self.slots.first().and_then(Slot::flow) {
                Some(flow) => flow,
                None if self.plan.head_uses_value => return Reaction::Quiet,
                None => Flow { value: Variant::Null, meta: Meta::default() },
            },
            None if self.plan.functions.get(entry).is_some_and(|f| !f.uses_value()) => {
                Flow { value: Variant::Null, meta: Meta::default() }
            }
            // The functions before have not let anything through yet.
            None => return Reaction::Quiet,
        };
        self.run(entry, flow, Some(input), now, trace)
    }

    /// Runs the chain from a function to its end.
    fn run(
        &mut self,
        from: usize,
        mut flow: Flow,
        mut trigger: Option<usize>,
        now: DateTime,
        mut trace: Option<&mut Vec<TraceStep>>,
    ) -> Reaction {
        let Self { plan, slots, state, carried, .. } = self;
        for (step, function) in plan.functions.iter().enumerate().skip(from) {
            if step > 0 && plan.carried.contains(&step) && trigger.is_none_or(|_| step != from) {
                carry(carried, step, &flow);
            }
            let applied = if let Function::Script = function {
                Applied::Call(flow)
            } else if matches!(state.0.get(step), None | Some(StepState::None)) {
                function.apply(&mut StepState::None, flow, trigger, slots, now)
            } else {
                function.apply(&mut Arc::make_mut(&mut state.0)[step], flow, trigger, slots, now)
            };
            trigger = None;
            match applied {
                Applied::Pass(next) => {
                    trace_passed(trace.as_deref_mut(), plan, step, &next);
                    flow = next;
                }
                Applied::Hold => {
                    TraceStep::held(trace.as_deref_mut(), step, plan.name_of(step));
                    return self.show_again();
                }
                Applied::Fail(fault, meta) => return self.fail(Some(step), fault, meta, trace),
                Applied::Call(flow) => return Reaction::Call(self.call(step, flow)),
            }
        }
        self.finish(flow, trace)
    }

    fn call(&mut self, step: usize, flow: Flow) -> ScriptCall {
        let mask = self
            .unsent
            .iter_mut()
            .find(|(at, _)| *at == step)
            .map_or(0, |(_, mask)| std::mem::take(mask));
        let changed = self.slots.iter().enumerate().filter(|(index, _)| mask >> index & 1 == 1);
        let inputs =
            changed.filter_map(|(index, slot)| Some((index, slot.flow()?.into_value()))).collect();
        let mut input_meta = Meta::default();
        let others = self
            .slots
            .iter()
            .zip(&self.plan.inputs)
            .skip(1)
            .filter(|(_, planned)| planned.is_required);
        for meta in others.filter_map(|(slot, _)| slot.meta()) {
            input_meta.combine(&meta);
        }
        ScriptCall { step, flow, inputs, input_meta }
    }

    /// The end of the chain: the value must be one of the target's type.
    fn finish(&mut self, flow: Flow, trace: Option<&mut Vec<TraceStep>>) -> Reaction {
        let Flow { value, meta } = flow;
        match self.plan.coerce(value) {
            Err(fault) => self.fail(None, fault, meta, trace),
            Ok(Variant::Null) => self.say_bad(meta.failed(StatusCode::BAD_NO_DATA)),
            Ok(value) => {
                let value = meta.with(value);
                let inputs = self.input_status();
                let own = if severity(meta.status) > severity(inputs) {
                    meta.status
                } else {
                    StatusCode::GOOD
                };
                self.last.set_usable(&value, own);
                Reaction::Candidate(value)
            }
        }
    }

    /// Inputs whose values the functions need.
    fn required(&self) -> impl Iterator<Item = &Slot> {
        let slots = self.slots.iter().zip(&self.plan.inputs);
        slots.filter(|(_, planned)| planned.is_required).map(|(slot, _)| slot)
    }

    /// The worst status among the required inputs.
    fn input_status(&self) -> StatusCode {
        let statuses = self.required().filter_map(|slot| slot.status(self.last.is_usable()));
        statuses.fold(StatusCode::GOOD, worst)
    }

    /// Yields the last value again where its status has changed with that of the inputs.
    fn show_again(&mut self) -> Reaction {
        let inputs = self.input_status();
        if severity(inputs) == 2 {
            let bad = self.required().find_map(|slot| slot.bad(self.last.is_usable()));
            return match bad {
                Some(bad) if self.last.status() != Some(bad.status) => self.say_bad(bad),
                _ => Reaction::Quiet,
            };
        }
        self.last.refresh(inputs).map_or(Reaction::Quiet, Reaction::Candidate)
    }

    fn say_bad(&mut self, value: DataValue) -> Reaction {
        self.last.set_bad(&value);
        Reaction::Candidate(value)
    }

    fn fail(
        &mut self,
        step: Option<usize>,
        fault: Fault,
        meta: Meta,
        trace: Option<&mut Vec<TraceStep>>,
    ) -> Reaction {
        if let Some(step) = step {
            TraceStep::failed(trace, step, self.plan.name_of(step), &fault);
        }
        let value = meta.failed(fault.status);
        self.last.set_bad(&value);
        Reaction::Failed(value, FailedStep { step, fault })
    }
}

fn trace_passed(trace: Option<&mut Vec<TraceStep>>, plan: &Plan, step: usize, flow: &Flow) {
    TraceStep::passed(trace, step, plan.name_of(step), &flow.value, &flow.meta);
}

/// Stores the value before a function at which another input than the first enters.
fn carry(carried: &mut Vec<(usize, Flow)>, step: usize, flow: &Flow) {
    match carried.iter_mut().find(|(at, _)| *at == step) {
        Some((_, kept)) => kept.clone_from(flow),
        None => carried.push((step, flow.clone())),
    }
}

#[cfg(test)]
mod tests;
