//! Output of commands.

use std::io::Write as _;

use anyhow::Context as _;

/// Prints a line.
pub(super) fn print(text: &str) -> anyhow::Result<()> {
    writeln!(std::io::stdout(), "{text}").context("writing to standard output")
}
