//! One script in its own runtime.

use std::{rc::Rc, sync::Arc};

use rquickjs::{
    CatchResultExt, Context, Ctx, Function, Object, Persistent, Runtime, Value,
    context::EvalOptions,
};
use script_protocol::{
    Call, CallValue, FaultKind, InputValue, Limits, Load, ScriptFault, Spoken, Yielded,
    message::STATE_BYTES_MAX, worker::PRELUDE,
};

use crate::{fault, guard::Guard, values};

/// A loaded script.
///
/// Fields are dropped in this order: what belongs to the context before it, the context before the
/// runtime.
pub struct Script {
    functions: Functions,
    /// `ctx.state` as it was sent last.
    state: Option<Arc<str>>,
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

type Failed = Result<Yielded, ScriptFault>;

impl Script {
    /// Compiles a script and takes its function.
    pub fn start(load: &Load, limits: &Limits) -> Result<Self, ScriptFault> {
        let broken =
            |error: rquickjs::Error| ScriptFault::new(FaultKind::OutOfMemory, error.to_string());
        let runtime = Runtime::new().map_err(broken)?;
        let bytes = |bytes: u64| usize::try_from(bytes).unwrap_or(usize::MAX);
        runtime.set_memory_limit(bytes(limits.script_memory_bytes));
        runtime.set_max_stack_size(bytes(limits.script_stack_bytes));
        let guard = Guard::install(&runtime, limits.call_budget);
        let context = Context::full(&runtime).map_err(broken)?;
        // The engine names places in the file's words; a name that looks like a position would
        // confuse it.
        let file = format!("{}.js", load.name.replace([':', '(', ')', '\n', '\r', '\0'], "_"));
        let functions = context.with(|ctx| Self::compile(&ctx, load, &guard, &file))?;
        Ok(Self { functions, state: load.state.clone(), file, context, guard, _runtime: runtime })
    }

    fn compile(
        ctx: &Ctx<'_>,
        load: &Load,
        guard: &Guard,
        file: &str,
    ) -> Result<Functions, ScriptFault> {
        let of = |caught| fault::of(ctx, caught, file);
        let tools: Object<'_> = ctx.eval(PRELUDE).catch(ctx).map_err(of)?;
        let function = |name: &str| tools.get::<_, Function<'_>>(name).catch(ctx).map_err(of);
        let define = function("define")?;
        for (index, name) in load.inputs.iter().enumerate() {
            define.call::<_, ()>((index, &**name)).catch(ctx).map_err(of)?;
        }
        if let Some(state) = &load.state {
            function("restore")?.call::<_, ()>((&**state,)).catch(ctx).map_err(of)?;
        }
        let input = function("input")?;
        for value in &load.values {
            set_input(ctx, &tools, &input, value).catch(ctx).map_err(of)?;
        }
        let mut options = EvalOptions::default();
        options.strict = true;
        options.filename = Some(file.to_owned());
        // Top-level code may loop too.
        let (evaluated, has_fired) = guard
            .watch(|| ctx.eval_with_options::<Value<'_>, _>(&*load.source, options).catch(ctx));
        if has_fired {
            return Err(fault::timeout());
        }
        let script = evaluated.map_err(of)?.into_function().ok_or_else(|| {
            let message = "the script must end with a function, as (value, ctx) => value";
            ScriptFault::new(FaultKind::Result, message)
        })?;
        Ok(Functions {
            script: Persistent::save(ctx, script),
            invoke: Persistent::save(ctx, function("invoke")?),
            invoke_input: Persistent::save(ctx, function("invokeInput")?),
            state: Persistent::save(ctx, function("state")?),
            input: Persistent::save(ctx, input),
            tools: Persistent::save(ctx, tools),
        })
    }

    /// Calls the function. The second value is `ctx.state` where it changed.
    pub fn call(&mut self, call: &Call) -> (Failed, Option<Arc<str>>) {
        let Self { functions, state, file, context, guard, .. } = self;
        let ((outcome, new_state), has_fired) = guard.watch(|| {
            context.with(|ctx| {
                let called = functions.call(&ctx, call, state.as_deref());
                match called.catch(&ctx) {
                    Ok((outcome, new_state)) => (outcome, new_state),
                    Err(caught) => (Err(fault::of(&ctx, caught, file)), None),
                }
            })
        });
        if has_fired {
            return (Err(fault::timeout()), None);
        }
        if new_state.is_some() {
            state.clone_from(&new_state);
        }
        (outcome, new_state)
    }
}

impl Functions {
    /// The outer error is what was thrown.
    fn call<'js>(
        &self,
        ctx: &Ctx<'js>,
        call: &Call,
        state: Option<&str>,
    ) -> rquickjs::Result<(Failed, Option<Arc<str>>)> {
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
        let yielded = values::yielded(ctx, &tools, result)?;
        let json: Option<rquickjs::String<'js>> = self.state.clone().restore(ctx)?.call(())?;
        let json = json.map(|json| json.to_string()).transpose()?;
        if json.as_ref().is_some_and(|json| json.len() > STATE_BYTES_MAX) {
            let message = format!("ctx.state has at most {STATE_BYTES_MAX} bytes as JSON");
            return Ok((Err(ScriptFault::new(FaultKind::Result, message)), None));
        }
        let new_state = match (json, state) {
            (None, None) => None,
            // Setting it back to nothing is a change too.
            (None, Some(_)) => Some(Arc::from("null")),
            (Some(json), old) => (old != Some(json.as_str())).then(|| Arc::from(json)),
        };
        Ok((yielded, new_state.filter(|new| state != Some(&**new))))
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
