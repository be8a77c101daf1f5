//! `platform seal`.

use clap::Subcommand;
use daemon::{data_directory, sealing};
use platform::{
    audit::{MachineUser, RecordingStore},
    clock::Clock,
    config::PlatformConfig,
    store::{AuditOutcome, AuditSubject, Store},
};

use super::output::print;

#[derive(Debug, Subcommand)]
pub(super) enum SealCommand {
    /// Make a new key and seal all secrets with it; the platform may run.
    Rotate,
    /// Print a new key, as a line of a key's file or of a credential.
    NewKey,
    /// Remove the secrets that no key opens, so that the platform starts without them.
    Forget,
}

pub(super) async fn run(command: SealCommand, config: &PlatformConfig) -> anyhow::Result<()> {
    if let SealCommand::NewKey = command {
        return print(sealing::new_key()?.expose());
    }
    let sealer = config.sealer();
    data_directory::create(&config.data_directory, config.allow_shared_data_directory)?;
    let mut store = Store::open(&config.database_path()).await?;
    if let SealCommand::Rotate = command {
        // Before the act, which has transactions of its own: what was tried is on record, however it ends.
        record_rotation(&RecordingStore::new(store.clone(), Clock::system())).await?;
        let count = sealing::rotate(&mut store, &sealer).await?;
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
