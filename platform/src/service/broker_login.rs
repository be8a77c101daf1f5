//! The link's login at a broker of another make, kept in line with the file of passwords, and that file sealed.

use std::{convert::Infallible, time::Duration};

use daemon::{Confidential, sealing::Sealer};
use messaging::{LinkHandle, Login};
use tokio_util::sync::CancellationToken;

use crate::config::{BrokerPasswordError, ExternalBrokerConfig, PasswordSealing};

/// Time between two reads of the file, which an administrator changes.
const READ_INTERVAL: Duration = Duration::from_secs(5);

/// Task that gives the link the platform's present password, and seals the file once it has been changed.
pub(super) struct BrokerLogin {
    external: ExternalBrokerConfig,
    sealer: Sealer,
    link: LinkHandle,
    /// Password that the link has.
    known: Option<Confidential<String>>,
}

impl BrokerLogin {
    /// Makes the task of a link that was opened just now.
    pub(super) fn new(external: ExternalBrokerConfig, sealer: Sealer, link: LinkHandle) -> Self {
        let known = external.password_of(&external.user_name, &sealer).ok();
        Self { external, sealer, link, known }
    }

    /// Compares and seals the file until shutdown.
    pub(super) async fn run(mut self, shutdown: CancellationToken) -> Result<(), Infallible> {
        let mut sealing = PasswordSealing::new(self.external.clone(), self.sealer.clone());
        while shutdown.run_until_cancelled(tokio::time::sleep(READ_INTERVAL)).await.is_some() {
            let (external, sealer) = (self.external.clone(), self.sealer.clone());
            // A file may be on a disk that does not answer.
            let read = tokio::task::spawn_blocking(move || {
                log_sealing(sealing.look());
                (sealing, external.password_of(&external.user_name, &sealer))
            });
            // Nothing in it panics, and only a shutdown ends it.
            let Ok((looked, password)) = read.await else { break };
            sealing = looked;
            self.compare(password);
        }
        Ok(())
    }

    fn compare(&mut self, read: Result<Confidential<String>, BrokerPasswordError>) {
        match read {
            Ok(password) if self.known.as_ref() != Some(&password) => {
                self.link.set_login(Login::new(&self.external.user_name, password.expose()));
                self.known = Some(password);
                tracing::info!("The password at the broker was read again.");
            }
            Ok(_) => {}
            Err(error) => {
                tracing::warn!(
                    error = &error as &dyn std::error::Error,
                    "The password at the broker cannot be read; the link goes on with the one it has."
                );
            }
        }
    }
}

/// Seals the file at the start, as the secrets of the database. A file that cannot be sealed is used all the same.
pub(super) fn seal_at_start(external: &ExternalBrokerConfig, sealer: &Sealer) {
    log_sealing(external.seal_passwords(sealer));
}

fn log_sealing(sealed: Result<usize, BrokerPasswordError>) {
    match sealed {
        Ok(0) => {}
        Ok(count) => {
            tracing::info!(
                passwords.count = count,
                "Passwords in broker.external.password_file were sealed."
            );
        }
        Err(error) => {
            tracing::warn!(
                error = &error as &dyn std::error::Error,
                "Passwords in broker.external.password_file are NOT SEALED."
            );
        }
    }
}
