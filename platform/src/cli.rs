//! The command line.

mod administration;
mod definitions;
mod output;
mod seal;
mod serve;

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use anyhow::Context;
use clap::{Args, Parser, Subcommand};
use daemon::{configuration, data_directory};
use platform::{
    config::{EXAMPLE, PlatformConfig},
    store::Role,
};

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
    /// Add organisations to the platform.
    #[command(subcommand)]
    Organisation(OrganisationCommand),
    /// Add factories and make their enrolment tokens.
    #[command(subcommand)]
    Factory(FactoryCommand),
    /// Add or change users of the platform.
    #[command(subcommand)]
    User(UserCommand),
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

#[derive(Debug, Subcommand)]
enum OrganisationCommand {
    /// Add an organisation.
    Add {
        /// Its id: letters, digits, `_` and `-`.
        organisation: String,
        /// Name for people; the id by default.
        #[arg(long)]
        name: Option<String>,
    },
}

#[derive(Debug, Subcommand)]
enum FactoryCommand {
    /// Add a factory and print a token with which its connector enrols.
    Add {
        /// Its id: letters, digits, `_` and `-`.
        factory: String,
        /// The organisation it belongs to; made where it is not known.
        #[arg(long)]
        organisation: String,
        /// Name for people; the id by default.
        #[arg(long)]
        name: Option<String>,
    },
    /// Print a new enrolment token for a factory.
    Token {
        /// Id of the factory.
        factory: String,
    },
}

#[derive(Debug, Subcommand)]
enum UserCommand {
    /// Add or change a user; the password is read from standard input.
    Set(SetUser),
}

/// A user to add or change.
#[derive(Debug, Args)]
struct SetUser {
    /// The name to sign in with.
    user: String,
    /// ADMINISTRATOR, PLANNER or VIEWER.
    #[arg(long)]
    role: Role,
    /// Organisation for which the user looks and acts; made where it is not known.
    #[arg(long)]
    organisation: Option<String>,
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
            Command::Organisation(OrganisationCommand::Add { organisation, name }) => {
                administration::add_organisation(&config, &organisation, name).await
            }
            Command::Factory(FactoryCommand::Add { factory, organisation, name }) => {
                administration::add_factory(&config, &factory, &organisation, name).await
            }
            Command::Factory(FactoryCommand::Token { factory }) => {
                administration::print_token(&config, &factory).await
            }
            Command::User(UserCommand::Set(user)) => {
                administration::set_user(&config, user.user, user.role, user.organisation).await
            }
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
