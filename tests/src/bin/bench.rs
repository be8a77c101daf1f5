//! Latency and throughput of the whole path, with the real programs of the profile this was built in, and figures of
//! the twin alone. Prints what it finds and writes `target/bench/results.json`.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use verbund_tests::{
    bench::{self, twin::Part},
    harness::say,
};

#[derive(Parser)]
#[command(about = "Benchmarks; without a subcommand all of them.")]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// The OPC UA server alone, and beside one written with node-opcua.
    Twin,
    /// Mappings of one connector alone, and beside the same job done with node-opcua.
    Mappings,
    /// One part of the server's figures, in a process of its own; prints them as JSON.
    #[command(hide = true)]
    Part {
        /// Which.
        #[arg(value_enum)]
        part: Part,
    },
}

#[tokio::main]
async fn main() -> ExitCode {
    rustls::crypto::ring::default_provider().install_default().ok();
    let outcome = match Arguments::parse().command {
        None => bench::run().await,
        Some(Command::Twin) => bench::run_twin().await,
        Some(Command::Mappings) => bench::run_mappings().await,
        Some(Command::Part { part }) => bench::run_twin_part(part).await,
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("\n{error:#}"));
            ExitCode::FAILURE
        }
    }
}
