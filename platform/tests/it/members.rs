//! Member against member: *every* operation of the description, by a planner of each member,
//! against what belongs to each other member. Nothing that changes passes, and nothing that is read
//! tells what the reader may not know. A new operation without a row fails the test.

mod addresses;
mod attack;
mod attempts;
mod examples;
mod messages;
mod oracle;
mod owners;
mod places;
mod play;
mod refusals;
mod stages;
mod walk;

use serde_json::{Value, json};

use crate::{
    chain::{self, CARRIER_FACTORY, MEMBERS, body},
    connector::Peer,
    harness::{Api, World, eventually},
    isolation::operations,
    story::{self, network_path, planner},
};

/// A member, with things that nobody else has to do with.
pub struct Member {
    id: &'static str,
    factory: &'static str,
    api: Api,
}

impl Member {
    fn network(&self) -> String {
        format!("net-{}", self.id)
    }

    fn tool(&self) -> String {
        format!("Planner-{}", self.id)
    }

    /// A text that stands in everything of the member's own, and may be told to nobody else.
    fn secret(&self) -> String {
        format!("secret of {}", self.id)
    }

    fn request(&self) -> Value {
        let mut request = story::request(&format!("Req-{}", self.id), self.id);
        request["purpose"] = json!(self.secret());
        request
    }

    /// The member's own network: its own request to its own factory.
    fn document(&self) -> Value {
        json!({ "operationNetworkId": self.network(), "name": self.secret(), "operationList": [
            { "operationId": "Own", "operationType": "PRODUCTION", "owningFactoryId": self.factory,
              "name": self.secret(), "dynamicDataRequestList": [self.request()] } ] })
    }

    fn path(&self) -> String {
        format!("/operation-networks/{}", self.network())
    }
}

/// The chain of all members, and a network, a comment and a tool of each alone.
async fn members(world: &World, admin: &Api) -> Vec<Member> {
    let factory = json!({ "factoryId": "ACME", "organisationId": "acme-aero", "name": "ACME" });
    admin.post("/factories", factory).await.expect_ok();
    admin.put("/collaborations/order/factories/ACME", json!({})).await.expect_ok();
    let mut members = Vec::new();
    for (id, factory) in MEMBERS.into_iter().zip(["ACME", "FOR_MUC", "INS_HAM", CARRIER_FACTORY]) {
        let member = Member { id, factory, api: planner(world, id).await };
        member.api.put(&member.path(), body(member.document())).await.expect_ok();
        let comment = json!({ "factoryId": factory, "text": member.secret() });
        member.api.post(&format!("{}/comments", member.path()), comment).await.expect_ok();
        let tool =
            json!({ "toolId": member.tool(), "organisationId": id, "name": member.secret() });
        admin.post("/tools", tool).await.expect_ok();
        members.push(member);
    }
    members
}

/// Paths that `reader` reads of what is `owner`'s.
fn readings(operation: &str, owner: &Member) -> Vec<String> {
    let network = owner.path();
    match operation {
        "/session"
        | "/session/second-factor"
        | "/session/passkeys"
        | "/sessions"
        | "/status"
        | "/organisations"
        | "/factories"
        | "/collaborations"
        | "/tools"
        | "/users"
        | "/dead-letters"
        | "/operation-networks" => vec![operation.to_owned()],
        "/users/{userName}/sessions" => vec![format!("/users/{}-planner/sessions", owner.id)],
        "/reports" => {
            let id = owner.network();
            vec!["/reports".into(), format!("/reports?network={id}"), "/reports?newest=true".into()]
        }
        "/factories/{factoryId}/lease" => vec![format!("/factories/{}/lease", owner.factory)],
        "/factories/{factoryId}/ledger-logs" => {
            vec![format!("/factories/{}/ledger-logs", owner.factory)]
        }
        "/factories/{factoryId}/writers" => vec![format!("/factories/{}/writers", owner.factory)],
        "/factories/{factoryId}/accesses" => vec![format!("/factories/{}/accesses", owner.factory)],
        "/factories/{factoryId}/accesses/checkpoint" => {
            vec![format!("/factories/{}/accesses/checkpoint", owner.factory)]
        }
        "/factories/{factoryId}/accesses/audit" => {
            vec![format!("/factories/{}/accesses/audit", owner.factory)]
        }
        "/operation-networks/{operationNetworkId}" => vec![network, network_path()],
        "/operation-networks/{operationNetworkId}/comments" => {
            vec![format!("{network}/comments"), format!("{}/comments", network_path())]
        }
        "/operation-networks/{operationNetworkId}/revocations" => {
            vec![format!("{network}/revocations"), format!("{}/revocations", network_path())]
        }
        "/audit-entries" | "/audit-entries/export" => vec![operation.to_owned()],
        // Read to its end below.
        "/live" => Vec::new(),
        other => panic!("{other} has no row: what may one member read of another by it?"),
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn no_member_reads_what_is_not_for_it() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let mut streams = Vec::new();
    for id in MEMBERS {
        streams.push(planner(&world, id).await.live(None).await);
    }
    let members = members(&world, &admin).await;
    let munich = Peer::enrolled(&world, &admin, "FOR_MUC").await;
    let maker = &members[1];
    let mut report = story::report_to(&[maker.id], "m1", 0, 3);
    let payload = &mut report["Messages"][0]["Payload"];
    payload["operationNetworkId"]["Body"] = json!(maker.network());
    payload["operationId"]["Body"] = json!("Own");
    payload["dynamicDataRequestId"]["Body"] = json!(format!("Req-{}", maker.id));
    payload["note"] = json!({ "Type": 12, "Body": maker.secret() });
    munich.send("ua-data", &report);
    eventually("the maker's report", || async {
        let reports = maker.api.get("/reports").await.expect_ok().to_string();
        if reports.contains(&maker.secret()) { Ok(()) } else { Err(reports) }
    })
    .await;
    for reader in &members {
        for owner in members.iter().filter(|owner| owner.id != reader.id) {
            for (method, path) in operations() {
                if method != "GET" {
                    continue;
                }
                for path in readings(&path, owner) {
                    let answer = reader.api.get(&path).await;
                    assert!([200, 403, 404].contains(&answer.status), "{path}: {answer:?}");
                    let text = answer.body.to_string();
                    assert!(!text.contains(&owner.secret()), "{} reads {path}: {text}", reader.id);
                    let is_own = path.contains(&owner.network()) || path.contains("/accesses");
                    assert!(
                        !is_own || answer.status == 404 || path.starts_with("/reports"),
                        "{path}"
                    );
                }
            }
        }
    }
    // The last thing that each hears of is a comment in a network of its own.
    for (reader, live) in members.iter().zip(&mut streams) {
        let comments = format!("{}/comments", reader.path());
        let last = json!({ "factoryId": reader.factory, "text": "last" });
        let last = reader.api.post(&comments, last).await.expect_ok()["commentId"].clone();
        loop {
            let (_, name, event) = live.any().await;
            let text = event.to_string();
            for owner in members.iter().filter(|owner| owner.id != reader.id) {
                let is_heard = text.contains(&owner.network()) || text.contains(&owner.secret());
                assert!(!is_heard, "{} hears {name} {text}", reader.id);
            }
            if event["commentId"] == last {
                break;
            }
        }
    }
}
