//! Authorities of the trust list with their revocation lists, as the folders have them at a time.

use std::sync::Arc;

use x509_parser::certificate::X509Certificate;

use super::denials::Denials;
use crate::{
    certificate_error::CertificateError,
    security::{
        issuance::{
            CHAIN_LENGTH_MAX, KnownCertificate, KnownList, is_issued_by, is_revoked, lists_of,
            namesakes_of_the_issuer,
        },
        known_folders::Items,
    },
};

/// Contents of the folders of which authorities and lists are made.
pub(super) struct Sources {
    pub denied: Items,
    /// Trusted certificates, those of clients too.
    pub trusted: Items,
    /// Authorities that complete chains.
    pub issuers: Items,
    pub lists: Items,
}

impl Sources {
    /// Returns true where nothing was read again.
    fn are(&self, others: &Self) -> bool {
        [&self.denied, &self.trusted, &self.issuers, &self.lists]
            .into_iter()
            .zip([&others.denied, &others.trusted, &others.issuers, &others.lists])
            .all(|(one, other)| Arc::ptr_eq(one, other))
    }
}

/// Source of the trust in a certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TrustedBy {
    /// An engineer trusts it itself.
    Itself,
    /// An engineer trusts an authority that issued it.
    Authority,
    /// A development setting, which lets in what nobody approved.
    Setting,
}

/// Authorities and their revocation lists.
pub(super) struct KnownAuthorities {
    sources: Sources,
    /// The trusted ones first.
    certificates: Vec<KnownCertificate>,
    lists: Vec<KnownList>,
    denials: Denials,
}

impl KnownAuthorities {
    /// Reads all of them: one that was left out may be the one by which a revocation is found. `None` where one cannot be
    /// read.
    pub fn new(sources: Sources) -> Option<Self> {
        let files = sources.trusted.iter().chain(sources.issuers.iter());
        let certificates =
            files.map(|der| KnownCertificate::new(der)).collect::<Option<Vec<_>>>()?;
        let lists = sources.lists.iter().map(|der| KnownList::new(der, &certificates));
        let lists = lists.collect::<Option<Vec<_>>>()?;
        let denials = Denials::new(&sources.denied)?;
        Some(Self { sources, certificates, lists, denials })
    }

    /// Returns true if these were made of the same reading of all folders.
    pub fn are_of(&self, sources: &Sources) -> bool {
        self.sources.are(sources)
    }

    /// Checks that nobody denied the certificate, that no authority revoked it or one above it, and, unless it is trusted
    /// itself, that its chain leads to a trusted authority. The trust of a single certificate needs no authority, so a list
    /// need not exist; one that names it is obeyed.
    pub fn check(&self, leaf: &X509Certificate<'_>) -> Result<TrustedBy, CertificateError> {
        if self.is_denied(leaf) {
            return Err(CertificateError::Denied);
        }
        if is_revoked(leaf, &self.certificates, &self.lists) {
            return Err(CertificateError::Revoked);
        }
        if self.is_trusted(leaf) {
            return Ok(TrustedBy::Itself);
        }
        self.follow_chain(leaf).map(|()| TrustedBy::Authority)
    }

    /// Follows the issuers up to a trusted one, each of which needs a current revocation list. What is denied takes part
    /// in no chain. That nobody on the way was revoked is checked before.
    fn follow_chain(&self, leaf: &X509Certificate<'_>) -> Result<(), CertificateError> {
        let mut subject = leaf.clone();
        for _ in 0..CHAIN_LENGTH_MAX {
            let (denied, others): (Vec<_>, Vec<_>) =
                namesakes_of_the_issuer(&subject, &self.certificates)
                    .map(KnownCertificate::parsed)
                    .filter(|authority| is_issued_by(&subject, authority))
                    .partition(|authority| self.is_denied(authority));
            let Some(authority) = others.into_iter().next() else {
                return Err(if denied.is_empty() {
                    CertificateError::Unknown
                } else {
                    CertificateError::Denied
                });
            };
            if !lists_of(&authority, &self.lists).any(KnownList::is_current) {
                return Err(CertificateError::RevocationUnknown);
            }
            if self.is_trusted(&authority) {
                return Ok(());
            }
            subject = authority;
        }
        Err(CertificateError::Unknown)
    }

    /// Returns true for what an engineer denied, and for any other certificate of such a key, unless it is trusted itself:
    /// who renewed a certificate was not asked whether its bearer is to come in.
    fn is_denied(&self, certificate: &X509Certificate<'_>) -> bool {
        self.denials.have(certificate)
            || self.denials.have_key_of(certificate) && !self.is_trusted(certificate)
    }

    /// Returns true for one that an engineer trusts, byte for byte.
    fn is_trusted(&self, certificate: &X509Certificate<'_>) -> bool {
        self.sources.trusted.iter().any(|der| der == certificate.as_raw())
    }
}
