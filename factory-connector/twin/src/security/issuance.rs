//! Signatures of authorities. Pure.

use x509_parser::{certificate::X509Certificate, revocation_list::CertificateRevocationList};

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
