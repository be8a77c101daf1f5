//! V8 errors as faults of the protocol.

use deno_core::v8;
use script_protocol::{
    FaultKind, ScriptFault,
    worker::fault::{out_of_memory, position, thrown},
};

/// Returns a thrown value as fault. `file` is the script's name as it was given to the engine.
pub fn of<'s>(
    scope: &v8::PinScope<'s, '_>,
    value: v8::Local<'s, v8::Value>,
    file: &str,
) -> ScriptFault {
    let text = |name: &str| {
        let object = v8::Local::<v8::Object>::try_from(value).ok()?;
        let key = v8::String::new(scope, name)?;
        let member = object.get(scope, key.into())?;
        member.is_string().then(|| member.to_rust_string_lossy(scope))
    };
    if value.is_null_or_undefined() {
        return out_of_memory();
    }
    let Some(message) = text("message") else {
        return ScriptFault::new(FaultKind::Error, value.to_rust_string_lossy(scope));
    };
    if message.contains("out of memory") {
        return out_of_memory();
    }
    let in_stack = text("stack").as_deref().and_then(|stack| position(stack, file));
    // An error of the compiler has no stack, but the engine knows where it is.
    let position = in_stack.or_else(|| {
        let message = v8::Exception::create_message(scope, value);
        let line = message.get_line_number(scope).and_then(|line| u32::try_from(line).ok())?;
        Some((line, u32::try_from(message.get_start_column() + 1).ok()))
    });
    thrown(text("name").unwrap_or_default(), message, position)
}
