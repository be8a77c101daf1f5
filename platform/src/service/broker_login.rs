//! The link's login at a broker of another make, kept in line with the file of passwords.

use std::{convert::Infallible, time::Duration};

use daemon::Confidential;
use messaging::{LinkHandle, Login};
use tokio_util::sync::CancellationToken;

use crate::config::{BrokerPasswordError, ExternalBrokerConfig};

/// Time between two reads of the file, which an administrator changes.
const READ_INTERVAL: Duration = Duration::from_secs(5);

/// Task that gives the link the platform's present password.
pub(super) struct BrokerLogin {
    external: ExternalBrokerConfig,
    link: LinkHandle,
    /// Password that the link has.
    known: Option<Confidential<String>>,
}

impl BrokerLogin {
    /// Makes the task of a link that was opened just now.
    pub(super) fn new(external: ExternalBrokerConfig, link: LinkHandle) -> Self {
        let known = external.password_of(&external.user_name).ok();
        Self { external, link, known }
    }

    /// Compares the file until shutdown.
    pub(super) async fn run(mut self, shutdown: CancellationToken) -> Result<(), Infallible> {
        while shutdown.run_until_cancelled(tokio::time::sleep(READ_INTERVAL)).await.is_some() {
            let external = self.external.clone();
            // A file may be on a disk that does not answer.
            let read =
                tokio::task::spawn_blocking(move || external.password_of(&external.user_name));
            if let Ok(read) = read.await {
                self.compare(read);
            }
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
