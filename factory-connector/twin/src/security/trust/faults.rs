//! Faults of a file that is to be added to the trust list, all at once. Pure.

use opcua_stack::opcua::crypto::X509;
use x509_parser::{
    certificate::X509Certificate, extensions::GeneralName, prelude::FromDer,
    revocation_list::CertificateRevocationList, time::ASN1Time,
};

use crate::{security::issuance::is_signed_by, trust_fault::TrustFault};

/// Sizes of a client's RSA key in bits that the security policies accept.
const KEY_BITS: std::ops::RangeInclusive<usize> = 2048..=4096;

/// Returns the application of a certificate: the URI among its alternative names (OPC 10000-6
/// §6.2.2).
pub(crate) fn application_uri<'a>(certificate: &'a X509Certificate<'_>) -> Option<&'a str> {
    let names = certificate.subject_alternative_name().ok().flatten()?;
    names.value.general_names.iter().find_map(|name| match name {
        GeneralName::URI(uri) => Some(*uri),
        _ => None,
    })
}

/// Returns whether a certificate is an authority's: it may issue others and names no application.
pub(crate) fn is_authority(certificate: &X509Certificate<'_>) -> bool {
    certificate.is_ca() && application_uri(certificate).is_none()
}

pub(crate) fn certificate(der: &[u8]) -> Result<X509Certificate<'_>, TrustFault> {
    match X509Certificate::from_der(der) {
        Ok(([], certificate)) => Ok(certificate),
        _ if CertificateRevocationList::from_der(der).is_ok() => Err(TrustFault::new(
            "NOT_A_CERTIFICATE",
            "This is a revocation list, not a certificate. Choose that kind instead.",
        )),
        _ => Err(TrustFault::new(
            "NOT_A_CERTIFICATE",
            "These bytes are no certificate (X.509, in PEM or DER).",
        )),
    }
}

/// Returns the faults for which a client's certificate would be rejected though it is trusted.
pub(crate) fn of_client(
    der: &[u8],
    certificate: &X509Certificate<'_>,
    now: ASN1Time,
) -> Vec<TrustFault> {
    let mut faults = Vec::new();
    faults.extend(expired(certificate, now));
    if matches!(certificate.key_usage(), Ok(Some(usage)) if !usage.value.digital_signature()) {
        faults.push(TrustFault::new(
            "WRONG_USAGE",
            "Its key may not be used for digital signatures, without which no client can connect.",
        ));
    }
    let bits = X509::from_der(der).ok().and_then(|certificate| certificate.key_length().ok());
    if bits.is_none_or(|bits| !KEY_BITS.contains(&bits)) {
        let found = bits
            .map_or_else(|| "no RSA key".to_owned(), |bits| format!("an RSA key of {bits} bits"));
        faults.push(TrustFault::new(
            "WRONG_KEY",
            format!("It has {found}; the security policies of the twin need RSA keys of 2048 to 4096 bits."),
        ));
    }
    faults
}

/// Returns the faults for which a certificate cannot be an authority's.
pub(crate) fn of_authority(certificate: &X509Certificate<'_>, now: ASN1Time) -> Vec<TrustFault> {
    let mut faults = Vec::new();
    if !certificate.is_ca() {
        faults.push(TrustFault::new(
            "NOT_AN_AUTHORITY",
            "It does not belong to an authority: its basic constraints do not say so. Add it as a client's certificate.",
        ));
    }
    if matches!(certificate.key_usage(), Ok(Some(usage)) if !usage.value.key_cert_sign()) {
        faults
            .push(TrustFault::new("WRONG_USAGE", "Its key may not be used to sign certificates."));
    }
    faults.extend(expired(certificate, now));
    faults
}

/// Parses a revocation list.
pub(crate) fn revocation_list(der: &[u8]) -> Result<CertificateRevocationList<'_>, TrustFault> {
    match CertificateRevocationList::from_der(der) {
        Ok(([], list)) => Ok(list),
        _ if X509Certificate::from_der(der).is_ok() => Err(TrustFault::new(
            "NOT_A_REVOCATION_LIST",
            "This is a certificate, not a revocation list. Choose another kind.",
        )),
        _ => Err(TrustFault::new(
            "NOT_A_REVOCATION_LIST",
            "These bytes are no revocation list (X.509, in PEM or DER).",
        )),
    }
}

/// Returns the faults for which a revocation list cannot be used, given the authorities and lists
/// of the trust list.
pub(crate) fn of_revocation_list(
    list: &CertificateRevocationList<'_>,
    authorities: &[X509Certificate<'_>],
    known: &[CertificateRevocationList<'_>],
    now: ASN1Time,
) -> Vec<TrustFault> {
    let mut faults = Vec::new();
    let issuer = list.issuer();
    let same_name: Vec<_> =
        authorities.iter().filter(|one| one.subject().as_raw() == issuer.as_raw()).collect();
    let signer = same_name.iter().find(|authority| is_signed_by(list, authority));
    if same_name.is_empty() {
        faults.push(TrustFault::new(
            "UNKNOWN_ISSUER",
            format!(
                "It is of the authority {issuer}, which is not known here. Add that authority's certificate first."
            ),
        ));
    } else if signer.is_none() {
        faults.push(TrustFault::new(
            "WRONG_SIGNATURE",
            format!("It names the authority {issuer}, but is not signed with the key of that authority's certificate."),
        ));
    }
    if let Some(next) = list.next_update().filter(|next| *next < now) {
        faults.push(TrustFault::new(
            "OUTDATED",
            format!("It was to be replaced by {next}. Get the authority's current list."),
        ));
    }
    let newest = signer.and_then(|authority| {
        let lists = known
            .iter()
            .filter(|one| one.issuer().as_raw() == issuer.as_raw() && is_signed_by(one, authority));
        lists.map(CertificateRevocationList::last_update).max()
    });
    if let Some(newest) = newest.filter(|newest| *newest > list.last_update()) {
        faults.push(TrustFault::new(
            "OLDER_THAN_KNOWN",
            format!(
                "It is of {}, older than the list that is here, of {newest}.",
                list.last_update()
            ),
        ));
    }
    faults
}

fn expired(certificate: &X509Certificate<'_>, now: ASN1Time) -> Option<TrustFault> {
    let end = certificate.validity().not_after;
    (end < now).then(|| TrustFault::new("EXPIRED", format!("It expired on {end}.")))
}
