//! `chaos --minutes 30 --seed 7`: the seeded run of everything that can go wrong.

use std::{path::PathBuf, process::ExitCode, time::Duration};

use clap::Parser;
use verbund_tests::{
    chaos::{self, Breach, Length},
    harness::say,
    world::BrokerKind,
};

#[derive(Parser)]
#[command(
    about = "Kills, cuts, stalls and fills what it can, and proves that nothing is lost or doubled."
)]
struct Arguments {
    /// Minutes for which faults go on.
    #[arg(long, default_value_t = 5)]
    minutes: u64,
    /// Seed of the faults; drawn at random and printed when none is given.
    #[arg(long)]
    seed: Option<u64>,
    /// No new faults after so many kills.
    #[arg(long, default_value_t = u32::MAX)]
    kills: u32,
    /// Fails when there were fewer kills in the end.
    #[arg(long, default_value_t = 0)]
    at_least_kills: u32,
    /// Fails when there were fewer faults in the end.
    #[arg(long, default_value_t = 0)]
    at_least_faults: u32,
    /// The broker: embedded, rabbitmq or mosquitto.
    #[arg(long, default_value = "embedded")]
    broker: BrokerKind,
    /// Leaves out full disks, which only root can mount, instead of failing.
    #[arg(long)]
    may_lack_disks: bool,
    /// Leaves out clocks that jump, which libfaketime makes, instead of failing.
    #[arg(long)]
    may_lack_clocks: bool,
    /// Keeps the folder for a look at logs and data.
    #[arg(long)]
    keep: bool,
    /// File for all faults that are found, each in a line; people are shown the first ones.
    #[arg(long)]
    faults: Option<PathBuf>,
}

#[tokio::main]
async fn main() -> ExitCode {
    rustls::crypto::ring::default_provider().install_default().ok();
    let arguments = Arguments::parse();
    let length = Length {
        span: Duration::from_secs(arguments.minutes * 60),
        kills: arguments.kills,
        at_least_kills: arguments.at_least_kills,
        at_least_faults: arguments.at_least_faults,
        rounds_at_least: 2,
        may_lack_disks: arguments.may_lack_disks,
        may_lack_clocks: arguments.may_lack_clocks,
    };
    let Arguments { seed, broker, keep, faults, .. } = arguments;
    match chaos::run(seed.unwrap_or_else(rand::random), length, broker, keep).await {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            say(&format!("\n{error:#}"));
            if let (Some(file), Some(breach)) = (faults, error.downcast_ref::<Breach>())
                && let Err(error) = std::fs::write(&file, breach.lines())
            {
                say(&format!("{}: {error}", file.display()));
            }
            ExitCode::FAILURE
        }
    }
}
