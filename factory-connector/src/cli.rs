//! Commands of the binary: run the connector, or work on its data directory.

mod certificate;
mod ledger;
mod output;
mod seal;
mod spool;

use std::{
    io::{BufRead as _, IsTerminal as _, Read as _},
    path::{Path, PathBuf},
    process::ExitCode,
    time::Duration,
};

use anyhow::Context as _;
use clap::{Parser, Subcommand};
use daemon::{
    Confidential, configuration, data_directory,
    lifecycle::Lifecycle,
    telemetry,
    web::session::{PasswordHashing, PasswordPolicy},
};
use factory_connector::{
    clock::now,
    config::{ConnectorConfig, EXAMPLE},
    enrolment, service,
    store::{Role, Store, User},
};
use output::{print, print_note};

/// Time for all tasks together to finish after the first signal.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(15);

/// Longest password or token on standard input.
const INPUT_BYTES_MAX: u64 = 4096;

/// Prefix of the environment variables that override the file.
const ENVIRONMENT: &str = "VERBUND";

/// The connector of one factory.
#[derive(Debug, Parser)]
#[command(name = "factory-connector", version, about)]
pub struct Arguments {
    /// The configuration file (TOML); defaults for all keys without one.
    #[arg(long, short, global = true, env = "VERBUND_CONFIG")]
    config: Option<PathBuf>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the connector until SIGINT or SIGTERM.
    Run,
    /// Spend a single-use token of the platform and keep the credential it yields.
    Enrol {
        /// File with the token that the platform's administrator gave you; standard input without it.
        #[arg(long)]
        token_file: Option<PathBuf>,
        /// The platform's address, where it differs from the one in the token.
        #[arg(long)]
        platform: Option<String>,
    },
    /// Check or show the configuration.
    #[command(subcommand)]
    Config(ConfigCommand),
    /// The OPC UA server's own certificate.
    #[command(subcommand)]
    Certificate(certificate::CertificateCommand),
    /// The ledger of everything that left.
    #[command(subcommand)]
    Ledger(ledger::LedgerCommand),
    /// Print what others wrote of this program and its pages, with the licences.
    Notices,
    /// The key that seals the passwords in the store.
    #[command(subcommand)]
    Seal(seal::SealCommand),
    /// The messages that wait to leave.
    #[command(subcommand)]
    Spool(spool::SpoolCommand),
    /// People who may sign in.
    #[command(subcommand)]
    Users(UsersCommand),
}

#[derive(Debug, Subcommand)]
enum ConfigCommand {
    /// Say what is wrong with the configuration, environment included.
    Check,
    /// Print a commented example with every key.
    Example,
}

#[derive(Debug, Subcommand)]
enum UsersCommand {
    /// List all users with their roles.
    List,
    /// Add or change a user; the password is read from standard input.
    Set {
        /// The name to sign in with.
        user: String,
        /// engineer, operator or viewer.
        #[arg(long, value_parser = role)]
        role: Role,
    },
    /// Remove a user.
    Remove {
        /// The name that the user signs in with.
        user: String,
    },
}

fn role(text: &str) -> Result<Role, String> {
    Role::from_name(text).ok_or_else(|| "a role is engineer, operator or viewer".to_owned())
}

/// Runs the command; prints what goes wrong with all its causes.
pub fn run(arguments: Arguments) -> ExitCode {
    let result = match arguments.command {
        Command::Config(ConfigCommand::Example) => print(EXAMPLE.trim_end()),
        Command::Config(ConfigCommand::Check) => {
            load(arguments.config.as_deref()).and_then(|_| print("The configuration is valid."))
        }
        Command::Notices => print(daemon::notices::NOTICES.trim_end()),
        command => {
            load(arguments.config.as_deref()).and_then(|config| run_command(command, config))
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => daemon::exit::after("factory-connector", error.as_ref()),
    }
}

fn run_command(command: Command, config: ConnectorConfig) -> anyhow::Result<()> {
    data_directory::tighten(&config.data_directory, config.allow_shared_data_directory)?;
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .context("starting the runtime")?;
    runtime.block_on(async {
        match command {
            Command::Run => serve(config).await,
            Command::Enrol { token_file, platform } => {
                let token = enrolment_token(token_file.as_deref())?;
                if let Some(note) = enrolment::unpinned_note(platform.as_deref(), &token)? {
                    print_note(note)?;
                }
                let factory = enrolment::enrol(&config, platform.as_deref(), &token).await?;
                print(&format!("This connector is now that of the factory {factory}."))
            }
            Command::Certificate(command) => certificate::run(command, &config).await,
            Command::Ledger(command) => ledger::run(command, &config).await,
            Command::Seal(command) => seal::run(command, &config).await,
            Command::Spool(command) => spool::run(command, &config).await,
            Command::Users(command) => manage_users(command, &config).await,
            Command::Config(_) | Command::Notices => Ok(()),
        }
    })
}

async fn serve(config: ConnectorConfig) -> anyhow::Result<()> {
    telemetry::install_logs(&config.log)?;
    daemon::descriptors::raise_limit();
    let lifecycle = Lifecycle::new();
    let handle = service::start(config, &lifecycle).await?;
    tracing::info!(
        factory.id = %handle.factory_id, web.address = %handle.web_address, twin.url = %handle.twin_url,
        "The connector is up."
    );
    lifecycle.run(DRAIN_TIMEOUT).await?;
    tracing::info!("The connector has stopped.");
    Ok(())
}

/// Returns the token of a file, or of standard input. Never of the arguments, which every user of the machine sees.
fn enrolment_token(file: Option<&Path>) -> anyhow::Result<Confidential<String>> {
    let text = match file {
        Some(path) => {
            let mut text = String::new();
            let file = std::fs::File::open(path);
            file.and_then(|file| file.take(INPUT_BYTES_MAX).read_to_string(&mut text))
                .with_context(|| format!("reading the token of {}", path.display()))?;
            text
        }
        None => {
            // A line: a person pastes it at a terminal.
            if std::io::stdin().is_terminal() {
                print_note("paste the token and press Enter")?;
            }
            let mut line = String::new();
            let input = std::io::stdin().lock().take(INPUT_BYTES_MAX).read_line(&mut line);
            input.context("reading the token of standard input")?;
            line
        }
    };
    let token = text.trim();
    anyhow::ensure!(!token.is_empty(), "there is no token in it");
    Ok(token.into())
}

/// Reads standard input up to a few kilobytes.
fn from_input() -> std::io::Result<String> {
    let mut text = String::new();
    std::io::stdin().take(INPUT_BYTES_MAX).read_to_string(&mut text)?;
    Ok(text)
}

async fn manage_users(command: UsersCommand, config: &ConnectorConfig) -> anyhow::Result<()> {
    let mut session = Store::connect(&config.data_directory).await?;
    match command {
        UsersCommand::List => {
            for user in session.users().all().await? {
                print(&format!("{}\t{}", user.user_name, user.role.name()))?;
            }
        }
        UsersCommand::Set { user, role } => {
            let password = from_input().context("reading the password")?;
            let password = Confidential::from(password.trim_end_matches(['\r', '\n']).to_owned());
            let hash = PasswordHashing::default().hash(password, PasswordPolicy::default()).await?;
            let user = User { user_name: user, role, password_hash: hash.as_str().to_owned() };
            session.users().put(&user, now()).await?;
            session.second_factors().remove(&user.user_name).await?;
            session.passkeys().remove_all(&user.user_name).await?;
        }
        UsersCommand::Remove { user } => {
            anyhow::ensure!(session.users().remove(&user).await?, "there is no user {user}");
        }
    }
    Ok(())
}

fn load(path: Option<&Path>) -> anyhow::Result<ConnectorConfig> {
    let mut config: ConnectorConfig = configuration::load(path, ENVIRONMENT)?;
    config.settings = configuration::shown(path, ENVIRONMENT, EXAMPLE)?;
    let faults = config.faults();
    if faults.is_empty() {
        return Ok(config);
    }
    anyhow::bail!("the configuration has {} fault(s):\n  {}", faults.len(), faults.join("\n  "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_taken_from_a_file_or_standard_input_alone() {
        let among_arguments =
            Arguments::try_parse_from(["factory-connector", "enrol", "https.secret"]);
        assert!(among_arguments.is_err(), "everybody on the machine would see it");
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("token");
        std::fs::write(&file, "a.token\n").expect("written");
        assert_eq!(enrolment_token(Some(&file)).expect("read").expose(), "a.token");
        std::fs::write(&file, "x".repeat(1 << 20)).expect("written");
        let read = enrolment_token(Some(&file)).expect("read").expose().len();
        assert!(read as u64 <= INPUT_BYTES_MAX, "{read} bytes");
        std::fs::write(&file, " \n").expect("written");
        assert!(enrolment_token(Some(&file)).is_err(), "nothing is no token");
    }
}
