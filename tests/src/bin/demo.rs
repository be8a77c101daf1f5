//! `demo run`: two factories and a cloud until Ctrl-C. `demo check`: the same, headless, each step
//! checked from outside.

use std::{path::PathBuf, process::ExitCode};

use clap::{Parser, Subcommand};
use verbund_tests::{demo, harness::say};

#[derive(Parser)]
#[command(about = "Two factories and a cloud on this machine.")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Plays the frame order until Ctrl-C; a second start goes on where the first stopped, with the next order.
    Run {
        /// Folder of configuration, data and logs.
        #[arg(long, default_value = "demo-data")]
        folder: PathBuf,
        /// Lets an order take three minutes instead of twenty.
        #[arg(long)]
        hurried: bool,
    },
    /// Plays it headless in a folder of its own and checks each step as a client from outside
    /// would; then watches a hurried `demo run` through an order and into the next.
    Check {
        /// Keeps the folder for a look at logs and data.
        #[arg(long)]
        keep: bool,
    },
    /// Goes a new factory's first steps in a browser, counted.
    Newcomer {
        /// Then measures the pages with 20 000 fields and 100 000 nodes on them.
        #[arg(long)]
        with_very_much: bool,
    },
    /// Goes the way that the README describes, from its commands to the first value, counted.
    Readme,
    /// Plays it headless and takes pictures of every page, into target/screenshots.
    Screenshots,
}

#[tokio::main]
async fn main() -> ExitCode {
    rustls::crypto::ring::default_provider().install_default().ok();
    let outcome = match Arguments::parse().command {
        Command::Run { folder, hurried } => demo::run(folder, hurried).await,
        Command::Check { keep } => match demo::check(keep).await {
            Ok(()) => demo::watch(keep).await,
            Err(error) => Err(error),
        },
        Command::Newcomer { with_very_much } => demo::newcomer(with_very_much).await,
        Command::Readme => demo::by_the_readme().await,
        Command::Screenshots => demo::screenshots().await,
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("\n{error:#}"));
            ExitCode::FAILURE
        }
    }
}
