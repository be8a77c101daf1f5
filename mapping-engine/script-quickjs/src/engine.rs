//! All scripts of the worker, by their ids.

use std::{collections::HashMap, sync::Arc};

use script_protocol::{
    Call, FaultKind, InputValue, Limits, Load, ScriptFault, ScriptId, Yielded, worker::ScriptEngine,
};

use crate::script::Script;

/// The engine.
pub struct QuickJs {
    limits: Limits,
    scripts: HashMap<ScriptId, Loaded>,
}

/// A script with what is needed to start it anew when it exhausted its memory.
struct Loaded {
    load: Load,
    script: Option<Script>,
}

impl QuickJs {
    pub fn new(limits: &Limits) -> Self {
        Self { limits: *limits, scripts: HashMap::new() }
    }
}

impl ScriptEngine for QuickJs {
    fn name(&self) -> String {
        "quickjs-ng".to_owned()
    }

    fn load(&mut self, load: Load) -> Result<(), ScriptFault> {
        self.scripts.remove(&load.script);
        let script = Script::start(&load, &self.limits)?;
        self.scripts.insert(load.script, Loaded { load, script: Some(script) });
        Ok(())
    }

    fn unload(&mut self, script: ScriptId) {
        self.scripts.remove(&script);
    }

    fn call(&mut self, call: Call) -> (Result<Yielded, ScriptFault>, Option<Arc<str>>) {
        let Some(loaded) = self.scripts.get_mut(&call.script) else {
            return (Err(ScriptFault::new(FaultKind::NotLoaded, "there is no such script")), None);
        };
        loaded.remember(&call.inputs);
        let script = match &mut loaded.script {
            Some(script) => script,
            empty => match Script::start(&loaded.load, &self.limits) {
                Ok(script) => empty.insert(script),
                Err(fault) => return (Err(fault), None),
            },
        };
        let (outcome, state) = script.call(&call);
        if let Some(state) = &state {
            loaded.load.state = Some(Arc::clone(state));
        }
        if matches!(&outcome, Err(fault) if fault.kind == FaultKind::OutOfMemory) {
            // What it allocated may be held by its closures: only a new runtime is sure to have its
            // memory back.
            loaded.script = None;
        }
        (outcome, state)
    }
}

impl Loaded {
    fn remember(&mut self, inputs: &[InputValue]) {
        for input in inputs {
            match self.load.values.iter_mut().find(|known| known.input == input.input) {
                Some(known) => known.spoken.clone_from(&input.spoken),
                None => self.load.values.push(input.clone()),
            }
        }
    }
}
