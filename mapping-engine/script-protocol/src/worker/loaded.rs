//! A loaded script that survives the loss of its engine context.

use std::sync::Arc;

use crate::{FaultKind, InputValue, Load, ScriptFault, Yielded};

/// Script of an engine, with everything that starts it again: source, state and input values.
#[derive(Debug)]
pub struct LoadedScript<S> {
    load: Load,
    /// `None` after [`Self::discard`], until the next call.
    running: Option<S>,
}

impl<S> LoadedScript<S> {
    /// Takes a script that was just started.
    pub const fn new(load: Load, running: S) -> Self {
        Self { load, running: Some(running) }
    }

    /// Stores the inputs that changed with a call.
    pub fn set_inputs(&mut self, inputs: &[InputValue]) {
        self.load.set_values(inputs);
    }

    /// Returns the running script and its `ctx.state` as JSON; starts it where it was discarded.
    ///
    /// # Errors
    /// Those of `start`.
    pub fn running(
        &mut self,
        start: impl FnOnce(&Load) -> Result<S, ScriptFault>,
    ) -> Result<(&mut S, Option<&str>), ScriptFault> {
        let script = match &mut self.running {
            Some(script) => script,
            empty => empty.insert(start(&self.load)?),
        };
        Ok((script, self.load.state.as_deref()))
    }

    /// Stores a call's new state. Discards a script that used up its memory and returns true then.
    ///
    /// Closures may hold what such a script allocated: only a new context is sure to have the
    /// memory back.
    pub fn record(
        &mut self,
        outcome: &Result<Yielded, ScriptFault>,
        state: Option<&Arc<str>>,
    ) -> bool {
        if let Some(state) = state {
            self.load.state = Some(Arc::clone(state));
        }
        let is_exhausted = matches!(outcome, Err(fault) if fault.kind == FaultKind::OutOfMemory);
        if is_exhausted {
            self.discard();
        }
        is_exhausted
    }

    /// Drops the engine's part of the script; the next call starts it again.
    pub fn discard(&mut self) {
        self.running = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ScriptId, worker::fault};

    #[test]
    fn a_script_that_used_up_its_memory_starts_again_from_its_state() {
        let load = Load {
            script: ScriptId(1),
            name: "m".into(),
            source: "v => v".into(),
            inputs: Vec::new(),
            state: None,
            values: Vec::new(),
        };
        let mut loaded = LoadedScript::new(load, "first");
        assert!(!loaded.record(&Ok(Yielded::Nothing), Some(&"1".into())));
        let mut starts = 0;
        let mut start = |load: &Load| {
            starts += 1;
            assert_eq!(load.state.as_deref(), Some("1"));
            Ok("second")
        };
        assert_eq!(loaded.running(&mut start), Ok((&mut "first", Some("1"))));
        assert!(loaded.record(&Err(fault::out_of_memory()), None));
        assert_eq!(loaded.running(&mut start), Ok((&mut "second", Some("1"))));
        assert_eq!(loaded.running(&mut start), Ok((&mut "second", Some("1"))));
        assert_eq!(starts, 1);
    }
}
