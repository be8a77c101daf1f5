//! `probes`: attacks that once worked, against the real programs of the profile this was built in.

use std::process::ExitCode;

use clap::Parser;
use verbund_tests::{harness::say, probes};

#[derive(Parser)]
#[command(about = "Replays attacks, and shows the answer, the time and the memory of each.")]
struct Arguments {
    /// Attacks whose names contain this text; all of them without it.
    only: Option<String>,
    /// Keeps the folder for a look at logs and data.
    #[arg(long)]
    keep: bool,
}

#[tokio::main]
async fn main() -> ExitCode {
    rustls::crypto::ring::default_provider().install_default().ok();
    let Arguments { only, keep } = Arguments::parse();
    match probes::run(only.as_deref(), keep).await {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("\n{error:#}"));
            ExitCode::FAILURE
        }
    }
}
