//! Client certificate, and the trust in servers' certificates.
//!
//! Trust is by the certificate itself, byte for byte, approved by a person who compares thumbprints:
//! `trusted/` and `rejected/` hold one DER file each. A certificate chain, an authority or a host name
//! inside it are not evaluated; its time is, and revocation lists (`crl/`, DER) that an authority of
//! `issuers/` or `trusted/` signed.

mod revocation;

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use asi_model::values::DateTime;
use opcua_stack::opcua::crypto::{CertificateStore, X509, X509Data};
use serde::Serialize;
use utoipa::ToSchema;

use crate::{Config, ShopFloorError};

const OWN_CERTIFICATE: &str = "own/cert.der";
const OWN_PRIVATE_KEY: &str = "private/private.pem";
const TRUSTED: &str = "trusted";
const REJECTED: &str = "rejected";
const ISSUERS: &str = "issuers";
const REVOCATION_LISTS: &str = "crl";
/// Days for which the client certificate is valid.
const OWN_VALIDITY_DAYS: u32 = 3650;
/// Most certificates listed per folder, and most stored as rejected.
const CERTIFICATES_MAX: usize = 1000;
/// Longest certificate file read.
const CERTIFICATE_BYTES_MAX: u64 = 64 << 10;
/// Longest revocation list read.
const REVOCATION_LIST_BYTES_MAX: u64 = 4 << 20;

/// Client certificate, which a server's administrator must trust.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct OwnCertificate {
    /// SHA-1 thumbprint, hex.
    pub thumbprint: String,
    /// Distinguished name of the subject.
    pub subject: String,
    /// The application URI it is for.
    pub application_uri: String,
    pub valid_from: DateTime,
    pub valid_to: DateTime,
    /// The certificate itself (DER), to be handed to the server's administrator.
    #[serde(skip)]
    pub der: Vec<u8>,
}

/// Certificate that a server has presented.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PeerCertificate {
    /// SHA-1 thumbprint, hex.
    pub thumbprint: String,
    /// Distinguished name of the subject.
    pub subject: String,
    pub valid_from: Option<DateTime>,
    pub valid_to: Option<DateTime>,
    /// The length of its RSA key in bits.
    pub key_bits: Option<usize>,
    pub trust: TrustState,
}

/// Trust in a server's certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum TrustState {
    /// A person approved it.
    Trusted,
    /// No person has approved it yet.
    Rejected,
}

/// Result of the check of a server's certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TrustFinding {
    Trusted,
    /// No person has approved it.
    NotApproved,
    /// Approved, but expired or not valid yet.
    OutOfTime,
    /// Approved, but its issuer revoked it.
    Revoked,
}

/// Directory with certificates and keys. Its methods read and write files: call them off the
/// async threads.
#[derive(Debug, Clone)]
pub(crate) struct PkiDirectory {
    directory: PathBuf,
    application_name: String,
    application_uri: String,
}

impl PkiDirectory {
    pub(crate) fn new(config: &Config) -> Self {
        Self {
            directory: config.pki_directory.clone(),
            application_name: config.application_name.clone(),
            application_uri: config.application_uri.clone(),
        }
    }

    pub(crate) fn directory(&self) -> &Path {
        &self.directory
    }

    /// Returns the client certificate. Creates it with its key on first use, which takes seconds.
    pub(crate) fn own(&self) -> Result<OwnCertificate, ShopFloorError> {
        let (certificate_path, key_path) =
            (self.directory.join(OWN_CERTIFICATE), self.directory.join(OWN_PRIVATE_KEY));
        for folder in [TRUSTED, REJECTED, ISSUERS, REVOCATION_LISTS, "own", "private"] {
            fs::create_dir_all(self.directory.join(folder))
                .map_err(|error| disk(&self.directory, &error))?;
        }
        restrict(&self.directory.join("private"), 0o700)?;
        if !certificate_path.exists() || !key_path.exists() {
            self.create_own(&certificate_path, &key_path)?;
        }
        let der =
            read_limited(&certificate_path).map_err(|error| disk(&certificate_path, &error))?;
        let certificate = X509::from_der(&der).map_err(|_| {
            ShopFloorError::Certificates(format!(
                "{} is no certificate",
                certificate_path.display()
            ))
        })?;
        let (valid_from, valid_to) = validity(&certificate);
        Ok(OwnCertificate {
            thumbprint: certificate.thumbprint().as_hex_string(),
            subject: certificate.subject_name(),
            application_uri: self.application_uri.clone(),
            valid_from: valid_from.unwrap_or(DateTime::MIN),
            valid_to: valid_to.unwrap_or(DateTime::MIN),
            der,
        })
    }

    fn create_own(&self, certificate_path: &Path, key_path: &Path) -> Result<(), ShopFloorError> {
        // Characters with a meaning in distinguished names would break the subject.
        let name: String = self
            .application_name
            .chars()
            .map(
                |letter| {
                    if letter.is_alphanumeric() || " -_.".contains(letter) { letter } else { ' ' }
                },
            )
            .take(60)
            .collect();
        let description = X509Data {
            key_size: 2048,
            common_name: name,
            organization: "Verbund".into(),
            organizational_unit: String::new(),
            country: String::new(),
            state: String::new(),
            alt_host_names: X509Data::alt_host_names(
                &self.application_uri,
                None,
                false,
                true,
                false,
            ),
            certificate_duration_days: OWN_VALIDITY_DAYS,
        };
        CertificateStore::create_certificate_and_key(
            &description,
            true,
            certificate_path,
            key_path,
        )
        .map_err(ShopFloorError::Certificates)?;
        restrict(key_path, 0o600)?;
        tracing::info!(
            "Created the client certificate for OPC UA servers; their administrators must trust it."
        );
        Ok(())
    }

    /// Returns whether a certificate may be relied on at a time. A new one is stored as rejected.
    pub(crate) fn examine(
        &self,
        certificate: &X509,
        now: DateTime,
    ) -> Result<TrustFinding, ShopFloorError> {
        if !self.is_approved(certificate)? {
            return Ok(TrustFinding::NotApproved);
        }
        let (from, to) = validity(certificate);
        if from.is_none_or(|from| now < from) || to.is_none_or(|to| to < now) {
            return Ok(TrustFinding::OutOfTime);
        }
        let contents = |folder, bytes_max| -> Vec<Vec<u8>> {
            self.files(folder).iter().filter_map(|path| read(path, bytes_max).ok()).collect()
        };
        let authorities =
            [ISSUERS, TRUSTED].map(|folder| contents(folder, CERTIFICATE_BYTES_MAX)).concat();
        let lists = contents(REVOCATION_LISTS, REVOCATION_LIST_BYTES_MAX);
        if revocation::is_revoked(certificate.as_byte_string().as_ref(), &authorities, &lists) {
            return Ok(TrustFinding::Revoked);
        }
        Ok(TrustFinding::Trusted)
    }

    /// Returns true when exactly this certificate is approved. A new one is stored as rejected.
    fn is_approved(&self, certificate: &X509) -> Result<bool, ShopFloorError> {
        let name = CertificateStore::cert_file_name(certificate);
        let der = certificate.to_der().map_err(|_| {
            ShopFloorError::Certificates("the server's certificate cannot be encoded".into())
        })?;
        let trusted = self.directory.join(TRUSTED).join(&name);
        if trusted.exists() {
            return Ok(read_limited(&trusted).map_err(|error| disk(&trusted, &error))? == der);
        }
        let rejected = self.directory.join(REJECTED).join(&name);
        if !rejected.exists() && self.files(REJECTED).len() < CERTIFICATES_MAX {
            fs::write(&rejected, der).map_err(|error| disk(&rejected, &error))?;
        }
        Ok(false)
    }

    /// Lists all certificates, the rejected ones first.
    pub(crate) fn list(&self) -> Vec<PeerCertificate> {
        [(REJECTED, TrustState::Rejected), (TRUSTED, TrustState::Trusted)]
            .into_iter()
            .flat_map(|(folder, trust)| {
                self.files(folder).into_iter().map(move |path| (path, trust))
            })
            .filter_map(|(path, trust)| describe(&path, trust))
            .collect()
    }

    /// Trusts a rejected certificate, or no longer trusts a trusted one.
    pub(crate) fn set_trust(
        &self,
        thumbprint: &str,
        trust: TrustState,
    ) -> Result<PeerCertificate, ShopFloorError> {
        let (from, to) = match trust {
            TrustState::Trusted => (REJECTED, TRUSTED),
            TrustState::Rejected => (TRUSTED, REJECTED),
        };
        let path = self.find(from, thumbprint).or_else(|| self.find(to, thumbprint));
        let path = path.ok_or_else(|| {
            ShopFloorError::Invalid(format!("there is no certificate {thumbprint}"))
        })?;
        let name = path.file_name().expect("a listed file has a name");
        let target = self.directory.join(to).join(name);
        if target != path {
            fs::rename(&path, &target).map_err(|error| disk(&path, &error))?;
        }
        describe(&target, trust)
            .ok_or_else(|| ShopFloorError::Certificates(format!("{thumbprint} is unreadable")))
    }

    /// Deletes a certificate by its thumbprint, rejected or trusted.
    pub(crate) fn forget(&self, thumbprint: &str) -> Result<(), ShopFloorError> {
        for folder in [REJECTED, TRUSTED] {
            if let Some(path) = self.find(folder, thumbprint) {
                fs::remove_file(&path).map_err(|error| disk(&path, &error))?;
            }
        }
        Ok(())
    }

    fn find(&self, folder: &str, thumbprint: &str) -> Option<PathBuf> {
        let trust = TrustState::Rejected;
        self.files(folder).into_iter().find(|path| {
            describe(path, trust)
                .is_some_and(|found| found.thumbprint.eq_ignore_ascii_case(thumbprint))
        })
    }

    fn files(&self, folder: &str) -> Vec<PathBuf> {
        let Ok(entries) = fs::read_dir(self.directory.join(folder)) else { return Vec::new() };
        let mut paths: Vec<_> = entries
            .filter_map(Result::ok)
            .map(|entry| entry.path())
            .take(CERTIFICATES_MAX)
            .collect();
        paths.sort();
        paths
    }
}

fn describe(path: &Path, trust: TrustState) -> Option<PeerCertificate> {
    let certificate = X509::from_der(&read_limited(path).ok()?).ok()?;
    let (valid_from, valid_to) = validity(&certificate);
    Some(PeerCertificate {
        thumbprint: certificate.thumbprint().as_hex_string(),
        subject: certificate.subject_name(),
        valid_from,
        valid_to,
        key_bits: certificate.key_length().ok(),
        trust,
    })
}

fn validity(certificate: &X509) -> (Option<DateTime>, Option<DateTime>) {
    let micros = |time: Result<i64, _>| time.ok().map(DateTime::from_unix_micros);
    (
        micros(certificate.not_before().map(|time| time.timestamp_micros())),
        micros(certificate.not_after().map(|time| time.timestamp_micros())),
    )
}

fn read_limited(path: &Path) -> io::Result<Vec<u8>> {
    read(path, CERTIFICATE_BYTES_MAX)
}

fn read(path: &Path, bytes_max: u64) -> io::Result<Vec<u8>> {
    if fs::metadata(path)?.len() > bytes_max {
        return Err(io::Error::other("the file is too long"));
    }
    fs::read(path)
}

fn disk(path: &Path, error: &io::Error) -> ShopFloorError {
    ShopFloorError::Certificates(format!("{}: {error}", path.display()))
}

#[cfg(unix)]
fn restrict(path: &Path, mode: u32) -> Result<(), ShopFloorError> {
    use std::os::unix::fs::PermissionsExt as _;
    fs::set_permissions(path, fs::Permissions::from_mode(mode)).map_err(|error| disk(path, &error))
}

#[cfg(not(unix))]
fn restrict(_path: &Path, _mode: u32) -> Result<(), ShopFloorError> {
    Ok(())
}

#[cfg(test)]
mod tests;
