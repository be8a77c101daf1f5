//! Addresses of the broker: a member's credential opens none that is another's.

use asi_model::{FactoryId, ToolId};
use messaging::LogicalAddress;
use serde_json::{Value, json};

use super::{Member, members};
use crate::{
    chain,
    connector::Peer,
    harness::{Api, World, eventually},
    story,
};

async fn credential_of_factory(world: &World, admin: &Api, member: &Member) -> Value {
    let path = format!("/factories/{}/enrolment-tokens", member.factory);
    let token = admin.post(&path, json!({})).await.expect_ok()["token"].clone();
    world.anonymous().post("/enrolments", json!({ "token": token })).await.expect_ok()
}

/// Addresses of the owner to read from and to write to.
fn addresses(owner: &Member) -> Vec<(LogicalAddress, LogicalAddress)> {
    let factory: FactoryId = owner.factory.parse().expect("an id");
    let tool: ToolId = owner.tool().parse().expect("an id");
    let ingress = LogicalAddress::FactoryIngress(factory.clone());
    vec![
        (LogicalAddress::FactoryRequests(factory.clone()), ingress.clone()),
        (LogicalAddress::FactoryLeases(factory), ingress),
        (LogicalAddress::ToolReports(tool.clone()), LogicalAddress::ToolRequests(tool)),
    ]
}

#[tokio::test(flavor = "multi_thread")]
async fn no_credential_opens_an_address_of_another_member() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let members = members(&world, &admin).await;
    for author in &members {
        let path = format!("/tools/{}/credentials", author.tool());
        let credentials = [
            credential_of_factory(&world, &admin, author).await,
            admin.post(&path, json!({})).await.expect_ok(),
        ];
        let mut peers = Vec::new();
        for owner in members.iter().filter(|owner| owner.id != author.id) {
            for (reads, writes) in addresses(owner) {
                for credential in &credentials {
                    let peer = Peer::start(credential, reads.clone(), writes.clone());
                    peer.send("ua-data", &story::report("m0", 0, 3));
                    peers.push((format!("{} at {reads} and {writes}", author.id), peer));
                }
            }
        }
        for (what, peer) in &peers {
            eventually(what, || async {
                let state = peer.link.state().borrow().clone();
                let reason = state.reason.clone().unwrap_or_default();
                let is_refused = reason.to_lowercase().contains("unauthorized");
                if is_refused { Ok(()) } else { Err(format!("{state:?}")) }
            })
            .await;
            assert_eq!((peer.waiting(), peer.received()), (1, Vec::new()), "{what}");
        }
    }
    for member in &members {
        let path = format!("/factories/{}/writers", member.factory);
        assert_eq!(member.api.get(&path).await.expect_ok()["items"], json!([]));
    }
    assert_eq!(admin.get("/dead-letters").await.expect_ok()["items"], json!([]));
}
