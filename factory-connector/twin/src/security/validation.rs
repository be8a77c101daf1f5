//! Validation of clients' certificates: trusted one by one, or issued by a trusted authority and not
//! revoked.
//!
//! In the certificate folder, `trusted` contains certificates of clients and of authorities,
//! `issuers` those of authorities that complete chains but are not trusted themselves, `crl` the
//! authorities' revocation lists (DER or PEM), `denied` certificates that an engineer rejected, `rejected`
//! those that wait for an approval, and `issued` those that came in through an authority, so that an engineer can deny
//! one of them by itself; nobody is let in for being there. What is denied stays so, also where its authority is trusted, however many others
//! wait, and however its bearer writes it: it is known by its signed part. Nor does another certificate of the same key
//! come in through an authority; an engineer can trust that one itself. OPC 10000-4 §6.1.3 defines the order of the checks.

mod authorities;
mod denials;

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
use parking_lot::Mutex;
use tokio::runtime::{Handle, RuntimeFlavor};
use x509_parser::{certificate::X509Certificate, prelude::FromDer};

use super::{
    certificate_files::{paths, read},
    issuance::{certificates_in, lists_in},
    known_folders::{Items, KnownFolder},
    rejected_clients::{ConnectionRejection, RejectedClients, thumbprint},
    trust::{DENIED, ISSUED, ISSUERS, REVOCATION_LISTS, TRUSTED, WAITING},
};
use crate::{certificate_error::CertificateError, clock, error::TwinError, events::EventReporter};

use authorities::{KnownAuthorities, Sources, TrustedBy};

/// Most certificates that wait for an approval. Beyond, the oldest are removed: any client may send
/// new ones.
const REJECTED_MAX: usize = 200;
/// Most certificates kept that came in through an authority. Beyond, those that came first are removed, and are there
/// again with their next session.
const ISSUED_MAX: usize = 1000;

/// Validates client certificates by the folders.
pub(crate) struct Validator {
    folder: PathBuf,
    denied: KnownFolder,
    trusted: KnownFolder,
    issuers: KnownFolder,
    lists: KnownFolder,
    /// Made of the four folders as they were read last.
    known: Mutex<Option<Arc<KnownAuthorities>>>,
    rejected_clients: RejectedClients,
    trust_unknown: bool,
    /// Set once the server is built.
    events: Arc<OnceLock<Arc<EventReporter>>>,
}

impl Validator {
    /// Creates a validator that looks at the folder at every connection, and reads what has changed.
    pub fn new(
        folder: &Path,
        trust_unknown: bool,
        events: Arc<OnceLock<Arc<EventReporter>>>,
    ) -> Self {
        let certificates = |name| KnownFolder::new(folder.join(name), "der", certificates_in);
        Self {
            denied: certificates(DENIED),
            trusted: certificates(TRUSTED),
            issuers: certificates(ISSUERS),
            lists: KnownFolder::new(folder.join(REVOCATION_LISTS), "crl", lists_in),
            known: Mutex::default(),
            folder: folder.to_owned(),
            rejected_clients: RejectedClients::new(folder),
            trust_unknown,
            events,
        }
    }

    /// Checks whether the bearer may connect at present. Nobody may while a file of the trust list cannot be read: it may
    /// be the one that denies or revokes.
    pub fn check(&self, der: &[u8]) -> Result<(), CertificateError> {
        self.checked(der).map(drop)
    }

    fn checked(&self, der: &[u8]) -> Result<TrustedBy, CertificateError> {
        let (_, leaf) = X509Certificate::from_der(der).map_err(|_| CertificateError::Unreadable)?;
        // First what denies: a certificate that is moved meanwhile is found in one of the folders, or refused.
        let denied = items(&self.denied)?;
        let trusted_by = match self.known_authorities(denied)?.check(&leaf) {
            Err(CertificateError::Unknown) if self.trust_unknown => {
                tracing::warn!(
                    certificate.subject = %shown(&leaf.subject().to_string()),
                    "DEVELOPMENT SETTING: the twin accepts a certificate that nobody approved."
                );
                TrustedBy::Setting
            }
            Err(CertificateError::Unknown) if self.is_in(WAITING, der) => {
                return Err(CertificateError::Waiting);
            }
            checked => checked?,
        };
        if !leaf.validity().is_valid() {
            return Err(CertificateError::OutOfTime);
        }
        match leaf.key_usage() {
            Ok(Some(usage)) if !usage.value.digital_signature() => Err(CertificateError::Usage),
            _ => Ok(trusted_by),
        }
    }

    /// Returns true if a folder has the certificate under the name by which the twin stores it: strangers fill these
    /// folders, so none is read as a whole.
    fn is_in(&self, folder: &str, der: &[u8]) -> bool {
        X509::from_der(der).is_ok_and(|certificate| {
            let name = CertificateStore::cert_file_name(&certificate);
            read(&self.folder.join(folder).join(name)).is_ok_and(|known| known == der)
        })
    }

    /// Returns the authorities with their revocation lists, the same ones until a file changes.
    fn known_authorities(&self, denied: Items) -> Result<Arc<KnownAuthorities>, CertificateError> {
        let trusted = items(&self.trusted)?;
        let issuers = items(&self.issuers)?;
        let lists = items(&self.lists)?;
        let sources = Sources { denied, trusted, issuers, lists };
        // Other connections wait while they are made.
        let mut known = self.known.lock();
        if let Some(known) = known.as_ref().filter(|known| known.are_of(&sources)) {
            return Ok(Arc::clone(known));
        }
        let made = KnownAuthorities::new(sources).ok_or(CertificateError::TrustListUnreadable)?;
        Ok(Arc::clone(known.insert(Arc::new(made))))
    }

    /// Stores an unknown certificate for the engineer to approve.
    fn store_rejected(&self, certificate: &X509, der: &[u8]) {
        // It may have come in before, through an authority that is trusted no longer.
        self.remove_from(ISSUED, certificate, der);
        self.store_among(WAITING, REJECTED_MAX, certificate, der);
    }

    /// Stores a certificate that was let in through its authority, for the engineer to see and to deny.
    fn store_issued(&self, certificate: &X509, der: &[u8]) {
        if !self.is_in(ISSUED, der) {
            self.remove_from(WAITING, certificate, der);
            self.rejected_clients.forget(&thumbprint(certificate));
            self.store_among(ISSUED, ISSUED_MAX, certificate, der);
        }
    }

    fn remove_from(&self, folder: &str, certificate: &X509, der: &[u8]) {
        if self.is_in(folder, der) {
            let name = CertificateStore::cert_file_name(certificate);
            remove(&self.folder.join(folder).join(name));
        }
    }

    /// Stores a certificate in a folder, in place of the oldest where there is the most it may have.
    fn store_among(&self, folder: &str, count_max: usize, certificate: &X509, der: &[u8]) {
        let folder = self.folder.join(folder);
        let Ok(paths) = paths(&folder, "der").inspect_err(|error| {
            tracing::error!(
                error = error as &dyn std::error::Error,
                "A client's certificate could not be stored for the engineer to see."
            );
        }) else {
            return;
        };
        let mut stored: Vec<_> = paths
            .into_iter()
            .filter_map(|path| Some((path.metadata().ok()?.modified().ok()?, path)))
            .collect();
        stored.sort();
        for (_, oldest) in stored.iter().take((stored.len() + 1).saturating_sub(count_max)) {
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
        let has = |folder: &KnownFolder| {
            folder.items().is_ok_and(|items| items.iter().any(|known| known == der))
        };
        let is_listed = self.is_in(WAITING, der) || self.is_in(ISSUED, der);
        if is_listed || has(&self.denied) || has(&self.trusted) {
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
        off_the_runtime(|| self.validate_now(certificate, security_policy, bearer))
    }
}

impl Validator {
    fn validate_now(
        &self,
        certificate: &X509,
        security_policy: SecurityPolicy,
        bearer: &CertificateBearer<'_>,
    ) -> Result<(), Error> {
        let der = certificate.as_byte_string();
        let result = self.checked(der.as_ref());
        if result == Err(CertificateError::Unknown) {
            self.store_rejected(certificate, der.as_ref());
        }
        let fits = certificate
            .public_key()
            .is_ok_and(|key| security_policy.is_valid_keylength(key.bit_length()));
        let result =
            result.and_then(|by| if fits { Ok(by) } else { Err(CertificateError::KeyLength) });
        if result == Ok(TrustedBy::Authority) {
            self.store_issued(certificate, der.as_ref());
        }
        result.map(drop).map_err(|error| {
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

/// Does work that may read files while the other tasks of this thread go on elsewhere, where there is an elsewhere.
fn off_the_runtime<T>(work: impl FnOnce() -> T) -> T {
    match Handle::try_current().map(|runtime| runtime.runtime_flavor()) {
        Ok(RuntimeFlavor::MultiThread) => tokio::task::block_in_place(work),
        _ => work(),
    }
}

fn items(folder: &KnownFolder) -> Result<Items, CertificateError> {
    folder.items().map_err(|error| unreadable(&error))
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
