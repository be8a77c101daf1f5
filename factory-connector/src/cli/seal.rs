//! `factory-connector seal`.

use clap::Subcommand;
use factory_connector::{
    config::ConnectorConfig,
    passwords,
    store::{PasswordHolder, Store},
};

use super::output::print;

#[derive(Debug, Subcommand)]
pub(super) enum SealCommand {
    /// Make a new key and seal all passwords with it; the connector may run.
    Rotate,
    /// Print a new key, as a line of a key's file or of a credential.
    NewKey,
    /// Remove the passwords that no key opens, so that the connector starts without them.
    Forget,
}

pub(super) async fn run(command: SealCommand, config: &ConnectorConfig) -> anyhow::Result<()> {
    if let SealCommand::NewKey = command {
        return print(daemon::sealing::new_key()?.expose());
    }
    let sealer = config.sealer();
    let mut session = Store::connect(&config.data_directory).await?;
    if let SealCommand::Rotate = command {
        let count = passwords::rotate(&mut session, &sealer).await?;
        let path = sealer.place().path().display();
        return print(&format!(
            "{count} password(s) are sealed with a new key, which is in {path}."
        ));
    }
    let forgotten = passwords::forget(&mut session, &sealer).await?;
    if forgotten.is_empty() {
        return print("Every password opens; nothing was removed.");
    }
    for holder in forgotten {
        print(&match holder {
            PasswordHolder::Broker => {
                "Removed the password at the platform's broker: enrol again.".to_owned()
            }
            PasswordHolder::Source(id) => {
                format!("Removed the password of the source {id}: give it again on its page.")
            }
        })?;
    }
    Ok(())
}
