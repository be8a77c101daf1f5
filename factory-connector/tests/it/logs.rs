//! Logs: what they must never contain.

use std::{
    fmt::Debug,
    sync::{Arc, Mutex},
    time::{SystemTime, UNIX_EPOCH},
};

use reqwest::Method;
use serde_json::json;
use tracing::{
    Event, Level, Metadata, Subscriber,
    field::{Field, Visit},
    span,
};

use crate::plant::{Plant, field};

/// A value of the plant, and a text that scripts choose.
const SECRET: &str = "sesame-4711";

/// Everything that is logged, as text.
#[derive(Clone, Default)]
struct Recorder(Arc<Mutex<String>>);

impl Visit for Recorder {
    fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
        let mut text = self.0.lock().expect("nobody panics while holding it");
        text.push_str(&format!("{field}={value:?} "));
    }
}

impl Recorder {
    fn contains(&self, text: &str) -> bool {
        self.0.lock().expect("nobody panics while holding it").contains(text)
    }
}

impl Subscriber for Recorder {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        // Of other crates what operators see; of our own everything.
        const OWN: [&str; 7] = [
            "factory_connector",
            "connector_state",
            "mapping_engine",
            "twin",
            "messaging",
            "shop_floor",
            "daemon",
        ];
        let target = metadata.target();
        *metadata.level() <= Level::INFO || OWN.iter().any(|own| target.starts_with(own))
    }
    fn new_span(&self, span: &span::Attributes<'_>) -> span::Id {
        span.record(&mut self.clone());
        span::Id::from_u64(1)
    }
    fn record(&self, _: &span::Id, values: &span::Record<'_>) {
        values.record(&mut self.clone());
    }
    fn record_follows_from(&self, _: &span::Id, _: &span::Id) {}
    fn event(&self, event: &Event<'_>) {
        event.record(&mut self.clone());
    }
    fn enter(&self, _: &span::Id) {}
    fn exit(&self, _: &span::Id) {}
}

fn script(node: &str, source: &str) -> serde_json::Value {
    json!({ "inputs": [{ "name": "a", "sourceId": "Mill1", "nodeId": node }],
        "steps": [{ "function": "script", "source": source }] })
}

#[allow(clippy::disallowed_methods, reason = "the script reads the machine's clock")]
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_log_contains_a_value_or_a_text_that_a_script_chose() {
    let log = Recorder::default();
    tracing::subscriber::set_global_default(log.clone()).expect("a process of its own");
    let plant = Plant::start(json!([
        { "name": "label", "type": 12 }, { "name": "late", "type": 12 }, { "name": "fatal", "type": 11 },
        { "name": "note", "type": 12 }, { "name": "count", "type": 9 },
    ]))
    .await;
    let node = plant.node("Mill1", "Spindle.Temperature");
    // A script throws the value.
    let throwing = format!("(v) => {{ throw new Error('{SECRET}' + v) }}");
    plant.map("label", script(&node, &throwing)).await;
    let path = format!("{}/mapping-status", field("label"));
    let is_told = |status: &serde_json::Value| status.to_string().contains(SECRET);
    plant.until("the engineer sees the text", &path, is_told).await;
    // A script that loads now, but not when its worker has to be replaced.
    let now = SystemTime::now().duration_since(UNIX_EPOCH).expect("after 1970").as_millis();
    let late =
        format!("if (Date.now() > {}) throw new Error('{SECRET}');\n(v) => 'fine'", now + 10_000);
    let late = format!("(() => {{ {} }})()", late.replace("(v) =>", "return (v) =>"));
    plant.map("late", script(&node, &late)).await;
    tokio::time::sleep(std::time::Duration::from_secs(11)).await;
    let fatal = "(v) => { (new Array(1e9) + ''); return 1 }";
    plant.map("fatal", script(&node, fatal)).await;
    let deadline = tokio::time::Instant::now() + std::time::Duration::from_secs(60);
    while !log.contains("A script does not load again.") {
        assert!(tokio::time::Instant::now() < deadline, "the worker is replaced");
        tokio::time::sleep(std::time::Duration::from_millis(20)).await;
    }
    // Values that people enter, taken and refused.
    for name in ["note", "count"] {
        let manual = json!({ "mappingState": "MAPPED", "valueSource": "MANUAL", "disclosure": {} });
        plant.put(&format!("{}/decision", field(name)), manual).await;
        let entered = json!({ "value": SECRET }).to_string();
        let path = format!("{}/value", field(name));
        let (status, text) = plant.call(Method::PUT, &path, Some(entered)).await;
        assert_eq!(status.is_success(), name == "note", "{text}");
    }
    let ledger = "/ledger?recipient=acme";
    plant.until("it was disclosed", ledger, |page| page.to_string().contains(SECRET)).await;
    assert!(!log.contains(SECRET), "a log contains it");
}
