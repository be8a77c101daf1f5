//! The trust list of the OPC UA server and its own certificate.

use opcua_stack::opcua::crypto::PrivateKey;
use serde_json::{Value, json};

use super::Answers;

fn file(kind: &str, content: String) -> Value {
    json!({ "kind": kind, "content": content })
}

pub async fn clients(answers: &mut Answers<'_>) {
    let key = PrivateKey::new(2048).expect("a key").to_der().expect("a key as DER");
    let key = rcgen::KeyPair::try_from(key.as_bytes()).expect("a key");
    let parameters =
        rcgen::CertificateParams::new(vec!["client.plant".to_owned()]).expect("parameters");
    let certificate = parameters.self_signed(&key).expect("a certificate");
    let path = "/client-certificates";
    let body = file("CERTIFICATE", certificate.pem());
    answers.post("addClientCertificate", path, body).await;
    let page = answers.get("listClientCertificates", path).await;
    let thumbprint = page["items"][0]["thumbprint"].as_str().expect("a thumbprint");
    let path = format!("{path}/{thumbprint}");
    answers.put("trustClientCertificate", &path, json!({ "isTrusted": false })).await;
}

/// An authority: its parameters, and its key.
fn authority() -> (rcgen::CertificateParams, rcgen::KeyPair) {
    let mut parameters = rcgen::CertificateParams::default();
    parameters.distinguished_name.push(rcgen::DnType::CommonName, "Plant CA");
    parameters.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
    parameters.key_usages =
        vec![rcgen::KeyUsagePurpose::KeyCertSign, rcgen::KeyUsagePurpose::CrlSign];
    (parameters, rcgen::KeyPair::generate().expect("a key"))
}

pub async fn authorities(answers: &mut Answers<'_>) {
    let (parameters, key) = authority();
    let certificate = parameters.self_signed(&key).expect("a certificate");
    let list = rcgen::CertificateRevocationListParams {
        this_update: rcgen::date_time_ymd(2026, 1, 1),
        next_update: rcgen::date_time_ymd(2096, 1, 1),
        crl_number: 1_u64.into(),
        issuing_distribution_point: None,
        revoked_certs: Vec::new(),
        key_identifier_method: rcgen::KeyIdMethod::Sha256,
    };
    let list = list.signed_by(&rcgen::Issuer::new(parameters, key)).expect("a list");
    let plant = answers.plant;
    plant.post("/client-certificates", file("CERTIFICATE", certificate.pem())).await;
    let list = file("REVOCATION_LIST", list.pem().expect("PEM"));
    plant.post("/client-certificates", list).await;

    let path = "/client-revocation-lists";
    let page = answers.get("listClientRevocationLists", path).await;
    let id = page["items"][0]["revocationListId"].as_str().expect("an id");
    answers.delete("removeClientRevocationList", &format!("{path}/{id}")).await;
    let path = "/client-authorities";
    let page = answers.get("listClientAuthorities", path).await;
    let thumbprint = page["items"][0]["thumbprint"].as_str().expect("a thumbprint");
    answers.delete("removeClientAuthority", &format!("{path}/{thumbprint}")).await;
}

pub async fn application_certificate(answers: &mut Answers<'_>) {
    let path = "/application-certificate";
    answers.get("showApplicationCertificate", path).await;
    let request =
        answers.post("requestApplicationCertificate", &format!("{path}/request"), json!({})).await;
    let request = request["content"].as_str().expect("PEM");

    let (parameters, key) = authority();
    let root = parameters.self_signed(&key).expect("a certificate").pem();
    let mut request = rcgen::CertificateSigningRequestParams::from_pem(request).expect("a request");
    request.params.serial_number = Some(7_u64.into());
    let issuer = rcgen::Issuer::new(parameters, key);
    let issued = request.signed_by(&issuer).expect("issued").pem();
    answers.put("installApplicationCertificate", path, json!({ "content": issued + &root })).await;
}
