//! The own certificate while the twin runs: renewed before it expires, and replaced where somebody
//! put another one in its place.

use std::{
    fs,
    sync::Arc,
    time::{Duration, SystemTime},
};

use asi_model::DateTime;
use opcua_stack::opcua::server::{ServerHandle, ServerIdentity};
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

use super::certificate;
use crate::{config::TwinConfig, error::TwinError, events::EventReporter};

/// The clock may be set, so the certificate is looked at every now and then.
const LOOK_AGAIN: Duration = Duration::from_secs(3600);
/// The shortest pause between two looks.
const PAUSE_MIN: Duration = Duration::from_secs(1);
/// How often somebody has to be told that a certificate is due which the twin cannot renew.
const REMIND: Duration = Duration::from_secs(24 * 3600);
/// How often the file is compared with what is in use.
const COMPARE: Duration = Duration::from_secs(1);

/// Keeps the certificate good. Connections that are open keep the one they began with.
pub(crate) struct Renewal {
    pub config: TwinConfig,
    pub application_uri: String,
    pub handle: ServerHandle,
    pub events: Arc<EventReporter>,
}

impl Renewal {
    /// Goes on until `shutdown`.
    pub async fn run(self, shutdown: &CancellationToken) {
        let mut due = Instant::now() + self.next_look();
        let mut seen = self.in_use();
        let mut complained_of = Vec::new();
        loop {
            tokio::select! {
                () = tokio::time::sleep(COMPARE) => {}
                () = shutdown.cancelled() => return,
            }
            let file = fs::read(self.config.pki_directory.join(certificate::CERTIFICATE_FILE))
                .unwrap_or_default();
            if file != seen {
                if self.replace().await {
                    seen = file;
                    due = Instant::now() + self.next_look();
                } else if complained_of != file {
                    // The other half of a new pair may still be to come.
                    tracing::warn!(
                        "The certificate that was put in the place of the twin's cannot be read or does not fit its \
                         key; the twin goes on with the one it has."
                    );
                    complained_of = file;
                }
                continue;
            }
            if Instant::now() < due {
                continue;
            }
            let pause = match self.renew().await {
                Ok(true) => {
                    seen = self.in_use();
                    self.next_look()
                }
                // Not due yet, or not ours to renew.
                Ok(false) if self.next_look() <= PAUSE_MIN => REMIND,
                Ok(false) => self.next_look(),
                Err(error) => {
                    tracing::error!(
                        error = &error as &dyn std::error::Error,
                        "The twin could not renew its certificate. Clients turn it away once the old one has expired."
                    );
                    LOOK_AGAIN
                }
            };
            due = Instant::now() + pause;
        }
    }

    fn next_look(&self) -> Duration {
        certificate::due_in(&self.config, now()).clamp(PAUSE_MIN, LOOK_AGAIN)
    }

    /// The certificate that new connections see, as DER.
    fn in_use(&self) -> Vec<u8> {
        let identity = self.handle.info().identity.load();
        identity
            .certificate
            .as_ref()
            .map(|certificate| certificate.as_byte_string().as_ref().to_vec())
            .unwrap_or_default()
    }

    /// Uses the pair that somebody put there. False where it is none yet.
    async fn replace(&self) -> bool {
        let config = self.config.clone();
        let loaded = tokio::task::spawn_blocking(move || certificate::load(&config)).await;
        match loaded {
            Ok(Ok(Some(identity))) => {
                self.take(identity);
                true
            }
            _ => false,
        }
    }

    fn take(&self, identity: ServerIdentity) {
        if let Some(certificate) = &identity.certificate {
            self.events.report_own_certificate(certificate);
        }
        self.handle.set_identity(identity);
        tracing::info!("The twin uses its new certificate from the next connection on.");
    }

    /// Making a key takes a second of computing.
    async fn renew(&self) -> Result<bool, TwinError> {
        let (config, application_uri) = (self.config.clone(), self.application_uri.clone());
        let renewed = tokio::task::spawn_blocking(move || {
            let is_new = certificate::ensure(&config, &application_uri, now())?;
            Ok::<_, TwinError>(if is_new { certificate::load(&config)? } else { None })
        });
        let renewed = renewed
            .await
            .map_err(|error| TwinError::Certificate { reason: error.to_string() })??;
        let is_new = renewed.is_some();
        if let Some(identity) = renewed {
            self.take(identity);
        }
        Ok(is_new)
    }
}

fn now() -> DateTime {
    DateTime::from(SystemTime::now())
}
