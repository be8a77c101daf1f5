//! Revocation lists of authorities. Pure.

use x509_parser::{
    certificate::X509Certificate, pem::Pem, prelude::FromDer,
    revocation_list::CertificateRevocationList,
};

/// Most authorities above a certificate that are looked at, one above the other.
const CHAIN_LENGTH_MAX: usize = 5;

/// Returns the revocation lists in a file as DER: one in DER, or any number in PEM. `None` where it has none or one that
/// cannot be read.
pub(super) fn lists_in(content: &[u8]) -> Option<Vec<Vec<u8>>> {
    if is_list(content) {
        return Some(vec![content.to_vec()]);
    }
    let blocks = Pem::iter_from_buffer(content).collect::<Result<Vec<_>, _>>().ok()?;
    let lists: Vec<_> = blocks.into_iter().map(|block| block.contents).collect();
    (!lists.is_empty() && lists.iter().all(|list| is_list(list))).then_some(lists)
}

fn is_list(der: &[u8]) -> bool {
    CertificateRevocationList::from_der(der).is_ok()
}

/// Returns whether a list that one of the authorities signed names a certificate that it issued: the one given, or that of
/// an authority above it. A list that is out of date is obeyed, too: what was revoked stays so. So is one that none of the
/// authorities signed, where it is of the issuer's name: its authority may be gone from here.
pub(super) fn is_revoked(der: &[u8], authorities: &[Vec<u8>], lists: &[Vec<u8>]) -> bool {
    let Ok((_, certificate)) = X509Certificate::from_der(der) else { return false };
    let authorities: Vec<X509Certificate<'_>> = authorities
        .iter()
        .filter_map(|der| Some(X509Certificate::from_der(der).ok()?.1))
        .filter(|one| one.is_ca())
        .collect();
    let lists: Vec<CertificateRevocationList<'_>> = lists
        .iter()
        .filter_map(|der| Some(CertificateRevocationList::from_der(der).ok()?.1))
        .collect();
    let mut level = vec![&certificate];
    for _ in 0..=CHAIN_LENGTH_MAX {
        let mut above: Vec<&X509Certificate<'_>> = Vec::new();
        for subject in level {
            let is_of_issuer = |list: &&CertificateRevocationList<'_>| {
                list.issuer().as_raw() == subject.issuer().as_raw() && has(list, subject)
            };
            if lists.iter().filter(is_of_issuer).any(|list| !is_signed(list, &authorities)) {
                return true;
            }
            for issuer in authorities.iter().filter(|one| is_issuer(one, subject)) {
                if lists.iter().any(|list| names(list, subject, issuer)) {
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

fn is_issuer(authority: &X509Certificate<'_>, subject: &X509Certificate<'_>) -> bool {
    authority.subject().as_raw() == subject.issuer().as_raw()
        && subject.verify_signature(Some(authority.public_key())).is_ok()
}

/// Returns whether the list is the issuer's and names the certificate.
fn names(
    list: &CertificateRevocationList<'_>,
    certificate: &X509Certificate<'_>,
    issuer: &X509Certificate<'_>,
) -> bool {
    list.issuer().as_raw() == issuer.subject().as_raw()
        && has(list, certificate)
        && list.verify_signature(issuer.public_key()).is_ok()
}

/// Returns whether the list has the certificate's number.
fn has(list: &CertificateRevocationList<'_>, certificate: &X509Certificate<'_>) -> bool {
    list.iter_revoked_certificates().any(|revoked| revoked.raw_serial() == certificate.raw_serial())
}

/// Returns whether one of the authorities signed the list.
fn is_signed(list: &CertificateRevocationList<'_>, authorities: &[X509Certificate<'_>]) -> bool {
    authorities.iter().any(|authority| {
        authority.subject().as_raw() == list.issuer().as_raw()
            && list.verify_signature(authority.public_key()).is_ok()
    })
}
