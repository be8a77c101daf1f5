//! Rights of users and disclosure to partners: policies, rules, revocations, the ledger.

use opcua_stack::opcua::crypto::PrivateKey;
use reqwest::{Method, StatusCode};
use serde_json::{Value, json};

use crate::plant::{PASSWORD, Plant, SignedIn, field};

/// The problem of a call that is refused.
async fn refused(plant: &SignedIn, method: Method, path: &str, body: Value) -> (StatusCode, Value) {
    let (status, text) = plant.call(method, path, Some(body.to_string())).await;
    assert!(status.is_client_error(), "{path}: {status} {text}");
    (status, serde_json::from_str(&text).expect("a problem"))
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn users_are_added_and_removed_but_the_last_engineer_stays() {
    let plant = Plant::start(json!([{ "name": "progressStatus", "type": 9 }])).await;
    let short = json!({ "role": "OPERATOR", "password": "short" });
    let (status, problem) = refused(&plant, Method::PUT, "/users/otto", short).await;
    assert_eq!(
        (status.as_u16(), &problem["faults"][0]["pointer"]),
        (422, &json!("/password")),
        "{problem}"
    );
    let (status, _) =
        refused(&plant, Method::PUT, "/users/otto", json!({ "role": "OPERATOR" })).await;
    assert_eq!(status, 422, "a new person needs a password");
    let otto = json!({ "role": "OPERATOR", "password": "otto at machine 7" });
    assert_eq!(
        plant.put("/users/otto", otto).await,
        json!({ "userName": "otto", "role": "OPERATOR" })
    );

    // Who adds a person does not overwrite another one of that name.
    let other = json!({ "role": "VIEWER", "password": "another otto altogether" });
    let (status, text) = plant.call_if_new("/users/otto", other.clone()).await;
    assert_eq!(status, 409, "{text}");
    assert!(text.contains("ALREADY_EXISTS"), "{text}");
    assert_eq!(plant.call_if_new("/users/otto2", other).await.0, 200);
    assert_eq!(plant.call(Method::DELETE, "/users/otto2", None).await.0, 204);

    let operator = plant.signed_in("otto", "otto at machine 7").await.expect("otto may come in");
    let (status, _) =
        refused(&operator, Method::PUT, "/users/otto", json!({ "role": "ENGINEER" })).await;
    assert_eq!(status, 403);
    assert_eq!(operator.call(Method::GET, "/users", None).await.0, 403);
    for (method, body) in
        [(Method::PUT, json!({ "role": "VIEWER" })), (Method::DELETE, Value::Null)]
    {
        let (status, problem) = refused(&plant, method, "/users/engineer", body).await;
        assert_eq!(
            (status.as_u16(), &problem["code"]),
            (409, &json!("LAST_ENGINEER")),
            "{problem}"
        );
    }

    // A new password ends the sessions of the old one.
    plant.put("/users/otto", json!({ "role": "VIEWER", "password": "otto's new secret" })).await;
    assert_eq!(operator.call(Method::GET, "/session", None).await.0, 401);
    assert!(plant.signed_in("otto", "otto at machine 7").await.is_err());
    let viewer = plant.signed_in("otto", "otto's new secret").await.expect("otto may come in");
    let users = plant.get("/users").await;
    assert_eq!(
        users["items"],
        json!([{ "userName": "engineer", "role": "ENGINEER" }, { "userName": "otto", "role": "VIEWER" }])
    );
    assert_eq!(plant.call(Method::DELETE, "/users/otto", None).await.0, 204);
    assert_eq!(viewer.call(Method::GET, "/session", None).await.0, 401);
    assert_eq!(plant.call(Method::DELETE, "/users/otto", None).await.0, 404);
    assert!(plant.signed_in("engineer", PASSWORD).await.is_ok());

    // Two engineers who remove each other at the same moment: one of them stays.
    plant.put("/users/ida", json!({ "role": "ENGINEER", "password": "ida knows the mill" })).await;
    let ida = plant.signed_in("ida", "ida knows the mill").await.expect("ida may come in");
    let both = tokio::join!(
        plant.call(Method::DELETE, "/users/ida", None),
        ida.call(Method::DELETE, "/users/engineer", None),
    );
    let gone = [both.0.0, both.1.0].iter().filter(|status| status.is_success()).count();
    assert_eq!(gone, 1, "{both:?}");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn policies_and_rules_decide_and_are_undone() {
    let fields = json!([{ "name": "power", "type": 11, "unit": "WTT" }, { "name": "count", "type": 9, "unit": "PIECE" },
        { "name": "recipe", "type": 12 }]);
    let plant = Plant::start(fields).await;
    check_consent_offer_and_revision(&plant).await;
    check_versions_of_policies(&plant).await;
    check_decisions_of_rules(&plant).await;
    check_tightened_policy(&plant).await;
}

async fn check_consent_offer_and_revision(plant: &SignedIn) {
    let offer = plant.get(&format!("{}/consent-offer", field("power"))).await;
    assert_eq!(offer["disclosure"]["minimumIntervalMs"], 1000, "{offer:#}");
    assert_eq!(offer["valuesPerHour"], 3600.0);
    let revision = plant.get("/operation-networks/frame/news").await;
    assert_eq!(
        (&revision["revision"], &revision["previousRevision"]),
        (&json!(1), &Value::Null),
        "{revision:#}"
    );
}

/// A named policy that rounds to `step`.
fn coarse(step: f64) -> Value {
    json!({ "name": "Coarse", "disclosure": { "roundingStep": step } })
}

/// A named policy has versions; a change of an older one than the newest is refused.
async fn check_versions_of_policies(plant: &SignedIn) {
    let created = plant.call_if_match(Method::PUT, "/policies/coarse", "\"0\"", coarse(10.0)).await;
    assert_eq!(created.0, 200, "{}", created.1);
    let stale = plant.call_if_match(Method::PUT, "/policies/coarse", "\"0\"", coarse(1.0)).await;
    assert!(stale.0 == 409 && stale.1.contains("CHANGED"), "{}", stale.1);
    let wrong = json!({ "name": "", "disclosure": {} });
    let (status, problem) = refused(plant, Method::PUT, "/policies/wrong", wrong).await;
    assert_eq!(
        (status.as_u16(), &problem["faults"][0]["pointer"]),
        (422, &json!("/name")),
        "{problem:#}"
    );
}

/// Rules accept and refuse the fields that they cover, after a preview; a decision can be undone.
async fn check_decisions_of_rules(plant: &SignedIn) {
    let accept = json!({ "name": "Power of acme", "isEnabled": true, "action": "ACCEPT", "valueSource": "EXTERNAL",
        "when": { "partners": ["acme"], "units": ["WTT"] }, "policyId": "coarse" });
    let looked = plant.post("/rules/preview", accept.clone()).await;
    assert_eq!(
        (&looked["count"], &looked["wouldDecideCount"]),
        (&json!(1), &json!(1)),
        "{looked:#}"
    );
    plant.put("/rules/power", accept).await;
    let refuse = json!({ "name": "No recipes", "isEnabled": true, "action": "REFUSE", "reason": "Recipes stay here.",
        "when": { "namePattern": "*recipe*" } });
    plant.put("/rules/recipes", refuse).await;
    assert_eq!(plant.post("/rules/apply", json!({})).await["decidedCount"], 2);
    let power = plant.get(&field("power")).await;
    assert_eq!(
        (&power["mappingState"], &power["valueSource"]),
        (&json!("MAPPED"), &json!("EXTERNAL")),
        "{power:#}"
    );
    assert_eq!(plant.get(&field("recipe")).await["mappingState"], "REFUSED");
    let decisions = plant.get("/rule-decisions").await;
    let by_one = plant.get("/rule-decisions?limit=1").await;
    let cursor = by_one["nextCursor"].as_str().expect("another page");
    let next = plant.get(&format!("/rule-decisions?limit=1&cursor={cursor}")).await;
    assert_eq!(json!([by_one["items"][0], next["items"][0]]), decisions["items"]);
    let recipe = decisions["items"]
        .as_array()
        .and_then(|all| all.iter().find(|d| d.to_string().contains("recipe")));
    let id = recipe.and_then(|decision| decision["id"].as_str()).expect("an id");
    assert_eq!(plant.call(Method::POST, &format!("/rule-decisions/{id}/undo"), None).await.0, 204);
    assert_eq!(plant.get(&field("recipe")).await["mappingState"], "PENDING");
    assert_eq!(
        plant.post("/rules/apply", json!({})).await["decidedCount"],
        0,
        "what was undone is the engineer's"
    );
}

/// A tightened policy shows its effect in a preview, and applies at once.
async fn check_tightened_policy(plant: &SignedIn) {
    let changed = plant.post("/policies/coarse/preview", coarse(100.0)).await;
    assert_eq!(changed["items"].as_array().map(Vec::len), Some(1), "{changed:#}");
    assert_ne!(changed["items"][0]["statement"], changed["items"][0]["statementThen"]);
    plant.put("/policies/coarse", coarse(100.0)).await;
    let versions = plant.get("/policies/coarse/versions").await;
    assert_eq!(versions["items"].as_array().map(Vec::len), Some(2));
    plant.put("/recipients/acme/policy", json!({ "policyId": "coarse" })).await;
    let recipients = plant.get("/recipients").await;
    assert_eq!(recipients["items"][0]["set"]["policyId"], "coarse", "{recipients:#}");
    let policies = plant.get("/policies").await;
    let coarse = &policies["items"][0];
    assert_eq!(
        (&coarse["fieldCount"], &coarse["recipients"]),
        (&json!(1), &json!(["acme"])),
        "{policies:#}"
    );
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn disclosed_values_are_listed_summed_up_exported_and_revoked() {
    let plant =
        Plant::start(json!([{ "name": "count", "type": 9 }, { "name": "state", "type": 12 }]))
            .await;
    for (name, value) in [("count", json!(17)), ("state", json!("RUNNING"))] {
        let manual = json!({ "mappingState": "MAPPED", "valueSource": "MANUAL", "disclosure": {} });
        plant.put(&format!("{}/decision", field(name)), manual).await;
        let (status, text) = plant
            .call(
                Method::PUT,
                &format!("{}/value", field(name)),
                Some(json!({ "value": value }).to_string()),
            )
            .await;
        assert!(status.is_success(), "{text}");
    }
    let ledger = plant
        .until("both values are in the ledger", "/ledger?recipient=acme", |ledger| {
            ledger["items"]
                .as_array()
                .is_some_and(|items| items.iter().any(|item| item["value"]["state"] != Value::Null))
        })
        .await;
    assert_eq!(ledger["recipients"], json!(["acme"]));
    assert_eq!(plant.get("/ledger?limit=1").await["items"].as_array().map(Vec::len), Some(1));
    let verified = plant.post("/ledger/verification", json!({})).await;
    assert_eq!(
        (&verified["valid"], &verified["fault"]),
        (&json!(true), &Value::Null),
        "{verified:#}"
    );
    for (format, expected) in [("jsonl", "{"), ("csv", "recipient"), ("html", "<!doctype html>")] {
        let (status, text) =
            plant.call(Method::GET, &format!("/ledger/export?format={format}"), None).await;
        assert!(status == 200 && text.to_lowercase().starts_with(expected), "{format}: {text}");
        assert!(text.contains("RUNNING") && text.contains("17"), "{format}: {text}");
    }

    let budgets = plant.get("/leak-budgets?partner=acme").await;
    let acme = &budgets["items"][0];
    assert_eq!(acme["partner"], "acme", "{budgets:#}");
    assert!(
        acme["warnings"].as_array().is_some_and(|warnings| !warnings.is_empty()),
        "states tell utilisation: {acme:#}"
    );
    assert_eq!(plant.get("/leak-budgets?partner=nobody").await["items"], json!([]));
    let summary = plant.get("/leak-budgets/summary").await;
    let short = &summary["items"][0];
    assert_eq!(short["partner"], json!("acme"), "{summary:#}");
    assert_eq!(short["fieldCount"], json!(2), "{summary:#}");
    assert_eq!(
        short["warningCount"],
        json!(acme["warnings"].as_array().map(Vec::len)),
        "{summary:#}"
    );
    assert_eq!(
        (&short["fields"], &short["conclusions"][0]),
        (&Value::Null, &acme["warnings"][0]["conclusion"])
    );
    let unchanged = json!([{ "code": "UNCHANGED" }]);
    assert_eq!(acme["fields"][0]["statementParts"], unchanged, "{acme:#}");
    assert_eq!(plant.get(&field("count")).await["disclosureParts"], unchanged);

    let nothing = refused(&plant, Method::POST, "/revocations", json!({})).await;
    assert_eq!(nothing.1["code"], "NOTHING_NAMED");
    let receipt = plant
        .post("/revocations", json!({ "operationNetworkId": "frame", "reason": "Order closed" }))
        .await;
    let id = receipt["receipt"]["revocationId"].as_str().or(receipt["revocationId"].as_str());
    let id = id.unwrap_or_else(|| panic!("{receipt:#}"));
    assert_eq!(plant.get(&format!("/revocations/{id}")).await, receipt);
    let (status, page) =
        plant.call(Method::GET, &format!("/revocations/{id}/print?language=de"), None).await;
    assert!(status == 200 && page.contains("Order closed"), "{status} {page}");
    for name in ["count", "state"] {
        assert_eq!(plant.get(&field(name)).await["mappingState"], "PENDING");
    }
    assert_eq!(plant.get("/leak-budgets").await["items"].as_array().map(Vec::len), Some(0));
    assert_eq!(plant.post("/ledger/verification", json!({})).await["valid"], true);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn certificates_of_clients_are_approved_and_rejected() {
    let plant = Plant::start(json!([{ "name": "count", "type": 9 }])).await;
    assert_eq!(plant.get("/client-certificates").await["items"], json!([]));
    // No security policy of ours takes its key.
    let elliptic =
        rcgen::generate_simple_self_signed(vec!["client.plant".to_owned()]).expect("a certificate");
    let file = json!({ "kind": "CERTIFICATE", "content": elliptic.cert.pem() });
    let (status, problem) = refused(&plant, Method::POST, "/client-certificates", file).await;
    assert_eq!(
        (status.as_u16(), &problem["faults"][0]["code"]),
        (422, &json!("WRONG_KEY")),
        "{problem}"
    );
    let key = PrivateKey::new(2048).expect("a key").to_der().expect("a key as DER");
    let key = rcgen::KeyPair::try_from(key.as_bytes()).expect("a key");
    let certificate =
        rcgen::CertificateParams::new(vec!["client.plant".to_owned()]).expect("parameters");
    let certificate = certificate.self_signed(&key).expect("a certificate");
    let file = json!({ "kind": "CERTIFICATE", "content": certificate.pem() });
    let (status, text) =
        plant.call(Method::POST, "/client-certificates", Some(file.to_string())).await;
    assert_eq!(status, 201, "{text}");
    let listed = plant.get("/client-certificates").await;
    let listed = &listed["items"][0];
    assert_eq!(listed["state"], "TRUSTED", "{listed:#}");
    let path =
        format!("/client-certificates/{}", listed["thumbprint"].as_str().expect("a thumbprint"));
    assert_eq!(plant.put(&path, json!({ "isTrusted": false })).await["state"], "DENIED");
    assert_eq!(plant.put(&path, json!({ "isTrusted": true })).await["state"], "TRUSTED");
    let (status, _) =
        refused(&plant, Method::PUT, "/client-certificates/00", json!({ "isTrusted": true })).await;
    assert_eq!(status, 404);
    let rubbish = json!({ "kind": "REVOCATION_LIST", "content": "AAAA" });
    let (status, problem) = refused(&plant, Method::POST, "/client-certificates", rubbish).await;
    assert_eq!((status.as_u16(), &problem["code"]), (422, &json!("NOT_USABLE")), "{problem}");
    assert_eq!(problem["faults"][0]["code"], "NOT_A_REVOCATION_LIST", "{problem}");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_request_is_read_alone_and_pages_continue_after_it() {
    let plant = Plant::start(json!([{ "name": "count", "type": 9 }])).await;
    let inbox = plant.get("/inbox").await;
    let request = plant.get("/requests/frame/MakeFrame/Req").await;
    assert_eq!(request, inbox["items"][0]);
    assert_eq!(request["fields"][0]["name"], "count", "{request:#}");
    for path in ["/requests/frame/MakeFrame/Other", "/requests/other/MakeFrame/Req"] {
        assert_eq!(plant.call(Method::GET, path, None).await.0, 404, "{path}");
    }
    let behind = "/inbox?cursor=%7B%22operationNetworkId%22:%22frame%22,%22operationId%22:%22MakeFrame%22,\
                  %22dynamicDataRequestId%22:%22Req%22%7D";
    let page = plant.get(behind).await;
    assert_eq!((&page["items"], &page["count"]), (&json!([]), &json!(1)), "{page:#}");
    let (status, problem) = refused(&plant, Method::GET, "/inbox?cursor=40", Value::Null).await;
    assert_eq!((status.as_u16(), &problem["code"]), (400, &json!("INVALID_CURSOR")), "{problem}");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_decision_without_a_policy_opens_nothing() {
    let plant = Plant::start(json!([{ "name": "count", "type": 9 }])).await;
    let path = format!("{}/decision", field("count"));
    let unsaid = json!({ "mappingState": "MAPPED", "valueSource": "MANUAL" });
    let (status, problem) = plant.status(Method::PUT, &path, Some(unsaid.to_string())).await;
    assert_eq!(status, 422, "{problem:#}");
    assert_eq!(problem["faults"][0]["pointer"], "/disclosure", "{problem:#}");
    assert_eq!(plant.get(&field("count")).await["mappingState"], "PENDING");
    let said = json!({ "mappingState": "MAPPED", "valueSource": "MANUAL", "disclosure": {} });
    assert_eq!(plant.put(&path, said).await["mappingState"], "MAPPED");
}
