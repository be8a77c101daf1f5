//! One answer of every operation, as a snapshot that the description of the API allows, and live
//! events that it allows. A new operation or kind of event without one fails the test.
//!
//! Members and texts that differ from run to run are replaced, see [`redaction`].

mod decisions;
mod events;
mod ledger;
mod mappings;
mod past;
mod people;
mod policies;
mod redaction;
mod requests;
mod sources;
mod twin;

use std::collections::BTreeSet;

use reqwest::{Method, StatusCode};
use serde_json::{Value, json};
use simulator::{MachineConfig, MachineKind};
use testkit::Contract;

use self::redaction::{redacted, redacted_text};
use crate::plant::Plant;

/// Checks of the answers of one plant.
struct Answers<'p> {
    plant: &'p Plant,
    contract: Contract,
    /// Operations with a snapshot so far.
    seen: BTreeSet<String>,
    /// Answers and events that the description does not allow.
    faults: Vec<String>,
    /// Members that the next answer is compared without.
    volatile: &'static [&'static str],
}

impl<'p> Answers<'p> {
    fn new(plant: &'p Plant) -> Self {
        let description =
            serde_json::to_value(factory_connector::api::openapi()).expect("it serialises");
        let contract = Contract::new(&description);
        Self { plant, contract, seen: BTreeSet::new(), faults: Vec::new(), volatile: &[] }
    }

    /// Leaves the values of members out of the next snapshot, besides those that always are.
    const fn without(&mut self, members: &'static [&'static str]) -> &mut Self {
        self.volatile = members;
        self
    }

    /// Compares an answer with the description and the snapshot of its operation; returns its body.
    fn check(&mut self, operation: &str, (status, text): (StatusCode, String)) -> Value {
        let volatile = std::mem::take(&mut self.volatile);
        let (body, shown) = match serde_json::from_str::<Value>(&text) {
            Ok(body) => (body.clone(), redacted(&body, volatile)),
            Err(_) => (Value::Null, redacted_text(&text).lines().collect()),
        };
        self.faults.extend(self.contract.faults(operation, status.as_u16(), &body));
        let document = json!({ "status": status.as_u16(), "body": shown });
        insta::assert_json_snapshot!(operation, document);
        assert!(self.seen.insert(operation.to_owned()), "{operation} has two answers");
        body
    }

    async fn get(&mut self, operation: &str, path: &str) -> Value {
        let answer = self.plant.call(Method::GET, path, None).await;
        self.check(operation, answer)
    }

    async fn post(&mut self, operation: &str, path: &str, body: Value) -> Value {
        let answer = self.plant.call(Method::POST, path, Some(body.to_string())).await;
        self.check(operation, answer)
    }

    async fn put(&mut self, operation: &str, path: &str, body: Value) -> Value {
        let answer = self.plant.call(Method::PUT, path, Some(body.to_string())).await;
        self.check(operation, answer)
    }

    async fn delete(&mut self, operation: &str, path: &str) -> Value {
        let answer = self.plant.call(Method::DELETE, path, None).await;
        self.check(operation, answer)
    }
}

/// The fields of the one request, each for another part of the test.
fn fields() -> Value {
    json!([
        { "name": "count", "type": 9, "unit": "PIECE", "semantic": "PRODUCED_QUANTITY",
          "description": "Frames finished so far" },
        { "name": "model", "type": 12, "description": "Model of the machine" },
        { "name": "power", "type": 11, "unit": "WTT" },
        { "name": "recipe", "type": 12 },
    ])
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn every_operation_answers_as_in_its_snapshot() {
    let mut mill = MachineConfig::new("Mill1", MachineKind::MillingCell);
    mill.security.protected = true;
    let plant = Plant::start_with(fields(), mill).await;
    let mut answers = Answers::new(&plant);
    let events = events::open(&answers).await;
    people::sign_in(&mut answers).await;
    people::manage(&mut answers).await;
    people::account(&mut answers).await;
    requests::read(&mut answers).await;
    requests::comment(&mut answers).await;
    // The ledger has the entries of one field then, in one order.
    decisions::decide_and_enter(&mut answers).await;
    ledger::read(&mut answers).await;
    decisions::report_operations(&mut answers).await;
    sources::read(&mut answers).await;
    sources::configure(&mut answers).await;
    mappings::publish(&mut answers).await;
    mappings::shadow(&mut answers).await;
    mappings::exchange(&mut answers).await;
    policies::policies(&mut answers).await;
    policies::rules(&mut answers).await;
    policies::leak_budgets(&mut answers).await;
    policies::caps(&mut answers).await;
    twin::clients(&mut answers).await;
    twin::authorities(&mut answers).await;
    twin::application_certificate(&mut answers).await;
    past::decide(&mut answers).await;
    ledger::revoke(&mut answers).await;
    events::check(&mut answers, events).await;
    answers.delete("signOut", "/session").await;

    assert!(answers.faults.is_empty(), "the description differs:\n{}", answers.faults.join("\n"));
    // A stream has no single answer: its events are compared one by one.
    let mut operations = answers.contract.operations();
    operations.remove(events::STREAM);
    let missing: Vec<&String> = operations.difference(&answers.seen).collect();
    assert!(missing.is_empty(), "operations without a snapshot: {missing:?}");
}
