//! Judging the certificates of clients: trusted one by one, or issued by a trusted authority and
//! not revoked.
//!
//! In the certificate folder, `trusted` holds certificates of clients and of authorities, `issuers`
//! those of authorities that are needed to complete chains but not trusted themselves, `crl` the
//! authorities' revocation lists (DER), and `rejected` what came and waits for an approval. OPC
//! 10000-4 §6.1.3 gives the order of the checks.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use asi_model::DateTime;
use opcua_stack::opcua::{
    crypto::{CertificateStore, KeySize, SecurityPolicy, X509},
    server::{CertificateBearer, CertificateValidator},
    types::{Error, StatusCode},
};
use x509_parser::{
    certificate::X509Certificate, prelude::FromDer, revocation_list::CertificateRevocationList,
    time::ASN1Time,
};

use super::trust::{
    Rejection, RejectionReason,
    knocks::{Knocks, thumbprint},
};
use crate::events::EventReporter;

/// Most authorities between a client's certificate and a trusted one.
pub(crate) const CHAIN_LENGTH_MAX: usize = 5;
/// Most certificates that wait for an approval; the oldest make room, as anybody may send new ones.
const REJECTED_MAX: usize = 200;
/// Longest certificate or revocation list read, in bytes.
pub(crate) const FILE_BYTES_MAX: u64 = 4 * 1024 * 1024;

/// Why a certificate opens no door.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Verdict {
    #[error("it cannot be read")]
    Unreadable,
    #[error("it was rejected and waits for an approval")]
    Rejected,
    #[error("neither it nor its issuer is trusted; it waits for an approval now")]
    Unknown,
    #[error("it is not valid at this time")]
    OutOfTime,
    #[error("its key is too short or too long for the security policy")]
    KeyLength,
    #[error("it may not be used for signing")]
    Usage,
    #[error("its issuer revoked it")]
    Revoked,
    #[error("there is no current revocation list of its issuer in the `crl` folder")]
    RevocationUnknown,
}

impl Verdict {
    const fn reason(self) -> RejectionReason {
        match self {
            Self::Unreadable => RejectionReason::Unreadable,
            Self::Rejected | Self::Unknown => RejectionReason::NotTrusted,
            Self::OutOfTime => RejectionReason::OutOfTime,
            Self::KeyLength => RejectionReason::KeyLength,
            Self::Usage => RejectionReason::Usage,
            Self::Revoked => RejectionReason::Revoked,
            Self::RevocationUnknown => RejectionReason::RevocationUnknown,
        }
    }
}

/// Judges client certificates by the folders.
pub(crate) struct Validator {
    folder: PathBuf,
    knocks: Knocks,
    trust_unknown: bool,
    /// Known once the server is built.
    events: Arc<OnceLock<Arc<EventReporter>>>,
}

impl Validator {
    pub fn new(
        folder: &Path,
        trust_unknown: bool,
        events: Arc<OnceLock<Arc<EventReporter>>>,
    ) -> Self {
        Self { folder: folder.to_owned(), knocks: Knocks::new(folder), trust_unknown, events }
    }

    /// Whether the bearer may come in now.
    fn judge(&self, der: &[u8]) -> Result<(), Verdict> {
        let (_, leaf) = X509Certificate::from_der(der).map_err(|_| Verdict::Unreadable)?;
        if files(&self.folder.join("rejected"), "der").any(|(_, known)| known == der) {
            return Err(Verdict::Rejected);
        }
        let is_trusted_itself =
            files(&self.folder.join("trusted"), "der").any(|(_, known)| known == der);
        if !is_trusted_itself {
            self.follow_chain(&leaf)?;
        }
        if !leaf.validity().is_valid() {
            return Err(Verdict::OutOfTime);
        }
        match leaf.key_usage() {
            Ok(Some(usage)) if !usage.value.digital_signature() => Err(Verdict::Usage),
            _ => Ok(()),
        }
    }

    /// From issuer to issuer until a trusted one, looking at each step whether it was revoked.
    fn follow_chain(&self, leaf: &X509Certificate<'_>) -> Result<(), Verdict> {
        let trusted: Vec<Vec<u8>> =
            files(&self.folder.join("trusted"), "der").map(|(_, der)| der).collect();
        let issuers: Vec<Vec<u8>> =
            files(&self.folder.join("issuers"), "der").map(|(_, der)| der).collect();
        let lists: Vec<Vec<u8>> =
            files(&self.folder.join("crl"), "crl").map(|(_, der)| der).collect();
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
            let Some((authority, is_trusted)) = found else { return Err(Verdict::Unknown) };
            check_revocation(&subject, &authority, &lists)?;
            if is_trusted {
                return Ok(());
            }
            subject = authority;
        }
        Err(Verdict::Unknown)
    }

    /// Keeps an unknown certificate for the engineer to look at.
    fn keep_rejected(&self, certificate: &X509, der: &[u8]) {
        let folder = self.folder.join("rejected");
        let mut waiting: Vec<_> = files(&folder, "der")
            .filter_map(|(path, _)| Some((path.metadata().ok()?.modified().ok()?, path)))
            .collect();
        waiting.sort();
        for (_, oldest) in waiting.iter().take((waiting.len() + 1).saturating_sub(REJECTED_MAX)) {
            if let Ok(gone) = CertificateStore::read_cert(oldest) {
                self.knocks.forget(&thumbprint(&gone));
            }
            remove(oldest);
        }
        store(&folder, certificate, der);
    }

    /// Notes who knocked in vain, for certificates that the engineer finds in the list.
    fn note(
        &self,
        certificate: &X509,
        der: &[u8],
        verdict: Verdict,
        bearer: &CertificateBearer<'_>,
    ) {
        let is_listed =
            |folder: &str| files(&self.folder.join(folder), "der").any(|(_, known)| known == der);
        if is_listed("rejected") || is_listed("trusted") {
            let now = DateTime::from(std::time::SystemTime::now());
            self.knocks.remember(certificate, &Rejection::new(now, verdict.reason(), bearer));
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
        let mut verdict = self.judge(der.as_ref());
        if verdict == Err(Verdict::Unknown) {
            if self.trust_unknown {
                store(&self.folder.join("trusted"), certificate, der.as_ref());
                verdict = self.judge(der.as_ref());
            } else {
                self.keep_rejected(certificate, der.as_ref());
            }
        }
        let fits = certificate
            .public_key()
            .is_ok_and(|key| security_policy.is_valid_keylength(key.bit_length()));
        let verdict = verdict.and(if fits { Ok(()) } else { Err(Verdict::KeyLength) });
        verdict.map_err(|verdict| {
            tracing::warn!(
                certificate.subject = certificate.subject_name(),
                certificate.thumbprint = certificate.thumbprint().as_hex_string(),
                peer.address = bearer.address.map(tracing::field::display),
                reason = %verdict,
                "The twin turned a certificate away."
            );
            self.note(certificate, der.as_ref(), verdict, bearer);
            metrics::counter!("twin_certificates_refused_total").increment(1);
            if let Some(events) = self.events.get() {
                events.report_certificate(certificate, verdict);
            }
            // Part 4 §6.1.3: what exactly is wrong is for the server's side only.
            Error::new(StatusCode::BadSecurityChecksFailed, "the certificate is not trusted")
        })
    }
}

/// Whether an authority issued and signed a certificate, as one that may.
pub(crate) fn is_issued_by(subject: &X509Certificate<'_>, authority: &X509Certificate<'_>) -> bool {
    let is_authority = matches!(authority.basic_constraints(), Ok(Some(constraints)) if constraints.value.ca)
        && !matches!(authority.key_usage(), Ok(Some(usage)) if !usage.value.key_cert_sign());
    is_authority
        && authority.validity().is_valid()
        && subject.issuer().as_raw() == authority.subject().as_raw()
        && subject.verify_signature(Some(authority.public_key())).is_ok()
}

/// Whether an authority signed a revocation list.
pub(crate) fn is_signed_by(
    list: &CertificateRevocationList<'_>,
    authority: &X509Certificate<'_>,
) -> bool {
    list.verify_signature(authority.public_key()).is_ok()
}

/// A certificate that was issued by an authority needs that authority's current word that it still
/// stands.
fn check_revocation(
    subject: &X509Certificate<'_>,
    authority: &X509Certificate<'_>,
    lists: &[Vec<u8>],
) -> Result<(), Verdict> {
    let current = lists
        .iter()
        .filter_map(|der| Some(CertificateRevocationList::from_der(der).ok()?.1))
        .filter(|list| list.issuer().as_raw() == authority.subject().as_raw())
        .filter(|list| list.next_update().is_none_or(|next| next >= ASN1Time::now()))
        .filter(|list| is_signed_by(list, authority));
    let mut is_known = false;
    for list in current {
        is_known = true;
        if list
            .iter_revoked_certificates()
            .any(|revoked| revoked.raw_serial() == subject.raw_serial())
        {
            return Err(Verdict::Revoked);
        }
    }
    if is_known { Ok(()) } else { Err(Verdict::RevocationUnknown) }
}

/// The files of a folder with their content; what cannot be read is left out.
pub(crate) fn files(
    folder: &Path,
    extension: &'static str,
) -> impl Iterator<Item = (PathBuf, Vec<u8>)> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    entries.filter_map(move |entry| {
        let path = entry.ok()?.path();
        let is_wanted = path.extension().is_some_and(|found| found == extension)
            && path.metadata().is_ok_and(|metadata| metadata.len() <= FILE_BYTES_MAX);
        is_wanted.then(|| fs::read(&path).ok()).flatten().map(|content| (path, content))
    })
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
