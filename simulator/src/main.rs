//! Simulated machines as OPC UA servers.

use std::{io::Write as _, path::PathBuf};

use anyhow::Context as _;
use clap::{Parser, Subcommand};
use simulator::{Config, EXAMPLE, Simulator};
use tokio_util::sync::CancellationToken;
use tracing_subscriber::EnvFilter;

/// Simulated machines as OPC UA servers.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
struct Arguments {
    /// The configuration file (TOML).
    #[arg(long, env = "SIMULATOR_CONFIG")]
    config: Option<PathBuf>,
    /// Family of controllers whose limits all machines have that name none, as `s7-1200`.
    #[arg(long)]
    profile: Option<String>,
    #[command(subcommand)]
    command: Option<SimulatorCommand>,
}

#[derive(Subcommand)]
enum SimulatorCommand {
    /// Prints a commented example of the configuration.
    ExampleConfig,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    if let Some(SimulatorCommand::ExampleConfig) = arguments.command {
        std::io::stdout().write_all(EXAMPLE.as_bytes())?;
        return Ok(());
    }
    let path = arguments
        .config
        .context("no configuration: give --config FILE (simulator example-config prints one)")?;
    let filter =
        EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("info,opcua=error"));
    tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).init();
    let mut config = Config::load(&path)?;
    if let Some(profile) = arguments.profile {
        for machine in &mut config.machines {
            machine.profile.get_or_insert_with(|| profile.clone());
        }
        config.check()?;
    }
    let (simulator, handle) = Simulator::new(config).await?;
    for machine in handle.machines() {
        tracing::info!(machine = %machine.name(), endpoint = %machine.endpoint_url(), "A machine is ready.");
    }
    let shutdown = CancellationToken::new();
    tokio::spawn({
        let shutdown = shutdown.clone();
        async move {
            stop_signal().await;
            shutdown.cancel();
        }
    });
    simulator.run(shutdown).await;
    Ok(())
}

#[cfg(unix)]
async fn stop_signal() {
    use tokio::signal::unix::{SignalKind, signal};
    let mut terminate = signal(SignalKind::terminate()).expect("a signal handler can be installed");
    tokio::select! {
        _ = tokio::signal::ctrl_c() => {}
        _ = terminate.recv() => {}
    }
}

#[cfg(not(unix))]
async fn stop_signal() {
    let _ = tokio::signal::ctrl_c().await;
}
