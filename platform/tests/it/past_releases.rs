//! Release of the past: reports that had left for others are shown to a recipient that was added
//! later, by the factory alone, exactly those that it names.

use serde_json::{Value, json};

use crate::{
    connector::Peer,
    entitlement::{BUYER, INSPECTOR, consent_again, held, network_to, nothing, sequences, shown},
    harness::{Api, World, eventually},
    story::{self, NETWORK},
};

const MAKER: &str = "frames-munich";
const EPOCH: u32 = 608_926_829;

/// A release of FOR_MUC: the reports `first` to `last` of the first writer, for a recipient.
pub fn release(recipient: &str, first: u32, last: u32) -> Value {
    json!({ "messageType": "past-release", "messageId": platform::clock::new_message_id(),
        "factoryId": "FOR_MUC", "operationNetworkId": NETWORK, "operationId": "MakeFrame1",
        "dynamicDataRequestId": "ReqResponse1", "recipientId": recipient,
        "decidedAt": "2019-04-18T18:40:00Z", "rangeList": [
            { "dataSetWriterId": 1, "epoch": EPOCH, "firstSequence": first, "lastSequence": last } ] })
}

pub async fn sees(api: &Api, expected: &[u64]) {
    eventually("the past", || async {
        let found = sequences(api).await;
        if found == expected { Ok(()) } else { Err(format!("{found:?}")) }
    })
    .await;
}

/// The codes of the dead letters, once there are as many.
async fn set_aside(admin: &Api, count: usize) -> Vec<Value> {
    eventually("dead letters", || async {
        let letters = admin.get("/dead-letters").await.expect_ok();
        let letters = letters["items"].as_array().cloned().unwrap_or_default();
        let mut codes: Vec<Value> = letters.iter().map(|letter| letter["code"].clone()).collect();
        codes.sort_by_key(Value::to_string);
        if codes.len() == count { Ok(codes) } else { Err(format!("{letters:?}")) }
    })
    .await
}

/// Three reports left for the buyer; then a revision adds two recipients, and the engineer consents.
async fn with_a_past(world: &World) -> (Api, Api, Peer, Peer) {
    let (admin, buyer, munich, hamburg) = story::accepted(world).await;
    for sequence in 0..3 {
        let id = format!("m{sequence}");
        munich.send("ua-data", &story::report_to(&[BUYER], &id, sequence, 3));
    }
    held(&admin, 3).await;
    story::put_network(&buyer, network_to(&[BUYER, INSPECTOR, MAKER])).await;
    consent_again(&buyer, &munich, 2, "2019-04-18T18:30:00Z").await;
    (admin, buyer, munich, hamburg)
}

#[tokio::test(flavor = "multi_thread")]
async fn the_past_is_shown_to_the_named_recipient_alone() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = with_a_past(&world).await;
    let (inspector, maker) =
        (story::planner(&world, INSPECTOR).await, story::planner(&world, MAKER).await);
    assert_eq!(sequences(&inspector).await, Vec::<u64>::new());

    munich.send("past-release", &release(INSPECTOR, 0, 1));
    sees(&inspector, &[0, 1]).await;
    assert_eq!(shown(&inspector).await, nothing(), "the past is no current value");
    assert_eq!(sequences(&maker).await, Vec::<u64>::new(), "another recipient learns nothing");
    let writers = inspector.get("/factories/FOR_MUC/writers").await.expect_ok();
    assert_eq!(writers["items"][0]["dataSetWriterId"], 1, "gaps are seen as of any writer");
    let heard = (&writers["items"][0]["throughSequence"], &writers["items"][0]["received"]);
    assert_eq!(heard, (&json!(1), &json!(2)), "of what was released");

    // The same again, and a part of it: nothing changes.
    munich.send("past-release", &release(INSPECTOR, 0, 1));
    munich.send("past-release", &release(INSPECTOR, 1, 1));
    munich.send("ua-data", &story::report_to(&[BUYER], "m3", 3, 4));
    held(&admin, 4).await;
    assert_eq!(inspector.get("/factories/FOR_MUC/writers").await.expect_ok(), writers);
    assert_eq!(sequences(&inspector).await, [0, 1]);
    assert_eq!(sequences(&maker).await, Vec::<u64>::new());
    assert_eq!(sequences(&buyer).await, [0, 1, 2, 3]);

    // Another recipient with its own decision; the first one keeps what it has.
    munich.send("past-release", &release(MAKER, 1, 2));
    sees(&maker, &[1, 2]).await;
    assert_eq!(sequences(&inspector).await, [0, 1]);
    assert_eq!(sequences(&buyer).await, [0, 1, 2, 3]);
}

#[tokio::test(flavor = "multi_thread")]
async fn what_arrives_after_its_release_is_for_the_recipient_too() {
    let mut world = World::start().await;
    let (_, _, munich, hamburg) = with_a_past(&world).await;
    let inspector = story::planner(&world, INSPECTOR).await;
    munich.send("past-release", &release(INSPECTOR, 2, 4));
    sees(&inspector, &[2]).await;

    drop((munich, hamburg));
    world.restart().await;
    let admin = world.admin().await;
    let buyer = story::planner(&world, BUYER).await;
    let inspector = story::planner(&world, INSPECTOR).await;
    let munich = Peer::enrolled(&world, &admin, "FOR_MUC").await;
    for sequence in [5, 4, 3] {
        let id = format!("m{sequence}");
        munich.send("ua-data", &story::report_to(&[BUYER], &id, sequence, 3));
    }
    held(&admin, 6).await;
    let mut found = sequences(&inspector).await;
    found.sort_unstable();
    assert_eq!(found, [2, 3, 4], "5 is not named");
    assert_eq!(sequences(&buyer).await.len(), 6);

    // Who is no recipient any more gets nothing of what comes later.
    munich.send("past-release", &release(INSPECTOR, 6, 7));
    munich.send("ua-data", &story::report_to(&[BUYER], "m6", 6, 3));
    held(&admin, 7).await;
    story::put_network(&buyer, network_to(&[BUYER])).await;
    munich.send("ua-data", &story::report_to(&[BUYER], "m7", 7, 3));
    held(&admin, 8).await;
    let mut found = sequences(&inspector).await;
    found.sort_unstable();
    assert_eq!(found, [2, 3, 4, 6]);
}

#[tokio::test(flavor = "multi_thread")]
async fn only_the_factory_of_the_reports_releases_them_to_a_recipient() {
    let world = World::start().await;
    let (admin, _buyer, munich, hamburg) = with_a_past(&world).await;
    let inspector = story::planner(&world, INSPECTOR).await;
    let mut foreign = release(INSPECTOR, 0, 2);
    foreign["factoryId"] = json!("INS_HAM");
    hamburg.send("past-release", &foreign);
    let mut forged = release(INSPECTOR, 0, 2);
    forged["rangeList"][0]["lastSequence"] = json!(1);
    hamburg.send("past-release", &forged);
    munich.send("past-release", &release("stranger", 0, 2));
    let mut other_writer = release(INSPECTOR, 0, 2);
    other_writer["rangeList"][0]["dataSetWriterId"] = json!(9);
    munich.send("past-release", &other_writer);
    let mut other_operation = release(INSPECTOR, 0, 2);
    other_operation["operationId"] = json!("InspectFrame1");
    munich.send("past-release", &other_operation);
    let codes = set_aside(&admin, 5).await;
    let of = |wanted: &str| codes.iter().filter(|code| **code == wanted).count();
    assert_eq!(of("FOREIGN_REQUEST"), 2, "{codes:?}");
    assert_eq!((of("NOT_A_RECIPIENT"), of("UNKNOWN_RANGE")), (1, 1), "{codes:?}");
    assert_eq!(sequences(&inspector).await, Vec::<u64>::new());
    let stranger = story::planner(&world, "stranger").await;
    assert_eq!(sequences(&stranger).await, Vec::<u64>::new());

    // An epoch of the writer that is not known yet opens nothing else.
    let mut other_epoch = release(INSPECTOR, 0, 2);
    other_epoch["rangeList"][0]["epoch"] = json!(EPOCH + 1);
    munich.send("past-release", &other_epoch);
    munich.send("past-release", &release(INSPECTOR, 2, 2));
    sees(&inspector, &[2]).await;
}

/// A straggler of the past is the current value of those who may read it, until the consent ends.
#[tokio::test(flavor = "multi_thread")]
async fn a_current_value_of_the_past_is_shown_and_ends_with_its_consent() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = with_a_past(&world).await;
    let inspector = story::planner(&world, INSPECTOR).await;
    munich.send("ua-data", &story::report_to(&[BUYER], "m3", 3, 7));
    story::value_is(&buyer, "7").await;
    assert_eq!(shown(&inspector).await, nothing());
    let view = inspector.get(&story::network_path()).await.expect_ok();
    let mut live = inspector.live(view["lastEventId"].as_str()).await;

    munich.send("past-release", &release(INSPECTOR, 3, 3));
    story::value_is(&inspector, "7").await;
    let (_, event) = live.next("value").await;
    assert_eq!(event["fields"][0]["value"], "7");
    assert_eq!(shown(&inspector).await, (json!("7"), true, json!(7.0)), "progress uses it, too");

    munich.send("decision", &story::decision_at("2019-04-18T18:50:00Z", "PENDING", None));
    story::state_is(&inspector, "PENDING").await;
    assert_eq!(shown(&inspector).await, nothing());
    assert_eq!(shown(&buyer).await, nothing());
    assert_eq!(sequences(&inspector).await, [3], "what was shown stays history, as for everybody");
}
