//! Who knocked last with a certificate that opens no door, as far as that is known.
//!
//! One small file per certificate. Anybody may knock, so only certificates that lie in a folder of
//! the trust list are remembered, and each at most once a second.

use std::{
    fs, io,
    net::IpAddr,
    path::{Path, PathBuf},
    time::Duration,
};

use asi_model::DateTime;
use opcua_stack::opcua::{crypto::X509, server::CertificateBearer};
use serde::{Deserialize, Serialize};

use super::replace;

/// The folder within that of the trust list.
pub(crate) const FOLDER: &str = "knocks";
/// Knocks of one certificate closer together than this are one.
const PAUSE: Duration = Duration::from_secs(1);
/// Longest name of an application that is kept, in characters.
const NAME_CHARS_MAX: usize = 128;
/// Longest file read, in bytes.
const FILE_BYTES_MAX: u64 = 16 * 1024;

/// Why a certificate was turned away.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum RejectionReason {
    /// Nobody has approved it, or somebody took the approval back.
    NotTrusted,
    /// It is not valid at this time.
    OutOfTime,
    /// It may not be used for signing.
    Usage,
    /// Its key is too short or too long for the security policy.
    KeyLength,
    /// It cannot be read.
    Unreadable,
    /// Its issuer revoked it.
    Revoked,
    /// There is no current revocation list of its issuer.
    RevocationUnknown,
}

/// A certificate was turned away.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Rejection {
    /// When, the last time.
    pub rejected_at: DateTime,
    /// Why.
    pub reason: RejectionReason,
    /// From where; unknown for a server that the twin itself called.
    pub address: Option<IpAddr>,
    /// What the application calls itself; it may say anything.
    pub application_name: Option<String>,
}

impl Rejection {
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

/// The last knock with each certificate.
#[derive(Debug, Clone)]
pub(crate) struct Knocks {
    folder: PathBuf,
}

impl Knocks {
    pub fn new(pki_directory: &Path) -> Self {
        Self { folder: pki_directory.join(FOLDER) }
    }

    /// Remembers a knock. A disk that fails costs nothing but this memory.
    pub fn remember(&self, certificate: &X509, rejection: &Rejection) {
        let thumbprint = thumbprint(certificate);
        let is_news = self.last(&thumbprint).is_none_or(|last| {
            last.rejected_at > rejection.rejected_at
                || last.rejected_at.after(PAUSE) <= rejection.rejected_at
        });
        if is_news && let Err(error) = self.write(&thumbprint, rejection) {
            tracing::warn!(
                error = &error as &dyn std::error::Error,
                certificate.thumbprint = thumbprint,
                "It could not be noted when a certificate was turned away."
            );
        }
    }

    /// The last knock with the certificate of this thumbprint.
    pub fn last(&self, thumbprint: &str) -> Option<Rejection> {
        let path = self.path(thumbprint);
        let is_ours = fs::metadata(&path).is_ok_and(|metadata| metadata.len() <= FILE_BYTES_MAX);
        is_ours
            .then(|| fs::read(&path).ok())
            .flatten()
            .and_then(|bytes| serde_json::from_slice(&bytes).ok())
    }

    /// The certificate is trusted now, or gone: what was is no longer of interest.
    pub fn forget(&self, thumbprint: &str) {
        match fs::remove_file(self.path(thumbprint)) {
            Ok(()) => {}
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => {
                tracing::warn!(%error, certificate.thumbprint = thumbprint, "An old note could not be removed.")
            }
        }
    }

    fn write(&self, thumbprint: &str, rejection: &Rejection) -> Result<(), crate::TwinError> {
        let bytes = serde_json::to_vec(rejection).expect("what was noted serialises");
        replace(&self.path(thumbprint), &bytes)
    }

    fn path(&self, thumbprint: &str) -> PathBuf {
        self.folder.join(format!("{}.json", thumbprint.to_ascii_lowercase()))
    }
}

/// SHA-1 over a certificate in lower-case hexadecimal digits.
pub(crate) fn thumbprint(certificate: &X509) -> String {
    certificate.thumbprint().as_hex_string().to_ascii_lowercase()
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
    fn the_last_knock_is_kept_with_what_is_known_of_the_bearer() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join(FOLDER)).unwrap();
        let (knocks, certificate) = (Knocks::new(folder.path()), certificate());
        let application = ApplicationDescription {
            application_name: LocalizedText::new("", &format!("Plan\u{1b}ner{}", "r".repeat(500))),
            ..ApplicationDescription::default()
        };
        let address = Some("[::ffff:10.0.0.7]:4321".parse().unwrap());
        let at = |micros| {
            let bearer = CertificateBearer { address, application: &application };
            Rejection::new(DateTime::from_unix_micros(micros), RejectionReason::NotTrusted, &bearer)
        };
        let thumbprint = thumbprint(&certificate);
        assert_eq!(knocks.last(&thumbprint), None);
        knocks.remember(&certificate, &at(5_000_000));
        let last = knocks.last(&thumbprint.to_ascii_uppercase()).unwrap();
        assert_eq!(last.address, Some("10.0.0.7".parse().unwrap()));
        let name = last.application_name.clone().unwrap();
        assert!(name.starts_with("Planner") && name.len() == NAME_CHARS_MAX, "{name}");

        // Many knocks at once are one; a clock that was set back is believed.
        for (micros, expected) in
            [(5_900_000, 5_000_000), (6_000_000, 6_000_000), (1_000_000, 1_000_000)]
        {
            knocks.remember(&certificate, &at(micros));
            assert_eq!(knocks.last(&thumbprint), Some(at(expected)));
        }
        knocks.forget(&thumbprint);
        assert_eq!(knocks.last(&thumbprint), None);
        knocks.forget(&thumbprint);
    }
}
