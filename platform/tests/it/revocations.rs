//! Signed receipts of revocations, from the factory to those who received the values.

use serde_json::{Value, json};

use crate::{
    connector::Peer,
    entitlement::{BUYER, INSPECTOR, network_to},
    harness::{Api, World, eventually},
    story::{self, NETWORK, network_path, planner},
};

/// Returns a receipt as a connector sends it. The platform passes on what it does not judge.
pub fn receipt(factory: &str, recipients: &[&str]) -> Value {
    json!({ "messageType": "revocation", "messageId": format!("r-{factory}"), "factoryId": factory,
        "operationNetworkId": NETWORK, "operationId": "MakeFrame1",
        "dynamicDataRequestId": "ReqResponse1", "recipientList": recipients,
        "signedText": "{\"revocationId\":\"r\", \"cause\":\"REVOKED\"}",
        "signature": "00ff", "publicKey": "8a88" })
}

async fn receipts(api: &Api) -> Vec<Value> {
    let list = api.get(&format!("{}/revocations", network_path())).await.expect_ok();
    list["items"].as_array().cloned().unwrap_or_default()
}

async fn arrived(api: &Api) {
    eventually("the receipt", || async {
        let found = receipts(api).await;
        if found.is_empty() { Err("none".to_owned()) } else { Ok(()) }
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn the_receipt_of_a_revocation_reaches_its_recipients_as_it_was_signed() {
    let world = World::start().await;
    let (admin, buyer, munich, hamburg): (Api, Api, Peer, Peer) = story::accepted(&world).await;
    let sent = receipt("FOR_MUC", &["acme-aero"]);
    munich.send("revocation", &sent);
    arrived(&buyer).await;
    let [found] = &receipts(&buyer).await[..] else { panic!("one receipt") };
    for member in ["signedText", "signature", "publicKey", "factoryId", "dynamicDataRequestId"] {
        assert_eq!(found[member], sent[member], "{member}");
    }
    // The factory's own organisation sees what it signed; other members of the network do not.
    assert_eq!(receipts(&planner(&world, "frames-munich").await).await.len(), 1);
    assert!(receipts(&planner(&world, "inspect-hamburg").await).await.is_empty());
    // Another factory cannot speak about the request, and a repeated message changes nothing.
    hamburg.send("revocation", &receipt("INS_HAM", &["acme-aero"]));
    eventually("a dead letter", || async {
        let letters = admin.get("/dead-letters").await.expect_ok();
        if letters["items"][0]["subject"] == "revocation" {
            Ok(())
        } else {
            Err(letters.to_string())
        }
    })
    .await;
    munich.send("revocation", &sent);
    munich.send("ua-data", &story::report("m0", 0, 3));
    story::value_is(&buyer, "3").await;
    assert_eq!(receipts(&buyer).await.len(), 1);
}

/// A factory could place documents before any organisation otherwise.
#[tokio::test(flavor = "multi_thread")]
async fn a_receipt_is_read_by_recipients_of_the_request_alone() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg): (Api, Api, Peer, Peer) = story::accepted(&world).await;
    let everybody = ["acme-aero", "inspect-hamburg", "stranger"];
    munich.send("revocation", &receipt("FOR_MUC", &everybody));
    arrived(&buyer).await;
    let inspector = planner(&world, "inspect-hamburg").await;
    assert!(receipts(&inspector).await.is_empty());
    // Who was a recipient once reads what is revoked of that.
    story::put_network(&buyer, network_to(&[BUYER, INSPECTOR])).await;
    story::put_network(&buyer, network_to(&[BUYER])).await;
    let mut second = receipt("FOR_MUC", &everybody);
    second["messageId"] = "second".into();
    munich.send("revocation", &second);
    arrived(&inspector).await;
    assert_eq!((receipts(&inspector).await.len(), receipts(&buyer).await.len()), (1, 2));
}
