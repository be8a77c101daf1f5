//! One script in its own runtime.

use std::{rc::Rc, sync::Arc};

use rquickjs::{Context, Ctx, Function, Object, Persistent, Runtime, Value, context::EvalOptions};
use script_protocol::{
    Call, CallValue, FaultKind, InputValue, Load, ScriptFault, ScriptLimits, Spoken, Yielded,
    worker::{
        PRELUDE,
        fault::{at_work, file_name, not_a_function, timeout},
        result::changed_state,
    },
};

use crate::{fault::Failure, guard::Guard, values};

/// A loaded script.
///
/// Fields are dropped in this order: what belongs to the context before it, the context before the
/// runtime.
pub struct RunningScript {
    functions: Functions,
    file: String,
    context: Context,
    guard: Rc<Guard>,
    _runtime: Runtime,
}

/// The functions that are called for every value.
struct Functions {
    script: Persistent<Function<'static>>,
    invoke: Persistent<Function<'static>>,
    invoke_input: Persistent<Function<'static>>,
    input: Persistent<Function<'static>>,
    state: Persistent<Function<'static>>,
    tools: Persistent<Object<'static>>,
}

/// Outcome of a call, and `ctx.state` as JSON where it changed.
type Called = (Result<Yielded, ScriptFault>, Option<Arc<str>>);

impl RunningScript {
    /// Compiles a script in a new runtime and takes the function that it evaluates to.
    ///
    /// # Errors
    /// [`ScriptFault`] where it does not compile, throws, takes too long or is no function.
    pub fn start(load: &Load, limits: &ScriptLimits) -> Result<Self, ScriptFault> {
        let no_runtime =
            |error: rquickjs::Error| ScriptFault::new(FaultKind::OutOfMemory, error.to_string());
        let runtime = Runtime::new().map_err(no_runtime)?;
        let bytes = |bytes: u64| usize::try_from(bytes).unwrap_or(usize::MAX);
        runtime.set_memory_limit(bytes(limits.script_memory_bytes));
        runtime.set_max_stack_size(bytes(limits.script_stack_bytes));
        let guard = Guard::install(&runtime, limits.call_budget);
        let context = Context::full(&runtime).map_err(no_runtime)?;
        let file = file_name(&load.name);
        let functions = context.with(|ctx| {
            Functions::compile(&ctx, load, &guard, &file)
                .map_err(|failure| failure.into_fault(&ctx, &file))
        })?;
        Ok(Self { functions, file, context, guard, _runtime: runtime })
    }

    /// Calls the function. `state` is `ctx.state` before the call, as JSON; the second value is the
    /// state where it changed.
    pub fn call(&mut self, call: &Call, state: Option<&str>) -> Called {
        let Self { functions, file, context, guard, .. } = self;
        let (called, has_fired) = guard.watch(|| {
            context.with(|ctx| {
                functions.call(&ctx, call, state).map_err(|failure| failure.into_fault(&ctx, file))
            })
        });
        match called {
            _ if has_fired => (Err(timeout()), None),
            Ok((outcome, new_state)) => (outcome, new_state),
            Err(fault) => (Err(at_work(fault)), None),
        }
    }
}

impl Functions {
    fn compile(ctx: &Ctx<'_>, load: &Load, guard: &Guard, file: &str) -> Result<Self, Failure> {
        let tools: Object<'_> = ctx.eval(PRELUDE)?;
        let function = |name: &str| tools.get::<_, Function<'_>>(name);
        let define = function("define")?;
        for (index, name) in load.inputs.iter().enumerate() {
            define.call::<_, ()>((index, &**name))?;
        }
        if let Some(state) = &load.state {
            function("restore")?.call::<_, ()>((&**state,))?;
        }
        let input = function("input")?;
        for value in &load.values {
            set_input(ctx, &tools, &input, value)?;
        }
        let mut options = EvalOptions::default();
        options.strict = true;
        options.filename = Some(file.to_owned());
        // Top-level code may loop too.
        let (evaluated, has_fired) =
            guard.watch(|| ctx.eval_with_options::<Value<'_>, _>(&*load.source, options));
        if has_fired {
            return Err(timeout().into());
        }
        let script = evaluated?.into_function().ok_or_else(not_a_function)?;
        Ok(Self {
            script: Persistent::save(ctx, script),
            invoke: Persistent::save(ctx, function("invoke")?),
            invoke_input: Persistent::save(ctx, function("invokeInput")?),
            state: Persistent::save(ctx, function("state")?),
            input: Persistent::save(ctx, input),
            tools: Persistent::save(ctx, tools),
        })
    }

    /// Returns the outcome and the state where it changed.
    ///
    /// A result that is not a value is an outcome: the script ran to its end, so its state counts.
    fn call<'js>(
        &self,
        ctx: &Ctx<'js>,
        call: &Call,
        state: Option<&str>,
    ) -> Result<Called, Failure> {
        let tools = self.tools.clone().restore(ctx)?;
        if !call.inputs.is_empty() {
            let input = self.input.clone().restore(ctx)?;
            for value in &call.inputs {
                set_input(ctx, &tools, &input, value)?;
            }
        }
        let script = self.script.clone().restore(ctx)?;
        let result: Value<'js> = match &call.value {
            CallValue::Input(index) => {
                self.invoke_input.clone().restore(ctx)?.call((script, *index))?
            }
            CallValue::Own(Spoken { value, status, source_time_ms }) => {
                let value = values::to_js(ctx, &tools, value)?;
                self.invoke.clone().restore(ctx)?.call((
                    script,
                    value,
                    f64::from(*status),
                    source_time_ms,
                ))?
            }
        };
        let outcome = match values::yielded(&tools, result) {
            Err(Failure::Fault(fault)) => Err(fault),
            yielded => Ok(yielded?),
        };
        let json: Option<rquickjs::String<'js>> = self.state.clone().restore(ctx)?.call(())?;
        let json = json.map(|json| json.to_string()).transpose()?;
        Ok((outcome, changed_state(json, state)?))
    }
}

fn set_input<'js>(
    ctx: &Ctx<'js>,
    tools: &Object<'js>,
    input: &Function<'js>,
    value: &InputValue,
) -> rquickjs::Result<()> {
    let Spoken { value: content, status, source_time_ms } = &value.spoken;
    let content = values::to_js(ctx, tools, content)?;
    input.call((value.input, content, f64::from(*status), source_time_ms))
}
