//! Latency and throughput of the whole path, with the real programs of the profile this was built
//! in, and figures of the twin alone. Prints what it finds and writes `target/bench/results.json`.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use verbund_tests::{
    bench::{self, Subject, part::Part},
    harness::say,
};

#[derive(Parser)]
#[command(about = "Benchmarks.", args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Parts to measure; all when none is named.
    #[arg(value_enum)]
    subjects: Vec<Subject>,
}

#[derive(Subcommand)]
enum Command {
    /// One part of the figures, in a process of its own; prints them as JSON.
    #[command(hide = true)]
    Part {
        /// Name of the part.
        #[arg(value_enum)]
        part: Part,
    },
}

#[tokio::main]
async fn main() -> ExitCode {
    rustls::crypto::ring::default_provider().install_default().ok();
    let arguments = Arguments::parse();
    let outcome = match arguments.command {
        None => bench::run(&arguments.subjects).await,
        Some(Command::Part { part }) => bench::part_runner::run(part).await,
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("\n{error:#}"));
            ExitCode::FAILURE
        }
    }
}
