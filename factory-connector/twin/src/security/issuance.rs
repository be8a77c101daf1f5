//! Signatures and revocation lists of authorities. Pure.

use std::collections::HashSet;

use x509_parser::{
    certificate::X509Certificate, pem::Pem, prelude::FromDer,
    revocation_list::CertificateRevocationList, time::ASN1Time,
};

/// Most authorities between a client's certificate and a trusted one.
pub(crate) const CHAIN_LENGTH_MAX: usize = 5;

/// Certificate in the trust list, read only where it is looked for by its name.
pub(crate) struct KnownCertificate {
    der: Vec<u8>,
    subject: Vec<u8>,
}

impl KnownCertificate {
    /// Takes a certificate; `None` for anything else.
    pub fn new(der: &[u8]) -> Option<Self> {
        let (_, parsed) = X509Certificate::from_der(der).ok()?;
        Some(Self { der: der.to_vec(), subject: parsed.subject().as_raw().to_vec() })
    }

    /// Reads it again.
    pub fn parsed(&self) -> X509Certificate<'_> {
        X509Certificate::from_der(&self.der).expect("it was read before").1
    }
}

/// Revocation list as far as checks need it: read once, and its signature verified once.
pub(crate) struct KnownList {
    issuer: Vec<u8>,
    next_update: Option<ASN1Time>,
    revoked: HashSet<Vec<u8>>,
    /// The authorities that signed it, as DER.
    signers: Vec<Vec<u8>>,
}

impl KnownList {
    /// Takes a list; `None` for anything else.
    pub fn new(der: &[u8], authorities: &[KnownCertificate]) -> Option<Self> {
        let (_, list) = CertificateRevocationList::from_der(der).ok()?;
        let issuer = list.issuer().as_raw().to_vec();
        let serials = list.iter_revoked_certificates().map(|revoked| revoked.raw_serial().to_vec());
        let signers = authorities
            .iter()
            .filter(|one| one.subject == issuer && is_signed_by(&list, &one.parsed()))
            .map(|one| one.der.clone());
        Some(Self {
            next_update: list.next_update(),
            revoked: serials.collect(),
            signers: signers.collect(),
            issuer,
        })
    }

    /// Returns whether the list names a certificate of its issuer.
    fn names(&self, certificate: &X509Certificate<'_>) -> bool {
        self.revoked.contains(certificate.raw_serial())
    }

    /// Returns whether no newer list is due yet.
    pub fn is_current(&self) -> bool {
        self.next_update.is_none_or(|next| next >= ASN1Time::now())
    }
}

/// Returns whether a valid authority issued and signed a certificate.
pub(crate) fn is_issued_by(subject: &X509Certificate<'_>, authority: &X509Certificate<'_>) -> bool {
    let is_authority = matches!(authority.basic_constraints(), Ok(Some(constraints)) if constraints.value.ca)
        && !matches!(authority.key_usage(), Ok(Some(usage)) if !usage.value.key_cert_sign());
    is_authority
        && authority.validity().is_valid()
        && subject.issuer().as_raw() == authority.subject().as_raw()
        && subject.verify_signature(Some(authority.public_key())).is_ok()
}

/// Returns whether an authority signed a revocation list.
pub(crate) fn is_signed_by(
    list: &CertificateRevocationList<'_>,
    authority: &X509Certificate<'_>,
) -> bool {
    list.verify_signature(authority.public_key()).is_ok()
}

/// Returns whether a list that one of the authorities signed names the certificate, or that of an authority above it. Lists
/// that are out of date are obeyed, too: what was revoked stays so. So are lists that none of the authorities signed, where
/// they are of the issuer's name: its authority may be gone from here, and nobody can say that the list is not its own.
pub(crate) fn is_revoked(
    certificate: &X509Certificate<'_>,
    authorities: &[KnownCertificate],
    lists: &[KnownList],
) -> bool {
    let mut level = vec![certificate.clone()];
    for _ in 0..=CHAIN_LENGTH_MAX {
        let mut above: Vec<X509Certificate<'_>> = Vec::new();
        for subject in &level {
            let may_be_its_issuers = |list: &KnownList| {
                list.issuer == subject.issuer().as_raw()
                    && list.names(subject)
                    && list.signers.is_empty()
            };
            if lists.iter().any(may_be_its_issuers) {
                return true;
            }
            let issuers = namesakes_of_the_issuer(subject, authorities)
                .map(KnownCertificate::parsed)
                .filter(|authority| {
                    authority.is_ca()
                        && subject.verify_signature(Some(authority.public_key())).is_ok()
                });
            for issuer in issuers {
                if lists_of(&issuer, lists).any(|list| list.names(subject)) {
                    return true;
                }
                let is_new = !above.iter().any(|known| known.as_raw() == issuer.as_raw());
                if is_new && issuer.as_raw() != subject.as_raw() {
                    above.push(issuer);
                }
            }
        }
        level = above;
    }
    false
}

/// Returns the certificates with the name of a certificate's issuer.
pub(crate) fn namesakes_of_the_issuer<'k>(
    subject: &X509Certificate<'_>,
    known: &'k [KnownCertificate],
) -> impl Iterator<Item = &'k KnownCertificate> {
    let name = subject.issuer().as_raw();
    known.iter().filter(move |one| one.subject == name)
}

/// Returns the revocation lists that an authority signed.
pub(crate) fn lists_of<'l>(
    authority: &X509Certificate<'_>,
    lists: &'l [KnownList],
) -> impl Iterator<Item = &'l KnownList> {
    let signer = authority.as_raw();
    lists.iter().filter(move |list| list.signers.iter().any(|one| one == signer))
}

/// Finds the certificates or the lists in the content of a file.
pub(crate) type ItemsIn = fn(&[u8]) -> Option<Vec<Vec<u8>>>;

/// Returns the revocation lists in a file as DER: one in DER, or any number in PEM. `None` where it has none or one that
/// cannot be read.
pub(crate) fn lists_in(content: &[u8]) -> Option<Vec<Vec<u8>>> {
    items_in(content, |der| {
        Some(CertificateRevocationList::from_der(der).ok()?.1.as_raw().to_vec())
    })
}

/// Returns the certificates in a file as DER, likewise.
pub(crate) fn certificates_in(content: &[u8]) -> Option<Vec<Vec<u8>>> {
    items_in(content, |der| Some(X509Certificate::from_der(der).ok()?.1.as_raw().to_vec()))
}

/// Returns the items without what may follow them: they are compared byte by byte.
fn items_in(content: &[u8], item: impl Fn(&[u8]) -> Option<Vec<u8>>) -> Option<Vec<Vec<u8>>> {
    if let Some(whole) = item(content) {
        return Some(vec![whole]);
    }
    let blocks = Pem::iter_from_buffer(content).collect::<Result<Vec<_>, _>>().ok()?;
    let items = blocks.iter().map(|block| item(&block.contents)).collect::<Option<Vec<_>>>()?;
    (!items.is_empty()).then_some(items)
}
