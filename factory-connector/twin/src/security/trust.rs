//! Trust list: certificates of clients that an engineer approved, those that wait for approval,
//! authorities and their revocation lists.
//!
//! A certificate that is new to the twin is stored among those that wait; approving moves it to the
//! trusted ones, rejecting to the denied ones. The folders are authoritative: the server looks at them at
//! every connection. Open sessions whose certificate lost its trust by a change end within moments.

mod authorities;
pub(crate) mod faults;
mod revocation_lists;

use std::{
    collections::HashSet,
    fs,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use asi_model::DateTime;
use opcua_stack::opcua::crypto::{CertificateStore, X509};
use tokio::sync::Notify;
use x509_parser::{certificate::X509Certificate, prelude::FromDer, time::ASN1Time};

pub use authorities::{Authority, RevocationKnowledge};
pub use revocation_lists::RevocationList;

use super::{
    approvals::{Approval, Approvals},
    certificate_files::{paths, replace},
    rejected_clients::{ConnectionRejection, RejectedClients, fingerprint, thumbprint},
};
use crate::{error::TwinError, events::EventReporter, trust_fault::TrustFault};

pub(crate) const TRUSTED: &str = "trusted";
/// Certificates that wait for an approval. The folder's name is older than the one of those that were denied one.
pub(crate) const WAITING: &str = "rejected";
pub(crate) const DENIED: &str = "denied";
/// Certificates that came in through an authority, as far as the twin has seen them; where they are trusted is no matter
/// of this folder.
pub(crate) const ISSUED: &str = "issued";
pub(crate) const ISSUERS: &str = "issuers";
pub(crate) const REVOCATION_LISTS: &str = "crl";
/// Most certificates listed of a folder: any client may add some that wait.
const LISTED_MAX: usize = 1000;
/// Most certificates named in one line of the log.
const NAMED_MAX: usize = 10;

/// State of a client's certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CertificateState {
    /// The client may connect.
    Trusted,
    /// The client came in through an authority that is trusted.
    Issued,
    /// The client is rejected and waits for an approval.
    Rejected,
    /// The client is rejected because an engineer said so.
    Denied,
}

/// A client's certificate in the trust list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClientCertificate {
    /// SHA-1 over the certificate in lower-case hexadecimal digits; identifies it in the trust list.
    pub thumbprint: String,
    /// SHA-256 over the certificate in lower-case hexadecimal digits, for people to compare.
    pub fingerprint: String,
    /// The subject's distinguished name.
    pub subject: String,
    /// ApplicationUri in its alternative names.
    pub application_uri: Option<String>,
    /// Beginning of its validity.
    pub not_before: DateTime,
    /// End of its validity.
    pub not_after: DateTime,
    pub state: CertificateState,
    /// The approval by a person; none on record where it is trusted without, or not trusted.
    pub approval: Option<Approval>,
    /// The last rejected connection attempt since it has this state.
    pub rejection: Option<ConnectionRejection>,
}

/// Lists, approves and rejects client certificates, authorities and revocation lists. Each change
/// takes the name of its author (`by`), for the log and the audit trail.
#[derive(Clone)]
pub struct TrustList {
    folder: PathBuf,
    approvals: Approvals,
    rejected_clients: RejectedClients,
    /// Set once the server is built.
    events: Arc<OnceLock<Arc<EventReporter>>>,
    /// Notified of each change, for the review of open sessions.
    review: Arc<Notify>,
}

impl TrustList {
    pub(crate) fn new(
        folder: &Path,
        events: Arc<OnceLock<Arc<EventReporter>>>,
        review: Arc<Notify>,
    ) -> Self {
        let rejected_clients = RejectedClients::new(folder);
        let approvals = Approvals::new(folder);
        Self { folder: folder.to_owned(), approvals, rejected_clients, events, review }
    }

    /// Opens the trust list in a folder that no server of this process uses: a change is one of its files alone.
    #[must_use]
    pub fn of_folder(folder: &Path) -> Self {
        Self::new(folder, Arc::default(), Arc::default())
    }

    /// Returns all certificates of clients, the rejected ones first, by the last attempt. Of those that an authority
    /// vouches for it has the ones that came.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when a folder cannot be read.
    pub fn list(&self) -> Result<Vec<ClientCertificate>, TwinError> {
        let mut all = Vec::new();
        for (name, state) in [
            (DENIED, CertificateState::Denied),
            (WAITING, CertificateState::Rejected),
            (TRUSTED, CertificateState::Trusted),
            (ISSUED, CertificateState::Issued),
        ] {
            for path in self.files(name, "der")?.into_iter().take(LISTED_MAX) {
                all.extend(
                    CertificateStore::read_cert(&path)
                        .ok()
                        .and_then(|found| self.describe(&found, state)),
                );
            }
        }
        // One may come in while an engineer decides about it, and be stored once more.
        let mut known = HashSet::new();
        all.retain(|one: &ClientCertificate| known.insert(one.fingerprint.clone()));
        all.sort_by_key(|certificate| {
            let last = certificate.rejection.as_ref().map(|rejection| rejection.rejected_at);
            let is_let_in =
                matches!(certificate.state, CertificateState::Trusted | CertificateState::Issued);
            (is_let_in, std::cmp::Reverse(last))
        });
        Ok(all)
    }

    /// Returns the certificates of clients that are trusted though no person's approval is on record.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when a folder cannot be read.
    pub fn unapproved(&self) -> Result<Vec<ClientCertificate>, TwinError> {
        let mut all = self.list()?;
        all.retain(|one| one.state == CertificateState::Trusted && one.approval.is_none());
        Ok(all)
    }

    /// Names the unapproved ones in the log.
    pub(crate) fn warn_of_unapproved(&self) {
        // A folder that cannot be read is said with each connection.
        let unapproved = self.unapproved().unwrap_or_default();
        if unapproved.is_empty() {
            return;
        }
        let named = unapproved.iter().take(NAMED_MAX).map(|one| one.subject.as_str());
        tracing::warn!(
            certificates = unapproved.len(),
            subjects = named.collect::<Vec<_>>().join("; "),
            "OPC UA clients may connect whose certificates no person is known to have approved: a former version \
             trusted them by a development setting or had no record yet, or they were copied into the folder. Compare \
             their fingerprints, and approve or deny each on the page of sources."
        );
    }

    /// Accepts a certificate from now on, or approves one that is trusted without an approval. False when it is not in
    /// the list.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when the certificate cannot be moved.
    pub fn trust(&self, thumbprint: &str, by: &str) -> Result<bool, TwinError> {
        let is_moved = self.shift(thumbprint, WAITING, TRUSTED)?
            || self.shift(thumbprint, DENIED, TRUSTED)?
            || self.shift(thumbprint, ISSUED, TRUSTED)?;
        let Some(fingerprint) = self.fingerprint_of(TRUSTED, thumbprint)? else {
            return Ok(is_moved);
        };
        if is_moved || self.approvals.of(&fingerprint).is_none() {
            self.approvals.record(&fingerprint, by)?;
            self.rejected_clients.forget(thumbprint);
            self.changed(by, format!("The certificate {thumbprint} is trusted."));
        }
        Ok(true)
    }

    /// Rejects a certificate, also where its authority is trusted; its open sessions end. False when it neither was
    /// trusted, nor waited for an approval, nor came in through an authority.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when the certificate cannot be moved.
    pub fn reject(&self, thumbprint: &str, by: &str) -> Result<bool, TwinError> {
        let is_moved = self.shift(thumbprint, TRUSTED, DENIED)?
            || self.shift(thumbprint, WAITING, DENIED)?
            || self.shift(thumbprint, ISSUED, DENIED)?;
        if is_moved {
            // First what ends its sessions: a record that cannot be removed must not keep them open.
            self.changed(by, format!("The certificate {thumbprint} is denied."));
            if let Some(fingerprint) = self.fingerprint_of(DENIED, thumbprint)? {
                self.approvals.forget(&fingerprint)?;
            }
        }
        Ok(is_moved)
    }

    /// Adds a certificate (DER) as trusted: a client's, or an authority's whose clients are to be
    /// trusted.
    ///
    /// # Errors
    /// [`TwinError::Refused`] with all its faults, [`TwinError::Pki`] when it cannot be stored.
    pub fn trust_new(&self, der: &[u8], by: &str) -> Result<(), TwinError> {
        let parsed = faults::certificate(der)?;
        let is_authority = faults::is_authority(&parsed);
        let now = ASN1Time::now();
        refuse(if is_authority {
            faults::of_authority(&parsed, now)
        } else {
            faults::of_client(der, &parsed, now)
        })?;
        let certificate = read(der)?;
        let thumbprint = thumbprint(&certificate);
        if !self.trust(&thumbprint, by)? {
            self.write(TRUSTED, &CertificateStore::cert_file_name(&certificate), der)?;
            self.approvals.record(&fingerprint(&certificate), by)?;
            let what = if is_authority { "authority's certificate" } else { "certificate" };
            self.changed(by, format!("The {what} {thumbprint} was added and is trusted."));
        }
        Ok(())
    }

    /// Denies a certificate (DER), known here or not, also where an authority vouches for it; its open sessions end.
    ///
    /// # Errors
    /// [`TwinError::Refused`] where it is none, [`TwinError::Pki`] when it cannot be stored.
    pub fn deny_new(&self, der: &[u8], by: &str) -> Result<(), TwinError> {
        faults::certificate(der)?;
        let certificate = read(der)?;
        let thumbprint = thumbprint(&certificate);
        // Stored in any case: another certificate may have the same thumbprint.
        self.write(DENIED, &CertificateStore::cert_file_name(&certificate), der)?;
        let moved = self.reject(&thumbprint, by);
        // It is denied in any case: its sessions end, whatever could not be moved.
        if !matches!(moved, Ok(true)) {
            self.changed(by, format!("The certificate {thumbprint} was added and is denied."));
        }
        moved.map(drop)
    }

    /// Describes a client's certificate; none for a trusted authority's, which is listed separately.
    fn describe(&self, certificate: &X509, state: CertificateState) -> Option<ClientCertificate> {
        let thumbprint = thumbprint(certificate);
        let der = certificate.as_byte_string();
        let (_, parsed) = X509Certificate::from_der(der.as_ref()).ok()?;
        if state == CertificateState::Trusted && faults::is_authority(&parsed) {
            return None;
        }
        let fingerprint = fingerprint(certificate);
        Some(ClientCertificate {
            subject: certificate.subject_name(),
            application_uri: faults::application_uri(&parsed).map(str::to_owned),
            not_before: time(parsed.validity().not_before),
            not_after: time(parsed.validity().not_after),
            state,
            rejection: self.rejected_clients.last(&thumbprint),
            approval: self
                .approvals
                .of(&fingerprint)
                .filter(|_| state == CertificateState::Trusted),
            thumbprint,
            fingerprint,
        })
    }

    /// Reports a change with its author to the log and to the server's audit trail.
    fn changed(&self, by: &str, message: String) {
        tracing::info!(by, change = message, "The trust list of the twin was changed.");
        if let Some(events) = self.events.get() {
            events.report_trust_list(by, message);
        }
        self.review.notify_one();
    }

    fn write(&self, folder: &str, name: &str, bytes: &[u8]) -> Result<(), TwinError> {
        replace(&self.folder.join(folder).join(name), bytes)
    }

    fn shift(&self, thumbprint: &str, from: &str, to: &str) -> Result<bool, TwinError> {
        let Some(path) = self.find(from, thumbprint)? else { return Ok(false) };
        let target =
            self.folder.join(to).join(path.file_name().expect("a file of a folder has a name"));
        fs::rename(&path, &target).map_err(|source| TwinError::Pki { path: target, source })?;
        Ok(true)
    }

    /// Finds the file of a certificate in a folder.
    fn find(&self, folder: &str, searched: &str) -> Result<Option<PathBuf>, TwinError> {
        let fits = |path: &PathBuf| {
            CertificateStore::read_cert(path)
                .is_ok_and(|certificate| thumbprint(&certificate).eq_ignore_ascii_case(searched))
        };
        Ok(self.files(folder, "der")?.into_iter().find(fits))
    }

    /// Returns the fingerprint of a certificate in a folder.
    fn fingerprint_of(&self, folder: &str, thumbprint: &str) -> Result<Option<String>, TwinError> {
        let path = self.find(folder, thumbprint)?;
        let found = path.and_then(|path| CertificateStore::read_cert(&path).ok());
        Ok(found.map(|certificate| fingerprint(&certificate)))
    }

    fn files(&self, name: &str, extension: &str) -> Result<Vec<PathBuf>, TwinError> {
        paths(&self.folder.join(name), extension)
    }
}

fn read(der: &[u8]) -> Result<X509, TwinError> {
    X509::from_der(der).map_err(|_| {
        TrustFault::new(
            "NOT_A_CERTIFICATE",
            "These bytes are a certificate that the OPC UA stack cannot read.",
        )
        .into()
    })
}

pub(crate) fn refuse(faults: Vec<TrustFault>) -> Result<(), TwinError> {
    if faults.is_empty() { Ok(()) } else { Err(TwinError::Refused { faults }) }
}

pub(crate) fn time(at: ASN1Time) -> DateTime {
    DateTime::from_unix_micros(at.timestamp().saturating_mul(1_000_000))
}
