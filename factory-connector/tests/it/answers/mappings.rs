//! Mappings: suggested, tried, published, compared, exchanged. They read a variable that never
//! changes.

use serde_json::{Value, json};

use super::Answers;
use crate::plant::field;

/// Counters of running mappings.
const COUNTERS: &[&str] = &["received", "repeated", "superseded", "yielded"];
/// Newest disclosed value: that of the former mapping for a moment.
const DISCLOSED: &[&str] = &["value"];
/// Mappings that run since a moment ago.
const RUNNING: &[&str] = &["status", "published"];

/// A mapping of the machine's model to the name that partners know it by, if there is one.
fn mapping(answers: &Answers<'_>, name: Option<&str>) -> Value {
    let node = answers.plant.node("Mill1", "Identification.Model");
    let steps: Vec<Value> = name
        .map(|name| json!({ "from": "FW-500 5X", "to": name }))
        .map(|entry| json!({ "function": "lookup", "entries": [entry] }))
        .into_iter()
        .collect();
    json!({ "inputs": [{ "name": "a", "sourceId": "Mill1", "nodeId": node }], "steps": steps })
}

fn of(rest: &str) -> String {
    format!("{}{rest}", field("model"))
}

pub async fn publish(answers: &mut Answers<'_>) {
    answers.get("listSuggestions", &of("/suggestions?limit=1")).await;
    let plain = mapping(answers, None);
    let draft = json!({ "valueSource": "MAPPING", "mapping": plain });
    answers.post("previewDecision", &of("/preview"), draft).await;
    answers.post("dryRunMapping", &of("/trial"), json!({ "mapping": plain })).await;
    answers.plant.map("model", plain).await;
    let named = mapping(answers, Some("Mill"));
    answers.plant.map("model", named).await;
    answers.get("listMappingVersions", &of("/versions")).await;
    answers.get("compareMappingVersions", &of("/version-difference?from=1&to=2")).await;
    let path = of("/versions/1/rollback");
    answers.without(DISCLOSED).post("rollMappingBack", &path, json!({})).await;
}

pub async fn shadow(answers: &mut Answers<'_>) {
    let renamed = mapping(answers, Some("Milling cell"));
    answers.without(RUNNING).put("startShadowMapping", &of("/shadow"), renamed.clone()).await;
    answers.without(RUNNING).get("showShadowMapping", &of("/shadow")).await;
    let path = of("/shadow/publish");
    answers.without(DISCLOSED).post("publishShadowMapping", &path, json!({})).await;
    answers.plant.put(&of("/shadow"), renamed).await;
    answers.delete("endShadowMapping", &of("/shadow")).await;
    let is_running = |status: &Value| status["lastCandidate"] != Value::Null;
    answers.plant.until("the mapping runs", &of("/mapping-status"), is_running).await;
    answers.without(COUNTERS).get("showMappingStatus", &of("/mapping-status")).await;
    let path = of("/mapping-status/restart");
    answers.without(COUNTERS).post("restartMapping", &path, json!({})).await;
    answers.without(COUNTERS).get("surveyMappings", "/mappings/survey").await;
}

pub async fn exchange(answers: &mut Answers<'_>) {
    let draft =
        json!({ "templateId": "model", "name": "Model", "parameters": { "field": "model" } });
    let template = answers.post("makeMappingTemplate", &of("/template"), draft).await;
    answers.put("putMappingTemplate", "/mapping-templates/model", template).await;
    answers.get("listMappingTemplates", "/mapping-templates").await;
    let series = json!({ "sets": [{ "field": "model" }, { "field": "recipe" }] });
    let path = "/mapping-templates/model/fill?dryRun=true";
    answers.post("fillMappingTemplate", path, series).await;
    let file = answers.get("exportMappings", "/mappings/export?form=file").await;
    answers.post("importMappings", "/mappings/import?dryRun=true", file).await;
    answers.delete("removeMappingTemplate", "/mapping-templates/model").await;
}
