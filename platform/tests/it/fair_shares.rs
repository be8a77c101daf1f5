//! Shares of organisations, factories and people: what one exhausts, others do not feel.

use std::time::Duration;

use asi_model::{
    DateTime,
    messages::{AssetOffer, Gap, GapCause},
    network::OperationNetwork,
};
use messaging::LogicalAddress;
use platform::{
    clock::new_opaque_id,
    networks::{Author, ChangeError, CommentError, PutNetwork, add_comment, put},
    store::{
        Collaboration, DEAD_LETTER_BYTES_PER_ADDRESS_MAX, DEAD_LETTERS_PER_ADDRESS_MAX,
        GAPS_PER_WRITER_MAX, NetworkRow, NewComment, NewDeadLetter, Organisation, Scope, Store,
        Work, WriterKey, WriterRow, WritersWanted,
    },
};
use reqwest::{Method, Response};
use serde_json::{Value, json};

use crate::{
    connector::Peer,
    harness::{Api, World, eventually},
    story,
};

fn at(seconds: i64) -> DateTime {
    DateTime::from_unix_micros(seconds * 1_000_000)
}

fn id<T: std::str::FromStr<Err: std::fmt::Debug>>(text: &str) -> T {
    text.parse().expect("valid")
}

/// A store with the organisations `a` and `b`, their factories `F` and `G` and a collaboration of both.
async fn store() -> (Store, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
    let mut work = store.begin().await.expect("begun");
    for (organisation, factory) in [("a", "F"), ("b", "G")] {
        let organisation_id = id(organisation);
        let row = Organisation { organisation_id, name: organisation.into(), created_at: at(0) };
        work.organisations().add(&row).await.expect("stored");
        let added = work.factories().add(&id(factory), &id(organisation), factory, at(0)).await;
        added.expect("stored");
    }
    let collaboration = Collaboration {
        collaboration_id: id("c"),
        name: "c".into(),
        created_at: at(0),
        members: vec![id("a"), id("b")],
        factories: vec![id("F"), id("G")],
    };
    work.collaborations().add(&collaboration).await.expect("stored");
    work.commit().await.expect("committed");
    (store, folder)
}

fn letter(factory: &str, bytes: usize) -> NewDeadLetter {
    NewDeadLetter {
        address: LogicalAddress::FactoryIngress(id(factory)).to_string(),
        message_id: None,
        subject: "any".into(),
        code: "INVALID_MESSAGE",
        reason: "It cannot be read.".into(),
        received_at: at(1),
        body: vec![b'x'; bytes],
        content_encoding: None,
        signature: None,
    }
}

/// Counts the dead letters of a factory.
async fn letters(work: &mut Work, factory: &str) -> usize {
    let address = LogicalAddress::FactoryIngress(id(factory)).to_string();
    let all = work.dead_letters().list(None, 1_000_000).await.expect("read");
    all.iter().filter(|letter| letter.address == address).count()
}

#[tokio::test]
async fn a_factory_flushes_its_own_dead_letters_alone() {
    let (store, _folder) = store().await;
    let mut work = store.begin().await.expect("begun");
    work.dead_letters().add(&letter("G", 10)).await.expect("stored");
    let mut forgotten = 0;
    for _ in 0..DEAD_LETTERS_PER_ADDRESS_MAX + 50 {
        forgotten += work.dead_letters().add(&letter("F", 10)).await.expect("stored");
    }
    assert_eq!(forgotten, 50);
    assert_eq!(letters(&mut work, "F").await, DEAD_LETTERS_PER_ADDRESS_MAX as usize);
    assert_eq!(letters(&mut work, "G").await, 1, "the other's evidence stays");
}

#[tokio::test]
async fn dead_letters_of_a_factory_have_a_bounded_number_of_bytes() {
    let (store, _folder) = store().await;
    let mut work = store.begin().await.expect("begun");
    work.dead_letters().add(&letter("G", 10)).await.expect("stored");
    let half = DEAD_LETTER_BYTES_PER_ADDRESS_MAX as usize / 2;
    for _ in 0..3 {
        work.dead_letters().add(&letter("F", half)).await.expect("stored");
    }
    assert_eq!(letters(&mut work, "F").await, 2);
    work.dead_letters().add(&letter("F", 3 * half)).await.expect("stored");
    assert_eq!(letters(&mut work, "F").await, 1, "the newest stays, however large");
    assert_eq!(letters(&mut work, "G").await, 1);
}

const FIRST: WritersWanted = WritersWanted { after: None, limit: 100 };

fn gap(factory: &str, number: u32) -> Gap {
    Gap {
        message_id: id("m"),
        factory_id: id(factory),
        data_set_writer_id: 1,
        epoch: 1,
        first_sequence: number,
        last_sequence: number,
        cause: GapCause::Coalesced,
    }
}

#[tokio::test]
async fn the_oldest_gaps_of_a_writer_become_a_coarse_one_which_says_so() {
    let (store, _folder) = store().await;
    let mut work = store.begin().await.expect("begun");
    for factory in ["F", "G"] {
        let key = WriterKey { factory_id: id(factory), data_set_writer_id: 1, epoch: 1 };
        work.writers().put(&WriterRow::new(key)).await.expect("stored");
    }
    assert!(work.writers().add_gaps(&gap("G", 7), &[(7, 7)], at(1)).await.expect("stored"));
    let count = u32::try_from(3 * GAPS_PER_WRITER_MAX).expect("few");
    for number in 0..count {
        work.writers()
            .add_gaps(&gap("F", 2 * number), &[(2 * number, 2 * number)], at(1))
            .await
            .expect("stored");
    }
    let seen = work.writers().of_factory(&Scope::Platform, &id("F"), FIRST).await.expect("read");
    let gaps = &seen[0].gaps;
    assert!(gaps.len() as u64 <= GAPS_PER_WRITER_MAX, "{}", gaps.len());
    assert!(gaps[0].is_coarse && !gaps[1].is_coarse);
    for number in 0..count {
        let is_in =
            gaps.iter().any(|gap| (gap.first_sequence..=gap.last_sequence).contains(&(2 * number)));
        assert!(is_in, "{number} was announced and is not lost");
    }
    let seen = work.writers().of_factory(&Scope::Platform, &id("G"), FIRST).await.expect("read");
    assert_eq!((seen[0].gaps.len(), seen[0].gaps[0].is_coarse), (1, false));
}

fn author(organisation: &str) -> Author {
    Author {
        name: format!("{organisation}-planner"),
        organisation_id: Some(id(organisation)),
        is_administrator: false,
        may_plan: true,
        now: at(1),
        scope: Scope::Organisation(id(organisation)),
    }
}

/// A network of an organisation's factory with requests of the organisation.
fn network(name: &str, factory: &str, requester: &str, requests: usize) -> OperationNetwork {
    let requests: Vec<Value> =
        (0..requests).map(|number| story::request(&format!("r{number}"), requester)).collect();
    let operation = json!({ "operationId": "op", "operationType": "PRODUCTION", "owningFactoryId": factory,
        "plannedQuantity": 12, "quantityUnit": "PIECE", "dynamicDataRequestList": requests });
    let document = json!({ "operationNetworkId": name, "operationList": [operation] });
    serde_json::from_value(document).expect("valid")
}

async fn draw(
    work: &mut Work,
    network: OperationNetwork,
    organisation: &str,
) -> Result<(), ChangeError> {
    let change = PutNetwork { collaboration_id: id("c"), network, expected_revision: None };
    put(work, change, &author(organisation), Duration::from_secs(60)).await.map(drop)
}

#[tokio::test]
async fn an_organisation_draws_a_bounded_number_of_networks() {
    let (store, _folder) = store().await;
    let mut work = store.begin().await.expect("begun");
    for number in 0..1_000 {
        let row = NetworkRow {
            collaboration_id: id("c"),
            revision: 1,
            network: network(&format!("net-{number}"), "F", "a", 0),
            updated_at: at(1),
            updated_by: "u".into(),
            author_organisation: None,
            withdrawn_at: None,
            drawn_by: Some(id("a")),
        };
        work.networks().put(&row).await.expect("stored");
    }
    let refusal = draw(&mut work, network("one-more", "F", "a", 0), "a").await;
    let refusal = refusal.expect_err("too many");
    assert!(matches!(refusal, ChangeError::QuotaExceeded { limit: 1_000, .. }), "{refusal}");
    draw(&mut work, network("of-b", "G", "b", 1), "b").await.expect("another organisation");
}

#[tokio::test]
async fn an_organisation_has_a_bounded_number_of_requests_in_a_network() {
    let (store, _folder) = store().await;
    let mut work = store.begin().await.expect("begun");
    let refusal = draw(&mut work, network("net", "F", "a", 5_001), "a").await;
    let refusal = refusal.expect_err("too many");
    assert!(matches!(refusal, ChangeError::QuotaExceeded { limit: 5_000, .. }), "{refusal}");
    draw(&mut work, network("net", "F", "a", 3), "a").await.expect("few");
    draw(&mut work, network("of-b", "G", "b", 3), "b").await.expect("another organisation");
}

#[tokio::test]
async fn a_person_writes_a_bounded_number_of_comments_on_a_network() {
    let (store, _folder) = store().await;
    let mut work = store.begin().await.expect("begun");
    draw(&mut work, network("net", "F", "a", 1), "a").await.expect("drawn");
    let comment = |person: &str| NewComment {
        comment_id: new_opaque_id(),
        operation_network_id: id("net"),
        factory_id: id("F"),
        dynamic_data_request_id: None,
        field_name: None,
        author_id: person.to_owned(),
        is_from_factory: false,
        text: "Hello".into(),
        created_at: at(1),
    };
    for _ in 0..2_000 {
        work.comments().add(&comment("ann")).await.expect("stored");
    }
    let refusal = add_comment(&mut work, &comment("ann"), &author("a")).await;
    assert!(matches!(refusal, Err(CommentError::TooMany)), "{refusal:?}");
    add_comment(&mut work, &comment("amy"), &author("a")).await.expect("another person");
}

#[tokio::test]
async fn what_is_kept_of_a_factory_is_counted_by_itself() {
    let (store, _folder) = store().await;
    let mut work = store.begin().await.expect("begun");
    for number in 0..3 {
        let offer = AssetOffer {
            message_id: id("m"),
            factory_id: id("F"),
            asset_id: id(&format!("asset-{number}")),
            kind_list: Vec::new(),
            description: "über".into(),
        };
        work.meta_data().put_offer(&offer, at(1)).await.expect("stored");
    }
    let kept = work.quotas().offers(&id("F"), &id("asset-0")).await.expect("read");
    assert_eq!((kept.rows, kept.bytes), (2, 2 * (5 + 2)), "bytes, not characters");
    let kept = work.quotas().offers(&id("G"), &id("asset-0")).await.expect("read");
    assert_eq!((kept.rows, kept.bytes), (0, 0));
}

/// Small shares, so that a test exhausts them.
const SMALL: &str = "[web.share_per_person]\nrequests_per_second = 1\nrequests_at_once = 60\n\
    downloads = 1\nstreams = 1\n\
    [web.share_per_organisation]\nrequests_per_second = 1\nrequests_at_once = 100\n\
    downloads = 2\nstreams = 2\n";

async fn get(api: &Api, path: &str) -> Response {
    let request = api.client.request(Method::GET, &format!("/api/v1{path}"));
    request.send().await.expect("an answer")
}

async fn code(response: Response) -> (u16, Value) {
    let status = response.status().as_u16();
    let document: Value = response.json().await.unwrap_or_default();
    (status, document["code"].clone())
}

/// Sends dead letters and gaps until both of the factory's shares are used up.
fn exhaust_ingest(peer: &Peer) {
    for number in 0..DEAD_LETTERS_PER_ADDRESS_MAX + 20 {
        peer.send_bytes("decision", None, format!("not JSON {number}").as_bytes());
    }
    for number in 0..1_200 {
        let message = json!({ "messageType": "gap", "messageId": format!("gap-{number}"), "factoryId": "INS_HAM",
            "dataSetWriterId": 1, "epoch": 1, "firstSequence": 2 * number + 1,
            "lastSequence": 2 * number + 1, "cause": "COALESCED" });
        peer.send("gap", &message);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn what_one_member_exhausts_others_do_not_feel() {
    let world = World::start_configured(SMALL).await;
    let admin = story::set_up(&world).await;
    let (munich, hamburg) = (
        Peer::enrolled(&world, &admin, "FOR_MUC").await,
        Peer::enrolled(&world, &admin, "INS_HAM").await,
    );
    let inspector = story::planner(&world, "inspect-hamburg").await;
    let maker = story::planner(&world, "frames-munich").await;
    munich.send_bytes("decision", None, b"the only dead letter of Munich");

    // One member uses up streams, dead letters, gaps, and at last its requests.
    let held = get(&inspector, "/live").await;
    assert_eq!(held.status(), 200);
    assert_eq!(code(get(&inspector, "/live").await).await, (429, "TOO_MANY_STREAMS".into()));
    exhaust_ingest(&hamburg);
    let metrics = eventually("both shares are used up", || async {
        let text = admin.client.call(Method::GET, "/metrics", None).await.expect("an answer").text;
        let has = |share: &str| {
            text.contains(&format!("{{of=\"factory\",share=\"{share}\",who=\"INS_HAM\"}}"))
        };
        if has("dead_letters") && has("gaps") { Ok(text) } else { Err(text) }
    })
    .await;
    assert!(!metrics.contains("who=\"FOR_MUC\""), "{metrics}");
    let mut passed = 0;
    while get(&inspector, "/status").await.status() == 200 {
        passed += 1;
        assert!(passed < 1_000, "requests have no end");
    }
    assert_eq!(code(get(&inspector, "/status").await).await, (429, "TOO_MANY_REQUESTS".into()));

    // The other member goes on as if nothing were.
    for _ in 0..20 {
        assert_eq!(get(&maker, "/factories").await.status(), 200);
    }
    assert_eq!(get(&maker, "/live").await.status(), 200);
    assert_eq!(get(&maker, "/factories/FOR_MUC/accesses/audit").await.status(), 200);
    assert_eq!(get(&maker, "/audit-entries/export").await.status(), 200);
    let store = &world.handle().application.store;
    let mut work = store.read().await.expect("a reader");
    let letters = work.dead_letters().list(None, 1_000_000).await.expect("read");
    let of = |factory: &str| {
        let address = format!("factory.{factory}.ingress");
        letters.iter().filter(|letter| letter.address == address).count()
    };
    assert_eq!((of("FOR_MUC"), of("INS_HAM")), (1, DEAD_LETTERS_PER_ADDRESS_MAX as usize));
    drop(held);
}

/// Room of one MiB for each factory.
const SMALL_ROOM: &str = "[retention]\nkept_mib_per_factory = 1\n";

#[tokio::test(flavor = "multi_thread")]
async fn a_factory_without_room_waits_at_the_broker_and_others_go_on() {
    let mut world = World::start_configured(SMALL_ROOM).await;
    let (admin, buyer, munich, hamburg) = story::accepted(&world).await;
    // JSON may have any space in it, and raw messages are kept as they came.
    let padding = " ".repeat(200_000);
    for number in 0..6 {
        let report = story::report(&format!("m{number}"), number, u64::from(number));
        let body = report.to_string() + &padding;
        munich.send_bytes("ua-data", Some(&format!("m{number}")), body.as_bytes());
    }
    story::value_is(&buyer, "5").await;
    // What was seen of its room counts for a while.
    tokio::time::sleep(Duration::from_secs(6)).await;
    munich.send("ua-data", &story::report("m6", 6, 6));
    eventually("the share is used up", || async {
        let text = admin.client.call(Method::GET, "/metrics", None).await.expect("an answer").text;
        let line = "verbund_share_refusals_total{of=\"factory\",share=\"kept\",who=\"FOR_MUC\"}";
        if text.contains(line) { Ok(()) } else { Err(text) }
    })
    .await;
    hamburg.send_bytes("decision", None, b"no JSON");
    let store = &world.handle().application.store;
    eventually("the other factory is served", || async {
        let mut work = store.read().await.expect("a reader");
        let count = letters(&mut work, "INS_HAM").await;
        if count == 1 { Ok(()) } else { Err(count.to_string()) }
    })
    .await;
    let mut work = store.read().await.expect("a reader");
    assert_eq!(letters(&mut work, "FOR_MUC").await, 0, "nothing of it is set aside");
    story::value_is(&buyer, "5").await;
    drop(work);
    // The platform ends although a factory waits.
    let ending = tokio::time::timeout(Duration::from_secs(20), world.stop());
    ending.await.expect("it ends");
}
