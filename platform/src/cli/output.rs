//! Output of commands.

use std::io::Write as _;

use anyhow::Context as _;

/// Prints a line.
pub(super) fn print(text: &str) -> anyhow::Result<()> {
    writeln!(std::io::stdout(), "{text}").context("writing to standard output")
}

/// Prints a line for people beside the output, which is for programs.
pub(super) fn note(text: &str) -> anyhow::Result<()> {
    writeln!(std::io::stderr(), "platform: {text}").context("writing to standard error")
}
