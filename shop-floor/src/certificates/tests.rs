use rcgen::{CertificateParams, Issuer, KeyPair};
use tempfile::TempDir;

use super::*;

/// Change of a folder after which its files cannot be read.
type Damage<'d> = &'d dyn Fn(&Path);

/// Certificates whose subject is that of the authority, so that they fit any issuer of this name.
struct Authority {
    issuer: Issuer<'static, KeyPair>,
    certificate: Vec<u8>,
}

impl Authority {
    fn new() -> Self {
        let (params, key) = Self::parameters("Machines");
        let certificate = params.self_signed(&key).expect("signed").der().to_vec();
        Self { issuer: Issuer::new(params, key), certificate }
    }

    /// An authority whose certificate another one issued, with this serial number.
    fn below(&self, serial: u64) -> Self {
        let (mut params, key) = Self::parameters("Line");
        params.serial_number = Some(serial.into());
        let certificate = params.signed_by(&key, &self.issuer).expect("signed").der().to_vec();
        Self { issuer: Issuer::new(params, key), certificate }
    }

    fn parameters(name: &str) -> (CertificateParams, KeyPair) {
        let mut params = CertificateParams::default();
        params.distinguished_name.push(rcgen::DnType::CommonName, name);
        params.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
        params.key_usages =
            vec![rcgen::KeyUsagePurpose::KeyCertSign, rcgen::KeyUsagePurpose::CrlSign];
        (params, KeyPair::generate().expect("a key"))
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
        self.list(serial).der().to_vec()
    }

    fn list(&self, serial: u64) -> rcgen::CertificateRevocationList {
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
        params.signed_by(&self.issuer).expect("signed")
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
    assert_eq!(examine(&pki, &revoked), TrustFinding::Trusted, "an authority of the same name");
    write("crl/machines.crl", &authority.revoke(7));
    assert_eq!(
        examine(&pki, &revoked),
        TrustFinding::Revoked,
        "though its issuer is not known here"
    );
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

#[test]
fn a_certificate_whose_authority_was_revoked_by_the_one_above_is_not_trusted() {
    let (folder, pki) = pki();
    let root = Authority::new();
    let line = root.below(9);
    let certificate = line.issue(1, 2029..2031);
    approve(&pki, &certificate);
    let write = |name: &str, bytes: &[u8]| {
        fs::write(folder.path().join(name), bytes).expect("written");
    };
    write("issuers/line.der", &line.certificate);
    write("issuers/root.der", &root.certificate);
    write("crl/root.crl", &root.revoke(8));
    assert_eq!(examine(&pki, &certificate), TrustFinding::Trusted);
    write("crl/root.crl", &root.revoke(9));
    assert_eq!(examine(&pki, &certificate), TrustFinding::Revoked);
}

#[test]
fn a_revocation_list_is_obeyed_in_pem_and_however_many_files_there_are() {
    let (folder, pki) = pki();
    let authority = Authority::new();
    let certificate = authority.issue(7, 2029..2031);
    approve(&pki, &certificate);
    let write = |name: &str, bytes: &[u8]| {
        fs::write(folder.path().join(name), bytes).expect("written");
    };
    write("issuers/machines.der", &authority.certificate);
    let other = authority.revoke(8);
    for number in 0..CERTIFICATES_MAX {
        write(&format!("crl/{number:04}.crl"), &other);
    }
    assert_eq!(examine(&pki, &certificate), TrustFinding::Trusted);
    let blocks = [8, 7].map(|serial| authority.list(serial).pem().expect("PEM")).concat();
    write("crl/z.crl", blocks.as_bytes());
    assert_eq!(examine(&pki, &certificate), TrustFinding::Revoked);
}

#[test]
fn no_certificate_is_trusted_while_it_is_not_known_what_is_revoked() {
    let authority = Authority::new();
    let too_long = vec![0; 5 << 20];
    let write = |path: &Path, bytes: &[u8]| fs::write(path, bytes).expect("written");
    let cases: [(&str, Damage<'_>); 6] = [
        ("a list that is too long", &|pki| write(&pki.join("crl/long.crl"), &too_long)),
        ("a folder in place of a list", &|pki| {
            fs::create_dir(pki.join("crl/folder.crl")).expect("a folder");
        }),
        ("a file that is no list", &|pki| write(&pki.join("crl/text.crl"), b"no list")),
        ("a file in place of the folder of lists", &|pki| {
            fs::remove_dir(pki.join("crl")).expect("removed");
            write(&pki.join("crl"), b"no folder");
        }),
        ("an authority that cannot be read", &|pki| {
            fs::create_dir(pki.join("issuers/folder.der")).expect("a folder");
        }),
        ("a file in place of the folder of authorities", &|pki| {
            fs::remove_dir(pki.join("issuers")).expect("removed");
            write(&pki.join("issuers"), b"no folder");
        }),
    ];
    for (case, spoil) in cases {
        let (folder, pki) = pki();
        let certificate = authority.issue(7, 2029..2031);
        approve(&pki, &certificate);
        spoil(folder.path());
        let now = DateTime::from_unix_micros(1_909_094_400_000_000);
        let found = pki.examine(&certificate, now);
        assert!(matches!(found, Err(ShopFloorError::Certificates(_))), "{case}: {found:?}");
    }
    let (folder, pki) = pki();
    let certificate = authority.issue(7, 2029..2031);
    approve(&pki, &certificate);
    for name in [ISSUERS, REVOCATION_LISTS] {
        fs::remove_dir(folder.path().join(name)).expect("removed");
    }
    assert_eq!(examine(&pki, &certificate), TrustFinding::Trusted, "a missing folder is empty");
}
