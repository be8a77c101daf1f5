//! Enrolment, rotation and revocation.

use messaging::{LinkPhase, Login};
use serde_json::json;

use crate::{
    connector::Peer,
    harness::{World, eventually},
    story,
};

pub async fn is_up(peer: &Peer) {
    eventually("the link is up", || async {
        let state = peer.link.state().borrow().clone();
        if state.is_up() { Ok(()) } else { Err(format!("{:?}", state.reason)) }
    })
    .await;
}

pub async fn is_down(peer: &Peer) {
    eventually("the link is down", || async {
        let is_up = peer.link.state().borrow().is_up();
        if is_up { Err("up".to_owned()) } else { Ok(()) }
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_token_works_once_and_two_credentials_are_alive() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let enrol = async || {
        let token = admin.post("/factories/FOR_MUC/enrolment-tokens", json!({})).await.expect_ok();
        assert_eq!(token["isPinned"], false, "the platform of these tests has no TLS");
        let body = json!({ "token": token["token"] });
        let enrolment = world.anonymous().post("/enrolments", body.clone()).await.expect_ok();
        world.anonymous().post("/enrolments", body).await.expect_problem(403, "TOKEN_REFUSED");
        enrolment
    };
    let first = enrol().await;
    assert_eq!((&first["factoryId"], &first["profile"]), (&json!("FOR_MUC"), &json!("embedded")));
    let second = enrol().await;
    let (old, new) = (Peer::connector(&first, "FOR_MUC"), Peer::connector(&second, "FOR_MUC"));
    is_up(&old).await;
    is_up(&new).await;

    // A third retires the first.
    let third = enrol().await;
    let retired = Peer::connector(&first, "FOR_MUC");
    let newest = Peer::connector(&third, "FOR_MUC");
    is_up(&newest).await;
    is_down(&retired).await;
    world
        .anonymous()
        .post("/enrolments", json!({ "token": "made-up" }))
        .await
        .expect_problem(403, "TOKEN_REFUSED");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_link_that_was_refused_goes_on_with_a_new_password() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let enrol = async || {
        let token = admin.post("/factories/FOR_MUC/enrolment-tokens", json!({})).await.expect_ok();
        let body = json!({ "token": token["token"] });
        world.anonymous().post("/enrolments", body).await.expect_ok()
    };
    let (first, _, third) = (enrol().await, enrol().await, enrol().await);
    let peer = Peer::connector(&first, "FOR_MUC");
    eventually("the retired password is refused", || async {
        let state = peer.link.state().borrow().clone();
        match state.phase {
            LinkPhase::Down { is_permanent: true, .. } => Ok(()),
            phase => Err(format!("{phase:?}")),
        }
    })
    .await;
    let text = |name: &str| third[name].as_str().expect("a text").to_owned();
    // A refused link pauses for minutes; a new password ends that.
    peer.link.set_login(Login::new(text("userName"), text("password")));
    is_up(&peer).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_revoked_connector_is_cut_off() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let munich = Peer::enrolled(&world, &admin, "FOR_MUC").await;
    is_up(&munich).await;
    let revoked = admin.delete("/factories/FOR_MUC/credentials").await.expect_ok();
    assert_eq!(revoked["credentials"], 1);
    is_down(&munich).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_connector_reads_and_writes_its_own_addresses_only() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    let token = admin.post("/factories/INS_HAM/enrolment-tokens", json!({})).await.expect_ok();
    let enrolment =
        world.anonymous().post("/enrolments", json!({ "token": token["token"] })).await.expect_ok();
    let spy = Peer::start(
        &enrolment,
        messaging::LogicalAddress::FactoryRequests("FOR_MUC".parse().expect("valid")),
        messaging::LogicalAddress::FactoryIngress("FOR_MUC".parse().expect("valid")),
    );
    spy.send("ua-data", &story::report("spy", 0, 99));
    munich.send("ua-data", &story::report("true", 0, 3));
    story::value_is(&buyer, "3").await;
    assert_eq!(spy.count("operation-network"), 0);
    let reports = buyer.get("/reports").await.expect_ok();
    assert_eq!(reports["items"].as_array().map(Vec::len), Some(1), "{reports}");
}
