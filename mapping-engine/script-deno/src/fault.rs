//! What went wrong, in the words of the protocol.

use deno_core::v8;
use script_protocol::{FaultKind, ScriptFault};

/// A caught error as fault. `file` is the script's name as it was given to the engine.
pub fn of<'s>(
    scope: &v8::PinScope<'s, '_>,
    thrown: v8::Local<'s, v8::Value>,
    file: &str,
) -> ScriptFault {
    let text = |name: &str| {
        let object = v8::Local::<v8::Object>::try_from(thrown).ok()?;
        let key = v8::String::new(scope, name)?;
        let value = object.get(scope, key.into())?;
        value.is_string().then(|| value.to_rust_string_lossy(scope))
    };
    if thrown.is_null_or_undefined() {
        return out_of_memory();
    }
    let Some(message) = text("message") else {
        return ScriptFault::new(FaultKind::Error, thrown.to_rust_string_lossy(scope));
    };
    let name = text("name").unwrap_or_default();
    if message.contains("out of memory") {
        return out_of_memory();
    }
    let kind = if name == "SyntaxError" { FaultKind::Syntax } else { FaultKind::Error };
    let mut fault = ScriptFault::new(kind, message);
    fault.name = name.into();
    if let Some((line, column)) = text("stack").as_deref().and_then(|stack| position(stack, file)) {
        (fault.line, fault.column) = (Some(line), column);
    } else {
        let message = v8::Exception::create_message(scope, thrown);
        fault.line = message.get_line_number(scope).and_then(|line| u32::try_from(line).ok());
        fault.column = fault.line.and_then(|_| u32::try_from(message.get_start_column() + 1).ok());
    }
    fault
}

/// The fault of a script that used up its memory.
pub fn out_of_memory() -> ScriptFault {
    ScriptFault::new(
        FaultKind::OutOfMemory,
        "the script used more memory than it may; it starts anew",
    )
}

/// The fault of a script that used up its time.
pub fn timeout() -> ScriptFault {
    ScriptFault::new(FaultKind::Timeout, "the script computed longer than it may")
}

/// The first place in the script's own file: `    at f (name.js:3:10)`.
fn position(stack: &str, file: &str) -> Option<(u32, Option<u32>)> {
    stack.lines().find_map(|line| {
        let at = line.find(file)?;
        let mut numbers =
            line[at + file.len()..].strip_prefix(':')?.split(|c: char| !c.is_ascii_digit());
        let line = numbers.next()?.parse().ok()?;
        Some((line, numbers.next().and_then(|column| column.parse().ok())))
    })
}
