//! Faults that every worker reports in the same words, and the position of an error in a script.

use crate::{FaultKind, ScriptFault};

/// Line and, where the engine knows it, column; both from 1.
pub type Position = (u32, Option<u32>);

/// Returns the fault of a call to a script that was never loaded, or was unloaded.
#[must_use]
pub fn not_loaded() -> ScriptFault {
    ScriptFault::new(FaultKind::NotLoaded, "there is no such script")
}

/// Returns the fault of a source text that does not evaluate to a function.
#[must_use]
pub fn not_a_function() -> ScriptFault {
    ScriptFault::new(
        FaultKind::Result,
        "the script must end with a function, as (value, ctx) => value",
    )
}

/// Returns the fault of a script that used up its memory.
#[must_use]
pub fn out_of_memory() -> ScriptFault {
    ScriptFault::new(
        FaultKind::OutOfMemory,
        "the script used more memory than it may; it starts again",
    )
}

/// Returns the fault of a script that used up its computing time.
#[must_use]
pub fn timeout() -> ScriptFault {
    ScriptFault::new(FaultKind::Timeout, "the script computed longer than it may")
}

/// Returns the fault of a thrown error; `name` is its class, as `TypeError`.
#[must_use]
pub fn thrown(name: String, message: String, position: Option<Position>) -> ScriptFault {
    let kind = if name == "SyntaxError" { FaultKind::Syntax } else { FaultKind::Error };
    let mut fault = ScriptFault::new(kind, message);
    fault.name = name.into();
    (fault.line, fault.column) =
        position.map_or((None, None), |(line, column)| (Some(line), column));
    fault
}

/// Returns a fault as one of a call: the script was JavaScript when it was loaded, so a `SyntaxError` is one that it threw.
#[must_use]
pub fn at_work(mut fault: ScriptFault) -> ScriptFault {
    if fault.kind == FaultKind::Syntax {
        fault.kind = FaultKind::Error;
    }
    fault
}

/// Returns the file name under which an engine gets a script, for [`position`] to find.
///
/// Characters that delimit positions in stack traces are replaced: a name that looks like a
/// position would be taken for one.
#[must_use]
pub fn file_name(script: &str) -> String {
    format!("{}.js", script.replace([':', '(', ')', '\n', '\r', '\0'], "_"))
}

/// Finds the innermost position in the script's own file, in lines as `    at f (name.js:3:10)` or
/// `    at name.js:3`.
#[must_use]
pub fn position(stack: &str, file: &str) -> Option<Position> {
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
