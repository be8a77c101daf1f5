//! Signed messages: what a broker between plant and platform changes is found, and changes nothing.

use ed25519_dalek::{Signer as _, SigningKey};
use message_signature::{PublicKey, SignedProperties, sign};
use messaging::Envelope;
use serde_json::{Value, json};

use crate::{
    connector::Peer,
    entitlement::{BUYER, INSPECTOR, consent_again, held, network_to, sequences},
    harness::{Api, World, eventually},
    leases, past_releases, story, witness,
};

const UNSIGNED: &str = "UNSIGNED";
const WRONG: &str = "WRONG_SIGNATURE";

/// A plant with a key, as its connector signs.
struct Plant(SigningKey);

impl Plant {
    fn new(secret: u8) -> Self {
        Self(SigningKey::from_bytes(&[secret; 32]))
    }

    fn public(&self) -> PublicKey {
        PublicKey::from_bytes(self.0.verifying_key().as_bytes()).expect("a key")
    }

    fn signed(&self, subject: &str, body: &Value) -> Envelope {
        self.signed_for("FOR_MUC", subject, body, None)
    }

    fn signed_for(
        &self,
        factory: &str,
        subject: &str,
        body: &Value,
        lease: Option<u64>,
    ) -> Envelope {
        let id = body["messageId"].as_str().or(body["MessageId"].as_str()).expect("an id");
        let mut envelope = Envelope::new(id.parse().expect("an id"), subject, body.to_string());
        let properties = SignedProperties {
            factory_id: factory.parse().expect("an id"),
            message_id: id.parse().expect("an id"),
            subject: subject.to_owned(),
            lease,
        };
        envelope.lease = lease;
        let sign_bytes = |bytes: &[u8]| self.0.sign(bytes).to_bytes();
        envelope.signature = Some(sign(&properties, &self.public(), &envelope.body, sign_bytes));
        envelope
    }
}

/// A broker puts this text in the place of that one, in the body alone.
fn changed(envelope: &Envelope, from: &str, to: &str) -> Envelope {
    let body = String::from_utf8(envelope.body.to_vec()).expect("UTF-8");
    assert!(body.contains(from), "{body}");
    Envelope { body: body.replace(from, to).into(), ..envelope.clone() }
}

/// The codes of the dead letters, the newest first, once there are as many.
async fn set_aside(admin: &Api, count: usize) -> Vec<String> {
    eventually("dead letters", || async {
        let letters = admin.get("/dead-letters").await.expect_ok();
        let letters = letters["items"].as_array().cloned().unwrap_or_default();
        let code = |letter: &Value| letter["code"].as_str().unwrap_or_default().to_owned();
        let codes: Vec<String> = letters.iter().map(code).collect();
        if codes.len() == count { Ok(codes) } else { Err(format!("{letters:?}")) }
    })
    .await
}

/// The frame order, whose first report is signed: from then on FOR_MUC signs. The network names buyer
/// and inspector; the reports are released to the buyer.
async fn signing(world: &World) -> (Api, Api, Peer, Plant) {
    let network = network_to(&[BUYER, INSPECTOR]);
    let (admin, buyer, munich, _hamburg) = story::accepted_network(world, network).await;
    let plant = Plant::new(1);
    munich.forward(plant.signed("ua-data", &story::report("m0", 0, 3)));
    story::value_is(&buyer, "3").await;
    (admin, buyer, munich, plant)
}

/// The platform holds the reports with the numbers 0 and 1, and receipts both.
async fn receipted(munich: &Peer) {
    let receipt = munich
        .receive("receipt", |receipt| receipt["receiptList"][0]["throughSequence"] == 1)
        .await;
    assert_eq!(receipt["receiptList"][0]["missingList"], json!([]));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_broker_that_widens_the_recipient_list_is_found() {
    let world = World::start().await;
    let (admin, buyer, munich, plant) = signing(&world).await;
    let inspector = story::planner(&world, INSPECTOR).await;
    let report = plant.signed("ua-data", &story::report("m1", 1, 4));
    let widened = changed(&report, r#"["acme-aero"]"#, r#"["acme-aero","inspect-hamburg"]"#);
    munich.forward(widened);
    assert_eq!(set_aside(&admin, 1).await, [WRONG]);
    assert_eq!(sequences(&inspector).await, [] as [u64; 0]);
    assert_eq!(sequences(&buyer).await, [0], "its number is not taken");

    // The message as it left the plant still can come, and is receipted.
    munich.forward(report);
    story::value_is(&buyer, "4").await;
    receipted(&munich).await;
    assert_eq!(sequences(&inspector).await, [] as [u64; 0]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_broker_that_changes_a_value_is_found() {
    let world = World::start().await;
    let (admin, buyer, munich, plant) = signing(&world).await;
    let report = plant.signed("ua-data", &story::report("m1", 1, 4));
    munich.forward(changed(&report, r#""Body":"4""#, r#""Body":"5""#));
    assert_eq!(set_aside(&admin, 1).await, [WRONG]);
    story::value_is(&buyer, "3").await;
    munich.forward(report);
    story::value_is(&buyer, "4").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_broker_that_changes_a_decision_is_found() {
    let world = World::start().await;
    let (admin, buyer, munich, plant) = signing(&world).await;
    let refusal = story::decision_at("2019-04-18T19:00:00Z", "REFUSED", None);
    let refusal = plant.signed("decision", &refusal);
    munich.forward(changed(&refusal, "REFUSED", "PENDING"));
    assert_eq!(set_aside(&admin, 1).await, [WRONG]);
    story::state_is(&buyer, "MAPPED").await;
    munich.forward(refusal);
    story::state_is(&buyer, "REFUSED").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_broker_that_changes_a_release_of_the_past_is_found() {
    let world = World::start().await;
    let (admin, _buyer, munich, _hamburg) = story::accepted(&world).await;
    let buyer = story::planner(&world, BUYER).await;
    for sequence in 0..3 {
        let id = format!("m{sequence}");
        munich.send("ua-data", &story::report_to(&[BUYER], &id, sequence, 3));
    }
    held(&admin, 3).await;
    story::put_network(&buyer, network_to(&[BUYER, INSPECTOR])).await;
    consent_again(&buyer, &munich, 2, "2019-04-18T18:30:00Z").await;
    let (plant, inspector) = (Plant::new(1), story::planner(&world, INSPECTOR).await);
    let release = plant.signed("past-release", &past_releases::release(INSPECTOR, 0, 1));
    munich.forward(changed(&release, r#""lastSequence":1"#, r#""lastSequence":2"#));
    assert_eq!(set_aside(&admin, 1).await, [WRONG]);
    assert_eq!(sequences(&inspector).await, [] as [u64; 0]);
    munich.forward(release);
    past_releases::sees(&inspector, &[0, 1]).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_broker_that_takes_the_signature_away_is_found() {
    let mut world = World::start().await;
    let (admin, buyer, munich, plant) = signing(&world).await;
    let report = plant.signed("ua-data", &story::report("m1", 1, 4));
    munich.forward(Envelope { signature: None, ..report.clone() });
    assert_eq!(set_aside(&admin, 1).await, [UNSIGNED]);
    let letters = admin.get("/dead-letters").await.expect_ok();
    let path =
        format!("/dead-letters/{}/replay", letters["items"][0]["id"].as_str().expect("an id"));
    // A replay makes nothing of it.
    admin.post(&path, json!({})).await.expect_ok();
    assert_eq!(set_aside(&admin, 2).await, [UNSIGNED, UNSIGNED]);
    assert_eq!(sequences(&buyer).await, [0]);

    // That the factory signs survives a restart.
    drop(munich);
    world.restart().await;
    let (admin, buyer) = (world.admin().await, story::planner(&world, BUYER).await);
    let key = json!(plant.public().to_string());
    let munich = Peer::enrolled_with(&world, &admin, "FOR_MUC", key).await;
    munich.forward(Envelope { signature: None, ..report.clone() });
    assert_eq!(set_aside(&admin, 3).await[0], UNSIGNED);
    munich.forward(report);
    story::value_is(&buyer, "4").await;
}

/// Both come in one batch, and so in one transaction.
#[tokio::test(flavor = "multi_thread")]
async fn an_unsigned_message_behind_the_first_signed_one_is_found() {
    let world = World::start().await;
    let (admin, buyer, _munich, _hamburg) = story::accepted(&world).await;
    let ingest = world.handle().application.ingest.clone();
    let address = "factory.FOR_MUC.ingress".parse().expect("an address");
    let signed = Plant::new(1).signed("ua-data", &story::report("m0", 0, 3));
    let unsigned = Plant::new(1).signed("ua-data", &story::report("m1", 1, 4));
    let batch =
        [signed, Envelope { signature: None, ..unsigned }].map(|envelope| messaging::Delivery {
            envelope,
            is_redelivered: false,
            delivery_count: 0,
            received_at: time::OffsetDateTime::now_utc(),
        });
    messaging::Inbox::receive(&ingest, &address, batch.into()).await;
    assert_eq!(set_aside(&admin, 1).await, [UNSIGNED]);
    assert_eq!(sequences(&buyer).await, [0]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_body_under_the_properties_of_another_message_is_found() {
    let world = World::start().await;
    let (admin, buyer, munich, plant) = signing(&world).await;
    let decision = story::decision_at("2019-04-18T19:00:00Z", "REFUSED", None);
    let decision = plant.signed("decision", &decision);
    let report = plant.signed("ua-data", &story::report("m1", 1, 4));
    let other_kind = plant.signed("comment", &story::report("m1", 1, 4));
    let other_id = Envelope { message_id: decision.message_id.clone(), ..report.clone() };
    let leased = plant.signed_for("FOR_MUC", "ua-data", &story::report("m1", 1, 4), Some(7));
    let hamburg = plant.signed_for("INS_HAM", "ua-data", &story::report("m1", 1, 4), None);
    let wrong = [
        Envelope { signature: decision.signature.clone(), ..report.clone() },
        other_kind,
        other_id,
        Envelope { lease: Some(8), ..leased },
        Envelope { lease: Some(1), ..report.clone() },
        hamburg,
    ];
    let count = wrong.len();
    wrong.into_iter().for_each(|envelope| munich.forward(envelope));
    assert_eq!(set_aside(&admin, count).await, vec![WRONG; count]);
    assert_eq!(sequences(&buyer).await, [0]);

    // A subject beside the body says nothing, and a property that was dropped is the signed one.
    munich.forward(Envelope { subject: "decision".into(), message_id: None, ..report });
    story::value_is(&buyer, "4").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_lease_that_a_broker_takes_away_counts_all_the_same() {
    let world = World::start().await;
    let (admin, buyer, munich, plant) = signing(&world).await;
    leases::with_leases(&munich);
    let request = json!({ "messageType": "lease-request", "messageId": "ask", "factoryId": "FOR_MUC",
        "instanceId": "a1", "place": "here", "host": "here", "startedAt": "2019-04-18T05:58:12Z" });
    munich.forward(plant.signed("lease-request", &request));
    let answer = munich.receive("lease", |answer| answer["correlationId"] == "ask").await;
    assert_eq!(answer["leaseNumber"], 1);
    let former = plant.signed_for("FOR_MUC", "ua-data", &story::report("m1", 1, 4), Some(2));
    munich.forward(Envelope { lease: None, ..former });
    assert_eq!(set_aside(&admin, 1).await, ["NOT_LEASED"]);

    // An administrator may take it all the same: its signature came with the letter.
    let letters = admin.get("/dead-letters").await.expect_ok();
    let path =
        format!("/dead-letters/{}/replay", letters["items"][0]["id"].as_str().expect("an id"));
    admin.post(&path, json!({})).await.expect_ok();
    story::value_is(&buyer, "4").await;
    assert_eq!(set_aside(&admin, 1).await, ["NOT_LEASED"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_signature_of_another_factory_is_found() {
    let world = World::start().await;
    let (admin, buyer, munich, _plant) = signing(&world).await;
    let other = Plant::new(2);
    munich.forward(other.signed("ua-data", &story::report("m1", 1, 4)));
    assert_eq!(set_aside(&admin, 1).await, [WRONG]);
    let hamburg = Peer::enrolled(&world, &admin, "INS_HAM").await;
    // What Munich said is not said to be Hamburg's, though nothing is known of Hamburg's key yet.
    hamburg.forward(Plant::new(1).signed("ua-data", &story::report("m1", 1, 4)));
    assert_eq!(set_aside(&admin, 2).await, [WRONG, WRONG]);
    assert_eq!(sequences(&buyer).await, [0]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_replayed_signed_message_counts_once() {
    let world = World::start().await;
    let (admin, buyer, munich, plant) = signing(&world).await;
    let report = plant.signed("ua-data", &story::report("m1", 1, 4));
    munich.forward(report.clone());
    story::value_is(&buyer, "4").await;
    munich.forward(plant.signed("ua-data", &story::report("m2", 2, 5)));
    story::value_is(&buyer, "5").await;
    munich.forward(report);
    eventually("a repeat", || async {
        let writers = admin.get("/factories/FOR_MUC/writers").await.expect_ok();
        let repeats = writers["items"][0]["duplicates"].clone();
        if repeats == 1 { Ok(()) } else { Err(writers.to_string()) }
    })
    .await;
    story::value_is(&buyer, "5").await;
    assert_eq!(sequences(&buyer).await, [0, 1, 2]);
    assert_eq!(set_aside(&admin, 0).await, [] as [&str; 0]);
}

/// The connector names its key where it enrols, past every broker.
#[tokio::test(flavor = "multi_thread")]
async fn a_factory_that_enrolled_with_a_key_signs_from_its_first_message_on() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let (first, second, third) = (Plant::new(1), Plant::new(2), Plant::new(3));
    let comment = |id: &str| {
        json!({ "messageType": "comment", "messageId": id, "factoryId": "FOR_MUC",
            "operationNetworkId": "none", "authorId": "engineer", "text": "Hello." })
    };
    let enrol = async |plant: &Plant| {
        let key = json!(plant.public().to_string());
        Peer::enrolled_with(&world, &admin, "FOR_MUC", key).await
    };
    let munich = enrol(&first).await;
    munich.send("comment", &comment("c0"));
    assert_eq!(set_aside(&admin, 1).await[0], UNSIGNED);
    munich.forward(second.signed("comment", &comment("c1")));
    assert_eq!(set_aside(&admin, 2).await[0], WRONG);
    munich.forward(first.signed("comment", &comment("c2")));
    assert_eq!(set_aside(&admin, 3).await[0], "UNKNOWN_NETWORK", "it is read");

    // Another enrolment allows another key; as of the credentials, the newest two count.
    let munich = enrol(&second).await;
    munich.forward(second.signed("comment", &comment("c3")));
    munich.forward(first.signed("comment", &comment("c4")));
    assert_eq!(set_aside(&admin, 5).await[..2], ["UNKNOWN_NETWORK", "UNKNOWN_NETWORK"]);
    let munich = enrol(&third).await;
    munich.forward(first.signed("comment", &comment("c5")));
    assert_eq!(set_aside(&admin, 6).await[0], WRONG);

    // Without its credentials nothing of a factory counts, with any signature: no key is trusted on first use.
    admin.delete("/factories/FOR_MUC/credentials").await.expect_ok();
    let ingest = world.handle().application.ingest.clone();
    let address = "factory.FOR_MUC.ingress".parse().expect("an address");
    let receive = async |envelope: Envelope| {
        let delivery = messaging::Delivery {
            envelope,
            is_redelivered: false,
            delivery_count: 0,
            received_at: time::OffsetDateTime::now_utc(),
        };
        messaging::Inbox::receive(&ingest, &address, vec![delivery]).await
    };
    receive(Envelope { signature: None, ..third.signed("comment", &comment("c6")) }).await;
    receive(second.signed("comment", &comment("c7"))).await;
    receive(third.signed("comment", &comment("c8"))).await;
    assert_eq!(set_aside(&admin, 9).await[..3], ["ACCESS_REVOKED"; 3]);

    // An administrator's token for a connector that does not sign.
    let munich = Peer::enrolled(&world, &admin, "FOR_MUC").await;
    munich.send("comment", &comment("c9"));
    assert_eq!(set_aside(&admin, 10).await[0], "UNKNOWN_NETWORK");
    let token = admin.post("/factories/FOR_MUC/enrolment-tokens", json!({})).await.expect_ok();
    let body = json!({ "token": token["token"], "signingKey": "none" });
    world.anonymous().post("/enrolments", body).await.expect_problem(422, "INVALID_KEY");
    let body = json!({ "token": token["token"] });
    world.anonymous().post("/enrolments", body).await.expect_ok();
}

#[tokio::test(flavor = "multi_thread")]
async fn only_a_key_of_the_countersigned_ledger_is_trusted_on_first_use() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    // The key of the log is that of the secret 1.
    witness::countersigned(&munich).await;
    munich.forward(Plant::new(2).signed("ua-data", &story::report("m0", 0, 3)));
    assert_eq!(set_aside(&admin, 1).await, [WRONG]);
    munich.send("ua-data", &story::report("m0", 0, 3));
    story::value_is(&buyer, "3").await;
    munich.forward(Plant::new(1).signed("ua-data", &story::report("m1", 1, 4)));
    story::value_is(&buyer, "4").await;
    munich.send("ua-data", &story::report("m2", 2, 5));
    assert_eq!(set_aside(&admin, 2).await[0], UNSIGNED);
}
