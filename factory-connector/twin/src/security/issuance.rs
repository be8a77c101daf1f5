//! Signatures and revocation lists of authorities. Pure.

use x509_parser::{
    certificate::X509Certificate, pem::Pem, prelude::FromDer,
    revocation_list::CertificateRevocationList,
};

/// Most authorities between a client's certificate and a trusted one.
pub(crate) const CHAIN_LENGTH_MAX: usize = 5;

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

/// Returns whether a revocation list names a certificate of its issuer.
pub(crate) fn names(
    list: &CertificateRevocationList<'_>,
    certificate: &X509Certificate<'_>,
) -> bool {
    list.iter_revoked_certificates().any(|revoked| revoked.raw_serial() == certificate.raw_serial())
}

/// Returns whether a list that one of the authorities signed names the certificate, or that of an authority above it. Lists
/// that are out of date are obeyed, too: what was revoked stays so. So are lists that none of the authorities signed, where
/// they are of the issuer's name: its authority may be gone from here, and nobody can say that the list is not its own.
pub(crate) fn is_revoked(
    certificate: &X509Certificate<'_>,
    authorities: &[X509Certificate<'_>],
    lists: &[CertificateRevocationList<'_>],
) -> bool {
    let mut level = vec![certificate];
    for _ in 0..=CHAIN_LENGTH_MAX {
        let mut above: Vec<&X509Certificate<'_>> = Vec::new();
        for subject in level {
            let may_be_its_issuers = |list: &CertificateRevocationList<'_>| {
                list.issuer().as_raw() == subject.issuer().as_raw()
                    && names(list, subject)
                    && !is_signed(list, authorities)
            };
            if lists.iter().any(may_be_its_issuers) {
                return true;
            }
            let issuers = authorities.iter().filter(|authority| {
                authority.is_ca()
                    && subject.issuer().as_raw() == authority.subject().as_raw()
                    && subject.verify_signature(Some(authority.public_key())).is_ok()
            });
            for issuer in issuers {
                if lists_of(issuer, lists).any(|list| names(list, subject)) {
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

/// Returns whether one of the authorities signed a revocation list.
fn is_signed(list: &CertificateRevocationList<'_>, authorities: &[X509Certificate<'_>]) -> bool {
    authorities.iter().any(|authority| {
        authority.subject().as_raw() == list.issuer().as_raw() && is_signed_by(list, authority)
    })
}

/// Returns the revocation lists that an authority signed.
pub(crate) fn lists_of<'l, 'a>(
    authority: &'l X509Certificate<'_>,
    lists: &'l [CertificateRevocationList<'a>],
) -> impl Iterator<Item = &'l CertificateRevocationList<'a>> {
    lists
        .iter()
        .filter(|list| list.issuer().as_raw() == authority.subject().as_raw())
        .filter(|list| is_signed_by(list, authority))
}

/// Returns the revocation lists in a file as DER: one in DER, or any number in PEM. `None` where it has none or one that
/// cannot be read.
pub(crate) fn lists_in(content: &[u8]) -> Option<Vec<Vec<u8>>> {
    items_in(content, |der| CertificateRevocationList::from_der(der).is_ok())
}

/// Returns the certificates in a file as DER, likewise.
pub(crate) fn certificates_in(content: &[u8]) -> Option<Vec<Vec<u8>>> {
    items_in(content, |der| X509Certificate::from_der(der).is_ok())
}

fn items_in(content: &[u8], is_item: impl Fn(&[u8]) -> bool) -> Option<Vec<Vec<u8>>> {
    if is_item(content) {
        return Some(vec![content.to_vec()]);
    }
    let blocks = Pem::iter_from_buffer(content).collect::<Result<Vec<_>, _>>().ok()?;
    let items: Vec<_> = blocks.into_iter().map(|block| block.contents).collect();
    (!items.is_empty() && items.iter().all(|item| is_item(item))).then_some(items)
}
