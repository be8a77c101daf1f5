//! What went wrong, in the words of the protocol.

use rquickjs::{CaughtError, Coerced, Ctx, Exception, FromJs};
use script_protocol::{FaultKind, ScriptFault};

/// A caught error as fault. `file` is the script's name as it was given to the engine.
pub fn of<'js>(ctx: &Ctx<'js>, caught: CaughtError<'js>, file: &str) -> ScriptFault {
    match caught {
        CaughtError::Exception(exception) => of_exception(&exception, file),
        CaughtError::Value(value) if value.is_null() || value.is_undefined() => out_of_memory(),
        CaughtError::Value(value) => {
            let text = Coerced::<String>::from_js(ctx, value)
                .map_or_else(|_| "a thrown value".to_owned(), |t| t.0);
            ScriptFault::new(FaultKind::Error, text)
        }
        // Rust-side conversions: a text that is not UTF-8, or memory that ran out there.
        CaughtError::Error(rquickjs::Error::Allocation) => out_of_memory(),
        CaughtError::Error(error) => ScriptFault::new(FaultKind::Result, error.to_string()),
    }
}

fn of_exception(exception: &Exception<'_>, file: &str) -> ScriptFault {
    let name: String = exception.as_object().get("name").unwrap_or_default();
    let message = exception.message().unwrap_or_default();
    if name == "InternalError" && message.contains("out of memory") {
        return out_of_memory();
    }
    let kind = if name == "SyntaxError" { FaultKind::Syntax } else { FaultKind::Error };
    let position = exception.stack().as_deref().and_then(|stack| position(stack, file));
    let mut fault = ScriptFault::new(kind, message);
    fault.name = name.into();
    (fault.line, fault.column) =
        position.map_or((None, None), |(line, column)| (Some(line), column));
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

/// The first place in the script's own file: `    at f (name.js:3:10)` or `    at name.js:3`.
fn position(stack: &str, file: &str) -> Option<(u32, Option<u32>)> {
    stack.lines().find_map(|line| {
        let at = line.find(file)?;
        let mut numbers =
            line[at + file.len()..].strip_prefix(':')?.split(|c: char| !c.is_ascii_digit());
        let line = numbers.next()?.parse().ok()?;
        Some((line, numbers.next().and_then(|column| column.parse().ok())))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_found_in_stacks() {
        for (stack, expected) in [
            ("    at f (m.js:3:10)\n    at m.js:7:1\n", Some((3, Some(10)))),
            ("    at <anonymous> (prelude.js:1:1)\n    at m.js:7\n", Some((7, None))),
            ("    at native\n", None),
            ("", None),
        ] {
            assert_eq!(position(stack, "m.js"), expected, "{stack}");
        }
    }
}
