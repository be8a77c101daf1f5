//! Validation of clients' certificates: trusted one by one, or issued by a trusted authority and not
//! revoked.
//!
//! In the certificate folder, `trusted` contains certificates of clients and of authorities,
//! `issuers` those of authorities that complete chains but are not trusted themselves, `crl` the
//! authorities' revocation lists (DER or PEM), `denied` certificates that an engineer rejected, and `rejected`
//! those that wait for an approval. What is denied stays so, also where its authority is trusted, and however many
//! others wait. OPC 10000-4 §6.1.3 defines the order of the checks.

use std::{
    fs, io,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use opcua_stack::opcua::{
    crypto::{CertificateStore, KeySize, SecurityPolicy, X509},
    server::{CertificateBearer, CertificateValidator},
    types::{Error, StatusCode},
};
use x509_parser::{
    certificate::X509Certificate, error::X509Error, prelude::FromDer,
    revocation_list::CertificateRevocationList, time::ASN1Time,
};

use super::{
    certificate_files::{files, paths},
    issuance::{CHAIN_LENGTH_MAX, certificates_in, is_issued_by, is_revoked, lists_in, lists_of},
    rejected_clients::{ConnectionRejection, RejectedClients, thumbprint},
    trust::{DENIED, ISSUERS, REVOCATION_LISTS, TRUSTED, WAITING},
};
use crate::{certificate_error::CertificateError, clock, error::TwinError, events::EventReporter};

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

    /// Checks whether the bearer may connect at present. Nobody may while a file of the trust list cannot be read: it may
    /// be the one that denies or revokes.
    pub fn check(&self, der: &[u8]) -> Result<(), CertificateError> {
        let (_, leaf) = X509Certificate::from_der(der).map_err(|_| CertificateError::Unreadable)?;
        // First what denies: a certificate that is moved meanwhile is found in one of the folders, or refused.
        if self.items(DENIED, "der", certificates_in)?.iter().any(|denied| denied == der) {
            return Err(CertificateError::Denied);
        }
        let known = self.known_authorities()?;
        let is_trusted = known.trusted.iter().any(|trusted| trusted == der);
        match known.check(&leaf, is_trusted) {
            Err(CertificateError::Unknown) if self.trust_unknown => {
                tracing::warn!(
                    certificate.subject = %shown(&leaf.subject().to_string()),
                    "DEVELOPMENT SETTING: the twin accepts a certificate that nobody approved."
                );
            }
            Err(CertificateError::Unknown) if self.has(WAITING, der)? => {
                return Err(CertificateError::Waiting);
            }
            checked => checked?,
        }
        if !leaf.validity().is_valid() {
            return Err(CertificateError::OutOfTime);
        }
        match leaf.key_usage() {
            Ok(Some(usage)) if !usage.value.digital_signature() => Err(CertificateError::Usage),
            _ => Ok(()),
        }
    }

    fn has(&self, folder: &str, der: &[u8]) -> Result<bool, CertificateError> {
        Ok(self.contents(folder, "der")?.iter().any(|(_, known)| known == der))
    }

    /// Reads the authorities with their revocation lists.
    fn known_authorities(&self) -> Result<KnownAuthorities, CertificateError> {
        let trusted = self.items(TRUSTED, "der", certificates_in)?;
        let issuers = self.items(ISSUERS, "der", certificates_in)?;
        let lists = self.items(REVOCATION_LISTS, "crl", lists_in)?;
        Ok(KnownAuthorities { trusted, issuers, lists })
    }

    /// Returns what the files of a folder hold, as DER. A file with anything else is as good as unreadable.
    fn items(
        &self,
        folder: &str,
        extension: &str,
        items_in: fn(&[u8]) -> Option<Vec<Vec<u8>>>,
    ) -> Result<Vec<Vec<u8>>, CertificateError> {
        let mut items = Vec::new();
        for (path, content) in self.contents(folder, extension)? {
            items.extend(items_in(&content).ok_or_else(|| {
                let source = io::Error::other("the file has other content, neither DER nor PEM");
                unreadable(&TwinError::Pki { path, source })
            })?);
        }
        Ok(items)
    }

    fn contents(
        &self,
        folder: &str,
        extension: &str,
    ) -> Result<Vec<(PathBuf, Vec<u8>)>, CertificateError> {
        files(&self.folder.join(folder), extension).map_err(|error| unreadable(&error))
    }

    /// Stores an unknown certificate for the engineer to approve.
    fn store_rejected(&self, certificate: &X509, der: &[u8]) {
        let folder = self.folder.join(WAITING);
        let Ok(paths) = paths(&folder, "der").inspect_err(|error| {
            tracing::error!(
                error = error as &dyn std::error::Error,
                "A client's certificate could not be stored for its approval."
            );
        }) else {
            return;
        };
        let mut waiting: Vec<_> = paths
            .into_iter()
            .filter_map(|path| Some((path.metadata().ok()?.modified().ok()?, path)))
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
        let is_listed = |folder: &&str| self.has(folder, der).unwrap_or(false);
        if [WAITING, DENIED, TRUSTED].iter().any(is_listed) {
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
                certificate.subject = %shown(&certificate.subject_name()),
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

/// Authorities and their revocation lists, each as DER.
struct KnownAuthorities {
    /// Trusted certificates, those of clients too.
    trusted: Vec<Vec<u8>>,
    /// Authorities that complete chains.
    issuers: Vec<Vec<u8>>,
    lists: Vec<Vec<u8>>,
}

impl KnownAuthorities {
    /// Checks that no authority revoked the certificate or one above it, and, unless it is trusted itself, that its
    /// chain leads to a trusted authority. The trust of a single certificate needs no authority, so a list need not
    /// exist; one that names it is obeyed.
    fn check(&self, leaf: &X509Certificate<'_>, is_trusted: bool) -> Result<(), CertificateError> {
        let (trusted, issuers): (Vec<X509Certificate<'_>>, Vec<X509Certificate<'_>>) =
            (parsed(&self.trusted)?, parsed(&self.issuers)?);
        let lists: Vec<CertificateRevocationList<'_>> = parsed(&self.lists)?;
        let all = [&trusted[..], &issuers[..]].concat();
        if is_revoked(leaf, &all, &lists) {
            return Err(CertificateError::Revoked);
        }
        if is_trusted { Ok(()) } else { follow_chain(leaf, &trusted, &issuers, &lists) }
    }
}

/// Parses all of them: one that was left out may be the one by which a revocation is found.
fn parsed<'d, T: FromDer<'d, X509Error>>(items: &'d [Vec<u8>]) -> Result<Vec<T>, CertificateError> {
    let parse = |der: &'d Vec<u8>| T::from_der(der).map(|(_, item)| item);
    items
        .iter()
        .map(parse)
        .collect::<Result<_, _>>()
        .map_err(|_| CertificateError::TrustListUnreadable)
}

/// Follows the issuers up to a trusted one, each of which needs a current revocation list. That nobody on the way was
/// revoked is checked before.
fn follow_chain(
    leaf: &X509Certificate<'_>,
    trusted: &[X509Certificate<'_>],
    issuers: &[X509Certificate<'_>],
    lists: &[CertificateRevocationList<'_>],
) -> Result<(), CertificateError> {
    let mut subject = leaf;
    for _ in 0..CHAIN_LENGTH_MAX {
        let trusted = trusted.iter().map(|authority| (authority, true));
        let found = trusted
            .chain(issuers.iter().map(|authority| (authority, false)))
            .find(|(authority, _)| is_issued_by(subject, authority));
        let Some((authority, is_trusted)) = found else {
            return Err(CertificateError::Unknown);
        };
        let is_current = |list: &CertificateRevocationList<'_>| {
            list.next_update().is_none_or(|next| next >= ASN1Time::now())
        };
        if !lists_of(authority, lists).any(is_current) {
            return Err(CertificateError::RevocationUnknown);
        }
        if is_trusted {
            return Ok(());
        }
        subject = authority;
    }
    Err(CertificateError::Unknown)
}

/// Reports a file of the trust list that cannot be read: someone has to act.
fn unreadable(error: &TwinError) -> CertificateError {
    tracing::error!(
        error = error as &dyn std::error::Error,
        "The twin rejects clients, since a file of its trust list cannot be read. Make it readable, or remove it."
    );
    CertificateError::TrustListUnreadable
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

/// Longest part of a subject in the log: strangers choose it.
const SUBJECT_CHARS_MAX: usize = 200;

fn shown(subject: &str) -> String {
    subject.chars().take(SUBJECT_CHARS_MAX).collect()
}

#[cfg(test)]
mod tests;
