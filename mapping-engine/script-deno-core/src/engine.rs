//! All scripts of the worker, by their ids, in one isolate.

use std::{collections::HashMap, sync::Arc};

use deno_core::v8;
use script_protocol::{
    Call, CallValue, FaultKind, InputValue, Load, ScriptFault, ScriptId, ScriptLimits, Spoken,
    Yielded,
    worker::{
        LoadedScript, PRELUDE, ScriptEngine,
        fault::{file_name, not_a_function, not_loaded, out_of_memory, timeout},
        result::changed_state,
    },
};

use crate::{fault, timer::Timer, values};

/// Memory of the isolate, as a multiple of the limit of one script: all scripts share it.
const SHARED_MEMORIES: u64 = 8;

/// All scripts of a worker in one isolate.
pub struct Deno {
    limits: ScriptLimits,
    timer: Timer,
    scripts: HashMap<ScriptId, LoadedScript<RunningScript>>,
    isolate: v8::OwnedIsolate,
}

/// A script in its context.
struct RunningScript {
    file: String,
    context: v8::Global<v8::Context>,
    function: v8::Global<v8::Function>,
    invoke: v8::Global<v8::Function>,
    invoke_input: v8::Global<v8::Function>,
    input: v8::Global<v8::Function>,
    state_of: v8::Global<v8::Function>,
    kind_of: v8::Global<v8::Function>,
}

type Called = (Result<Yielded, ScriptFault>, Option<Arc<str>>);
type Function<'s> = v8::Local<'s, v8::Function>;

impl Deno {
    /// Creates an isolate for scripts with these limits; `timer` ends their calls.
    pub fn new(limits: ScriptLimits, timer: Timer) -> Self {
        Self { limits, timer, scripts: HashMap::new(), isolate: isolate(&limits) }
    }

    /// Runs something in the isolate within the budget. The second value is the reason where the
    /// timer or the memory limit ended it.
    fn watched<R>(
        &mut self,
        run: impl FnOnce(&mut v8::OwnedIsolate) -> R,
    ) -> (R, Option<ScriptFault>) {
        self.timer.begin(self.isolate.thread_safe_handle(), self.limits.call_budget);
        let result = run(&mut self.isolate);
        let has_fired = self.timer.end();
        // The other one that ends executions is the memory limit.
        let is_ended = self.isolate.is_execution_terminating();
        if has_fired || is_ended {
            self.isolate.cancel_terminate_execution();
        }
        let fault = if has_fired { Some(timeout()) } else { is_ended.then(out_of_memory) };
        (result, fault)
    }

    fn start(&mut self, load: &Load) -> Result<RunningScript, ScriptFault> {
        let (started, ended) = self.watched(|isolate| RunningScript::start(isolate, load));
        match ended {
            Some(fault) => Err(fault),
            None => started,
        }
    }

    /// Replaces the isolate: memory that scripts allocated is freed only with it.
    fn replace_isolate(&mut self) {
        for loaded in self.scripts.values_mut() {
            loaded.discard();
        }
        self.isolate = isolate(&self.limits);
    }
}

fn isolate(limits: &ScriptLimits) -> v8::OwnedIsolate {
    let memory = usize::try_from(limits.script_memory_bytes.saturating_mul(SHARED_MEMORIES))
        .unwrap_or(usize::MAX);
    v8::Isolate::new(v8::CreateParams::default().heap_limits(0, memory))
}

impl ScriptEngine for Deno {
    fn name(&self) -> String {
        format!("deno_core ({})", v8::V8::get_version())
    }

    fn load(&mut self, load: Load) -> Result<(), ScriptFault> {
        self.scripts.remove(&load.script);
        let script = self.start(&load);
        if matches!(&script, Err(fault) if fault.kind == FaultKind::OutOfMemory) {
            self.replace_isolate();
        }
        self.scripts.insert(load.script, LoadedScript::new(load, script?));
        Ok(())
    }

    fn unload(&mut self, script: ScriptId) {
        self.scripts.remove(&script);
    }

    fn call(&mut self, call: Call) -> Called {
        let Some(mut loaded) = self.scripts.remove(&call.script) else {
            return (Err(not_loaded()), None);
        };
        loaded.set_inputs(&call.inputs);
        let (outcome, state) = self.call_loaded(&mut loaded, &call);
        let is_exhausted = loaded.record(&outcome, state.as_ref());
        self.scripts.insert(call.script, loaded);
        if is_exhausted {
            self.replace_isolate();
        }
        (outcome, state)
    }
}

impl Deno {
    fn call_loaded(&mut self, loaded: &mut LoadedScript<RunningScript>, call: &Call) -> Called {
        let (script, state) = match loaded.running(|load| self.start(load)) {
            Ok(running) => running,
            Err(fault) => return (Err(fault), None),
        };
        let (called, ended) = self.watched(|isolate| script.call(isolate, call, state));
        match ended {
            Some(fault) => (Err(fault), None),
            None => called,
        }
    }
}

impl RunningScript {
    fn start(isolate: &mut v8::OwnedIsolate, load: &Load) -> Result<Self, ScriptFault> {
        let file = file_name(&load.name);
        let context = {
            v8::scope!(let scope, isolate);
            let context = v8::Context::new(scope, Default::default());
            v8::Global::new(scope, context)
        };
        v8::scope_with_context!(let scope, isolate, &context);
        v8::tc_scope!(let scope, scope);
        let compiled = Self::compile(scope, load, &file);
        match compiled {
            Some(Ok(functions)) => {
                let [function, invoke, invoke_input, input, state_of, kind_of] = functions;
                Ok(Self {
                    file,
                    context: context.clone(),
                    function,
                    invoke,
                    invoke_input,
                    input,
                    state_of,
                    kind_of,
                })
            }
            Some(Err(fault)) => Err(fault),
            None => Err(match scope.exception() {
                Some(thrown) => fault::of(scope, thrown, &file),
                None => out_of_memory(),
            }),
        }
    }

    /// The functions in the order of the fields. `None` where the engine threw.
    fn compile<'s>(
        scope: &v8::PinScope<'s, '_>,
        load: &Load,
        file: &str,
    ) -> Option<Result<[v8::Global<v8::Function>; 6], ScriptFault>> {
        let tools = run(scope, PRELUDE, "prelude.js", false)?;
        let tools: v8::Local<'s, v8::Object> = v8::Local::try_from(tools).ok()?;
        let tool =
            |name| v8::Local::<v8::Function>::try_from(values::member(scope, tools, name)?).ok();
        let undefined = v8::undefined(scope).into();
        let define = tool("define")?;
        for (index, name) in load.inputs.iter().enumerate() {
            let index = v8::Integer::new(scope, i32::try_from(index).ok()?);
            let name = v8::String::new(scope, name)?;
            define.call(scope, undefined, &[index.into(), name.into()])?;
        }
        if let Some(state) = &load.state {
            let json = v8::String::new(scope, state)?;
            tool("restore")?.call(scope, undefined, &[json.into()])?;
        }
        let input = tool("input")?;
        for value in &load.values {
            set_input(scope, input, value)?;
        }
        let result = run(scope, &load.source, file, true)?;
        let Ok(function) = v8::Local::<v8::Function>::try_from(result) else {
            return Some(Err(not_a_function()));
        };
        let functions =
            [function, tool("invoke")?, tool("invokeInput")?, input, tool("state")?, tool("kind")?];
        Some(Ok(functions.map(|function| v8::Global::new(scope, function))))
    }

    fn call(&self, isolate: &mut v8::OwnedIsolate, call: &Call, state: Option<&str>) -> Called {
        v8::scope_with_context!(let scope, isolate, &self.context);
        v8::tc_scope!(let scope, scope);
        match self.call_in(scope, call, state) {
            Some(called) => called,
            None => match scope.exception() {
                Some(thrown) => (Err(fault::of(scope, thrown, &self.file)), None),
                None => (Err(out_of_memory()), None),
            },
        }
    }

    /// `None` where the engine threw.
    fn call_in(
        &self,
        scope: &v8::PinScope<'_, '_>,
        call: &Call,
        state: Option<&str>,
    ) -> Option<Called> {
        let undefined = v8::undefined(scope).into();
        let input = v8::Local::new(scope, &self.input);
        for value in &call.inputs {
            set_input(scope, input, value)?;
        }
        let function = v8::Local::new(scope, &self.function);
        let result = match &call.value {
            CallValue::Input(index) => {
                let index = v8::Integer::new(scope, (*index).into());
                v8::Local::new(scope, &self.invoke_input).call(
                    scope,
                    undefined,
                    &[function.into(), index.into()],
                )?
            }
            CallValue::Own(spoken) => {
                let [value, status, time] = arguments(scope, spoken)?;
                v8::Local::new(scope, &self.invoke).call(
                    scope,
                    undefined,
                    &[function.into(), value, status, time],
                )?
            }
        };
        let yielded = values::yielded(scope, v8::Local::new(scope, &self.kind_of), result)?;
        let json = v8::Local::new(scope, &self.state_of).call(scope, undefined, &[])?;
        let json = json.is_string().then(|| json.to_rust_string_lossy(scope));
        Some(match changed_state(json, state) {
            Ok(changed) => (yielded, changed),
            Err(fault) => (Err(fault), None),
        })
    }
}

fn arguments<'s>(
    scope: &v8::PinScope<'s, '_>,
    spoken: &Spoken,
) -> Option<[v8::Local<'s, v8::Value>; 3]> {
    let time = match spoken.source_time_ms {
        Some(ms) => v8::Number::new(scope, ms).into(),
        None => v8::null(scope).into(),
    };
    Some([
        values::to_js(scope, &spoken.value)?,
        v8::Number::new(scope, spoken.status.into()).into(),
        time,
    ])
}

fn set_input<'s>(
    scope: &v8::PinScope<'s, '_>,
    input: Function<'s>,
    value: &InputValue,
) -> Option<()> {
    let index = v8::Integer::new(scope, value.input.into());
    let [content, status, time] = arguments(scope, &value.spoken)?;
    let undefined = v8::undefined(scope).into();
    input.call(scope, undefined, &[index.into(), content, status, time]).map(|_| ())
}

fn run<'s>(
    scope: &v8::PinScope<'s, '_>,
    source: &str,
    file: &str,
    is_strict: bool,
) -> Option<v8::Local<'s, v8::Value>> {
    // On the first line, so that lines keep their numbers; columns of that line are those of an
    // engine in strict mode.
    let source = if is_strict { format!("\"use strict\";{source}") } else { source.to_owned() };
    let source = v8::String::new(scope, &source)?;
    let name = v8::String::new(scope, file)?;
    let column = if is_strict { -13 } else { 0 };
    let origin = v8::ScriptOrigin::new(
        scope,
        name.into(),
        0,
        column,
        false,
        0,
        None,
        false,
        false,
        false,
        None,
    );
    v8::Script::compile(scope, source, Some(&origin))?.run(scope)
}
