//! Faults of a certificate that is to be installed for the twin. Pure.

use x509_parser::{certificate::X509Certificate, prelude::FromDer, time::ASN1Time};

use crate::{
    host_names::names_host,
    security::{
        issuance::{CHAIN_LENGTH_MAX, is_issued_by},
        trust::faults,
    },
    trust_fault::TrustFault,
};

/// Properties that the certificate must have.
pub(super) struct Expected<'a> {
    pub application_uri: &'a str,
    pub host_names: &'a [String],
    pub now: ASN1Time,
}

/// Returns all faults of a certificate, given those of authorities.
pub(super) fn faults(
    der: &[u8],
    authorities: &[Vec<u8>],
    expected: &Expected<'_>,
) -> Vec<TrustFault> {
    let leaf = match faults::certificate(der) {
        Ok(leaf) => leaf,
        Err(fault) => return vec![fault],
    };
    let mut found = Vec::new();
    of_validity(&leaf, expected.now, &mut found);
    of_names(&leaf, expected, &mut found);
    of_usage(&leaf, &mut found);
    let authorities: Vec<_> =
        authorities.iter().filter_map(|der| Some(X509Certificate::from_der(der).ok()?.1)).collect();
    found.extend(of_chain(&leaf, &authorities));
    found
}

fn of_validity(leaf: &X509Certificate<'_>, now: ASN1Time, found: &mut Vec<TrustFault>) {
    let validity = leaf.validity();
    if validity.not_after < now {
        found.push(TrustFault::new("EXPIRED", format!("It expired on {}.", validity.not_after)));
    }
    if validity.not_before > now {
        found.push(TrustFault::new(
            "NOT_VALID_YET",
            format!("It is not valid before {}.", validity.not_before),
        ));
    }
}

fn of_names(leaf: &X509Certificate<'_>, expected: &Expected<'_>, found: &mut Vec<TrustFault>) {
    let uri = faults::application_uri(leaf);
    if uri != Some(expected.application_uri) {
        let says =
            uri.map_or_else(|| "no application".to_owned(), |uri| format!("the application {uri}"));
        found.push(TrustFault::new(
            "WRONG_APPLICATION",
            format!(
                "It names {says} among its alternative names, but clients expect {}. The authority has to take the \
                 alternative names over from the request.",
                expected.application_uri
            ),
        ));
    }
    let missing: Vec<&str> = expected
        .host_names
        .iter()
        .map(String::as_str)
        .filter(|host| !names_host(leaf, host))
        .collect();
    if !missing.is_empty() {
        found.push(TrustFault::new(
            "MISSING_HOST_NAME",
            format!(
                "It lacks the host name {}, under which clients reach the twin.",
                missing.join(", ")
            ),
        ));
    }
}

fn of_usage(leaf: &X509Certificate<'_>, found: &mut Vec<TrustFault>) {
    if leaf.is_ca() {
        found.push(TrustFault::new(
            "WRONG_USAGE",
            "It belongs to an authority, not to an application.",
        ));
    }
    if matches!(leaf.key_usage(), Ok(Some(usage)) if !usage.value.digital_signature() || !usage.value.key_encipherment())
    {
        found.push(TrustFault::new(
            "WRONG_USAGE",
            "Its key may not be used for both digital signatures and key encipherment, which OPC UA needs.",
        ));
    }
    if matches!(leaf.extended_key_usage(), Ok(Some(usage)) if !usage.value.server_auth && !usage.value.any)
    {
        found.push(TrustFault::new(
            "WRONG_USAGE",
            "It may not be used by a server (extended key usage serverAuth).",
        ));
    }
}

/// Follows the issuers up to the root.
fn of_chain(leaf: &X509Certificate<'_>, authorities: &[X509Certificate<'_>]) -> Option<TrustFault> {
    if leaf.issuer().as_raw() == leaf.subject().as_raw() {
        return Some(TrustFault::new(
            "SELF_SIGNED",
            "Nobody issued it: it is signed with its own key. The twin makes such certificates by itself.",
        ));
    }
    let mut subject = leaf;
    for _ in 0..=CHAIN_LENGTH_MAX {
        let Some(issuer) = authorities.iter().find(|authority| is_issued_by(subject, authority))
        else {
            return Some(TrustFault::new(
                "UNKNOWN_ISSUER",
                format!(
                    "The authority {} that is to have issued {} is missing, has expired or did not sign it. Give its \
                     certificate, too, up to the root.",
                    subject.issuer(),
                    subject.subject()
                ),
            ));
        };
        if issuer.issuer().as_raw() == issuer.subject().as_raw() {
            return None;
        }
        subject = issuer;
    }
    Some(TrustFault::new(
        "CHAIN_TOO_LONG",
        format!("There are more than {CHAIN_LENGTH_MAX} authorities up to the root."),
    ))
}
