//! Tests of one unit of ingest: decisions and values that arrive together.

mod fair_shares;

use std::sync::Arc;

use access_log::{AccessKind, AccessLogKey, AgentKind};
use asi_model::{FieldKey, RequestKey};
use messaging::{Delivery, Envelope};
use serde_json::{Value, json};
use tempfile::TempDir;

use super::*;
use crate::{
    accesses::{AccessRecorder, Reader},
    clock::Clock,
    ingest::decode::decode,
    signing::SigningState,
    store::{Collaboration, NetworkRow, NewField, Organisation, Scope, Store},
};

fn id<T: std::str::FromStr<Err: std::fmt::Debug>>(text: &str) -> T {
    text.parse().expect("valid")
}

fn at(seconds: i64) -> DateTime {
    DateTime::from_unix_micros(seconds * 1_000_000)
}

/// Time of a message, `seconds` past an hour.
fn moment(seconds: i64) -> String {
    format!("1970-01-01T00:00:{seconds:02}Z")
}

fn count() -> FieldKey {
    let request = RequestKey {
        operation_network_id: id("net"),
        operation_id: id("op"),
        dynamic_data_request_id: id("req"),
    };
    request.field(id("count"))
}

/// A platform whose factory F is asked for the field `count`, factory G for nothing.
struct Platform {
    store: Store,
    folder: TempDir,
}

impl Platform {
    async fn asks() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
        let mut work = store.begin().await.expect("begun");
        let a = Organisation { organisation_id: id("a"), name: "a".into(), created_at: at(0) };
        work.organisations().add(&a).await.expect("stored");
        for factory in ["F", "G"] {
            work.factories().add(&id(factory), &id("a"), factory, at(0)).await.expect("stored");
        }
        let collaboration = Collaboration {
            collaboration_id: id("c"),
            name: "c".into(),
            created_at: at(0),
            members: vec![id("a")],
            factories: vec![id("F"), id("G")],
        };
        work.collaborations().add(&collaboration).await.expect("stored");
        let network =
            serde_json::from_value(json!({ "operationNetworkId": "net", "operationList": [] }))
                .expect("valid");
        let row = NetworkRow {
            collaboration_id: id("c"),
            revision: 1,
            network,
            updated_at: at(1),
            updated_by: "u".into(),
            author_organisation: None,
            withdrawn_at: None,
            drawn_by: Some(id("a")),
        };
        work.networks().put(&row).await.expect("stored");
        let wanted = [NewField { key: count(), factory_id: id("F"), position: 0 }];
        work.fields().replace(&id("net"), &wanted).await.expect("stored");
        work.asked_requests().add(&count().request, &id("F")).await.expect("stored");
        work.commit().await.expect("committed");
        Self { store, folder }
    }

    /// Applies messages in one unit of ingest.
    async fn ingest(&self, messages: &[(&str, Value)]) {
        let mut work = self.store.begin().await.expect("begun");
        let heartbeats = Heartbeats::new(Duration::from_secs(60));
        let witness = WitnessKey::open(self.folder.path()).expect("a key");
        let wait = Duration::from_secs(60);
        let mut applier = Applier::new(&mut work, at(59), wait, &heartbeats, &witness);
        for (factory, body) in messages {
            let address = LogicalAddress::FactoryIngress(id(factory));
            let delivery = Delivery {
                envelope: Envelope::new(id("t1"), "any", body.to_string()),
                is_redelivered: false,
                delivery_count: 0,
                received_at: time::OffsetDateTime::UNIX_EPOCH,
            };
            let incoming = decode(&address, &delivery.into(), &(), &SigningState::default());
            applier.batch(&address, &[incoming]).await.expect("applied");
        }
        applier.finish().await.expect("finished");
        work.commit().await.expect("committed");
    }

    /// Returns the current value of the field.
    async fn current(&self) -> Option<Value> {
        let mut work = self.store.read().await.expect("begun");
        let fields = work.fields().list(&Scope::Platform, &id("net")).await.expect("read");
        drop(work);
        let storage = Arc::new(self.store.clone());
        let key = AccessLogKey::from_secret(&[1; 32]);
        let accesses = AccessRecorder::new(storage, key, Clock::from_fn(|| at(59)));
        let reader = Reader {
            organisation_id: id("a"),
            kind: AgentKind::User,
            name: "u".to_owned(),
            role: None,
        };
        let fields = accesses.disclose(Some(&reader), AccessKind::Looked, fields).await;
        let fields = fields.expect("recorded");
        fields[0].current.as_ref().map(|current| current.value.clone())
    }
}

fn report(sequence: u32, seconds: i64, value: u32) -> (&'static str, Value) {
    let version = json!({ "MajorVersion": 1, "MinorVersion": 1 });
    let text = |text: &str| json!({ "Type": 12, "Body": text });
    let payload = json!({
        "reportName": text("R"), "dynamicDataRequestId": text("req"), "operationId": text("op"),
        "operationNetworkId": text("net"), "recipientList": { "Type": 12, "Body": ["a"] },
        "shopfloorTimestamp": { "Type": 13, "Body": moment(seconds) },
        "count": { "Type": 7, "Body": value } });
    let message = json!({ "DataSetWriterId": 1, "SequenceNumber": sequence, "MetaDataVersion": version,
        "Timestamp": moment(seconds), "Payload": payload });
    let body = json!({ "MessageId": format!("report-{sequence}"), "MessageType": "ua-data",
        "PublisherId": "F", "Messages": [message] });
    ("F", body)
}

fn decision(factory: &'static str, state: &str, seconds: i64) -> (&'static str, Value) {
    let body = json!({ "messageType": "decision", "messageId": format!("{factory}-{state}-{seconds}"),
        "factoryId": factory, "operationNetworkId": "net", "operationId": "op",
        "dynamicDataRequestId": "req", "fieldName": "count", "mappingState": state,
        "decidedAt": moment(seconds) });
    (factory, body)
}

#[tokio::test]
async fn a_decision_without_effect_ends_no_value_of_its_batch() {
    for refused in [decision("G", "REFUSED", 30), decision("F", "REFUSED", 5)] {
        let platform = Platform::asks().await;
        platform.ingest(&[decision("F", "MAPPED", 10)]).await;
        platform.ingest(&[report(1, 20, 7), refused.clone()]).await;
        assert_eq!(platform.current().await, Some(json!(7)), "{}", refused.1);
    }
}

#[tokio::test]
async fn a_decision_that_closes_the_field_ends_the_value_of_its_batch() {
    let platform = Platform::asks().await;
    platform.ingest(&[decision("F", "MAPPED", 10)]).await;
    platform.ingest(&[report(1, 20, 7), decision("F", "REFUSED", 30)]).await;
    assert_eq!(platform.current().await, None);
}

#[tokio::test]
async fn a_value_from_before_a_consent_is_no_current_one() {
    let platform = Platform::asks().await;
    platform.ingest(&[report(1, 20, 7), decision("F", "MAPPED", 30)]).await;
    assert_eq!(platform.current().await, None);
    platform.ingest(&[decision("F", "MAPPED", 31), report(2, 40, 8)]).await;
    assert_eq!(platform.current().await, Some(json!(8)));
}
