//! Logs: what they must never contain.

use std::{
    collections::BTreeSet,
    fmt::Debug,
    sync::{Arc, LazyLock, Mutex},
    time::Duration,
};

use factory_connector::clock::now;
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
        *metadata.level() <= Level::INFO || is_own(metadata.target())
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

/// Returns true for a module of a package of this workspace.
fn is_own(target: &str) -> bool {
    static OWN: LazyLock<Vec<String>> = LazyLock::new(|| {
        let manifest = include_str!("../../../Cargo.toml");
        let packages = manifest.lines().filter_map(|line| line.split_once(" = { path = "));
        packages.map(|(package, _)| package.replace('-', "_")).collect()
    });
    let name = target.split("::").next().unwrap_or_default();
    OWN.iter().any(|own| own == name)
}

fn script(node: &str, source: &str) -> serde_json::Value {
    json!({ "inputs": [{ "name": "a", "sourceId": "Mill1", "nodeId": node }],
        "steps": [{ "function": "script", "source": source }] })
}

/// Time until a script no longer loads, which has to be loaded by then: on a busy machine the next
/// one is tried.
const MARGINS: [Duration; 6] = [
    Duration::from_millis(500),
    Duration::from_secs(1),
    Duration::from_secs(2),
    Duration::from_secs(4),
    Duration::from_secs(8),
    Duration::from_secs(16),
];

/// Maps a field with a script that has loaded, and does not load again: where its worker is
/// replaced, it throws a text of its own.
async fn map_script_that_loads_once(plant: &Plant, name: &str, node: &str) {
    let path = format!("{}/mapping-status", field(name));
    let decision = format!("{}/decision", field(name));
    for margin in MARGINS {
        let end = now().after(margin);
        let end_ms = end.unix_micros() / 1000;
        let yielded = format!("in time {end_ms}");
        let source = format!(
            "(() => {{ if (Date.now() >= {end_ms}) throw new Error('{SECRET}'); return (v) => '{yielded}' }})()"
        );
        let body = json!({ "mappingState": "MAPPED", "valueSource": "MAPPING",
            "mapping": script(node, &source), "disclosure": {} });
        let (status, _) = plant.call(Method::PUT, &decision, Some(body.to_string())).await;
        if !status.is_success() {
            continue;
        }
        let runs =
            |status: &serde_json::Value| status["lastCandidate"]["value"] == yielded.as_str();
        let is_over = |status: &serde_json::Value| runs(status) || now() > end;
        let status = plant.until("it runs, or was too late", &path, is_over).await;
        if runs(&status) {
            plant.until("it does not load any more", &path, |_| now() > end).await;
            return;
        }
    }
    panic!("it never loaded in time");
}

/// Maps a field to the machine's variable, and returns numbers of it, which a script gives many digits and which leave as
/// they are.
async fn numbers_of_the_machine(plant: &Plant, node: &str) -> BTreeSet<String> {
    plant.map("heat", script(node, "(v) => v * 1.000001234567 + 0.000012345")).await;
    let path = format!("{}/mapping-status", field("heat"));
    let mut seen = BTreeSet::new();
    let has_many = |text: &String| text.len() > 6 && text.contains('.');
    for _ in 0..200 {
        let status = plant.get(&path).await;
        seen.extend(Some(status["lastCandidate"]["value"].to_string()).filter(has_many));
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    assert!(!seen.is_empty(), "the machine has a value");
    seen
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_log_contains_a_value_or_a_text_that_a_script_chose() {
    let log = Recorder::default();
    tracing::subscriber::set_global_default(log.clone()).expect("a process of its own");
    let plant = Plant::start(json!([
        { "name": "label", "type": 12 }, { "name": "late", "type": 12 }, { "name": "fatal", "type": 11 },
        { "name": "note", "type": 12 }, { "name": "count", "type": 9 }, { "name": "heat", "type": 11 },
    ]))
    .await;
    let node = plant.node("Mill1", "Spindle.Temperature");
    // A script throws the value.
    let throwing = format!("(v) => {{ throw new Error('{SECRET}' + v) }}");
    plant.map("label", script(&node, &throwing)).await;
    let path = format!("{}/mapping-status", field("label"));
    let is_shown = |status: &serde_json::Value| status.to_string().contains(SECRET);
    plant.until("the engineer sees the text", &path, is_shown).await;
    map_script_that_loads_once(&plant, "late", &node).await;
    let fatal = "(v) => { (new Array(1e9) + ''); return 1 }";
    plant.map("fatal", script(&node, fatal)).await;
    let is_logged = || log.contains("A script does not load again.");
    testkit::wait::until("the worker is replaced", Duration::from_secs(60), is_logged).await;
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
    let seen = numbers_of_the_machine(&plant, &node).await;
    let logged = seen.iter().find(|number| log.contains(number));
    assert_eq!(logged, None, "a log contains a number of the machine");
    for package in ["disclosure", "ledger", "mapping", "opcua_stack", "factory_connector"] {
        assert!(is_own(&format!("{package}::module")), "everything of {package} is looked at");
    }
    assert!(!log.contains(SECRET), "a log contains it");
}
