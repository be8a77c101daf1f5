#![allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]

mod chains;
mod denials;

use opcua_stack::opcua::types::ApplicationDescription;
use tempfile::TempDir;

use super::*;
use crate::security::{certificate::prepare_folders, certificate_files::files, trust::TrustList};

/// Change of a folder after which its files cannot be read.
type Damage<'d> = &'d dyn Fn(&Path);

/// An authority with its certificate.
struct Authority {
    issuer: rcgen::Issuer<'static, rcgen::KeyPair>,
    certificate: Vec<u8>,
}

impl Authority {
    fn new(name: &str) -> Self {
        let (params, key) = Self::parameters(name);
        let certificate = params.self_signed(&key).unwrap().der().to_vec();
        Self { issuer: rcgen::Issuer::new(params, key), certificate }
    }

    /// An authority whose certificate this one issued, with a serial number.
    fn below(&self, name: &str, serial: u64) -> Self {
        let (mut params, key) = Self::parameters(name);
        params.serial_number = Some(serial.into());
        let certificate = params.signed_by(&key, &self.issuer).unwrap().der().to_vec();
        Self { issuer: rcgen::Issuer::new(params, key), certificate }
    }

    fn parameters(name: &str) -> (rcgen::CertificateParams, rcgen::KeyPair) {
        let mut params = rcgen::CertificateParams::default();
        params.distinguished_name.push(rcgen::DnType::CommonName, name);
        params.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
        params.key_usages =
            vec![rcgen::KeyUsagePurpose::KeyCertSign, rcgen::KeyUsagePurpose::CrlSign];
        (params, rcgen::KeyPair::generate().unwrap())
    }

    fn issue(&self, serial: u64) -> X509 {
        let key = rcgen::KeyPair::generate().unwrap();
        let mut params = rcgen::CertificateParams::default();
        params.serial_number = Some(serial.into());
        X509::from_der(params.signed_by(&key, &self.issuer).unwrap().der()).unwrap()
    }

    /// A list that names one certificate and is to be replaced at the beginning of a year.
    fn revoke(&self, serial: u64, next_update: i32) -> Vec<u8> {
        self.list(serial, next_update).der().to_vec()
    }

    fn list(&self, serial: u64, next_update: i32) -> rcgen::CertificateRevocationList {
        let params = rcgen::CertificateRevocationListParams {
            this_update: rcgen::date_time_ymd(2020, 1, 1),
            next_update: rcgen::date_time_ymd(next_update, 1, 1),
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
        params.signed_by(&self.issuer).unwrap()
    }
}

fn self_signed() -> X509 {
    let key = rcgen::KeyPair::generate().unwrap();
    X509::from_der(rcgen::CertificateParams::default().self_signed(&key).unwrap().der()).unwrap()
}

struct Fixture {
    folder: TempDir,
    validator: Validator,
    list: TrustList,
}

impl Fixture {
    fn new(trust_unknown: bool) -> Self {
        let folder = tempfile::tempdir().unwrap();
        prepare_folders(folder.path()).unwrap();
        Self::of(folder, trust_unknown)
    }

    fn of(folder: TempDir, trust_unknown: bool) -> Self {
        let validator = Validator::new(folder.path(), trust_unknown, Arc::default());
        let list = TrustList::new(folder.path(), Arc::default(), Arc::default());
        Self { folder, validator, list }
    }

    /// A client shows a certificate. (The keys of these tests are too short for any policy, so that it is never let in.)
    fn show(&self, certificate: &X509) {
        let application = ApplicationDescription::default();
        let bearer = CertificateBearer { address: None, application: &application };
        let policy = SecurityPolicy::Basic256Sha256;
        assert!(self.validator.validate(certificate, policy, &bearer).is_err());
    }

    fn check(&self, certificate: &X509) -> Result<(), CertificateError> {
        self.validator.check(certificate.as_byte_string().as_ref())
    }

    fn trust(&self, certificate: &X509) {
        store(
            &self.folder.path().join(TRUSTED),
            certificate,
            certificate.as_byte_string().as_ref(),
        );
    }

    fn names(&self, folder: &str) -> usize {
        files(&self.folder.path().join(folder), "der").unwrap().len()
    }
}

#[test]
fn a_denied_certificate_stays_denied_however_many_others_come_and_if_its_authority_is_trusted() {
    let fixture = Fixture::new(false);
    let authority = Authority::new("Plant CA");
    let client = authority.issue(7);
    fixture.trust(&client);
    assert_eq!(fixture.check(&client), Ok(()));
    assert!(fixture.list.reject(&thumbprint(&client), "anna").unwrap());
    assert_eq!(fixture.check(&client), Err(CertificateError::Denied));
    for _ in 0..300 {
        fixture.show(&self_signed());
    }
    assert_eq!(fixture.names(WAITING), REJECTED_MAX, "the waiting ones are bounded");
    // Even now that its authority is trusted, and revokes others only.
    fixture.list.trust_new(&authority.certificate, "anna").unwrap();
    fixture.list.put_revocation_list(&authority.revoke(8, 2096), "anna").unwrap();
    assert_eq!(fixture.check(&authority.issue(9)), Ok(()));
    assert_eq!(fixture.check(&client), Err(CertificateError::Denied));
    // Until an engineer trusts it again.
    assert!(fixture.list.trust(&thumbprint(&client), "anna").unwrap());
    assert_eq!(fixture.check(&client), Ok(()));
}

#[test]
fn a_certificate_that_waits_can_be_denied_and_is_let_in_once_its_authority_is_trusted() {
    let fixture = Fixture::new(false);
    let authority = Authority::new("Plant CA");
    let (wanted, unwanted) = (authority.issue(1), authority.issue(2));
    for client in [&wanted, &unwanted] {
        assert_eq!(fixture.check(client), Err(CertificateError::Unknown));
        fixture.show(client);
        assert_eq!(fixture.check(client), Err(CertificateError::Waiting));
    }
    assert!(fixture.list.reject(&thumbprint(&unwanted), "anna").unwrap());
    fixture.list.trust_new(&authority.certificate, "anna").unwrap();
    fixture.list.put_revocation_list(&authority.revoke(8, 2096), "anna").unwrap();
    assert_eq!(fixture.check(&wanted), Ok(()));
    assert_eq!(fixture.check(&unwanted), Err(CertificateError::Denied));
}

#[test]
fn what_a_former_version_rejected_stays_rejected() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("rejected")).unwrap();
    let authority = Authority::new("Plant CA");
    let client = authority.issue(1);
    store(&folder.path().join("rejected"), &client, client.as_byte_string().as_ref());
    prepare_folders(folder.path()).unwrap();
    let fixture = Fixture::of(folder, false);
    fixture.list.trust_new(&authority.certificate, "anna").unwrap();
    fixture.list.put_revocation_list(&authority.revoke(8, 2096), "anna").unwrap();
    assert_eq!(fixture.check(&client), Err(CertificateError::Denied));
    assert_eq!((fixture.names(WAITING), fixture.names(DENIED)), (0, 1));
    // Only once: what waits later is not denied by a restart.
    fixture.show(&self_signed());
    prepare_folders(fixture.folder.path()).unwrap();
    assert_eq!((fixture.names(WAITING), fixture.names(DENIED)), (1, 1));
}

#[test]
fn development_trust_leaves_nothing_behind() {
    let fixture = Fixture::new(true);
    let client = self_signed();
    fixture.show(&client);
    assert_eq!(fixture.check(&client), Ok(()));
    assert_eq!((fixture.names(TRUSTED), fixture.names(WAITING)), (0, 0));
    let fixture = Fixture::of(fixture.folder, false);
    assert_eq!(fixture.check(&client), Err(CertificateError::Unknown));

    // Nor does it trust what an engineer denied.
    fixture.trust(&client);
    assert!(fixture.list.reject(&thumbprint(&client), "anna").unwrap());
    let fixture = Fixture::of(fixture.folder, true);
    assert_eq!(fixture.check(&client), Err(CertificateError::Denied));
}

#[test]
fn a_certificate_that_was_trusted_without_a_person_is_marked_until_one_approves_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join(TRUSTED)).unwrap();
    let (client, other) = (self_signed(), self_signed());
    store(&folder.path().join(TRUSTED), &client, client.as_byte_string().as_ref());
    prepare_folders(folder.path()).unwrap();
    let fixture = Fixture::of(folder, false);
    let list = &fixture.list;
    let unapproved = || {
        let found = list.unapproved().unwrap();
        found.into_iter().map(|one| one.thumbprint).collect::<Vec<_>>()
    };
    assert_eq!(unapproved(), [thumbprint(&client)]);
    assert_eq!(fixture.check(&client), Ok(()), "it goes on until a person decides");
    assert!(list.trust(&thumbprint(&client), "anna").unwrap());
    assert!(unapproved().is_empty());
    let approval = list.list().unwrap()[0].approval.clone().unwrap();
    assert_eq!(approval.by, "anna");
    assert!(list.trust(&thumbprint(&client), "eva").unwrap(), "again");
    assert_eq!(list.list().unwrap()[0].approval.clone(), Some(approval), "of the first one");

    // One that waited has it from the beginning.
    fixture.show(&other);
    assert!(list.trust(&thumbprint(&other), "anna").unwrap());
    assert!(unapproved().is_empty());
    // An approval ends with the trust: the file, moved back by hand, has none.
    assert!(list.reject(&thumbprint(&other), "anna").unwrap());
    for (denied, _) in files(&fixture.folder.path().join(DENIED), "der").unwrap() {
        fs::remove_file(denied).unwrap();
    }
    fixture.trust(&other);
    assert_eq!(unapproved(), [thumbprint(&other)]);
}

#[test]
fn a_revoked_certificate_is_refused_though_it_is_trusted_itself() {
    let fixture = Fixture::new(false);
    let (authority, namesake) = (Authority::new("Plant CA"), Authority::new("Plant CA"));
    let (client, other) = (authority.issue(7), authority.issue(8));
    for certificate in [&client, &other] {
        fixture.trust(certificate);
    }
    let crl = |name: &str, list: Vec<u8>| {
        fs::write(fixture.folder.path().join("crl").join(name), list).unwrap();
    };
    assert_eq!(fixture.check(&client), Ok(()), "it needs no list");
    crl("namesake.crl", namesake.revoke(7, 2096));
    assert_eq!(
        fixture.check(&client),
        Err(CertificateError::Revoked),
        "no authority is known that signed the list, so it may be the issuer's"
    );
    fixture.list.add_issuer(&namesake.certificate, "anna").unwrap();
    assert_eq!(fixture.check(&client), Ok(()), "an authority of the same name did not issue it");
    crl("plant.crl", authority.revoke(7, 2021));
    assert_eq!(fixture.check(&client), Err(CertificateError::Revoked), "nobody else signed it");
    assert_eq!(fixture.check(&other), Ok(()), "no list names it");
    fixture.list.add_issuer(&authority.certificate, "anna").unwrap();
    assert_eq!(fixture.check(&client), Err(CertificateError::Revoked), "the list is out of date");
    assert_eq!(fixture.check(&other), Ok(()), "it needs no list of its own");
}

#[test]
fn revocation_lists_and_denied_certificates_are_obeyed_in_pem() {
    let fixture = Fixture::new(false);
    let authority = Authority::new("Plant CA");
    let client = authority.issue(7);
    fixture.trust(&client);
    fixture.list.add_issuer(&authority.certificate, "anna").unwrap();
    let path = fixture.folder.path().join("crl/plant.crl");
    let blocks = [8, 7].map(|serial| authority.list(serial, 2096).pem().unwrap());
    fs::write(&path, &blocks[0]).unwrap();
    assert_eq!(fixture.check(&client), Ok(()));
    fs::write(&path, blocks.concat()).unwrap();
    assert_eq!(fixture.check(&client), Err(CertificateError::Revoked));
    assert_eq!(fixture.list.revocation_lists().unwrap().len(), 2, "both are listed");
    fs::remove_file(&path).unwrap();

    let key = rcgen::KeyPair::generate().unwrap();
    let denied = rcgen::CertificateParams::default().self_signed(&key).unwrap();
    let certificate = X509::from_der(denied.der()).unwrap();
    fixture.trust(&certificate);
    fs::write(fixture.folder.path().join("denied/by-hand.der"), denied.pem()).unwrap();
    assert_eq!(fixture.check(&certificate), Err(CertificateError::Denied));
}

#[test]
fn a_damaged_issuer_lets_nobody_in_and_one_in_pem_is_found() {
    let fixture = Fixture::new(false);
    let key = rcgen::KeyPair::generate().unwrap();
    let (params, _) = Authority::parameters("Plant CA");
    let certificate = params.self_signed(&key).unwrap();
    let (der, pem) = (certificate.der().to_vec(), certificate.pem());
    let authority = Authority { issuer: rcgen::Issuer::new(params, key), certificate: der.clone() };
    let client = authority.issue(7);
    fixture.trust(&client);
    fs::write(fixture.folder.path().join("crl/plant.crl"), authority.revoke(7, 2096)).unwrap();
    for folder in [ISSUERS, TRUSTED] {
        let path = fixture.folder.path().join(folder).join("plant.der");
        for (content, expected) in [
            (&der[..der.len() / 2], CertificateError::TrustListUnreadable),
            (pem.as_bytes(), CertificateError::Revoked),
            (&der[..], CertificateError::Revoked),
        ] {
            fs::write(&path, content).unwrap();
            assert_eq!(fixture.check(&client), Err(expected), "{folder}");
        }
        fs::remove_file(&path).unwrap();
        assert_eq!(
            fixture.check(&client),
            Err(CertificateError::Revoked),
            "the list is obeyed, though no authority is known that signed it"
        );
    }
}

#[test]
fn nobody_is_let_in_while_it_is_not_known_who_is_denied_or_revoked() {
    let write = |path: &Path, bytes: &[u8]| fs::write(path, bytes).unwrap();
    let too_long = vec![0; 5 << 20];
    let cases: [(&str, Damage<'_>); 8] = [
        ("a list that is too long", &|pki| write(&pki.join("crl/long.crl"), &too_long)),
        ("a denied certificate that is too long", &|pki| {
            write(&pki.join("denied/long.der"), &too_long);
        }),
        ("a folder in place of a list", &|pki| fs::create_dir(pki.join("crl/x.crl")).unwrap()),
        ("a folder in place of a denied certificate", &|pki| {
            fs::create_dir(pki.join("denied/x.der")).unwrap();
        }),
        ("a file that is no list", &|pki| write(&pki.join("crl/text.crl"), b"no list")),
        ("a file that is no certificate", &|pki| write(&pki.join("denied/text.der"), b"none")),
        ("a file in place of the folder of denied ones", &|pki| {
            fs::remove_dir(pki.join("denied")).unwrap();
            write(&pki.join("denied"), b"no folder");
        }),
        ("a file in place of the folder of lists", &|pki| {
            fs::remove_dir(pki.join("crl")).unwrap();
            write(&pki.join("crl"), b"no folder");
        }),
    ];
    for (case, spoil) in cases {
        let fixture = Fixture::new(false);
        let client = self_signed();
        fixture.trust(&client);
        assert_eq!(fixture.check(&client), Ok(()));
        spoil(fixture.folder.path());
        assert_eq!(fixture.check(&client), Err(CertificateError::TrustListUnreadable), "{case}");
        fixture.show(&client);
        let shown = fixture.validator.rejected_clients.last(&thumbprint(&client));
        assert_eq!(
            shown.map(|rejection| rejection.reason),
            Some(crate::RejectionReason::TrustListUnreadable),
            "{case}"
        );
    }
    let fixture = Fixture::new(false);
    let client = self_signed();
    fixture.trust(&client);
    for name in [DENIED, ISSUERS, REVOCATION_LISTS] {
        fs::remove_dir(fixture.folder.path().join(name)).unwrap();
    }
    assert_eq!(fixture.check(&client), Ok(()), "a missing folder is empty");
}
