//! Denied certificates that come back in another form.

use super::*;

/// Algorithm ECDSA with SHA-256 as the tests' authorities write it, and with parameters, which nobody signs or reads.
const ALGORITHM: [u8; 12] = [0x30, 10, 6, 8, 0x2a, 0x86, 0x48, 0xce, 0x3d, 4, 3, 2];
const WITH_PARAMETERS: [u8; 14] = [0x30, 12, 6, 8, 0x2a, 0x86, 0x48, 0xce, 0x3d, 4, 3, 2, 5, 0];

fn der_of(certificate: &X509) -> Vec<u8> {
    let der = certificate.as_byte_string();
    let bytes: &[u8] = der.as_ref();
    bytes.to_vec()
}

/// Writes a certificate with other bytes around the same signed part and the same signature.
fn written_otherwise(certificate: &X509) -> Vec<u8> {
    let der = der_of(certificate);
    let positions = 0..der.len() - ALGORITHM.len();
    // The last one: the signed part has the same algorithm.
    let at = positions.rev().find(|at| der[*at..].starts_with(&ALGORITHM)).unwrap();
    let content = [&der[4..at], &WITH_PARAMETERS[..], &der[at + ALGORITHM.len()..]].concat();
    assert_eq!(der[..2], [0x30, 0x82], "a sequence with a length of two bytes");
    let length = u16::try_from(content.len()).unwrap().to_be_bytes();
    [&der[..2], &length[..], &content[..]].concat()
}

fn issue_for(authority: &Authority, key: &rcgen::KeyPair, serial: u64) -> X509 {
    let mut params = rcgen::CertificateParams::default();
    params.serial_number = Some(serial.into());
    X509::from_der(params.signed_by(key, &authority.issuer).unwrap().der()).unwrap()
}

/// A folder that trusts an authority, which revoked another certificate.
fn with_authority() -> (Fixture, Authority) {
    let (fixture, authority) = (Fixture::new(false), Authority::new("Plant CA"));
    fixture.list.trust_new(&authority.certificate, "anna").unwrap();
    fixture.list.put_revocation_list(&authority.revoke(8, 2096), "anna").unwrap();
    (fixture, authority)
}

fn deny(fixture: &Fixture, certificate: &X509) {
    fixture.trust(certificate);
    assert!(fixture.list.reject(&thumbprint(certificate), "anna").unwrap());
    assert_eq!(fixture.check(certificate), Err(CertificateError::Denied));
}

#[test]
fn a_denied_certificate_stays_denied_however_it_is_written() {
    let (fixture, authority) = with_authority();
    let client = authority.issue(7);
    let otherwise = written_otherwise(&client);
    assert_ne!(otherwise, der_of(&client));
    assert_eq!(fixture.validator.check(&otherwise), Ok(()), "the signature is as good as before");
    deny(&fixture, &client);
    assert_eq!(fixture.validator.check(&otherwise), Err(CertificateError::Denied));
    // Nor does an approval of the other form lift the denial: it is of the same certificate.
    fs::write(fixture.folder.path().join("trusted/otherwise.der"), &otherwise).unwrap();
    assert_eq!(fixture.validator.check(&otherwise), Err(CertificateError::Denied));
    assert_eq!(fixture.check(&authority.issue(9)), Ok(()), "another client");
}

#[test]
fn an_authority_that_is_denied_completes_no_chain_however_it_is_written() {
    let (fixture, root) = with_authority();
    let plant = root.below("Plant CA 2", 9);
    let client = plant.issue(1);
    let certificate = X509::from_der(&plant.certificate).unwrap();
    fs::write(fixture.folder.path().join("issuers/plant.der"), written_otherwise(&certificate))
        .unwrap();
    fs::write(fixture.folder.path().join("crl/plant.crl"), plant.revoke(8, 2096)).unwrap();
    assert_eq!(fixture.check(&client), Ok(()));
    fs::write(fixture.folder.path().join("denied/plant.der"), &plant.certificate).unwrap();
    assert_eq!(fixture.check(&client), Err(CertificateError::Denied));
}

#[test]
fn a_denied_client_comes_in_by_no_other_certificate_of_its_key_unless_one_trusts_that_itself() {
    let (fixture, authority) = with_authority();
    let key = rcgen::KeyPair::generate().unwrap();
    let (client, renewed) = (issue_for(&authority, &key, 7), issue_for(&authority, &key, 9));
    assert_eq!(fixture.check(&renewed), Ok(()));
    deny(&fixture, &client);
    assert_eq!(fixture.check(&renewed), Err(CertificateError::Denied));
    fixture.trust(&renewed);
    assert_eq!(fixture.check(&renewed), Ok(()), "a person decided about this one");
    assert_eq!(fixture.check(&client), Err(CertificateError::Denied));
    assert_eq!(fixture.check(&authority.issue(10)), Ok(()), "another client");
}

#[test]
fn a_certificate_that_came_in_through_its_authority_is_listed_and_denied_by_itself() {
    let (fixture, authority) = with_authority();
    let (client, other) = (authority.issue(7), authority.issue(9));
    assert_eq!(fixture.check(&client), Ok(()));
    for certificate in [&client, &other] {
        fixture.validator.store_issued(certificate, &der_of(certificate));
    }
    let states = || {
        let listed = fixture.list.list().unwrap();
        listed.into_iter().map(|one| (one.thumbprint, one.state)).collect::<Vec<_>>()
    };
    assert!(states().iter().all(|(_, state)| *state == crate::CertificateState::Issued));
    assert!(fixture.list.reject(&thumbprint(&client), "anna").unwrap());
    assert_eq!(fixture.check(&client), Err(CertificateError::Denied));
    assert_eq!(fixture.check(&other), Ok(()), "its authority is as trusted as before");
    // Stored once more, as by a session that began meanwhile: it is denied, and listed so.
    fixture.validator.store_issued(&client, &der_of(&client));
    let expected = [
        (thumbprint(&client), crate::CertificateState::Denied),
        (thumbprint(&other), crate::CertificateState::Issued),
    ];
    assert_eq!(states(), expected);
    assert_eq!(fixture.check(&client), Err(CertificateError::Denied));
    assert!(fixture.list.trust(&thumbprint(&client), "anna").unwrap());
    assert_eq!(fixture.check(&client), Ok(()));
}

#[test]
fn no_one_comes_in_for_having_come_in_through_an_authority_before() {
    let fixture = Fixture::new(false);
    let client = self_signed();
    fixture.show(&client);
    assert_eq!((fixture.names(WAITING), fixture.names(ISSUED)), (1, 0));
    fixture.validator.store_issued(&client, &der_of(&client));
    assert_eq!((fixture.names(WAITING), fixture.names(ISSUED)), (0, 1), "it waits no longer");
    assert_eq!(fixture.check(&client), Err(CertificateError::Unknown));
    fixture.show(&client);
    assert_eq!((fixture.names(WAITING), fixture.names(ISSUED)), (1, 0), "it waits again");
}

#[test]
fn a_certificate_is_denied_before_its_bearer_ever_came() {
    let (fixture, authority) = with_authority();
    let client = authority.issue(7);
    assert_eq!(fixture.check(&client), Ok(()));
    fixture.list.deny_new(&der_of(&client), "anna").unwrap();
    fixture.list.deny_new(&der_of(&client), "anna").unwrap();
    assert_eq!(fixture.check(&client), Err(CertificateError::Denied));
    assert_eq!(fixture.names(DENIED), 1);
    let trusted = authority.issue(9);
    fixture.trust(&trusted);
    fixture.list.deny_new(&der_of(&trusted), "anna").unwrap();
    assert_eq!(fixture.check(&trusted), Err(CertificateError::Denied));
    assert_eq!((fixture.names(DENIED), fixture.names(TRUSTED)), (2, 1), "the authority's is left");
    fixture.list.deny_new(&authority.revoke(7, 2096), "anna").unwrap_err();
}
