//! Local OPC UA servers.

use serde_json::{Value, json};

use super::Answers;

/// A query with one parameter.
fn query(name: &str, value: &str) -> String {
    let url = reqwest::Url::parse_with_params("http://connector", [(name, value)]);
    url.expect("an address").query().expect("a query").to_owned()
}

pub async fn read(answers: &mut Answers<'_>) {
    let plant = answers.plant;
    answers.without(&["sessions"]).get("listSources", "/sources").await;
    // A group with one variable: servers list children in any order.
    let axes = query("parent", &plant.node("Mill1", "Axes.Loads").replace(".Loads", ""));
    answers.get("browseSource", &format!("/sources/Mill1/nodes?{axes}")).await;
    let text = "/sources/Mill1/search?text=identification%20model";
    plant.until("the variables are listed", text, |page| page["isComplete"] == true).await;
    answers.get("searchSource", text).await;
    let model = plant.node("Mill1", "Identification.Model");
    let none = model.replace("Model", "Nothing");
    let nodes = json!({ "nodes": [model, none] });
    answers.post("readSourceValues", "/sources/Mill1/values", nodes).await;
}

pub async fn configure(answers: &mut Answers<'_>) {
    let plant = answers.plant;
    let endpoint = plant.machines.machine("Mill1").expect("a machine").endpoint_url().to_owned();
    let source = json!({ "sourceId": "Secured", "endpointUrl": endpoint });
    let address = json!({ "endpointUrl": endpoint });
    answers
        .without(&["certificates", "findings"])
        .post("discoverSource", "/source-discovery", address)
        .await;
    let unsaved =
        json!({ "sourceId": "New", "endpointUrl": endpoint, "security": { "choice": "none" } });
    answers.post("testSource", "/source-test", unsaved).await;
    answers.without(&["items"]).get("listServerProfiles", "/server-profiles").await;
    let own = "/source-client-certificate";
    answers.get("showSourceClientCertificate", own).await;
    let next = format!("{own}/next");
    answers.post("prepareSourceClientCertificate", &next, json!({})).await;
    answers.post("useSourceClientCertificate", &format!("{next}/use"), json!({})).await;
    answers.delete("discardSourceClientCertificate", &next).await;
    answers.post("addSource", "/sources", source.clone()).await;
    let certificates = "/source-certificates";
    let page = plant
        .until("its certificate waits", certificates, |page| page["items"][0] != Value::Null)
        .await;
    answers.get("listSourceCertificates", certificates).await;
    let thumbprint = page["items"][0]["thumbprint"].as_str().expect("a thumbprint");
    let path = format!("{certificates}/{thumbprint}");
    answers.put("trustSourceCertificate", &path, json!({ "isTrusted": true })).await;
    let mut renamed = source;
    renamed["name"] = json!("The mill, secured");
    answers.put("changeSource", "/sources/Secured", renamed).await;
    answers.get("showSourceUse", "/sources/Mill1/use").await;
    answers.delete("removeSource", "/sources/Secured").await;
}
