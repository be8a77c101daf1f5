//! Review of open sessions: a client whose certificate lost its trust does not stay.

use std::{sync::Arc, time::Duration};

use opcua_stack::opcua::{crypto::X509, server::ServerHandle};
use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;

use super::validation::Validator;
use crate::{certificate_error::CertificateError, events::EventReporter};

/// Time between two reviews without a change through the trust list: files may be copied by hand.
const INTERVAL: Duration = Duration::from_secs(60);
/// Message of the audit event.
const ENDED: &str = "A session was ended, for its client's certificate is no longer trusted.";

/// Task that checks the certificates of all sessions again after each change of the trust list (OPC 10000-12 §7.8.2).
pub(crate) struct SessionReview {
    pub server: ServerHandle,
    pub validator: Arc<Validator>,
    pub events: Arc<EventReporter>,
    /// Notified of changes of the trust list.
    pub changed: Arc<Notify>,
}

impl SessionReview {
    /// Runs until `shutdown`.
    pub async fn run(self, shutdown: &CancellationToken) {
        loop {
            tokio::select! {
                () = tokio::time::sleep(INTERVAL) => {}
                () = self.changed.notified() => {}
                () = shutdown.cancelled() => return,
            }
            self.review().await;
        }
    }

    async fn review(&self) {
        let (certificates, validator) =
            (self.server.session_certificates(), Arc::clone(&self.validator));
        let lost = tokio::task::spawn_blocking(move || {
            let has_lost = |certificate: &X509| {
                let checked = validator.check(certificate.as_byte_string().as_ref());
                checked.is_err_and(is_loss_of_trust)
            };
            certificates.into_iter().filter(has_lost).collect::<Vec<_>>()
        });
        match lost.await {
            Ok(lost) => self.end(&lost).await,
            Err(error) => tracing::error!(
                error = &error as &dyn std::error::Error,
                "The certificates of the twin's sessions could not be checked; the sessions go on for the time being."
            ),
        }
    }

    async fn end(&self, lost: &[X509]) {
        for certificate in lost {
            let der = certificate.as_byte_string();
            let is_meant = |of_session: &X509| of_session.as_byte_string() == der;
            let ended = self.server.close_sessions_of_certificates(is_meant).await;
            tracing::warn!(
                certificate.subject = certificate.subject_name(),
                certificate.thumbprint = certificate.thumbprint().as_hex_string(),
                sessions = ended.len(),
                "OPC UA sessions were ended, for the certificate of their client is no longer trusted."
            );
            for (session_id, user_token) in ended {
                self.events.report_terminated(session_id, user_token, ENDED);
            }
        }
    }
}

/// Returns whether an open session has to end at once. What only is not known, as without a current revocation list,
/// ends the connection when its channel is to be renewed.
const fn is_loss_of_trust(error: CertificateError) -> bool {
    match error {
        CertificateError::Denied
        | CertificateError::Waiting
        | CertificateError::Unknown
        | CertificateError::Revoked => true,
        CertificateError::Unreadable
        | CertificateError::OutOfTime
        | CertificateError::KeyLength
        | CertificateError::Usage
        | CertificateError::RevocationUnknown
        | CertificateError::TrustListUnreadable => false,
    }
}
