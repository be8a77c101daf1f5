//! Clients of the OPC UA server: users of the pages, with certificates that an engineer trusts.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use base64::{Engine as _, engine::general_purpose::STANDARD};
use factory_connector::{
    clock::now,
    store::{Role, Store, User},
};
use opcua_stack::{
    limits,
    opcua::{
        client::{ClientBuilder, IdentityToken, Session},
        crypto::SecurityPolicy,
        types::{
            AttributeId, MessageSecurityMode, NodeId, ReadValueId, StatusCode, TimestampsToReturn,
            UserTokenPolicy, VariableId,
        },
    },
};
use reqwest::Method;
use serde_json::{Value, json};

use crate::plant::Plant;

/// Signs in at the twin.
pub async fn sign_in(
    url: &str,
    pki: PathBuf,
    user: &str,
    password: &str,
) -> Result<Arc<Session>, StatusCode> {
    let builder = ClientBuilder::new()
        .application_name("line planner")
        .application_uri("urn:verbund:test:client")
        .pki_dir(pki)
        .create_sample_keypair(true)
        .trust_server_certs(true)
        .session_retry_limit(0);
    let mut client = limits::raise_client(builder).client().expect("a client");
    let policy = SecurityPolicy::Basic256Sha256;
    let endpoint =
        (url, policy.to_str(), MessageSecurityMode::SignAndEncrypt, UserTokenPolicy::anonymous());
    let connected = client
        .connect_to_matching_endpoint(endpoint, IdentityToken::new_user_name(user, password))
        .await;
    let (session, event_loop) = connected.map_err(|error| error.status())?;
    let mut events = event_loop.spawn();
    tokio::select! {
        is_connected = session.wait_for_connection() => {
            if is_connected { Ok(session) } else { Err(events.await.expect("it ends well")) }
        }
        ended = &mut events => Err(ended.expect("it ends well")),
    }
}

pub async fn read_state(session: &Session) -> Result<(), StatusCode> {
    let node_id: NodeId = VariableId::Server_ServerStatus_State.into();
    let wanted =
        ReadValueId { node_id, attribute_id: AttributeId::Value as u32, ..ReadValueId::default() };
    session
        .read(&[wanted], TimestampsToReturn::Both, 0.0)
        .await
        .map(drop)
        .map_err(|error| error.status())
}

/// Longest time that an answer of the server may take.
const ANSWER_MAX: Duration = Duration::from_secs(10);

/// Waits until a session is no longer good for anything.
async fn ends(session: &Session) {
    let has_ended = || async {
        match tokio::time::timeout(ANSWER_MAX, read_state(session)).await {
            Ok(Ok(())) => Err("it is good".to_owned()),
            Ok(Err(_)) => Ok(()),
            Err(_) => Err("no answer".to_owned()),
        }
    };
    let ended = testkit::wait::eventually("the session ends", Duration::from_secs(30), has_ended);
    ended.await.expect("it ends");
}

pub async fn endpoint(plant: &Plant) -> String {
    plant.get("/status").await["twin"]["endpointUrl"].as_str().expect("an address").to_owned()
}

async fn password_hash(plant: &Plant, user: &str) -> String {
    let mut session = Store::connect(&plant.data_directory()).await.expect("a store");
    session.users().lookup(user).await.expect("read").expect("a user").password_hash
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn people_sign_in_at_the_twin_until_their_password_changes() {
    let plant = Plant::start(json!([{ "name": "progressStatus", "type": 9 }])).await;
    let url = endpoint(&plant).await;
    let folder = tempfile::tempdir().expect("a folder");
    let pki = || folder.path().join("client");
    plant.put("/users/otto", json!({ "role": "OPERATOR", "password": "otto at machine 7" })).await;
    let hash = password_hash(&plant, "otto").await;
    assert!(hash.starts_with("$argon2id$v=19$") && !hash.contains("otto at machine 7"), "{hash}");

    // A rejected client waits for an approval, and is identified by name and address.
    let refused = sign_in(&url, pki(), "otto", "otto at machine 7").await.err();
    assert_eq!(refused, Some(StatusCode::BadSecurityChecksFailed));
    let waiting = plant.get("/client-certificates").await["items"][0].clone();
    assert_eq!(
        (&waiting["state"], &waiting["rejectionReason"]),
        (&json!("REJECTED"), &json!("NOT_TRUSTED"))
    );
    assert_eq!(waiting["rejectedApplicationName"], "line planner");
    assert_eq!(
        (&waiting["rejectedAddress"], waiting["rejectedAt"].is_string()),
        (&json!("127.0.0.1"), true)
    );
    let path =
        format!("/client-certificates/{}", waiting["thumbprint"].as_str().expect("a thumbprint"));
    let trusted = plant.put(&path, json!({ "isTrusted": true })).await;
    assert_eq!((&trusted["state"], &trusted["rejectedAt"]), (&json!("TRUSTED"), &Value::Null));
    assert_eq!(trusted["approvedBy"], "engineer");

    let session =
        sign_in(&url, pki(), "otto", "otto at machine 7").await.expect("otto may come in");
    read_state(&session).await.expect("and look");
    // A new password by the page ends the session, and the old password is good for nothing.
    plant.put("/users/otto", json!({ "role": "OPERATOR", "password": "otto's new secret" })).await;
    ends(&session).await;
    let refused = sign_in(&url, pki(), "otto", "otto at machine 7").await.err();
    assert_eq!(refused, Some(StatusCode::BadIdentityTokenRejected));

    // So does one by the command line, which only writes to the store.
    let session =
        sign_in(&url, pki(), "otto", "otto's new secret").await.expect("otto may come in");
    let page = plant.signed_in("otto", "otto's new secret").await.expect("at the pages, too");
    let mut store = Store::connect(&plant.data_directory()).await.expect("a store");
    let password_hash = password_hash(&plant, "engineer").await;
    let otto = User { user_name: "otto".to_owned(), role: Role::Operator, password_hash };
    store.users().put(&otto, now()).await.expect("written");
    assert_eq!(page.call(Method::GET, "/session", None).await.0, 401);
    ends(&session).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn people_see_and_end_their_sessions_at_the_opc_ua_server() {
    let plant = Plant::start(json!([{ "name": "progressStatus", "type": 9 }])).await;
    let url = endpoint(&plant).await;
    let folder = tempfile::tempdir().expect("a folder");
    let password = "otto at machine 7";
    plant.put("/users/otto", json!({ "role": "OPERATOR", "password": password })).await;
    let at_twin = || sign_in(&url, folder.path().join("client"), "otto", password);
    assert!(at_twin().await.is_err(), "the client waits for its approval");
    let waiting = plant.get("/client-certificates").await["items"][0]["thumbprint"].clone();
    let path = format!("/client-certificates/{}", waiting.as_str().expect("a thumbprint"));
    plant.put(&path, json!({ "isTrusted": true })).await;
    let first = at_twin().await.expect("otto may come in");
    let second = at_twin().await.expect("otto may come in");
    let otto = plant.signed_in("otto", password).await.expect("at the pages, too");

    let of_kind = |list: &Value, kind: &str| -> Vec<Value> {
        let items = list["items"].as_array().expect("a list");
        items.iter().filter(|one| one["kind"] == kind).cloned().collect()
    };
    let list = otto.get("/sessions").await;
    let pages = of_kind(&list, "PAGE");
    assert_eq!((pages.len(), &pages[0]["isPresent"]), (1, &json!(true)), "{list}");
    let mut twins = of_kind(&list, "OPC_UA");
    let number = |one: &Value| {
        let id = one["sessionId"].as_str().expect("an id");
        id.strip_prefix("opcua-").expect("a prefix").parse::<u32>().expect("a number")
    };
    twins.sort_by_key(number);
    assert_eq!(twins.len(), 2, "{list}");
    for one in &twins {
        assert_eq!((&one["address"], &one["isPresent"]), (&json!("127.0.0.1"), &json!(false)));
        assert_eq!(one["userAgent"], "line planner");
        let certificate = one["clientCertificate"].as_str().expect("a subject");
        assert!(certificate.contains("line planner"), "{certificate}");
    }

    let path = format!("/sessions/opcua-{}", number(&twins[0]));
    assert_eq!(plant.call(Method::DELETE, &path, None).await.0, 404, "it is not the engineer's");
    assert_eq!(otto.call(Method::DELETE, &path, None).await.0, 204);
    assert_eq!(otto.call(Method::DELETE, &path, None).await.0, 404);
    ends(&first).await;
    read_state(&second).await.expect("the other one goes on");
    let list = plant.get("/users/otto/sessions").await;
    let left: Vec<u32> = of_kind(&list, "OPC_UA").iter().map(number).collect();
    assert_eq!(left, [number(&twins[1])]);
    let path = format!("/users/otto/sessions/opcua-{}", left[0]);
    assert_eq!(plant.call(Method::DELETE, &path, None).await.0, 204);
    ends(&second).await;
    assert!(of_kind(&plant.get("/users/otto/sessions").await, "OPC_UA").is_empty());
    assert_eq!(otto.call(Method::GET, "/session", None).await.0, 200, "the page goes on");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_client_that_no_person_approved_is_marked_until_an_engineer_approves_it() {
    let plant = Plant::start(json!([{ "name": "progressStatus", "type": 9 }])).await;
    let key = rcgen::KeyPair::generate().expect("a key");
    let certificate = rcgen::CertificateParams::default().self_signed(&key).expect("signed");
    let path = plant.data_directory().join("twin-pki/trusted/former.der");
    std::fs::write(path, certificate.der()).expect("written");
    let found = plant.get("/client-certificates").await["items"][0].clone();
    assert_eq!((&found["state"], &found["approvedBy"]), (&json!("TRUSTED"), &Value::Null));
    let path = format!("/client-certificates/{}", found["thumbprint"].as_str().expect("one"));
    let approved = plant.put(&path, json!({ "isTrusted": true })).await;
    assert_eq!(
        (&approved["state"], &approved["approvedBy"]),
        (&json!("TRUSTED"), &json!("engineer"))
    );
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_client_of_an_authority_is_denied_by_itself() {
    let plant = Plant::start(json!([{ "name": "progressStatus", "type": 9 }])).await;
    let certificate = || {
        let key = rcgen::KeyPair::generate().expect("a key");
        rcgen::CertificateParams::default().self_signed(&key).expect("signed")
    };
    // As the twin stores one that it lets in through an authority.
    let path = plant.data_directory().join("twin-pki/issued/client.der");
    std::fs::write(path, certificate().der()).expect("written");
    let found = plant.get("/client-certificates").await["items"][0].clone();
    assert_eq!((&found["state"], &found["approvedBy"]), (&json!("ISSUED"), &Value::Null));
    let path = format!("/client-certificates/{}", found["thumbprint"].as_str().expect("one"));
    let denied = plant.put(&path, json!({ "isTrusted": false })).await;
    assert_eq!((&denied["state"], &denied["thumbprint"]), (&json!("DENIED"), &found["thumbprint"]));

    let deny = async |content: String| {
        let body = json!({ "kind": "DENIED_CERTIFICATE", "content": content }).to_string();
        plant.call(Method::POST, "/client-certificates", Some(body)).await.0.as_u16()
    };
    assert_eq!(deny(certificate().pem()).await, 201, "it need not have come before");
    assert_eq!(deny("MAMC".to_owned()).await, 422);
    let listed = plant.get("/client-certificates").await["items"].clone();
    let states: Vec<_> =
        listed.as_array().expect("a page").iter().map(|one| one["state"].clone()).collect();
    assert_eq!(states, [json!("DENIED"), json!("DENIED")]);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn authorities_and_revocation_lists_come_and_go() {
    let plant = Plant::start(json!([{ "name": "progressStatus", "type": 9 }])).await;
    let mut params = rcgen::CertificateParams::default();
    params.distinguished_name.push(rcgen::DnType::CommonName, "Plant CA");
    params.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
    params.key_usages = vec![rcgen::KeyUsagePurpose::KeyCertSign, rcgen::KeyUsagePurpose::CrlSign];
    let key = rcgen::KeyPair::generate().expect("a key");
    let certificate = params.self_signed(&key).expect("a certificate");
    let list = rcgen::CertificateRevocationListParams {
        this_update: rcgen::date_time_ymd(2026, 1, 1),
        next_update: rcgen::date_time_ymd(2096, 1, 1),
        crl_number: 1_u64.into(),
        issuing_distribution_point: None,
        revoked_certs: Vec::new(),
        key_identifier_method: rcgen::KeyIdMethod::Sha256,
    };
    let list = list.signed_by(&rcgen::Issuer::new(params, key)).expect("a list");
    let file =
        |kind: &str, content: String| json!({ "kind": kind, "content": content }).to_string();

    let add =
        async |body: String| plant.call(Method::POST, "/client-certificates", Some(body)).await;
    let list_file = file("REVOCATION_LIST", list.pem().expect("PEM"));
    let (status, problem) = add(list_file.clone()).await;
    let problem: Value = serde_json::from_str(&problem).expect("a problem");
    assert_eq!(
        (status.as_u16(), &problem["faults"][0]["code"]),
        (422, &json!("UNKNOWN_ISSUER")),
        "{problem}"
    );
    assert_eq!(add(file("CERTIFICATE", certificate.pem())).await.0, 201);
    assert_eq!(plant.get("/client-authorities").await["items"][0]["revocationList"], "MISSING");
    assert_eq!(add(list_file).await.0, 201);
    assert_eq!(add(file("ISSUER", STANDARD.encode(certificate.der()))).await.0, 201);

    let authorities = plant.get("/client-authorities").await;
    let shown: Vec<_> = authorities["items"]
        .as_array()
        .expect("a page")
        .iter()
        .map(|one| &one["isTrusted"])
        .collect();
    assert_eq!(shown, [&json!(true), &json!(false)]);
    assert_eq!(authorities["items"][0]["revocationList"], "CURRENT");
    let lists = plant.get("/client-revocation-lists").await;
    assert_eq!(
        (&lists["items"][0]["issuer"], &lists["items"][0]["revokedCount"]),
        (&json!("CN=Plant CA"), &json!(0))
    );
    assert!(
        plant.get("/client-certificates").await["items"].as_array().expect("a page").is_empty()
    );

    plant.put("/users/vera", json!({ "role": "VIEWER", "password": "vera only looks" })).await;
    let vera = plant.signed_in("vera", "vera only looks").await.expect("vera may come in");
    let id = lists["items"][0]["revocationListId"].as_str().expect("an id");
    let thumbprint = authorities["items"][0]["thumbprint"].as_str().expect("a thumbprint");
    for path in
        [format!("/client-revocation-lists/{id}"), format!("/client-authorities/{thumbprint}")]
    {
        assert_eq!(vera.call(Method::DELETE, &path, None).await.0, 403);
        assert_eq!(plant.call(Method::DELETE, &path, None).await.0, 204);
        assert_eq!(plant.call(Method::DELETE, &path, None).await.0, 404);
    }
    assert!(
        plant.get("/client-authorities").await["items"].as_array().expect("a page").is_empty(),
        "both are gone"
    );
}

/// Runs the connector's command line; what it printed, or what it complained of.
fn command_line(config: &Path, arguments: &[&str]) -> Result<String, String> {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_factory-connector"));
    let done = command.arg("--config").arg(config).args(arguments).output().expect("it runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    if done.status.success() { Ok(text(done.stdout)) } else { Err(text(done.stderr)) }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_command_line_requests_and_installs_a_certificate_beside_the_running_connector() {
    let plant = Plant::start(json!([{ "name": "progressStatus", "type": 9 }])).await;
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name);
    let config = file("connector.toml");
    let text = format!(
        "data_directory = {:?}\n[twin]\nlisten = \"127.0.0.1:0\"\n",
        plant.data_directory()
    );
    std::fs::write(&config, text).expect("written");
    let name = |path: &Path| path.to_str().expect("text").to_owned();
    let request = name(&file("twin.csr"));
    command_line(&config, &["certificate", "request", "--new-key", "--output", &request])
        .expect("requested");

    let mut params = rcgen::CertificateParams::default();
    params.distinguished_name.push(rcgen::DnType::CommonName, "Plant CA");
    params.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
    let key = rcgen::KeyPair::generate().expect("a key");
    std::fs::write(file("ca.der"), params.self_signed(&key).expect("a certificate").der())
        .expect("written");
    let issuer = rcgen::Issuer::new(params, key);
    let request = std::fs::read_to_string(&request).expect("a request");
    let mut request =
        rcgen::CertificateSigningRequestParams::from_pem(&request).expect("a request");
    request.params.serial_number = Some(7_u64.into());
    std::fs::write(file("twin.pem"), request.signed_by(&issuer).expect("issued").pem())
        .expect("written");

    let (issued, authority) = (name(&file("twin.pem")), name(&file("ca.der")));
    let complaint = command_line(&config, &["certificate", "install", &issued])
        .expect_err("its issuer is missing");
    assert!(complaint.contains("CN=Plant CA"), "{complaint}");
    let shown =
        command_line(&config, &["certificate", "install", &issued, &authority]).expect("installed");
    assert!(shown.contains("issued by    CN=Plant CA"), "{shown}");
    assert!(
        command_line(&config, &["certificate", "show"])
            .expect("shown")
            .contains("urn:verbund:twin:FOR_MUC")
    );
    let own = plant.get("/application-certificate").await;
    assert_eq!((&own["isSelfSigned"], &own["issuer"]), (&json!(false), &json!("CN=Plant CA")));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_authority_can_issue_the_twins_certificate() {
    let plant = Plant::start(json!([{ "name": "progressStatus", "type": 9 }])).await;
    let own = plant.get("/application-certificate").await;
    assert_eq!(
        (&own["isSelfSigned"], &own["applicationUri"]),
        (&json!(true), &json!("urn:verbund:twin:FOR_MUC"))
    );
    let answer = plant
        .post("/application-certificate/request", json!({ "organization": "Plant Ltd" }))
        .await;
    let request = answer["content"].as_str().expect("PEM");
    assert!(request.starts_with("-----BEGIN CERTIFICATE REQUEST-----"), "{request}");
    let body = json!({ "content": request }).to_string();
    let (status, problem) = plant.call(Method::PUT, "/application-certificate", Some(body)).await;
    let problem: Value = serde_json::from_str(&problem).expect("a problem");
    assert_eq!(
        (status.as_u16(), &problem["faults"][0]["code"]),
        (422, &json!("NOT_ISSUED")),
        "{problem}"
    );
    let long = json!({ "commonName": "x".repeat(65) }).to_string();
    assert_eq!(
        plant.call(Method::POST, "/application-certificate/request", Some(long)).await.0,
        422
    );
}
