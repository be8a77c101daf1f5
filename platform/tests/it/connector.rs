//! A connector's side of the broker: enrolled, linked, remembering what it received.

use std::sync::Arc;

use async_trait::async_trait;
use messaging::{
    Delivery, Envelope, Inbox, Link, LinkConfig, LinkHandle, LogicalAddress, Login, Roots,
    Settlement,
    spool::memory::{AcceptedReports, MemorySpool},
};
use parking_lot::Mutex;
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use crate::harness::{Api, World, eventually};

#[derive(Default)]
struct Memory(Mutex<Vec<(String, Value)>>);

#[async_trait]
impl Inbox for Memory {
    async fn receive(
        &self,
        _address: &LogicalAddress,
        deliveries: Vec<Delivery>,
    ) -> Vec<Settlement> {
        let mut received = self.0.lock();
        for delivery in &deliveries {
            let body = delivery.envelope.unpacked(4 << 20).expect("a body");
            received.push((
                delivery.envelope.subject.clone(),
                serde_json::from_slice(&body).expect("JSON"),
            ));
        }
        vec![Settlement::Accept; deliveries.len()]
    }
}

/// A peer of the broker with its own credential.
pub struct Peer {
    pub link: LinkHandle,
    spool: Arc<MemorySpool>,
    received: Arc<Memory>,
    writes: LogicalAddress,
    shutdown: CancellationToken,
}

impl Peer {
    /// A connector that has just enrolled; like one of before, it does not sign.
    pub async fn enrolled(world: &World, admin: &Api, factory: &str) -> Self {
        Self::enrolled_with(world, admin, factory, Value::Null).await
    }

    /// A connector that has just enrolled with a key that signs.
    pub async fn enrolled_with(world: &World, admin: &Api, factory: &str, key: Value) -> Self {
        let token = admin
            .post(&format!("/factories/{factory}/enrolment-tokens"), json!({}))
            .await
            .expect_ok();
        let enrolment = world
            .anonymous()
            .post("/enrolments", json!({ "token": token["token"], "signingKey": key }))
            .await
            .expect_ok();
        Self::connector(&enrolment, factory)
    }

    /// A connector with the credential of an enrolment.
    pub fn connector(enrolment: &Value, factory: &str) -> Self {
        let reads = LogicalAddress::FactoryRequests(factory.parse().expect("valid"));
        Self::start(
            enrolment,
            reads,
            LogicalAddress::FactoryIngress(factory.parse().expect("valid")),
        )
    }

    /// A tool with its credential.
    pub fn tool(credential: &Value, tool: &str) -> Self {
        let reads = LogicalAddress::ToolReports(tool.parse().expect("valid"));
        Self::start(credential, reads, LogicalAddress::ToolRequests(tool.parse().expect("valid")))
    }

    pub fn start(credential: &Value, reads: LogicalAddress, writes: LogicalAddress) -> Self {
        let text = |name: &str| credential[name].as_str().expect("a text").to_owned();
        let url = text("brokerUrl").parse().expect("a broker's address");
        let mut config =
            LinkConfig::new(url, Login::new(text("userName"), text("password")), "test-peer");
        config.tls.roots = Roots::Pem(text("rootCertificatePem").into_bytes().into());
        config.consumed = vec![reads];
        let (spool, received) =
            (Arc::new(MemorySpool::new(AcceptedReports::Leave)), Arc::new(Memory::default()));
        let (link, handle) =
            Link::new(config, Arc::clone(&spool) as _, Arc::clone(&received) as _).expect("a link");
        let shutdown = CancellationToken::new();
        tokio::spawn(link.run(shutdown.clone()));
        Self { link: handle, spool, received, writes, shutdown }
    }

    /// Sends a body; its id is the body's.
    pub fn send(&self, subject: &str, body: &Value) {
        self.send_bytes(
            subject,
            body["messageId"].as_str().or(body["MessageId"].as_str()),
            body.to_string().as_bytes(),
        );
    }

    /// Sends a report as the holder of a lease does.
    pub fn send_under(&self, lease: u64, subject: &str, body: &Value) {
        let id = body["MessageId"].as_str().expect("an id").parse().expect("valid");
        let mut envelope = Envelope::new(id, subject, body.to_string());
        envelope.lease = Some(lease);
        self.spool.push(self.writes.clone(), envelope);
        self.link.wake();
    }

    /// Sends a message as it stands.
    pub fn forward(&self, envelope: Envelope) {
        self.spool.push(self.writes.clone(), envelope);
        self.link.wake();
    }

    pub fn send_bytes(&self, subject: &str, id: Option<&str>, body: &[u8]) {
        let id = id.map_or_else(platform::clock::new_message_id, |id| id.parse().expect("valid"));
        self.spool.push(self.writes.clone(), Envelope::new(id, subject, body.to_vec()));
        self.link.wake();
    }

    /// Waits for a message with this subject that fulfils the condition.
    pub async fn receive(&self, subject: &str, is_wanted: impl Fn(&Value) -> bool) -> Value {
        eventually(subject, || async {
            let received = self.received.0.lock();
            let found = received.iter().find(|(kind, body)| kind == subject && is_wanted(body));
            found
                .map(|(_, body)| body.clone())
                .ok_or_else(|| format!("{} messages", received.len()))
        })
        .await
    }

    /// Counts the messages with this subject so far.
    pub fn count(&self, subject: &str) -> usize {
        self.received.0.lock().iter().filter(|(kind, _)| kind == subject).count()
    }

    /// Returns the bodies of all messages so far, as texts.
    pub fn received(&self) -> Vec<String> {
        self.received.0.lock().iter().map(|(_, body)| body.to_string()).collect()
    }

    /// Counts the messages that the broker has not accepted.
    pub fn waiting(&self) -> usize {
        self.spool.waiting()
    }

    /// Answers a part as a connector does.
    pub fn accept(&self, part: &Value) {
        self.answer(part, "ACCEPTED", json!([]));
    }

    pub fn answer(&self, part: &Value, result: &str, faults: Value) {
        let network = part["operationNetwork"]["operationNetworkId"]
            .as_str()
            .or(part["operationNetworkId"].as_str());
        self.send(
            "acknowledgement",
            &json!({ "messageType": "acknowledgement", "messageId": platform::clock::new_message_id(),
                "factoryId": part["factoryId"], "correlationId": part["messageId"],
                "operationNetworkId": network, "revision": part["revision"], "result": result, "faultList": faults }),
        );
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        self.shutdown.cancel();
    }
}
