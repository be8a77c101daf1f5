//! A story in which consents are asked for, given, ended and given again, with all that each member
//! reads and hears.

use std::sync::Arc;

use parking_lot::Mutex;
use serde_json::{Value, json};
use tokio::task::JoinSet;

use super::{
    Member,
    attack::attack,
    members,
    oracle::{Door, Oracle, Subject},
    walk::{Ids, read, readings},
};
use crate::{
    chain::{self, CARRIER, operation},
    connector::Peer,
    harness::{Api, Live, World, eventually},
    story::{self, NETWORK},
};

pub const BUYER: &str = "acme-aero";
pub const MAKER: &str = "frames-munich";
pub const INSPECTOR: &str = "inspect-hamburg";
const STRANGER: &str = "stranger";
pub const ADMINISTRATOR: &str = "admin";
const EVERYBODY: [&str; 6] = [BUYER, MAKER, INSPECTOR, CARRIER, STRANGER, ADMINISTRATOR];
const SECOND: &str = "frame-4712";
const NETWORKS: [&str; 2] = [NETWORK, SECOND];
const EPOCH: u32 = 608_926_829;

/// A request that FOR_MUC is asked, each with a writer of its own.
struct Asked {
    network: &'static str,
    request: &'static str,
    /// The organisation whose tool gets the reports.
    tool_of: Option<&'static str>,
}

/// The requests of the buyer, whose recipients change, and one of the inspector alone.
const ASKED: [Asked; 4] = [
    Asked { network: NETWORK, request: "ReqResponse1", tool_of: Some(BUYER) },
    Asked { network: NETWORK, request: "ForTheInspector", tool_of: Some(INSPECTOR) },
    Asked { network: SECOND, request: "ReqResponse1", tool_of: Some(BUYER) },
    Asked { network: NETWORK, request: "AskedByHamburg", tool_of: None },
];
pub const OF_THE_BUYER: [usize; 3] = [0, 1, 2];
pub const ALL: [usize; 4] = [0, 1, 2, 3];

fn tool_of(organisation: &str) -> String {
    format!("Queue-{organisation}")
}

pub fn path(network: &str) -> String {
    format!("/operation-networks/{network}")
}

fn ids() -> Ids {
    let texts = |list: &[&str]| list.iter().map(|&text| text.to_owned()).collect();
    Ids {
        networks: texts(&[NETWORK, SECOND, "none"]),
        factories: texts(&["FOR_MUC", "INS_HAM", "NONE"]),
        requests: texts(&["ReqResponse1", "ForTheInspector", "AskedByHamburg"]),
        organisations: texts(&[BUYER, INSPECTOR]),
    }
}

/// A member with all that it hears.
struct Reader {
    id: &'static str,
    api: Api,
    events: Arc<Mutex<String>>,
    tool: Option<Peer>,
}

/// The story, and what each may know of it.
pub struct Play {
    admin: Api,
    /// Members that try to change what is others'.
    members: Vec<Member>,
    readers: Vec<Reader>,
    munich: Peer,
    pub oracle: Oracle,
    recipients: Vec<&'static str>,
    revisions: [u64; 2],
    /// Hour of the day, which counts up with the decisions.
    hour: u32,
    /// Number of reports of each writer so far.
    reports: u32,
    /// Readers of live events, which end with the story.
    _listeners: JoinSet<()>,
}

async fn listen(mut live: Live, events: Arc<Mutex<String>>) {
    loop {
        if let Some(event) = live.event().await {
            events.lock().push_str(&format!("{} {}\n", event.name, event.data));
        }
    }
}

impl Play {
    /// The chain, and another network with one of its requests; both are open to nobody.
    pub async fn begin(world: &World) -> Self {
        let admin = chain::drawn(world).await;
        let members = members(world, &admin).await;
        let munich = Peer::enrolled(world, &admin, "FOR_MUC").await;
        let (mut readers, mut listeners) = (Vec::new(), JoinSet::new());
        for id in EVERYBODY {
            let api = match id {
                ADMINISTRATOR => world.admin().await,
                _ => story::planner(world, id).await,
            };
            let events = Arc::default();
            listeners.spawn(listen(api.live(None).await, Arc::clone(&events)));
            let mut tool = None;
            if [BUYER, INSPECTOR].contains(&id) {
                let name = tool_of(id);
                let body = json!({ "toolId": name, "organisationId": id, "name": name });
                admin.post("/tools", body).await.expect_ok();
                let path = format!("/tools/{name}/credentials");
                tool = Some(Peer::tool(&admin.post(&path, json!({})).await.expect_ok(), &name));
            }
            readers.push(Reader { id, api, events, tool });
        }
        let (oracle, revisions, recipients) = (Oracle::default(), [0; 2], Vec::new());
        let (hour, reports) = (0, 0);
        let mut play = Self {
            admin,
            members,
            readers,
            munich,
            oracle,
            recipients,
            revisions,
            hour,
            reports,
            _listeners: listeners,
        };
        let purpose = play.oracle.issue();
        play.oracle.show(Subject::Purpose, purpose, &[BUYER, MAKER, ADMINISTRATOR]);
        play.draw(&format!("Plan {purpose}")).await;
        play
    }

    /// Draws the networks with the buyer's requests.
    async fn draw(&mut self, purpose: &str) {
        for network in NETWORKS {
            let mut document = chain::network();
            document["operationNetworkId"] = json!(network);
            let asked = ASKED.iter().filter(|a| a.network == network && a.tool_of.is_some());
            let requests = asked.map(|asked| {
                let tool = tool_of(asked.tool_of.expect("a tool"));
                let mut request = story::request_of_tool(asked.request, BUYER, &tool);
                request["purpose"] = json!(purpose);
                request
            });
            operation(&mut document, "MakeFrame1")["dynamicDataRequestList"] = requests.collect();
            self.put(network, document).await;
        }
        self.recipients = vec![BUYER];
    }

    async fn put(&mut self, network: &str, document: Value) {
        let answer = self.api(BUYER).put(&path(network), chain::body(document)).await.expect_ok();
        let at = NETWORKS.iter().position(|known| *known == network).expect("a network");
        self.revisions[at] = answer["revision"].as_u64().expect("a revision");
    }

    pub fn api(&self, id: &str) -> &Api {
        &self.readers.iter().find(|reader| reader.id == id).expect("a reader").api
    }

    /// The recipients of the request with this number.
    fn recipients(&self, number: usize) -> Vec<&'static str> {
        if OF_THE_BUYER.contains(&number) { self.recipients.clone() } else { vec![INSPECTOR] }
    }

    /// The buyer gives its requests other recipients, which ends the consents.
    pub async fn revise(&mut self, recipients: &[&'static str]) {
        self.recipients = recipients.to_vec();
        for network in NETWORKS {
            let mut document =
                self.api(BUYER).get(&path(network)).await.expect_ok()["network"].clone();
            let requests = &mut operation(&mut document, "MakeFrame1")["dynamicDataRequestList"];
            for request in requests.as_array_mut().expect("a list") {
                request["recipientList"] = json!(recipients);
            }
            self.put(network, document).await;
        }
        OF_THE_BUYER.into_iter().for_each(|number| self.close(number));
    }

    /// A field is open no more.
    pub fn close(&mut self, number: usize) {
        self.oracle.hide(Subject::Value(number));
        self.oracle.hide(Subject::Reason(number));
    }

    /// The factory takes the newest revisions.
    pub async fn answer(&self) {
        for (network, revision) in NETWORKS.into_iter().zip(self.revisions) {
            let is_newest = |part: &Value| {
                part["operationNetwork"]["operationNetworkId"] == network
                    && part["revision"] == revision
            };
            let part = self.munich.receive("operation-network", is_newest).await;
            self.munich.accept(&part);
            eventually("the answer", || async {
                let view = self.api(MAKER).get(&path(network)).await.expect_ok();
                let mut parts = view["parts"].as_array().expect("parts").iter();
                let is_taken =
                    |part: &Value| part["factoryId"] == "FOR_MUC" && part["state"] == "ACCEPTED";
                if parts.any(is_taken) { Ok(()) } else { Err(view["parts"].to_string()) }
            })
            .await;
        }
    }

    /// The factory decides about the requests with these numbers, each with a reason.
    pub async fn decide(&mut self, numbers: &[usize], state: &str) {
        self.hour += 1;
        for &number in numbers {
            let (asked, reason) = (&ASKED[number], self.oracle.issue());
            let time = format!("2019-04-18T{:02}:00:00Z", self.hour);
            let mut decision = story::decision_at(&time, state, Some(&format!("Since {reason}")));
            decision["operationNetworkId"] = json!(asked.network);
            decision["dynamicDataRequestId"] = json!(asked.request);
            self.munich.send("decision", &decision);
            self.close(number);
            let mut readers = self.recipients(number);
            readers.push(MAKER);
            self.oracle.show(Subject::Reason(number), reason, &readers);
            self.oracle.give(Door::Live, reason, &readers);
            self.is_shown(MAKER, &path(asked.network), reason).await;
        }
    }

    async fn is_shown(&self, reader: &str, path: &str, secret: u64) {
        eventually(path, || async {
            let found = self.api(reader).get(path).await.expect_ok().to_string();
            if found.contains(&secret.to_string()) { Ok(()) } else { Err(found) }
        })
        .await;
    }

    /// The factory reports under each request, for `named` as it says. The fields of `open` have
    /// current values, and the requests of `asked` are in effect. Returns the values by request.
    pub async fn report(
        &mut self,
        named: &[&'static str],
        open: &[usize],
        asked: &[usize],
    ) -> Vec<u64> {
        let mut secrets = Vec::new();
        for (number, Asked { network, request, tool_of }) in ASKED.iter().enumerate() {
            let secret = self.oracle.issue();
            secrets.push(secret);
            let id = format!("m{number}-{}", self.reports);
            let recipients = self.recipients(number);
            let named = if number == 3 { vec![INSPECTOR] } else { named.to_vec() };
            let mut report = story::report_to(&named, &id, self.reports, secret);
            let message = &mut report["Messages"][0];
            message["DataSetWriterId"] = json!(number + 1);
            message["Timestamp"] = json!(format!("2019-04-18T{:02}:30:00Z", self.hour));
            message["Payload"]["operationNetworkId"]["Body"] = json!(network);
            message["Payload"]["dynamicDataRequestId"]["Body"] = json!(request);
            self.munich.send("ua-data", &report);
            let entitled: Vec<_> =
                recipients.into_iter().filter(|reader| named.contains(reader)).collect();
            self.oracle.give(Door::History, secret, &entitled);
            if open.contains(&number) {
                self.oracle.show(Subject::Value(number), secret, &entitled);
                self.oracle.give(Door::Live, secret, &entitled);
            }
            let of_tool = entitled.into_iter().filter(|reader| Some(*reader) == *tool_of);
            if asked.contains(&number) {
                self.oracle.give(Door::Queue, secret, &of_tool.collect::<Vec<_>>());
            }
        }
        self.reports += 1;
        eventually("the reports", || async {
            let page = self.api(MAKER).get("/factories/FOR_MUC/writers").await.expect_ok();
            let writers = page["items"].as_array().expect("writers").iter();
            let counts: Vec<_> = writers.map(|writer| writer["received"].clone()).collect();
            if counts == [self.reports; 4] { Ok(()) } else { Err(page.to_string()) }
        })
        .await;
        secrets
    }

    /// The factory shows the inspector the first report of the second network, and no other.
    pub fn release_the_past(&mut self) {
        let Asked { network, request, .. } = &ASKED[2];
        let release = json!({ "messageType": "past-release", "messageId": "past",
            "factoryId": "FOR_MUC", "operationNetworkId": network, "operationId": "MakeFrame1",
            "dynamicDataRequestId": request, "recipientId": INSPECTOR,
            "decidedAt": "2019-04-18T18:40:00Z", "rangeList": [ { "dataSetWriterId": 3,
            "epoch": EPOCH, "firstSequence": 0, "lastSequence": 0 } ] });
        self.munich.send("past-release", &release);
    }

    /// The factory states for all who received values that their consent has ended.
    pub async fn revoke(&mut self) {
        let secret = self.oracle.issue();
        let mut receipt = crate::revocations::receipt("FOR_MUC", &[BUYER, INSPECTOR]);
        receipt["signedText"] = json!(format!("{{\"revocationId\":\"{secret}\"}}"));
        self.munich.send("revocation", &receipt);
        self.oracle.give(Door::Receipts, secret, &[BUYER, INSPECTOR, MAKER]);
        self.is_shown(MAKER, &format!("{}/revocations", path(NETWORK)), secret).await;
    }

    /// Lets everybody read everything, and compares it with what each may see.
    pub async fn check(&self, stage: &'static str) {
        let (readings, mut walks) = (Arc::new(readings(&ids())), JoinSet::new());
        for Reader { id, api, .. } in &self.readers {
            let (id, client, readings) = (*id, api.client.clone(), Arc::clone(&readings));
            walks.spawn(async move { (id, read(&client, &readings).await) });
        }
        while let Some(walk) = walks.join_next().await {
            let (id, answers) = walk.expect("a walk");
            self.oracle.judge(stage, id, &answers);
        }
        for Reader { id, events, tool, .. } in &self.readers {
            let of_queue = || tool.as_ref().map(Peer::received).unwrap_or_default().concat();
            self.hears(stage, id, Door::Live, || events.lock().clone()).await;
            self.hears(stage, id, Door::Queue, of_queue).await;
        }
    }

    /// Lets each member try to change what is others'.
    pub async fn attack(&self, stage: &str) {
        let tried = attack(stage, &self.admin, &self.members).await;
        let by_right: usize = tried.by_right.values().sum();
        assert!(tried.attempts > 200 && by_right > 300, "{stage}: only {tried:?}");
    }

    /// Waits until a reader heard all that it may, and nothing else.
    async fn hears(&self, stage: &str, id: &'static str, door: Door, heard: impl Fn() -> String) {
        let allowed = self.oracle.allowed(id, door);
        eventually(stage, || async {
            let found = self.oracle.found(&heard());
            assert!(found.is_subset(&allowed), "{stage}: {id} hears by {door:?}: {}", heard());
            if found == allowed { Ok(()) } else { Err(format!("{id} by {door:?}: {found:?}")) }
        })
        .await;
    }
}
