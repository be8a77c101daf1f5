//! Certificates by which a daemon shows a broker who it is, beside user name and password.

use std::{
    io,
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use rustls::{
    CertificateError, RootCertStore,
    pki_types::{CertificateDer, PrivateKeyDer, UnixTime, pem, pem::PemObject as _},
    server::WebPkiClientVerifier,
    sign::CertifiedKey,
};
use serde::Deserialize;
use time::OffsetDateTime;
use zeroize::Zeroizing;

use crate::secret_file::{self, SecretFileError};

/// Longest file of a key.
const KEY_BYTES_MAX: u64 = 64 * 1024;
/// Time before its end from which a certificate is said to end soon.
const SOON: Duration = Duration::from_secs(30 * 24 * 3600);

/// Certificate and key of a client, as PEM files.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClientCertificateFiles {
    /// The certificate chain, leaf first.
    pub certificate: PathBuf,
    /// PEM file of the private key of the leaf, for this program's user alone.
    pub key: PathBuf,
}

/// Failure to use a client certificate.
#[derive(Debug, thiserror::Error)]
pub enum ClientCertificateError {
    #[error("cannot read {}; is the path right?", path.display())]
    Access {
        path: PathBuf,
        #[source]
        source: io::Error,
    },
    #[error("the key cannot be read")]
    Key(#[from] SecretFileError),
    #[error("{} is not PEM of a certificate, or of a key without a password", path.display())]
    Pem {
        path: PathBuf,
        #[source]
        source: pem::Error,
    },
    #[error("{} holds no certificate", path.display())]
    Empty { path: PathBuf },
    #[error("the key {} is not that of the certificate {}", key.display(), certificate.display())]
    Mismatch { key: PathBuf, certificate: PathBuf },
    #[error("certificate and key cannot be used")]
    Use(#[source] rustls::Error),
}

/// A client's certificate with the key that fits.
pub struct ShownCertificate {
    /// The chain, leaf first, as PEM.
    pub certificates_pem: Vec<u8>,
    /// The private key, as PEM; wiped from memory when dropped.
    pub key_pem: Zeroizing<Vec<u8>>,
    leaf: CertificateDer<'static>,
    path: PathBuf,
}

impl ClientCertificateFiles {
    /// Reads both files and checks that they fit.
    ///
    /// # Errors
    /// [`ClientCertificateError`] naming the file at fault and the remedy.
    pub fn load(&self) -> Result<ShownCertificate, ClientCertificateError> {
        let certificates_pem = std::fs::read(&self.certificate).map_err(|source| {
            ClientCertificateError::Access { path: self.certificate.clone(), source }
        })?;
        let key_pem = secret_file::read(&self.key, KEY_BYTES_MAX)?.text;
        let chain: Vec<CertificateDer<'static>> = CertificateDer::pem_slice_iter(&certificates_pem)
            .collect::<Result<_, _>>()
            .map_err(not_pem(&self.certificate))?;
        let leaf = chain.first().cloned();
        let leaf =
            leaf.ok_or_else(|| ClientCertificateError::Empty { path: self.certificate.clone() })?;
        let key = PrivateKeyDer::from_pem_slice(key_pem.as_bytes()).map_err(not_pem(&self.key))?;
        let provider = rustls::crypto::ring::default_provider();
        CertifiedKey::from_der(chain, key, &provider).map_err(|error| match error {
            rustls::Error::InconsistentKeys(_) => ClientCertificateError::Mismatch {
                key: self.key.clone(),
                certificate: self.certificate.clone(),
            },
            error => ClientCertificateError::Use(error),
        })?;
        let key_pem = Zeroizing::new(key_pem.as_bytes().to_vec());
        Ok(ShownCertificate { certificates_pem, key_pem, leaf, path: self.certificate.clone() })
    }
}

fn not_pem(path: &Path) -> impl Fn(pem::Error) -> ClientCertificateError {
    let path = path.to_owned();
    move |source| ClientCertificateError::Pem { path: path.clone(), source }
}

impl ShownCertificate {
    /// Returns what to say of a certificate that a broker refuses now or soon. It keeps nothing from starting: what is
    /// to leave waits until there is a new one.
    #[must_use]
    pub fn notice(&self, now: OffsetDateTime) -> Option<String> {
        let path = self.path.display();
        let moment = |at: UnixTime| {
            let seconds = i64::try_from(at.as_secs()).ok();
            let moment = seconds.and_then(|s| OffsetDateTime::from_unix_timestamp(s).ok());
            moment.map(|found| found.to_string()).unwrap_or_default()
        };
        match self.fault_at(now) {
            Some(CertificateError::ExpiredContext { not_after, .. }) => Some(format!(
                "the certificate {path} ended at {}: put a new one in its place and start again",
                moment(not_after)
            )),
            Some(CertificateError::NotValidYetContext { not_before, .. }) => Some(format!(
                "the certificate {path} is valid from {} on: is this machine's clock right?",
                moment(not_before)
            )),
            Some(
                CertificateError::InvalidPurpose | CertificateError::InvalidPurposeContext { .. },
            ) => Some(format!(
                "the certificate {path} is not for clients: have one issued with the purpose clientAuth"
            )),
            _ => match self.fault_at(now + SOON) {
                Some(CertificateError::ExpiredContext { not_after, .. }) => Some(format!(
                    "the certificate {path} ends at {}: put a new one in its place before, and start again",
                    moment(not_after)
                )),
                _ => None,
            },
        }
    }

    /// Returns the fault that a server finds at a time. Who issued the certificate is the broker's to judge; here it
    /// vouches for itself, which is the last that is looked at.
    fn fault_at(&self, at: OffsetDateTime) -> Option<CertificateError> {
        let mut own = RootCertStore::empty();
        own.add(self.leaf.clone()).ok()?;
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let verifier =
            WebPkiClientVerifier::builder_with_provider(Arc::new(own), provider).build().ok()?;
        let seconds = u64::try_from(at.unix_timestamp()).unwrap_or_default();
        let time = UnixTime::since_unix_epoch(Duration::from_secs(seconds));
        match verifier.verify_client_cert(&self.leaf, &[], time) {
            Err(rustls::Error::InvalidCertificate(fault)) => Some(fault),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use rcgen::{CertificateParams, ExtendedKeyUsagePurpose, KeyPair, date_time_ymd};
    use time::macros::datetime;

    use super::*;

    /// A certificate for the year 2026, and its key.
    fn pair(purpose: ExtendedKeyUsagePurpose) -> (String, String) {
        let key = KeyPair::generate().expect("a key");
        let mut params = CertificateParams::new(vec!["f1".to_owned()]).expect("a name");
        params.not_before = date_time_ymd(2026, 1, 1);
        params.not_after = date_time_ymd(2027, 1, 1);
        params.extended_key_usages = vec![purpose];
        (params.self_signed(&key).expect("a certificate").pem(), key.serialize_pem())
    }

    fn files(folder: &Path, certificate: &str, key: &str, mode: u32) -> ClientCertificateFiles {
        let files = ClientCertificateFiles {
            certificate: folder.join("client.pem"),
            key: folder.join("client.key"),
        };
        std::fs::write(&files.certificate, certificate).expect("written");
        std::fs::write(&files.key, key).expect("written");
        std::fs::set_permissions(&files.key, std::fs::Permissions::from_mode(mode)).expect("ours");
        files
    }

    fn chain_of(error: &(dyn std::error::Error + 'static)) -> String {
        let cause = error.source().map(chain_of).unwrap_or_default();
        format!("{error} {cause}")
    }

    #[test]
    fn a_pair_that_cannot_be_used_is_refused_with_the_remedy() {
        let folder = tempfile::tempdir().expect("a folder");
        let (certificate, key) = pair(ExtendedKeyUsagePurpose::ClientAuth);
        let (_, another) = pair(ExtendedKeyUsagePurpose::ClientAuth);
        let (certificate, key) = (certificate.as_str(), key.as_str());
        for (shown, signing, mode, said) in [
            (certificate, key, 0o640, "chmod 600"),
            (certificate, key, 0o604, "chmod 600"),
            (certificate, another.as_str(), 0o600, "not that of the certificate"),
            (certificate, "no PEM", 0o600, "not PEM"),
            ("no PEM", key, 0o600, "holds no certificate"),
        ] {
            let refused = files(folder.path(), shown, signing, mode).load().err();
            let refused = chain_of(&refused.expect("refused"));
            assert!(refused.contains(said), "{said}: {refused}");
        }
        let missing = ClientCertificateFiles {
            certificate: folder.path().join("nowhere"),
            key: folder.path().join("nowhere"),
        };
        let refused = missing.load().err().expect("refused").to_string();
        assert!(refused.contains("is the path right?"), "{refused}");
        files(folder.path(), certificate, key, 0o600).load().map(drop).expect("it fits");
    }

    #[test]
    fn an_end_is_said_before_and_after_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let (certificate, key) = pair(ExtendedKeyUsagePurpose::ClientAuth);
        let loaded = files(folder.path(), &certificate, &key, 0o600).load().expect("it fits");
        let notice = |now| loaded.notice(now).unwrap_or_default();
        assert_eq!(notice(datetime!(2026-06-01 00:00 UTC)), "");
        for (now, said) in [
            (datetime!(2026-12-15 00:00 UTC), "ends at 2027-01-01"),
            (datetime!(2027-01-02 00:00 UTC), "ended at 2027-01-01"),
            (datetime!(2025-12-31 00:00 UTC), "valid from 2026-01-01"),
        ] {
            assert!(notice(now).contains(said), "{said}: {}", notice(now));
        }
        let (certificate, key) = pair(ExtendedKeyUsagePurpose::ServerAuth);
        let loaded = files(folder.path(), &certificate, &key, 0o600).load().expect("it fits");
        let notice = loaded.notice(datetime!(2026-06-01 00:00 UTC)).expect("a notice");
        assert!(notice.contains("clientAuth"), "{notice}");
    }
}
