//! The trust list: certificates of clients that an engineer approved, and those that wait for it.
//!
//! A certificate that is new to the twin lands among the rejected ones; approving moves it to the trusted ones. The
//! folders are the truth: the server looks into them at every connection.

use std::{
    fs,
    path::{Path, PathBuf},
};

use asi_model::DateTime;
use opcua_stack::opcua::crypto::{CertificateStore, X509};

use x509_parser::{prelude::FromDer, revocation_list::CertificateRevocationList};

use crate::error::TwinError;

const TRUSTED: &str = "trusted";
const REJECTED: &str = "rejected";
/// Most certificates listed of a folder: rejected ones come from anybody.
const LISTED_MAX: usize = 1000;

/// Whether a certificate opens the door.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CertificateState {
    /// Its bearer may connect.
    Trusted,
    /// Its bearer was turned away and waits for an approval.
    Rejected,
}

/// A client's certificate as the trust list knows it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClientCertificate {
    /// SHA-1 over the certificate, in lower-case hexadecimal digits: its identity here.
    pub thumbprint: String,
    /// The subject's distinguished name.
    pub subject: String,
    /// Beginning of its validity.
    pub not_before: Option<DateTime>,
    /// End of its validity.
    pub not_after: Option<DateTime>,
    /// Where it stands.
    pub state: CertificateState,
}

/// Lists, approves and rejects client certificates.
#[derive(Debug, Clone)]
pub struct TrustList {
    folder: PathBuf,
}

impl TrustList {
    pub(crate) fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned() }
    }

    /// Every certificate known, rejected ones first.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when a folder cannot be read.
    pub fn list(&self) -> Result<Vec<ClientCertificate>, TwinError> {
        let mut all = Vec::new();
        for (name, state) in [(REJECTED, CertificateState::Rejected), (TRUSTED, CertificateState::Trusted)] {
            for path in self.files(name)?.into_iter().take(LISTED_MAX) {
                if let Ok(certificate) = CertificateStore::read_cert(&path) {
                    all.push(describe(&certificate, state));
                }
            }
        }
        Ok(all)
    }

    /// Lets the bearer of a certificate in from now on. False where the certificate is not known.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when the certificate cannot be moved.
    pub fn trust(&self, thumbprint: &str) -> Result<bool, TwinError> {
        self.shift(thumbprint, REJECTED, TRUSTED)
    }

    /// Turns the bearer of a certificate away from the next connection on. False where it was not trusted.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when the certificate cannot be moved.
    pub fn reject(&self, thumbprint: &str) -> Result<bool, TwinError> {
        self.shift(thumbprint, TRUSTED, REJECTED)
    }

    /// Trusts a certificate that was brought here another way, as DER.
    ///
    /// # Errors
    /// [`TwinError::Certificate`] when these are not a certificate's bytes, [`TwinError::Pki`] when it cannot be stored.
    pub fn trust_new(&self, der: &[u8]) -> Result<ClientCertificate, TwinError> {
        let certificate = X509::from_der(der)
            .map_err(|_| TwinError::Certificate { reason: "the bytes are no certificate in DER".to_owned() })?;
        let description = describe(&certificate, CertificateState::Trusted);
        if !self.trust(&description.thumbprint)? {
            self.write(TRUSTED, &CertificateStore::cert_file_name(&certificate), der)?;
        }
        Ok(description)
    }

    /// Lets an authority's certificates take part in chains without being trusted itself, as DER.
    ///
    /// # Errors
    /// [`TwinError::Certificate`] when these are not a certificate's bytes, [`TwinError::Pki`] when it cannot be stored.
    pub fn add_issuer(&self, der: &[u8]) -> Result<(), TwinError> {
        let certificate = X509::from_der(der)
            .map_err(|_| TwinError::Certificate { reason: "the bytes are no certificate in DER".to_owned() })?;
        self.write("issuers", &CertificateStore::cert_file_name(&certificate), der)
    }

    /// Takes an authority's revocation list as DER; it replaces the one before of the same authority. Certificates of an
    /// authority open the door only while its current list is here.
    ///
    /// # Errors
    /// [`TwinError::Certificate`] when these are not a list's bytes, [`TwinError::Pki`] when it cannot be stored.
    pub fn put_revocation_list(&self, der: &[u8]) -> Result<(), TwinError> {
        let (_, list) = CertificateRevocationList::from_der(der)
            .map_err(|_| TwinError::Certificate { reason: "the bytes are no revocation list in DER".to_owned() })?;
        let name: String = list
            .issuer()
            .to_string()
            .chars()
            .map(|c| if c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '=' | ' ') { c } else { '_' })
            .take(120)
            .collect();
        self.write("crl", &format!("{name}.crl"), der)
    }

    fn write(&self, folder: &str, name: &str, bytes: &[u8]) -> Result<(), TwinError> {
        let path = self.folder.join(folder).join(name);
        fs::write(&path, bytes).map_err(|source| TwinError::Pki { path, source })
    }

    fn shift(&self, thumbprint: &str, from: &str, to: &str) -> Result<bool, TwinError> {
        for path in self.files(from)? {
            let fits = CertificateStore::read_cert(&path)
                .is_ok_and(|certificate| certificate.thumbprint().as_hex_string().eq_ignore_ascii_case(thumbprint));
            if fits && let Some(name) = path.file_name() {
                let target = self.folder.join(to).join(name);
                fs::rename(&path, &target).map_err(|source| TwinError::Pki { path: target, source })?;
                tracing::info!(certificate.thumbprint = thumbprint, folder = to, "A client's certificate was moved.");
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn files(&self, name: &str) -> Result<Vec<PathBuf>, TwinError> {
        let folder = self.folder.join(name);
        let entries = fs::read_dir(&folder).map_err(|source| TwinError::Pki { path: folder.clone(), source })?;
        let mut files: Vec<PathBuf> = entries
            .filter_map(|entry| entry.ok().map(|entry| entry.path()))
            .filter(|path| path.extension().is_some_and(|extension| extension == "der"))
            .collect();
        files.sort();
        Ok(files)
    }
}

fn describe(certificate: &X509, state: CertificateState) -> ClientCertificate {
    ClientCertificate {
        thumbprint: certificate.thumbprint().as_hex_string().to_ascii_lowercase(),
        subject: certificate.subject_name(),
        not_before: certificate.not_before().ok().map(|t| DateTime::from_unix_micros(t.timestamp_micros())),
        not_after: certificate.not_after().ok().map(|t| DateTime::from_unix_micros(t.timestamp_micros())),
        state,
    }
}
