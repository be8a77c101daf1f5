//! Renewal of the own certificate while the twin runs.

use std::time::{Duration, SystemTime};

use asi_model::DateTime;
use opcua_stack::opcua::server::ServerHandle;
use tokio_util::sync::CancellationToken;

use super::certificate;
use crate::{config::TwinConfig, error::TwinError};

/// The clock may be set, so the certificate is looked at every now and then.
const LOOK_AGAIN: Duration = Duration::from_secs(3600);
/// The shortest pause between two looks.
const PAUSE_MIN: Duration = Duration::from_secs(1);

/// Renews the certificate before it expires. Connections that are open keep the one they began with.
pub(crate) struct Renewal {
    pub config: TwinConfig,
    pub application_uri: String,
    pub handle: ServerHandle,
}

impl Renewal {
    /// Goes on until `shutdown`.
    pub async fn run(self, shutdown: &CancellationToken) {
        let mut pause = self.next_look();
        loop {
            tokio::select! {
                () = tokio::time::sleep(pause) => {}
                () = shutdown.cancelled() => return,
            }
            pause = match self.renew().await {
                Ok(true) => {
                    tracing::info!("The twin uses its new certificate from the next connection on.");
                    self.next_look()
                }
                // Not due yet, or not ours to renew.
                Ok(false) => self.next_look().max(Duration::from_secs(60)),
                Err(error) => {
                    tracing::error!(
                        error = &error as &dyn std::error::Error,
                        "The twin could not renew its certificate. Clients turn it away once the old one has expired."
                    );
                    LOOK_AGAIN
                }
            };
        }
    }

    fn next_look(&self) -> Duration {
        certificate::due_in(&self.config, now()).clamp(PAUSE_MIN, LOOK_AGAIN)
    }

    /// Making a key takes a second of computing.
    async fn renew(&self) -> Result<bool, TwinError> {
        let (config, application_uri) = (self.config.clone(), self.application_uri.clone());
        let renewed = tokio::task::spawn_blocking(move || {
            let is_new = certificate::ensure(&config, &application_uri, now())?;
            is_new.then(|| certificate::load(&config)).transpose()
        });
        let renewed = renewed.await.map_err(|error| TwinError::Certificate { reason: error.to_string() })??;
        let is_new = renewed.is_some();
        if let Some(identity) = renewed {
            self.handle.set_identity(identity);
        }
        Ok(is_new)
    }
}

fn now() -> DateTime {
    DateTime::from(SystemTime::now())
}
