//! Every kind of message, sent with the credential of each member's factory and tool against the
//! requests, writers, parts and networks of each other member: nothing of the other's changes, and
//! the refusal is a dead letter of the sender's alone.

use std::collections::{BTreeMap, BTreeSet};

use asi_model::MessageId;
use messaging::LogicalAddress;
use platform::clock::new_message_id;
use serde_json::{Value, json};

use super::{
    Member,
    examples::{Example, examples, filled, forged, refusals},
    members,
    walk::{Ids, read, readings},
};
use crate::{
    chain::{self, seen},
    connector::Peer,
    harness::{Api, World, event_form, eventually},
    story::{self, NETWORK},
};

/// The number of the writer that each factory uses.
const WRITER: u16 = 1;
/// A revision that no network here reaches.
const NO_REVISION: u64 = 999;
/// A network that does not exist.
const NO_NETWORK: &str = "net-none";

/// A member with its programs on the broker.
struct Side {
    member: Member,
    factory: Peer,
    tool: Peer,
    /// Message that brought the factory its part of the own network.
    part: Value,
}

/// A request that the author of a message has nothing to do with.
struct Target {
    network: String,
    operation: String,
    request: String,
}

/// A message, with the codes that its dead letter may have; none where it gets no dead letter.
struct Attempt {
    id: MessageId,
    kind: String,
    body: Value,
    codes: &'static [&'static str],
}

impl Attempt {
    fn new(
        example: &Example,
        values: &BTreeMap<&str, Value>,
        codes: &'static [&'static str],
    ) -> Self {
        let id = new_message_id();
        let mut values = values.clone();
        values.insert("messageId", json!(id));
        values.insert("MessageId", json!(id));
        let body = filled(&example.body, &values);
        Self { id, kind: example.kind.clone(), body, codes }
    }

    fn send(&self, peer: &Peer) {
        let subject = self.kind.split('/').next().expect("a type");
        let body = self.body.to_string();
        peer.send_bytes(subject, Some(self.id.as_str()), body.as_bytes());
    }
}

/// All members, each with a part that it answered, an open field, a value and metadata of a writer.
async fn sides(world: &World, admin: &Api) -> Vec<Side> {
    let mut sides = Vec::new();
    for member in members(world, admin).await {
        let factory = Peer::enrolled(world, admin, member.factory).await;
        let path = format!("/tools/{}/credentials", member.tool());
        let tool = Peer::tool(&admin.post(&path, json!({})).await.expect_ok(), &member.tool());
        let part = answer(admin, &factory, &member, &member.network()).await;
        if !sides.is_empty() {
            answer(admin, &factory, &member, NETWORK).await;
        }
        begin(&member, &factory).await;
        sides.push(Side { member, factory, tool, part });
    }
    story::parts_are(admin, "ACCEPTED").await;
    sides
}

/// The member's factory takes its part of a network. Returns the id of the message that brought it.
async fn answer(admin: &Api, factory: &Peer, member: &Member, network: &str) -> Value {
    let view = admin.get(&format!("/operation-networks/{network}")).await.expect_ok();
    let mut parts = view["parts"].as_array().expect("parts").iter();
    let revision = &parts.find(|part| part["factoryId"] == member.factory).expect("it")["revision"];
    let is_newest = |part: &Value| {
        part["operationNetwork"]["operationNetworkId"] == *network && part["revision"] == *revision
    };
    let part = factory.receive("operation-network", is_newest).await;
    factory.accept(&part);
    part["messageId"].clone()
}

/// The member's factory opens the field of its own request, and reports a value.
async fn begin(member: &Member, factory: &Peer) {
    let request = format!("Req-{}", member.id);
    let mut decision = story::decision("MAPPED", Some(&member.secret()));
    decision["factoryId"] = json!(member.factory);
    decision["operationNetworkId"] = json!(member.network());
    decision["operationId"] = json!("Own");
    decision["dynamicDataRequestId"] = json!(request);
    factory.send("decision", &decision);
    let mut report = story::report_to(&[member.id], &format!("m-{}", member.id), 0, 3);
    report["PublisherId"] = json!(member.factory);
    let payload = &mut report["Messages"][0]["Payload"];
    payload["operationNetworkId"]["Body"] = json!(member.network());
    payload["operationId"]["Body"] = json!("Own");
    payload["dynamicDataRequestId"]["Body"] = json!(request);
    factory.send("ua-data", &report);
    eventually("the value", || async {
        let view = member.api.get(&member.path()).await.expect_ok();
        if view["fields"][0]["value"] == "3" { Ok(()) } else { Err(view["fields"].to_string()) }
    })
    .await;
}

/// Lists the requests that belong to `owner` alone: its own, and those that its factory is asked.
fn targets(chain: &Value, author: &Member, owner: &Member) -> Vec<Target> {
    let request = format!("Req-{}", owner.id);
    let mut targets =
        vec![Target { network: owner.network(), operation: "Own".to_owned(), request }];
    let text = |value: &Value| value.as_str().expect("a text").to_owned();
    for operation in chain["operationList"].as_array().expect("operations") {
        let factory = &operation["owningFactoryId"];
        for request in operation["dynamicDataRequestList"].as_array().into_iter().flatten() {
            let is_of_owner = *factory == owner.factory || request["requesterId"] == owner.id;
            if is_of_owner && *factory != author.factory {
                targets.push(Target {
                    network: NETWORK.to_owned(),
                    operation: text(&operation["operationId"]),
                    request: text(&request["dynamicDataRequestId"]),
                });
            }
        }
    }
    targets
}

/// Messages of the author's factory: in its own name, and in that of the owner's.
fn of_factory(
    examples: &[Example],
    (author, owner): (&Member, &Side),
    target: &Target,
    sequence: &mut u32,
) -> Vec<Attempt> {
    let mut attempts = Vec::new();
    for example in examples {
        let codes = match example.kind.as_str() {
            // The example is of the log of this factory.
            "ledger-checkpoint" if author.factory == "FOR_MUC" => &[],
            kind => refusals(kind),
        };
        for (name, codes) in
            [(author.factory, codes), (owner.member.factory, forged(&example.kind))]
        {
            *sequence += 1;
            let values = BTreeMap::from([
                ("factoryId", json!(name)),
                ("PublisherId", json!(name)),
                ("operationNetworkId", json!(target.network)),
                ("operationId", json!(target.operation)),
                ("dynamicDataRequestId", json!(target.request)),
                ("correlationId", owner.part.clone()),
                ("revision", json!(NO_REVISION)),
                ("recipientList", json!([author.id, owner.member.id])),
                ("recipientId", json!(recipient(&example.kind, author))),
                ("dataSetWriterId", json!(WRITER)),
                ("DataSetWriterId", json!(WRITER)),
                ("SequenceNumber", json!(sequence)),
                ("decidedAt", json!("2026-01-01T00:00:00Z")),
            ]);
            attempts.push(Attempt::new(example, &values, codes));
        }
    }
    attempts
}

/// The past is asked for by the author itself; the log of the example is for one organisation.
fn recipient<'m>(kind: &str, author: &'m Member) -> &'m str {
    if kind == "past-release" { author.id } else { "acme-aero" }
}

/// A question of the author's tool about an operation, under an id and in a name.
fn question(tool: &str, network: &str, operation: &str, request: Value) -> Attempt {
    let id = new_message_id();
    let body = json!({ "messageType": "data-request", "messageId": id, "toolId": tool,
        "operationNetworkId": network, "operationId": operation, "dynamicDataRequest": request });
    Attempt { id, kind: "data-request".to_owned(), body, codes: &[] }
}

/// Questions of the author's tool about what is the owner's.
fn questions(author: &Member, owner: &Member, target: &Target) -> Vec<Attempt> {
    let (tool, network, operation) = (author.tool(), &target.network, &target.operation);
    let mut in_its_name =
        question(&owner.tool(), network, operation, story::request("Asked", owner.id));
    in_its_name.codes = &["FORGED_PUBLISHER"];
    vec![
        in_its_name,
        question(&tool, network, operation, story::request("Asked", owner.id)),
        question(&tool, network, operation, story::request(&target.request, owner.id)),
    ]
}

/// All that a member reads of its own, by path.
async fn view(side: &Side, author: &Member) -> BTreeMap<String, Value> {
    let member = &side.member;
    let ids = Ids {
        networks: vec![member.network(), NETWORK.to_owned(), author.network()],
        factories: vec![member.factory.to_owned(), author.factory.to_owned()],
        requests: vec![format!("Req-{}", member.id)],
        organisations: vec![author.id.to_owned()],
    };
    let mut readings = readings(&ids);
    // Reading is itself on record, and the session and its platform are nobody's.
    readings.retain(|reading| {
        let is_of_itself = ["/session", "/sessions", "/status"];
        let is_of_itself = is_of_itself.contains(&reading.operation.as_str());
        !is_of_itself && !reading.operation.contains("/accesses")
    });
    let answers = read(&member.api.client, &readings).await;
    let views = answers.into_iter().map(|answer| {
        let body = match answer.reading.operation.ends_with("/export") {
            true => json!(answer.body.lines().collect::<Vec<_>>()),
            false => serde_json::from_str(&answer.body).expect("JSON"),
        };
        (answer.reading.path, json!([answer.status, without(&body, author.factory)]))
    });
    views.collect()
}

/// Returns an answer without signs of life of a factory, and with the form of ids of live events.
fn without(body: &Value, factory: &str) -> Value {
    match body {
        Value::Object(members) => {
            let is_of_factory = body["factoryId"] == factory;
            let signs: &[&str] = match is_of_factory {
                true => &["lastSeenAt", "publisherState"],
                false => &[],
            };
            let others = members.iter().filter(|(name, _)| !signs.contains(&name.as_str()));
            let shown = others.map(|(name, member)| match name.as_str() {
                "lastEventId" => (name.clone(), json!(event_form(member))),
                _ => (name.clone(), without(member, factory)),
            });
            shown.collect()
        }
        Value::Array(elements) => elements.iter().map(|each| without(each, factory)).collect(),
        other => other.clone(),
    }
}

/// Codes and addresses of all dead letters by the ids of their messages.
async fn dead_letters(admin: &Api) -> BTreeMap<String, (String, String)> {
    let (mut letters, mut cursor) = (BTreeMap::new(), String::new());
    loop {
        let page = admin.get(&format!("/dead-letters?limit=1000{cursor}")).await.expect_ok();
        for letter in page["items"].as_array().expect("letters") {
            let text = |name: &str| letter[name].as_str().expect("a text").to_owned();
            letters.insert(text("messageId"), (text("code"), text("address")));
        }
        let Some(next) = page["nextCursor"].as_str() else { return letters };
        cursor = format!("&cursor={next}");
    }
}

/// Waits until everything that a member's programs sent has been applied.
async fn settled(side: &Side) {
    let Side { member, factory, tool, .. } = side;
    let id = new_message_id();
    factory.send(
        "comment",
        &json!({ "messageType": "comment", "messageId": id, "factoryId": member.factory,
            "operationNetworkId": member.network(), "authorId": "engineer", "text": id }),
    );
    let last = question(&member.tool(), NO_NETWORK, "Own", story::request("Asked", member.id));
    last.send(tool);
    tool.receive("acknowledgement", |answer| answer["correlationId"] == last.id.as_str()).await;
    eventually("the last comment", || async {
        let path = format!("{}/comments?limit=1000", member.path());
        let comments = member.api.get(&path).await.expect_ok().to_string();
        if comments.contains(id.as_str()) { Ok(()) } else { Err(comments) }
    })
    .await;
}

/// The refusal of a question about a network, without its name.
async fn refusal(author: &Side, network: &str) -> String {
    let request = story::request("Asked", author.member.id);
    let asked = question(&author.member.tool(), network, "Own", request);
    asked.send(&author.tool);
    let is_answer = |answer: &Value| answer["correlationId"] == asked.id.as_str();
    let answer = author.tool.receive("acknowledgement", is_answer).await;
    assert_eq!((&answer["result"], &answer["revision"]), (&json!("REJECTED"), &Value::Null));
    answer["faultList"].to_string().replace(network, "-")
}

/// Sends everything of an author against all others. Returns what was sent by the two programs.
fn send_all(
    examples: &[Example],
    chain: &Value,
    author: &Side,
    owners: &[&Side],
) -> (Vec<Attempt>, Vec<Attempt>) {
    let (mut of_factory_sent, mut of_tool, mut sequence) = (Vec::new(), Vec::new(), 100);
    for owner in owners {
        for target in targets(chain, &author.member, &owner.member) {
            let pair = (&author.member, *owner);
            of_factory_sent.extend(of_factory(examples, pair, &target, &mut sequence));
            of_tool.extend(questions(&author.member, &owner.member, &target));
        }
        for example in examples {
            let values = BTreeMap::from([("toolId", json!(author.member.tool()))]);
            of_tool.push(Attempt::new(example, &values, &["INVALID_MESSAGE"]));
        }
    }
    of_factory_sent.iter().for_each(|attempt| attempt.send(&author.factory));
    of_tool.iter().for_each(|attempt| attempt.send(&author.tool));
    (of_factory_sent, of_tool)
}

/// Compares the dead letters with what was sent to an address, and removes them. Returns what
/// differs.
fn differences(
    letters: &mut BTreeMap<String, (String, String)>,
    sent: &[Attempt],
    address: &LogicalAddress,
) -> Vec<String> {
    let mut differences = Vec::new();
    for Attempt { id, kind, body, codes } in sent {
        let letter = letters.remove(id.as_str());
        let is_expected = match &letter {
            Some((code, at)) => codes.contains(&code.as_str()) && *at == address.to_string(),
            None => codes.is_empty(),
        };
        if !is_expected {
            differences.push(format!("{kind} at {address}: {letter:?}, not {codes:?}: {body}"));
        }
    }
    differences
}

#[tokio::test(flavor = "multi_thread")]
async fn no_message_changes_what_belongs_to_another_member() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let sides = sides(&world, &admin).await;
    let (examples, chain) = (examples(), seen(&admin).await);
    let mut known: BTreeSet<String> = dead_letters(&admin).await.into_keys().collect();
    let mut count = 0;
    for author in &sides {
        let owners: Vec<&Side> =
            sides.iter().filter(|owner| owner.member.id != author.member.id).collect();
        let mut before = Vec::new();
        for owner in &owners {
            before.push(view(owner, &author.member).await);
        }
        let (of_factory, of_tool) = send_all(&examples, &chain, author, &owners);
        settled(author).await;
        for (owner, before) in owners.iter().zip(&before) {
            let after = view(owner, &author.member).await;
            for (path, view) in &after {
                let id = owner.member.id;
                assert_eq!(view, &before[path], "{} changes {path} of {id}", author.member.id);
            }
            let received = [author.factory.received(), author.tool.received()].concat();
            let secret = owner.member.secret();
            assert!(!received.iter().any(|text| text.contains(&secret)), "{}", author.member.id);
            let hidden = refusal(author, &owner.member.network()).await;
            assert_eq!(hidden, refusal(author, NO_NETWORK).await, "it exists, and is hidden");
        }
        let mut letters = dead_letters(&admin).await;
        letters.retain(|id, _| known.insert(id.clone()));
        let factory = author.member.factory.parse().expect("an id");
        let address = LogicalAddress::FactoryIngress(factory);
        let mut differing = differences(&mut letters, &of_factory, &address);
        let tool = author.member.tool().parse().expect("an id");
        let address = LogicalAddress::ToolRequests(tool);
        differing.extend(differences(&mut letters, &of_tool, &address));
        assert!(differing.is_empty(), "{}", differing.join("\n"));
        assert!(letters.is_empty(), "{letters:?}");
        count += of_factory.len() + of_tool.len();
    }
    assert!(count > 1000, "only {count} messages");
}
