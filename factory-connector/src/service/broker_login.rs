//! The link's login, kept in line with the store: an enrolment beside the running connector changes it.

use std::time::Duration;

use daemon::sealing::Sealer;
use messaging::{LinkHandle, Login};
use tokio_util::sync::CancellationToken;

use crate::{
    passwords,
    store::{Enrolment, Readers},
};

/// Time between two reads of the enrolment, which the command line changes.
const READ_INTERVAL: Duration = Duration::from_secs(5);

/// Task that gives the link the login of the newest enrolment.
pub(super) struct BrokerLogin {
    readers: Readers,
    sealer: Sealer,
    link: LinkHandle,
    /// Enrolment that the link was opened with.
    known: Enrolment,
}

impl BrokerLogin {
    /// Makes the task of a link that was opened with this enrolment.
    pub(super) fn new(
        readers: Readers,
        sealer: Sealer,
        link: &LinkHandle,
        known: &Enrolment,
    ) -> Self {
        Self { readers, sealer, link: link.clone(), known: known.clone() }
    }

    /// Compares the enrolment until shutdown.
    pub(super) async fn run(mut self, shutdown: CancellationToken) {
        while shutdown.run_until_cancelled(tokio::time::sleep(READ_INTERVAL)).await.is_some() {
            if let Err(error) = self.compare().await {
                tracing::warn!(
                    error = &*error as &dyn std::error::Error,
                    "It is not known whether this connector was enrolled again; the link goes on with the login it has."
                );
            }
        }
    }

    async fn compare(&mut self) -> anyhow::Result<()> {
        let current = self.readers.session().await?.enrolments().current().await?;
        let Some(current) = current.filter(|current| *current != self.known) else { return Ok(()) };
        let was_enrolled = (&current.user_name, &current.broker_url, &current.profile)
            != (&self.known.user_name, &self.known.broker_url, &self.known.profile);
        if was_enrolled {
            tracing::warn!(
                broker.url = current.broker_url,
                "The enrolment names another broker, profile or user: start the connector again to use them."
            );
        } else {
            let password = passwords::of_broker(&self.sealer, &current)?;
            self.link.set_login(Login::new(&current.user_name, password.expose()));
            tracing::info!("The password at the platform's broker was read again.");
        }
        self.known = current;
        Ok(())
    }
}
