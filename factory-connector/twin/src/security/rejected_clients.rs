//! Last rejected connection attempt per untrusted certificate.
//!
//! One small file per certificate. Any client may try to connect, so attempts are recorded only for
//! certificates of the trust list, and at most once a second for each.

use std::{
    fs, io,
    net::IpAddr,
    path::{Path, PathBuf},
    time::Duration,
};

use asi_model::DateTime;
use opcua_stack::opcua::{crypto::X509, server::CertificateBearer};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use super::certificate_files::replace;
use crate::certificate_error::CertificateError;

/// The folder within that of the trust list. Its name on disk is older than the words used here.
pub(crate) const FOLDER: &str = "knocks";
/// Shortest time between two recorded attempts with one certificate. A client that retries in a
/// loop must not write a file each time.
const PAUSE: Duration = Duration::from_secs(1);
/// Longest name of an application that is stored, in characters. Any client may send any text.
const NAME_CHARS_MAX: usize = 128;
/// Longest file read, in bytes.
const FILE_BYTES_MAX: u64 = 16 * 1024;

/// Cause for which a certificate was rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum RejectionReason {
    /// Never approved, or the approval was withdrawn.
    NotTrusted,
    /// The certificate is not valid at this time.
    OutOfTime,
    /// The certificate may not be used for signing.
    Usage,
    /// Its key is too short or too long for the security policy.
    KeyLength,
    /// The certificate cannot be read.
    Unreadable,
    /// Its issuer revoked it.
    Revoked,
    /// The issuer has no current revocation list.
    RevocationUnknown,
    /// A file of the trust list cannot be read.
    TrustListUnreadable,
}

impl From<CertificateError> for RejectionReason {
    fn from(error: CertificateError) -> Self {
        match error {
            CertificateError::Unreadable => Self::Unreadable,
            CertificateError::Denied | CertificateError::Waiting | CertificateError::Unknown => {
                Self::NotTrusted
            }
            CertificateError::OutOfTime => Self::OutOfTime,
            CertificateError::KeyLength => Self::KeyLength,
            CertificateError::Usage => Self::Usage,
            CertificateError::Revoked => Self::Revoked,
            CertificateError::RevocationUnknown => Self::RevocationUnknown,
            CertificateError::TrustListUnreadable => Self::TrustListUnreadable,
        }
    }
}

/// A rejected connection attempt.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ConnectionRejection {
    /// Time of the last attempt.
    pub rejected_at: DateTime,
    pub reason: RejectionReason,
    /// Address of the client; none for a discovery server that the twin called.
    pub address: Option<IpAddr>,
    /// Name of the application as it claims.
    pub application_name: Option<String>,
}

impl ConnectionRejection {
    pub(crate) fn new(
        rejected_at: DateTime,
        reason: RejectionReason,
        bearer: &CertificateBearer<'_>,
    ) -> Self {
        let name: String = bearer
            .application
            .application_name
            .text
            .as_ref()
            .chars()
            .filter(|letter| !letter.is_control())
            .take(NAME_CHARS_MAX)
            .collect();
        Self {
            rejected_at,
            reason,
            address: bearer.address.map(|address| address.ip().to_canonical()),
            application_name: Some(name).filter(|name| !name.is_empty()),
        }
    }
}

/// Store of the last rejected attempt with each certificate.
#[derive(Debug, Clone)]
pub(crate) struct RejectedClients {
    folder: PathBuf,
}

impl RejectedClients {
    /// Creates the store in the folder of certificates.
    pub fn new(pki_directory: &Path) -> Self {
        Self { folder: pki_directory.join(FOLDER) }
    }

    /// Records an attempt. Errors of the disk are logged, and the attempt is lost.
    pub fn record(&self, certificate: &X509, rejection: &ConnectionRejection) {
        let thumbprint = thumbprint(certificate);
        let is_due = self.last(&thumbprint).is_none_or(|last| {
            last.rejected_at > rejection.rejected_at
                || last.rejected_at.after(PAUSE) <= rejection.rejected_at
        });
        if is_due && let Err(error) = self.write(&thumbprint, rejection) {
            tracing::warn!(
                error = &error as &dyn std::error::Error,
                certificate.thumbprint = thumbprint,
                "A rejected connection attempt could not be recorded."
            );
        }
    }

    /// Returns the last rejected attempt with the certificate of this thumbprint.
    pub fn last(&self, thumbprint: &str) -> Option<ConnectionRejection> {
        let path = self.path(thumbprint);
        let is_small = fs::metadata(&path).is_ok_and(|metadata| metadata.len() <= FILE_BYTES_MAX);
        is_small
            .then(|| fs::read(&path).ok())
            .flatten()
            .and_then(|bytes| serde_json::from_slice(&bytes).ok())
    }

    /// Removes the record of a certificate that is trusted now or was removed.
    pub fn forget(&self, thumbprint: &str) {
        match fs::remove_file(self.path(thumbprint)) {
            Ok(()) => {}
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => {
                tracing::warn!(%error, certificate.thumbprint = thumbprint, "The record of a rejected certificate could not be removed.")
            }
        }
    }

    fn write(
        &self,
        thumbprint: &str,
        rejection: &ConnectionRejection,
    ) -> Result<(), crate::TwinError> {
        let bytes = serde_json::to_vec(rejection).expect("a rejection has text keys only");
        replace(&self.path(thumbprint), &bytes)
    }

    fn path(&self, thumbprint: &str) -> PathBuf {
        self.folder.join(format!("{}.json", thumbprint.to_ascii_lowercase()))
    }
}

/// Returns SHA-1 over a certificate in lower-case hexadecimal digits.
pub(crate) fn thumbprint(certificate: &X509) -> String {
    certificate.thumbprint().as_hex_string().to_ascii_lowercase()
}

/// Returns SHA-256 over a certificate in lower-case hexadecimal digits, for people to compare. Thumbprints are SHA-1, of
/// which two certificates with the same can be made.
pub(crate) fn fingerprint(certificate: &X509) -> String {
    hex::encode(Sha256::digest(certificate.as_byte_string().as_ref()))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]
mod tests {
    use opcua_stack::opcua::types::{ApplicationDescription, LocalizedText};

    use super::*;

    fn certificate() -> X509 {
        let key = rcgen::KeyPair::generate().unwrap();
        X509::from_der(rcgen::CertificateParams::default().self_signed(&key).unwrap().der())
            .unwrap()
    }

    #[test]
    fn the_last_attempt_is_stored_with_address_and_name() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join(FOLDER)).unwrap();
        let (rejected, certificate) = (RejectedClients::new(folder.path()), certificate());
        let application = ApplicationDescription {
            application_name: LocalizedText::new("", &format!("Plan\u{1b}ner{}", "r".repeat(500))),
            ..ApplicationDescription::default()
        };
        let address = Some("[::ffff:10.0.0.7]:4321".parse().unwrap());
        let at = |micros| {
            let bearer = CertificateBearer { address, application: &application };
            ConnectionRejection::new(
                DateTime::from_unix_micros(micros),
                RejectionReason::NotTrusted,
                &bearer,
            )
        };
        let thumbprint = thumbprint(&certificate);
        assert_eq!(rejected.last(&thumbprint), None);
        rejected.record(&certificate, &at(5_000_000));
        let last = rejected.last(&thumbprint.to_ascii_uppercase()).unwrap();
        assert_eq!(last.address, Some("10.0.0.7".parse().unwrap()));
        let name = last.application_name.clone().unwrap();
        assert!(name.starts_with("Planner") && name.len() == NAME_CHARS_MAX, "{name}");

        // Attempts within a second count as one. A clock that was set back is trusted.
        for (micros, expected) in
            [(5_900_000, 5_000_000), (6_000_000, 6_000_000), (1_000_000, 1_000_000)]
        {
            rejected.record(&certificate, &at(micros));
            assert_eq!(rejected.last(&thumbprint), Some(at(expected)));
        }
        rejected.forget(&thumbprint);
        assert_eq!(rejected.last(&thumbprint), None);
        rejected.forget(&thumbprint);
    }
}
