//! Client certificate, and the trust in servers' certificates.
//!
//! Trust is by the certificate itself, byte for byte, approved by a person who compares fingerprints:
//! `trusted/` and `rejected/` hold one DER file each. A certificate chain, an authority or a host name
//! inside it are not evaluated; its time is, and revocation lists (`crl/`, DER or PEM) that an authority of
//! `issuers/` or `trusted/` signed, those of the authorities above it too. While one of these files cannot be read, no
//! certificate is trusted.

mod folder;
mod own;
mod revocation;

use std::{
    fs, io,
    path::{Path, PathBuf},
    sync::Arc,
};

use asi_model::values::DateTime;
use opcua_stack::opcua::crypto::{CertificateStore, X509};
use parking_lot::Mutex;
use serde::Serialize;
use sha2::{Digest as _, Sha256};
use utoipa::ToSchema;

use self::folder::{contents, disk, read};
pub use self::own::{OwnCertificate, OwnCertificates};
use crate::{Config, ShopFloorError};

const TRUSTED: &str = "trusted";
const REJECTED: &str = "rejected";
const ISSUERS: &str = "issuers";
const REVOCATION_LISTS: &str = "crl";
/// Most certificates listed per folder, and most stored as rejected.
const CERTIFICATES_MAX: usize = 1000;
/// Longest certificate file read.
const CERTIFICATE_BYTES_MAX: u64 = 64 << 10;
/// Longest revocation list read.
const REVOCATION_LIST_BYTES_MAX: u64 = 4 << 20;

/// Certificate that a server has presented.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PeerCertificate {
    /// SHA-1 thumbprint, hex: the certificate's name in OPC UA.
    pub thumbprint: String,
    /// SHA-256 fingerprint, hex, for people to compare.
    pub fingerprint: String,
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
    /// Held while own certificates and keys are read or written, which belong together in pairs.
    own_files: Arc<Mutex<()>>,
}

impl PkiDirectory {
    pub(crate) fn new(config: &Config) -> Self {
        Self {
            directory: config.pki_directory.clone(),
            application_name: config.application_name.clone(),
            application_uri: config.application_uri.clone(),
            own_files: Arc::default(),
        }
    }

    pub(crate) fn directory(&self) -> &Path {
        &self.directory
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
        if self.is_revoked(certificate).inspect_err(|error| {
            tracing::error!(
                error = error as &dyn std::error::Error,
                "It is not known which certificates are revoked, so no server is connected over a secured endpoint. Make \
                 the file readable or remove it."
            );
        })? {
            return Ok(TrustFinding::Revoked);
        }
        Ok(TrustFinding::Trusted)
    }

    /// Returns whether an authority revoked the certificate, or that of an authority above it.
    fn is_revoked(&self, certificate: &X509) -> Result<bool, ShopFloorError> {
        let mut authorities = Vec::new();
        for folder in [ISSUERS, TRUSTED] {
            let found = contents(&self.directory.join(folder), CERTIFICATE_BYTES_MAX)?;
            authorities.extend(found.into_iter().map(|(_, der)| der));
        }
        let mut lists = Vec::new();
        let files = contents(&self.directory.join(REVOCATION_LISTS), REVOCATION_LIST_BYTES_MAX)?;
        for (path, content) in files {
            lists.extend(revocation::lists_in(&content).ok_or_else(|| {
                disk(&path, &io::Error::other("the file is no revocation list in DER or PEM"))
            })?);
        }
        Ok(revocation::is_revoked(certificate.as_byte_string().as_ref(), &authorities, &lists))
    }

    /// Returns true when exactly this certificate is approved. A new one is stored as rejected.
    fn is_approved(&self, certificate: &X509) -> Result<bool, ShopFloorError> {
        if let Some(is_approved) = self.known_as_trusted(certificate)? {
            return Ok(is_approved);
        }
        let name = CertificateStore::cert_file_name(certificate);
        let rejected = self.directory.join(REJECTED).join(&name);
        if !rejected.exists() && self.files(REJECTED)?.len() < CERTIFICATES_MAX {
            fs::write(&rejected, der(certificate)?).map_err(|error| disk(&rejected, &error))?;
        }
        Ok(false)
    }

    /// Returns whether the trusted certificate of this name is exactly this one; `None` without one. Stores nothing.
    pub(crate) fn known_as_trusted(
        &self,
        certificate: &X509,
    ) -> Result<Option<bool>, ShopFloorError> {
        let path = self.directory.join(TRUSTED).join(CertificateStore::cert_file_name(certificate));
        if !path.exists() {
            return Ok(None);
        }
        let trusted = read_limited(&path).map_err(|error| disk(&path, &error))?;
        Ok(Some(trusted == der(certificate)?))
    }

    /// Lists all certificates, the rejected ones first.
    pub(crate) fn list(&self) -> Result<Vec<PeerCertificate>, ShopFloorError> {
        let mut all = Vec::new();
        for (folder, trust) in [(REJECTED, TrustState::Rejected), (TRUSTED, TrustState::Trusted)] {
            let files = self.files(folder)?.into_iter().take(CERTIFICATES_MAX);
            all.extend(files.filter_map(|path| describe(&path, trust)));
        }
        Ok(all)
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
        let path = match self.find(from, thumbprint)? {
            None => self.find(to, thumbprint)?,
            found => found,
        };
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
            if let Some(path) = self.find(folder, thumbprint)? {
                fs::remove_file(&path).map_err(|error| disk(&path, &error))?;
            }
        }
        Ok(())
    }

    fn find(&self, folder: &str, thumbprint: &str) -> Result<Option<PathBuf>, ShopFloorError> {
        let trust = TrustState::Rejected;
        Ok(self.files(folder)?.into_iter().find(|path| {
            describe(path, trust)
                .is_some_and(|found| found.thumbprint.eq_ignore_ascii_case(thumbprint))
        }))
    }

    fn files(&self, folder: &str) -> Result<Vec<PathBuf>, ShopFloorError> {
        folder::files(&self.directory.join(folder))
    }
}

fn describe(path: &Path, trust: TrustState) -> Option<PeerCertificate> {
    let certificate = X509::from_der(&read_limited(path).ok()?).ok()?;
    let (valid_from, valid_to) = validity(&certificate);
    Some(PeerCertificate {
        thumbprint: certificate.thumbprint().as_hex_string(),
        fingerprint: fingerprint(&certificate),
        subject: certificate.subject_name(),
        valid_from,
        valid_to,
        key_bits: certificate.key_length().ok(),
        trust,
    })
}

/// Returns SHA-256 over a certificate, hex. Thumbprints are SHA-1, of which two certificates with the same can be made.
pub(crate) fn fingerprint(certificate: &X509) -> String {
    hex::encode(Sha256::digest(certificate.as_byte_string().as_ref()))
}

fn der(certificate: &X509) -> Result<Vec<u8>, ShopFloorError> {
    certificate.to_der().map_err(|_| {
        ShopFloorError::Certificates("the server's certificate cannot be encoded".into())
    })
}

pub(crate) fn validity(certificate: &X509) -> (Option<DateTime>, Option<DateTime>) {
    let micros = |time: Result<i64, _>| time.ok().map(DateTime::from_unix_micros);
    (
        micros(certificate.not_before().map(|time| time.timestamp_micros())),
        micros(certificate.not_after().map(|time| time.timestamp_micros())),
    )
}

fn read_limited(path: &Path) -> io::Result<Vec<u8>> {
    read(path, CERTIFICATE_BYTES_MAX)
}

#[cfg(test)]
mod tests;
