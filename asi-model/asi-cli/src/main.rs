//! `asi`: checks, converts and explains the messages of the Activity Status Interface without any
//! server.
//!
//! Exit codes: 0 all is well, 1 the input is not valid, 2 the command could not be carried out.

mod access;
mod audit_lines;
mod check;
mod commands;
mod explain;
mod input;
mod ledger;
mod left;
mod lines;
mod outcome;

use std::{io::Write as _, process::ExitCode};

use clap::Parser as _;

use commands::AsiCommand;
use outcome::CommandOutcome;

/// Checks, converts and explains messages of the Activity Status Interface.
#[derive(Debug, clap::Parser)]
#[command(
    name = "asi",
    version,
    about,
    after_help = "Exit codes: 0 all is well, 1 the input is not valid, 2 the \
command could not be carried out."
)]
struct Arguments {
    #[command(subcommand)]
    command: AsiCommand,
}

fn main() -> ExitCode {
    // clap itself ends with 2 where the command line is wrong.
    let arguments = Arguments::parse();
    let mut out = std::io::stdout().lock();
    let outcome = commands::run(arguments.command, &mut out).and_then(|outcome| {
        out.flush()?;
        Ok(outcome)
    });
    match outcome {
        Ok(CommandOutcome::Valid) => ExitCode::SUCCESS,
        Ok(CommandOutcome::Invalid) => ExitCode::from(1),
        // The reader of our output may stop early, as `head` does.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            // An error that cannot be printed leaves only the exit code.
            let _ = writeln!(std::io::stderr(), "asi: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error
        .downcast_ref::<std::io::Error>()
        .is_some_and(|error| error.kind() == std::io::ErrorKind::BrokenPipe)
}
