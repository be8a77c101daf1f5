//! Standard output of commands.

use std::io::Write as _;

use anyhow::Context as _;

/// Prints a line. A closed output is an error of the command, not a panic.
pub(super) fn print(text: &str) -> anyhow::Result<()> {
    writeln!(std::io::stdout(), "{text}").context("writing to standard output")
}

/// Prints a warning or a request on standard error, apart from what a script reads.
pub(super) fn print_note(text: &str) -> anyhow::Result<()> {
    writeln!(std::io::stderr(), "factory-connector: {text}").context("writing to standard error")
}
