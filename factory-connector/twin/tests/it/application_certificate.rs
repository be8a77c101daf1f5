//! Application certificate issued by an authority: requested, checked, and installed during sessions.

use std::path::Path;

use asi_model::FactoryId;
use opcua_stack::opcua::types::ObjectTypeId;
use testkit::wait::eventually;
use twin::{ApplicationCertificate, InstalledCertificate, RequestedSubject, TwinConfig, TwinError};
use x509_parser::{certificate::X509Certificate, prelude::FromDer as _};

use crate::{
    audit::{FIELDS, another_than, next_of, shown},
    authority::Authority,
    changes::events,
    harness::{DEADLINE, TestTwin, document, message},
};

/// Issues a certificate for a request.
fn issue(authority: &Authority, request: &str) -> String {
    issue_other(authority, request, |_| {})
}

/// Issues a certificate that differs from the request.
fn issue_other(
    authority: &Authority,
    request: &str,
    adjust: impl FnOnce(&mut rcgen::CertificateParams),
) -> String {
    let mut request = rcgen::CertificateSigningRequestParams::from_pem(request).unwrap();
    request.params.serial_number = Some(7_u64.into());
    adjust(&mut request.params);
    request.signed_by(&authority.issuer).unwrap().pem()
}

/// Returns the folder of a connector before its first start.
fn offline() -> (tempfile::TempDir, ApplicationCertificate) {
    let folder = tempfile::tempdir().unwrap();
    let config = TwinConfig {
        pki_directory: folder.path().to_owned(),
        host_names: vec!["press.plant".to_owned(), "10.0.0.7".to_owned()],
        ..TwinConfig::default()
    };
    let own = ApplicationCertificate::new(&FactoryId::new("FOR_MUC").unwrap(), config);
    (folder, own)
}

fn codes(result: Result<InstalledCertificate, TwinError>) -> Vec<&'static str> {
    match result {
        Err(TwinError::Refused { faults }) => faults.into_iter().map(|fault| fault.code).collect(),
        other => panic!("it should be refused, not {other:?}"),
    }
}

fn public_key(der: &[u8]) -> Vec<u8> {
    X509Certificate::from_der(der).unwrap().1.public_key().raw.to_vec()
}

fn certificate_der(folder: &Path) -> Vec<u8> {
    std::fs::read(folder.join("own/cert.der")).unwrap()
}

#[test]
fn a_request_names_application_and_hosts_and_never_the_key() {
    let (folder, own) = offline();
    let authority = Authority::new("Plant CA");
    let wanted = RequestedSubject {
        organization: Some("Plant Ltd".to_owned()),
        ..RequestedSubject::default()
    };
    let request = own.request(&wanted).unwrap();
    assert!(
        request.starts_with("-----BEGIN CERTIFICATE REQUEST-----") && !request.contains("PRIVATE"),
        "{request}"
    );
    let parsed = rcgen::CertificateSigningRequestParams::from_pem(&request).unwrap().params;
    let names: Vec<String> =
        parsed.subject_alt_names.iter().map(|name| format!("{name:?}")).collect();
    assert_eq!(names.len(), 3, "{names:?}");
    for (name, part) in names.iter().zip(["urn:verbund:twin:FOR_MUC", "press.plant", "10.0.0.7"]) {
        assert!(name.contains(part), "{names:?}");
    }
    assert!(format!("{:?}", parsed.distinguished_name).contains("Plant Ltd"));

    // The key is that of the certificate which is there, unless a new one was asked for.
    let requested = |request: &str| {
        let (_, block) =
            x509_parser::pem::parse_x509_pem(issue(&authority, request).as_bytes()).unwrap();
        public_key(&block.contents)
    };
    let present = public_key(&certificate_der(folder.path()));
    assert_eq!(requested(&request), present);
    let new = own.request(&RequestedSubject { with_new_key: true, ..wanted }).unwrap();
    assert_ne!(requested(&new), present);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        let mode = std::fs::metadata(folder.path().join("private/requested.pem"))
            .unwrap()
            .permissions()
            .mode();
        assert_eq!(mode & 0o777, 0o600);
    }
}

#[test]
fn a_certificate_is_refused_with_all_its_faults() {
    let (folder, own) = offline();
    let (plant, stranger) = (Authority::new("Plant CA"), Authority::new("Plant CA"));
    let request = own.request(&RequestedSubject::default()).unwrap();
    let before = own.show().unwrap();
    assert!(before.is_self_signed);
    let with_root = |issued: String| format!("{issued}{}", plant.pem).into_bytes();
    let install = |content: Vec<u8>| codes(own.install(&content, "anna"));

    assert_eq!(install(b"nonsense".to_vec()), ["NOT_A_CERTIFICATE"]);
    assert_eq!(install(request.clone().into_bytes()), ["NOT_ISSUED"]);
    let key = rcgen::KeyPair::generate().unwrap();
    assert_eq!(install(with_root(key.serialize_pem())), ["PRIVATE_KEY"]);
    assert_eq!(install(plant.pem.clone().into_bytes()), ["WRONG_KEY"]);
    let (_other_folder, other) = offline();
    let others = issue(&plant, &other.request(&RequestedSubject::default()).unwrap());
    assert_eq!(install(with_root(others)), ["WRONG_KEY"]);
    assert_eq!(install(issue(&plant, &request).into_bytes()), ["UNKNOWN_ISSUER"], "no chain");
    assert_eq!(
        install(with_root(issue(&stranger, &request))),
        ["UNKNOWN_ISSUER"],
        "one of the same name"
    );
    let wrong = issue_other(&plant, &request, |params| {
        params.not_after = rcgen::date_time_ymd(2020, 1, 1);
        params.subject_alt_names = vec![rcgen::SanType::DnsName("press.plant".try_into().unwrap())];
        params.key_usages = vec![rcgen::KeyUsagePurpose::DigitalSignature];
        params.extended_key_usages = vec![rcgen::ExtendedKeyUsagePurpose::ClientAuth];
    });
    assert_eq!(
        install(wrong.into_bytes()),
        [
            "EXPIRED",
            "WRONG_APPLICATION",
            "MISSING_HOST_NAME",
            "WRONG_USAGE",
            "WRONG_USAGE",
            "UNKNOWN_ISSUER"
        ]
    );
    assert_eq!(install(certificate_der(folder.path())), ["SELF_SIGNED"]);
    assert_eq!(own.show().unwrap(), before, "nothing was changed");

    // After all of this the right one is taken.
    let installed = own.install(&with_root(issue(&plant, &request)), "anna").unwrap();
    assert_eq!((installed.issuer.as_str(), installed.is_self_signed), ("CN=Plant CA", false));
    assert_eq!(installed.host_names, ["press.plant", "10.0.0.7"]);
    assert_eq!(own.show().unwrap(), installed);
    assert!(!folder.path().join("private/requested.pem").exists());
}

#[tokio::test]
async fn an_issued_certificate_is_used_from_the_next_connection_on_and_after_a_restart() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let before = twin.client("vera").await;
    let old = shown(&before);
    let anna = twin.client("anna").await;
    let mut heard = events(&anna, ObjectTypeId::AuditEventType, &FIELDS).await;

    // As the command line does it, beside the running twin; the authority is known to the trust
    // list.
    let config = TwinConfig {
        pki_directory: twin.folder.path().join("pki"),
        listen: "127.0.0.1:0".parse().unwrap(),
        ..TwinConfig::default()
    };
    let own = ApplicationCertificate::new(&FactoryId::new("FOR_MUC").unwrap(), config);
    let plant = Authority::new("Plant CA");
    twin.handle.trust_list().add_issuer(&plant.certificate, "anna").unwrap();
    let request = own
        .request(&RequestedSubject { with_new_key: true, ..RequestedSubject::default() })
        .unwrap();
    let installed = own.install(issue(&plant, &request).as_bytes(), "anna").unwrap();
    let updated = next_of(&mut heard, ObjectTypeId::CertificateUpdatedAuditEventType).await;
    assert_eq!(updated[1], "Method/UpdateCertificate".into());

    let new = eventually("the certificate is used", DEADLINE, || async {
        assert!(before.read("net#Revision").await.status().is_good(), "open sessions go on");
        another_than(&old, &twin).await
    });
    let new = new.await.unwrap();
    assert_eq!(new, certificate_der(&twin.folder.path().join("pki")));
    assert_eq!(twin.handle.application_certificate().show().unwrap(), installed);
    before.close().await;
    anna.close().await;

    // A restart keeps it, and so does one with a further host name, which only an authority can
    // add.
    let pki = twin.folder.path().join("pki");
    let _folder = twin.stop_but_keep().await;
    for host_names in
        [vec!["127.0.0.1".to_owned()], vec!["127.0.0.1".to_owned(), "press.plant".to_owned()]]
    {
        let again = TestTwin::start_with(|config| {
            config.pki_directory.clone_from(&pki);
            config.host_names = host_names;
        })
        .await;
        assert_eq!(certificate_der(&pki), new);
        again.stop().await;
    }
}
