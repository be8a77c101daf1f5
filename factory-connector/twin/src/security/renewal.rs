//! Certificate of a running twin: renewed before it expires, and reloaded when the files change.

use std::{fs, sync::Arc, time::Duration};

use opcua_stack::opcua::server::{ServerHandle, ServerIdentity};
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

use super::certificate;
use crate::{clock::now, config::TwinConfig, error::TwinError, events::EventReporter};

/// Longest pause between two checks: the clock may be set meanwhile.
const CHECK_MAX: Duration = Duration::from_secs(3600);
/// Shortest pause between two checks.
const CHECK_MIN: Duration = Duration::from_secs(1);
/// Interval of the reminder that a certificate is due which the twin cannot renew.
const REMINDER: Duration = Duration::from_secs(24 * 3600);
/// Interval at which the file is compared with the certificate in use.
const COMPARISON: Duration = Duration::from_secs(1);

/// Renews and reloads the certificate. Open connections stay with the one they started with.
pub(crate) struct Renewal {
    pub config: TwinConfig,
    pub application_uri: String,
    pub handle: ServerHandle,
    pub events: Arc<EventReporter>,
}

impl Renewal {
    /// Runs until `shutdown`.
    pub async fn run(self, shutdown: &CancellationToken) {
        let mut due = Instant::now() + self.next_check();
        let mut in_use = self.certificate_in_use();
        let mut reported = Vec::new();
        loop {
            tokio::select! {
                () = tokio::time::sleep(COMPARISON) => {}
                () = shutdown.cancelled() => return,
            }
            let file = fs::read(self.config.pki_directory.join(certificate::CERTIFICATE_FILE))
                .unwrap_or_default();
            if file != in_use {
                if self.reload().await {
                    in_use = file;
                    due = Instant::now() + self.next_check();
                } else if reported != file {
                    // The key of a new pair may not be written yet.
                    tracing::warn!(
                        "The new certificate file of the twin cannot be read or does not match the key; the twin \
                         continues with the certificate that it has."
                    );
                    reported = file;
                }
                continue;
            }
            if Instant::now() < due {
                continue;
            }
            let pause = match self.renew().await {
                Ok(true) => {
                    in_use = self.certificate_in_use();
                    self.next_check()
                }
                // Not due yet, or issued by an authority, which the twin cannot renew.
                Ok(false) if self.next_check() <= CHECK_MIN => REMINDER,
                Ok(false) => self.next_check(),
                Err(error) => {
                    tracing::error!(
                        error = &error as &dyn std::error::Error,
                        "The twin could not renew its certificate. Clients reject it once the old one has expired."
                    );
                    CHECK_MAX
                }
            };
            due = Instant::now() + pause;
        }
    }

    fn next_check(&self) -> Duration {
        certificate::due_in(&self.config, now()).clamp(CHECK_MIN, CHECK_MAX)
    }

    /// Returns the certificate of new connections, as DER.
    fn certificate_in_use(&self) -> Vec<u8> {
        let identity = self.handle.info().identity.load();
        identity
            .certificate
            .as_ref()
            .map(|certificate| certificate.as_byte_string().as_ref().to_vec())
            .unwrap_or_default()
    }

    /// Loads the pair from the files. False while it does not match.
    async fn reload(&self) -> bool {
        let config = self.config.clone();
        let loaded = tokio::task::spawn_blocking(move || certificate::load(&config)).await;
        match loaded {
            Ok(Ok(Some(identity))) => {
                self.install(identity);
                true
            }
            _ => false,
        }
    }

    fn install(&self, identity: ServerIdentity) {
        if let Some(certificate) = &identity.certificate {
            self.events.report_application_certificate(certificate);
        }
        self.handle.set_identity(identity);
        tracing::info!("The twin uses its new certificate from the next connection on.");
    }

    /// Renews the certificate if it is due, in a blocking task: a key takes about a second to
    /// generate. True when there is a new one.
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
            self.install(identity);
        }
        Ok(is_new)
    }
}
