//! `platform seal`.

use std::io::BufRead as _;

use anyhow::Context as _;
use clap::Subcommand;
use daemon::{
    Confidential, data_directory,
    sealing::{self, Sealer},
};
use platform::{
    audit::{MachineUser, RecordingStore},
    clock::Clock,
    config::{BROKER_PASSWORD_CHARACTERS_MIN, PlatformConfig, sealed_line},
    store::{AuditOutcome, AuditSubject, Store},
};
use zeroize::Zeroizing;

use super::output::print;

#[derive(Debug, Subcommand)]
pub(super) enum SealCommand {
    /// Make a new key and seal all secrets with it; the platform may run.
    Rotate,
    /// Print a new key, as a line of a key's file or of a credential.
    NewKey,
    /// Seal a password at a broker of another make, one line of standard input, and print the line that
    /// `broker.external.password_file` then has for its account.
    Password {
        /// Name of the account, as `factory.FOR_MUC`.
        user_name: String,
    },
    /// Remove the secrets that no key opens, so that the platform starts without them.
    Forget,
}

pub(super) async fn run(command: SealCommand, config: &PlatformConfig) -> anyhow::Result<()> {
    if let SealCommand::NewKey = command {
        return print(sealing::new_key()?.expose());
    }
    let sealer = config.sealer();
    if let SealCommand::Password { user_name } = command {
        return print(&sealed_password(&user_name, &sealer)?);
    }
    data_directory::create(&config.data_directory, config.allow_shared_data_directory)?;
    let mut store = Store::open(&config.database_path()).await?;
    if let SealCommand::Rotate = command {
        // Before the act, which has transactions of its own: what was tried is on record, however it ends.
        record_rotation(&RecordingStore::new(store.clone(), Clock::system())).await?;
        // Before and after, as the secrets of the database: a new key pushes out the one before the last.
        seal_file(config, &sealer)?;
        let stored = sealing::rotate(&mut store, &sealer).await?;
        let count = stored + seal_file(config, &sealer)?;
        let path = sealer.place().path().display();
        return print(&format!("{count} secret(s) are sealed with a new key, which is in {path}."));
    }
    let forgotten = sealing::forget(&mut store, &sealer).await?;
    if forgotten.is_empty() {
        return print("Every secret opens; nothing was removed.");
    }
    for user in forgotten {
        print(&format!(
            "Removed the secret of {user}'s second factor: an administrator removes the rest, or a recovery code \
             signs in."
        ))?;
    }
    Ok(())
}

async fn record_rotation(store: &RecordingStore) -> anyhow::Result<()> {
    let work = store.begin(MachineUser::of_process(), "rotateSealingKey").await?;
    Ok(work.commit(AuditSubject::shared("sealing-key"), AuditOutcome::Done).await?)
}

fn seal_file(config: &PlatformConfig, sealer: &Sealer) -> anyhow::Result<usize> {
    let external = config.broker.external.as_ref();
    Ok(external.map_or(Ok(0), |external| external.seal_passwords(sealer))?)
}

fn sealed_password(user_name: &str, sealer: &Sealer) -> anyhow::Result<String> {
    // With a key made here the running platform, which may have another, opens nothing.
    let key = sealer.place().path();
    anyhow::ensure!(
        key.exists(),
        "there is no sealing key {}: start the platform once, or give this command the credential that the service has",
        key.display()
    );
    let is_name = !user_name.is_empty()
        && !user_name.starts_with('#')
        && !user_name.contains(char::is_whitespace);
    anyhow::ensure!(is_name, "the name of an account has no spaces and does not begin with #");
    let mut line = Zeroizing::new(String::new());
    let read = std::io::stdin().lock().read_line(&mut line);
    read.context("reading the password from standard input")?;
    let password: Confidential<String> = line.trim().into();
    anyhow::ensure!(
        password.expose().len() >= BROKER_PASSWORD_CHARACTERS_MIN,
        "the password on standard input needs at least {BROKER_PASSWORD_CHARACTERS_MIN} characters"
    );
    Ok(sealed_line(user_name, &password, sealer)?)
}
