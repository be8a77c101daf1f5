//! Validation of clients' certificates: trusted one by one, or issued by a trusted authority and not
//! revoked.
//!
//! In the certificate folder, `trusted` contains certificates of clients and of authorities,
//! `issuers` those of authorities that complete chains but are not trusted themselves, `crl` the
//! authorities' revocation lists (DER), `denied` certificates that an engineer rejected, and `rejected`
//! those that wait for an approval. What is denied stays so, also where its authority is trusted, and however many
//! others wait. OPC 10000-4 §6.1.3 defines the order of the checks.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use opcua_stack::opcua::{
    crypto::{CertificateStore, KeySize, SecurityPolicy, X509},
    server::{CertificateBearer, CertificateValidator},
    types::{Error, StatusCode},
};
use x509_parser::{
    certificate::X509Certificate, prelude::FromDer, revocation_list::CertificateRevocationList,
    time::ASN1Time,
};

use super::{
    certificate_files::files,
    issuance::{CHAIN_LENGTH_MAX, is_issued_by, is_signed_by},
    rejected_clients::{ConnectionRejection, RejectedClients, thumbprint},
    trust::{DENIED, ISSUERS, REVOCATION_LISTS, TRUSTED, WAITING},
};
use crate::{certificate_error::CertificateError, clock, events::EventReporter};

/// Most certificates that wait for an approval. Beyond, the oldest are removed: any client may send
/// new ones.
const REJECTED_MAX: usize = 200;

/// Validates client certificates by the folders.
pub(crate) struct Validator {
    folder: PathBuf,
    rejected_clients: RejectedClients,
    trust_unknown: bool,
    /// Set once the server is built.
    events: Arc<OnceLock<Arc<EventReporter>>>,
}

impl Validator {
    /// Creates a validator that reads the folder at every connection.
    pub fn new(
        folder: &Path,
        trust_unknown: bool,
        events: Arc<OnceLock<Arc<EventReporter>>>,
    ) -> Self {
        Self {
            folder: folder.to_owned(),
            rejected_clients: RejectedClients::new(folder),
            trust_unknown,
            events,
        }
    }

    /// Checks whether the bearer may connect at present.
    pub fn check(&self, der: &[u8]) -> Result<(), CertificateError> {
        let (_, leaf) = X509Certificate::from_der(der).map_err(|_| CertificateError::Unreadable)?;
        if self.has(DENIED, der) {
            return Err(CertificateError::Denied);
        }
        if self.has(TRUSTED, der) {
            self.check_not_revoked(&leaf)?;
        } else {
            match self.follow_chain(&leaf) {
                Err(CertificateError::Unknown) if self.trust_unknown => {
                    tracing::warn!(
                        certificate.subject = %leaf.subject(),
                        "DEVELOPMENT SETTING: the twin accepts a certificate that nobody approved."
                    );
                }
                Err(CertificateError::Unknown) if self.has(WAITING, der) => {
                    return Err(CertificateError::Waiting);
                }
                followed => followed?,
            }
        }
        if !leaf.validity().is_valid() {
            return Err(CertificateError::OutOfTime);
        }
        match leaf.key_usage() {
            Ok(Some(usage)) if !usage.value.digital_signature() => Err(CertificateError::Usage),
            _ => Ok(()),
        }
    }

    fn has(&self, folder: &str, der: &[u8]) -> bool {
        files(&self.folder.join(folder), "der").any(|(_, known)| known == der)
    }

    fn contents(&self, folder: &str, extension: &'static str) -> Vec<Vec<u8>> {
        files(&self.folder.join(folder), extension).map(|(_, der)| der).collect()
    }

    /// Checks that no authority revoked a certificate that is trusted itself. Its trust needs no authority, so a list
    /// need not exist; one that names it is obeyed, also when it is out of date.
    fn check_not_revoked(&self, leaf: &X509Certificate<'_>) -> Result<(), CertificateError> {
        let lists = self.contents(REVOCATION_LISTS, "crl");
        for der in self.contents(TRUSTED, "der").iter().chain(&self.contents(ISSUERS, "der")) {
            let Ok((_, authority)) = X509Certificate::from_der(der) else { continue };
            let is_issuer = authority.is_ca()
                && leaf.issuer().as_raw() == authority.subject().as_raw()
                && leaf.verify_signature(Some(authority.public_key())).is_ok();
            if is_issuer && lists_of(&authority, &lists).any(|list| names(&list, leaf)) {
                return Err(CertificateError::Revoked);
            }
        }
        Ok(())
    }

    /// Follows the issuers up to a trusted one, and checks at each step that it was not revoked.
    fn follow_chain(&self, leaf: &X509Certificate<'_>) -> Result<(), CertificateError> {
        let trusted = self.contents(TRUSTED, "der");
        let issuers = self.contents(ISSUERS, "der");
        let lists = self.contents(REVOCATION_LISTS, "crl");
        let mut subject = leaf.clone();
        for _ in 0..CHAIN_LENGTH_MAX {
            let found = trusted
                .iter()
                .map(|der| (der, true))
                .chain(issuers.iter().map(|der| (der, false)))
                .filter_map(|(der, is_trusted)| {
                    Some((X509Certificate::from_der(der).ok()?.1, is_trusted))
                })
                .find(|(authority, _)| is_issued_by(&subject, authority));
            let Some((authority, is_trusted)) = found else {
                return Err(CertificateError::Unknown);
            };
            check_revocation(&subject, &authority, &lists)?;
            if is_trusted {
                return Ok(());
            }
            subject = authority;
        }
        Err(CertificateError::Unknown)
    }

    /// Stores an unknown certificate for the engineer to approve.
    fn store_rejected(&self, certificate: &X509, der: &[u8]) {
        let folder = self.folder.join(WAITING);
        let mut waiting: Vec<_> = files(&folder, "der")
            .filter_map(|(path, _)| Some((path.metadata().ok()?.modified().ok()?, path)))
            .collect();
        waiting.sort();
        for (_, oldest) in waiting.iter().take((waiting.len() + 1).saturating_sub(REJECTED_MAX)) {
            if let Ok(removed) = CertificateStore::read_cert(oldest) {
                self.rejected_clients.forget(&thumbprint(&removed));
            }
            remove(oldest);
        }
        store(&folder, certificate, der);
    }

    /// Records a rejected connection attempt, if the certificate is in the trust list.
    fn record(
        &self,
        certificate: &X509,
        der: &[u8],
        error: CertificateError,
        bearer: &CertificateBearer<'_>,
    ) {
        if [WAITING, DENIED, TRUSTED].iter().any(|folder| self.has(folder, der)) {
            self.rejected_clients
                .record(certificate, &ConnectionRejection::new(clock::now(), error.into(), bearer));
        }
    }
}

impl CertificateValidator for Validator {
    fn validate(
        &self,
        certificate: &X509,
        security_policy: SecurityPolicy,
        bearer: &CertificateBearer<'_>,
    ) -> Result<(), Error> {
        let der = certificate.as_byte_string();
        let result = self.check(der.as_ref());
        if result == Err(CertificateError::Unknown) {
            self.store_rejected(certificate, der.as_ref());
        }
        let fits = certificate
            .public_key()
            .is_ok_and(|key| security_policy.is_valid_keylength(key.bit_length()));
        let result = result.and(if fits { Ok(()) } else { Err(CertificateError::KeyLength) });
        result.map_err(|error| {
            tracing::warn!(
                certificate.subject = certificate.subject_name(),
                certificate.thumbprint = certificate.thumbprint().as_hex_string(),
                peer.address = bearer.address.map(tracing::field::display),
                reason = %error,
                "The twin rejected a certificate."
            );
            self.record(certificate, der.as_ref(), error, bearer);
            metrics::counter!("twin_certificates_refused_total").increment(1);
            if let Some(events) = self.events.get() {
                events.report_certificate(certificate, error);
            }
            // OPC 10000-4 §6.1.3: the exact cause is for the server's side only.
            Error::new(StatusCode::BadSecurityChecksFailed, "the certificate is not trusted")
        })
    }
}

/// Checks that a current revocation list of the authority exists and does not name the certificate.
fn check_revocation(
    subject: &X509Certificate<'_>,
    authority: &X509Certificate<'_>,
    lists: &[Vec<u8>],
) -> Result<(), CertificateError> {
    let mut is_known = false;
    for list in lists_of(authority, lists) {
        if names(&list, subject) {
            return Err(CertificateError::Revoked);
        }
        is_known |= list.next_update().is_none_or(|next| next >= ASN1Time::now());
    }
    if is_known { Ok(()) } else { Err(CertificateError::RevocationUnknown) }
}

/// The revocation lists that an authority signed.
fn lists_of<'a>(
    authority: &'a X509Certificate<'_>,
    lists: &'a [Vec<u8>],
) -> impl Iterator<Item = CertificateRevocationList<'a>> {
    lists
        .iter()
        .filter_map(|der| Some(CertificateRevocationList::from_der(der).ok()?.1))
        .filter(|list| list.issuer().as_raw() == authority.subject().as_raw())
        .filter(|list| is_signed_by(list, authority))
}

fn names(list: &CertificateRevocationList<'_>, certificate: &X509Certificate<'_>) -> bool {
    list.iter_revoked_certificates().any(|revoked| revoked.raw_serial() == certificate.raw_serial())
}

fn store(folder: &Path, certificate: &X509, der: &[u8]) {
    let path = folder.join(CertificateStore::cert_file_name(certificate));
    if let Err(error) = fs::write(&path, der) {
        tracing::error!(%error, path = %path.display(), "A client's certificate could not be stored.");
    }
}

fn remove(path: &Path) {
    if let Err(error) = fs::remove_file(path) {
        tracing::warn!(%error, path = %path.display(), "An old rejected certificate could not be removed.");
    }
}

#[cfg(test)]
mod tests;
