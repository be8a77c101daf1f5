//! `factory-connector seal`.

use clap::Subcommand;
use daemon::sealing;
use factory_connector::{
    config::ConnectorConfig,
    store::{SecretHolder, Store},
};

use super::output::print;

#[derive(Debug, Subcommand)]
pub(super) enum SealCommand {
    /// Make a new key and seal all secrets with it; the connector may run.
    Rotate,
    /// Print a new key, as a line of a key's file or of a credential.
    NewKey,
    /// Remove the secrets that no key opens, so that the connector starts without them.
    Forget,
}

pub(super) async fn run(command: SealCommand, config: &ConnectorConfig) -> anyhow::Result<()> {
    if let SealCommand::NewKey = command {
        return print(sealing::new_key()?.expose());
    }
    let sealer = config.sealer();
    let mut session = Store::connect(&config.data_directory).await?;
    if let SealCommand::Rotate = command {
        let count = sealing::rotate(&mut session, &sealer).await?;
        let path = sealer.place().path().display();
        return print(&format!("{count} secret(s) are sealed with a new key, which is in {path}."));
    }
    let forgotten = sealing::forget(&mut session, &sealer).await?;
    if forgotten.is_empty() {
        return print("Every secret opens; nothing was removed.");
    }
    for holder in forgotten {
        print(&match holder {
            SecretHolder::Broker => {
                "Removed the password at the platform's broker: enrol again.".to_owned()
            }
            SecretHolder::Source(id) => {
                format!("Removed the password of the source {id}: give it again on its page.")
            }
            SecretHolder::SecondFactor(user) => format!(
                "Removed the secret of {user}'s second factor: an engineer removes the rest, or a recovery code \
                 signs in."
            ),
        })?;
    }
    Ok(())
}
