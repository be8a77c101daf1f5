//! All scripts of the worker, by their ids.

use std::{collections::HashMap, sync::Arc};

use script_protocol::{
    Call, Load, ScriptFault, ScriptId, ScriptLimits, Yielded,
    worker::{LoadedScript, ScriptEngine, fault},
};

use crate::script::RunningScript;

/// All scripts of a worker, each in a runtime of its own.
pub struct QuickJs {
    limits: ScriptLimits,
    scripts: HashMap<ScriptId, LoadedScript<RunningScript>>,
}

impl QuickJs {
    /// Creates an engine without scripts; each script gets these limits.
    pub fn new(limits: &ScriptLimits) -> Self {
        Self { limits: *limits, scripts: HashMap::new() }
    }
}

impl ScriptEngine for QuickJs {
    fn name(&self) -> String {
        "quickjs-ng".to_owned()
    }

    fn load(&mut self, load: Load) -> Result<(), ScriptFault> {
        self.scripts.remove(&load.script);
        let script = RunningScript::start(&load, &self.limits)?;
        self.scripts.insert(load.script, LoadedScript::new(load, script));
        Ok(())
    }

    fn unload(&mut self, script: ScriptId) {
        self.scripts.remove(&script);
    }

    fn call(&mut self, call: Call) -> (Result<Yielded, ScriptFault>, Option<Arc<str>>) {
        let Some(loaded) = self.scripts.get_mut(&call.script) else {
            return (Err(fault::not_loaded()), None);
        };
        loaded.set_inputs(&call.inputs);
        let (outcome, state) = match loaded.running(|load| RunningScript::start(load, &self.limits))
        {
            Ok((script, state)) => script.call(&call, state),
            Err(fault) => (Err(fault), None),
        };
        loaded.record(&outcome, state.as_ref());
        (outcome, state)
    }
}
