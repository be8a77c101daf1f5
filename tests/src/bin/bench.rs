//! Latency and throughput of the whole path, with the real programs of the profile this was built in. Prints what it
//! finds and writes `target/bench/results.json`.

use std::process::ExitCode;

use verbund_tests::{bench, harness::say};

#[tokio::main]
async fn main() -> ExitCode {
    rustls::crypto::ring::default_provider().install_default().ok();
    match bench::run().await {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("\n{error:#}"));
            ExitCode::FAILURE
        }
    }
}
