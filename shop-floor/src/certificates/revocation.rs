//! Revocation lists of authorities. Pure.

use x509_parser::{
    certificate::X509Certificate, prelude::FromDer, revocation_list::CertificateRevocationList,
};

/// Returns whether a list that one of the authorities signed names a certificate that it issued. A list that is out of
/// date is obeyed, too: what was revoked stays so.
pub(super) fn is_revoked(der: &[u8], authorities: &[Vec<u8>], lists: &[Vec<u8>]) -> bool {
    let Ok((_, certificate)) = X509Certificate::from_der(der) else { return false };
    let issuers: Vec<X509Certificate<'_>> = authorities
        .iter()
        .filter_map(|der| Some(X509Certificate::from_der(der).ok()?.1))
        .filter(|one| one.is_ca() && one.subject().as_raw() == certificate.issuer().as_raw())
        .filter(|one| certificate.verify_signature(Some(one.public_key())).is_ok())
        .collect();
    lists
        .iter()
        .filter_map(|der| Some(CertificateRevocationList::from_der(der).ok()?.1))
        .filter(|list| list.issuer().as_raw() == certificate.issuer().as_raw())
        .filter(|list| {
            list.iter_revoked_certificates()
                .any(|revoked| revoked.raw_serial() == certificate.raw_serial())
        })
        .any(|list| issuers.iter().any(|one| list.verify_signature(one.public_key()).is_ok()))
}
