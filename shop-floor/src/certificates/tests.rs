use rcgen::{CertificateParams, Issuer, KeyPair};
use tempfile::TempDir;

use super::*;

/// Certificates whose subject is that of the authority, so that they fit any issuer of this name.
struct Authority {
    issuer: Issuer<'static, KeyPair>,
    certificate: Vec<u8>,
}

impl Authority {
    fn new() -> Self {
        let mut params = CertificateParams::default();
        params.distinguished_name.push(rcgen::DnType::CommonName, "Machines");
        params.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
        params.key_usages =
            vec![rcgen::KeyUsagePurpose::KeyCertSign, rcgen::KeyUsagePurpose::CrlSign];
        let key = KeyPair::generate().expect("a key");
        let certificate = params.self_signed(&key).expect("signed").der().to_vec();
        Self { issuer: Issuer::new(params, key), certificate }
    }

    fn issue(&self, serial: u64, years: std::ops::Range<i32>) -> X509 {
        let key = KeyPair::generate().expect("a key");
        let mut params = CertificateParams::default();
        params.serial_number = Some(serial.into());
        params.not_before = rcgen::date_time_ymd(years.start, 1, 1);
        params.not_after = rcgen::date_time_ymd(years.end, 1, 1);
        let certificate = params.signed_by(&key, &self.issuer).expect("signed");
        X509::from_der(certificate.der()).expect("a certificate")
    }

    fn revoke(&self, serial: u64) -> Vec<u8> {
        let params = rcgen::CertificateRevocationListParams {
            this_update: rcgen::date_time_ymd(2020, 1, 1),
            next_update: rcgen::date_time_ymd(2021, 1, 1),
            crl_number: 1_u64.into(),
            issuing_distribution_point: None,
            revoked_certs: vec![rcgen::RevokedCertParams {
                serial_number: serial.into(),
                revocation_time: rcgen::date_time_ymd(2020, 1, 1),
                reason_code: None,
                invalidity_date: None,
            }],
            key_identifier_method: rcgen::KeyIdMethod::Sha256,
        };
        params.signed_by(&self.issuer).expect("signed").der().to_vec()
    }
}

fn pki() -> (TempDir, PkiDirectory) {
    let folder = tempfile::tempdir().expect("a folder");
    for name in [TRUSTED, REJECTED, ISSUERS, REVOCATION_LISTS] {
        fs::create_dir(folder.path().join(name)).expect("a folder");
    }
    let pki = PkiDirectory::new(&Config::new(folder.path(), "test", "urn:test"));
    (folder, pki)
}

fn examine(pki: &PkiDirectory, certificate: &X509) -> TrustFinding {
    // The first of July 2030.
    let now = DateTime::from_unix_micros(1_909_094_400_000_000);
    pki.examine(certificate, now).expect("the folders are readable")
}

fn approve(pki: &PkiDirectory, certificate: &X509) {
    assert_eq!(examine(pki, certificate), TrustFinding::NotApproved);
    let thumbprint = certificate.thumbprint().as_hex_string();
    pki.set_trust(&thumbprint, TrustState::Trusted).expect("it waits for an approval");
}

#[test]
fn an_approved_certificate_is_trusted_in_its_time_only() {
    let (_folder, pki) = pki();
    let authority = Authority::new();
    for (years, expected) in [
        (2029..2031, TrustFinding::Trusted),
        (2020..2030, TrustFinding::OutOfTime),
        (2031..2040, TrustFinding::OutOfTime),
    ] {
        let certificate = authority.issue(1, years.clone());
        approve(&pki, &certificate);
        assert_eq!(examine(&pki, &certificate), expected, "{years:?}");
    }
}

#[test]
fn an_approved_certificate_that_its_issuer_revoked_is_not_trusted() {
    let (folder, pki) = pki();
    let (authority, namesake) = (Authority::new(), Authority::new());
    let (revoked, other) = (authority.issue(7, 2029..2031), authority.issue(8, 2029..2031));
    for certificate in [&revoked, &other] {
        approve(&pki, certificate);
    }
    let write = |name: &str, bytes: &[u8]| {
        fs::write(folder.path().join(name), bytes).expect("written");
    };
    write("crl/namesake.crl", &namesake.revoke(7));
    write("issuers/namesake.der", &namesake.certificate);
    write("crl/machines.crl", &authority.revoke(7));
    assert_eq!(examine(&pki, &revoked), TrustFinding::Trusted, "its issuer is not known here");
    write("issuers/machines.der", &authority.certificate);
    assert_eq!(examine(&pki, &revoked), TrustFinding::Revoked);
    assert_eq!(examine(&pki, &other), TrustFinding::Trusted);
}

#[test]
fn trust_is_in_the_bytes_and_not_in_the_name_of_a_file() {
    let (folder, pki) = pki();
    let authority = Authority::new();
    let (approved, other) = (authority.issue(1, 2029..2031), authority.issue(2, 2029..2031));
    approve(&pki, &approved);
    // As if both had the same SHA-1 thumbprint, which names the file.
    let name = folder.path().join(TRUSTED).join(CertificateStore::cert_file_name(&other));
    fs::write(name, approved.as_byte_string().as_ref()).expect("written");
    assert_eq!(examine(&pki, &other), TrustFinding::NotApproved);
}
