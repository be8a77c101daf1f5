//! The command line.

mod administration;
mod collaboration;
mod definitions;
mod factory;
mod organisation;
mod output;
mod removal;
mod seal;
mod serve;
mod tool;
mod user;

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use anyhow::Context;
use clap::{Parser, Subcommand};
use daemon::{configuration, data_directory};
use platform::config::{EXAMPLE, PlatformConfig};

use output::print;

/// The cloud services of Verbund.
#[derive(Debug, Parser)]
#[command(name = "platform", version, about)]
pub struct Arguments {
    /// The configuration file (TOML); defaults for all keys without one.
    #[arg(long, short, global = true, env = "VERBUND_CONFIG")]
    config: Option<PathBuf>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the platform until SIGINT or SIGTERM.
    Serve,
    /// Run the embedded broker alone, with the same users and queues.
    Broker {
        /// Do what the platform says over standard input; for the platform itself.
        #[arg(long, hide = true)]
        supervised: bool,
    },
    /// Print the definitions for another broker: users, rights, queues, limits. Contains secrets.
    Definitions {
        /// Product that the definitions are for.
        kind: definitions::BrokerKind,
    },
    /// Check or show the configuration.
    #[command(subcommand)]
    Config(ConfigCommand),
    /// Print what others wrote of this program and its pages, with the licences.
    Notices,
    /// List, add and remove organisations.
    #[command(subcommand)]
    Organisation(organisation::OrganisationCommand),
    /// List, add and remove factories, and make their enrolment tokens.
    #[command(subcommand)]
    Factory(factory::FactoryCommand),
    /// List, add, change and remove the people who may sign in.
    #[command(subcommand, visible_alias = "person")]
    User(user::UserCommand),
    /// List, add and remove collaborations, and say who takes part in them.
    #[command(subcommand)]
    Collaboration(collaboration::CollaborationCommand),
    /// List, add and remove tools, and make their credentials.
    #[command(subcommand)]
    Tool(tool::ToolCommand),
    /// Manage the key that seals the secrets in the database.
    #[command(subcommand)]
    Seal(seal::SealCommand),
}

#[derive(Debug, Subcommand)]
enum ConfigCommand {
    /// Say what is wrong with the configuration, environment included.
    Check,
    /// Print a commented example with every key.
    Example,
}

/// Runs the command; prints what goes wrong with all its causes.
pub fn run(arguments: Arguments) -> ExitCode {
    let result = match arguments.command {
        Command::Config(ConfigCommand::Example) => print(EXAMPLE.trim_end()),
        Command::Notices => print(daemon::notices::NOTICES.trim_end()),
        Command::Broker { supervised: true } => run_supervised(),
        Command::Config(ConfigCommand::Check) => {
            load(arguments.config.as_deref()).and_then(|config| {
                for note in config.notes() {
                    print(&note)?;
                }
                print("The configuration is valid.")
            })
        }
        command => {
            load(arguments.config.as_deref()).and_then(|config| run_command(command, config))
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => daemon::exit::after("platform", error.as_ref()),
    }
}

fn run_supervised() -> anyhow::Result<()> {
    let runtime = start_runtime()?;
    let ended = runtime.block_on(platform::broker_process::run_supervised());
    // Not waiting for the thread that reads the platform's lines.
    runtime.shutdown_background();
    Ok(ended?)
}

fn start_runtime() -> anyhow::Result<tokio::runtime::Runtime> {
    let mut builder = tokio::runtime::Builder::new_multi_thread();
    builder.enable_all().build().context("starting the runtime")
}

fn run_command(command: Command, config: PlatformConfig) -> anyhow::Result<()> {
    data_directory::tighten(&config.data_directory, config.allow_shared_data_directory)?;
    start_runtime()?.block_on(async {
        match command {
            Command::Serve => serve::serve(config).await,
            Command::Broker { .. } => serve::broker(config).await,
            Command::Definitions { kind } => definitions::print(&config, kind).await,
            Command::Organisation(command) => organisation::run(command, &config).await,
            Command::Factory(command) => factory::run(command, &config).await,
            Command::User(command) => user::run(command, &config).await,
            Command::Collaboration(command) => collaboration::run(command, &config).await,
            Command::Tool(command) => tool::run(command, &config).await,
            Command::Seal(command) => seal::run(command, &config).await,
            Command::Config(_) | Command::Notices => Ok(()),
        }
    })
}

fn load(path: Option<&Path>) -> anyhow::Result<PlatformConfig> {
    let config: PlatformConfig = configuration::load(path, "VERBUND")?;
    let faults = config.faults();
    if faults.is_empty() {
        return Ok(config);
    }
    anyhow::bail!("the configuration has {} fault(s):\n  {}", faults.len(), faults.join("\n  "))
}
