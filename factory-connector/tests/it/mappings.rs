//! Way from a request to values: suggestions, mappings, their versions and files.

use serde_json::json;

use crate::plant::{Plant, field};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_field_is_mapped_as_suggested() {
    let plant = Plant::start(json!([
        { "name": "progressStatus", "type": 9, "unit": "PIECE", "semantic": "PRODUCED_QUANTITY",
          "description": "Frames finished so far" },
        { "name": "spindlePower", "type": 11, "unit": "KWT", "description": "Power drawn by the spindle" },
    ]))
    .await;
    let suggested = plant.get(&format!("{}/suggestions", field("progressStatus"))).await;
    assert_eq!(suggested["sources"].as_array().map(Vec::len), Some(2));
    assert!(
        suggested["sources"]
            .as_array()
            .is_some_and(|all| all.iter().all(|s| s["isComplete"] == true))
    );
    let best = &suggested["items"][0];
    assert_eq!(best["sourceId"], "Mill1", "{suggested:#}");
    assert!(best["reasons"].as_array().is_some_and(|reasons| reasons.len() > 2), "{best:#}");
    assert!(best["value"]["status"] == "Good", "{best:#}");
    let view = plant.map("progressStatus", best["mapping"].clone()).await;
    assert_eq!(view["mappingState"], "MAPPED");

    // The power of the spindle is there in watts; the conversion is proposed with it.
    let power = plant.get(&format!("{}/suggestions?limit=3", field("spindlePower"))).await;
    assert_eq!(
        power["items"][0]["place"].as_str().map(|place| place.contains("Power")),
        Some(true),
        "{power:#}"
    );
    let found = plant.get("/sources/Mill1/search?text=spindle%20temperature").await;
    assert_eq!(found["items"][0]["displayName"], "Temperature");
    assert_eq!(found["isComplete"], true);
}

/// A mapping of one variable with these functions.
fn mapping(node: &str, steps: serde_json::Value) -> serde_json::Value {
    json!({ "inputs": [{ "name": "a", "sourceId": "Mill1", "nodeId": node }], "steps": steps })
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_mapping_is_corrected_tried_and_taken_back() {
    let plant = Plant::start(
        json!([{ "name": "temperature", "type": 11 }, { "name": "other", "type": 11 }]),
    )
    .await;
    let node = plant.node("Mill1", "Spindle.Temperature");
    let of = |rest: &str| format!("{}{rest}", field("temperature"));
    let scaled = |factor: f64| mapping(&node, json!([{ "function": "scale", "factor": factor }]));
    let mapped = plant.map("temperature", scaled(1.0)).await;
    let path = &mapped["mapping"]["inputs"][0]["monitor"]["browsePath"];
    assert!(
        path.as_array().is_some_and(|path| path.len() == 3),
        "where it stands is kept with it: {mapped:#}"
    );
    assert_eq!(mapped["mappingVersion"], 1);
    plant.map("temperature", scaled(1.0)).await;
    assert_eq!(
        plant.get(&field_versions()).await["items"].as_array().map(Vec::len),
        Some(1),
        "the same is no version"
    );

    // Tried beside the published one, on the same live values, without a trace in what leaves.
    plant.put(&of("/shadow"), scaled(1000.0)).await;
    let shadow = plant
        .until("both have values", &of("/shadow"), |shadow| {
            let value = |of: &str| shadow[of]["lastCandidate"]["value"].as_f64();
            value("status")
                .zip(value("published"))
                .is_some_and(|(tried, published)| tried > 100.0 * published)
        })
        .await;
    assert_eq!(shadow["changes"][0]["pointer"], "/steps/0/factor", "{shadow:#}");
    let disclosed = plant.get("/inbox").await.to_string();
    assert!(!disclosed.contains("\"mappingVersion\":2"));
    let view = plant.post(&of("/shadow/publish"), json!({})).await;
    assert_eq!((&view["mappingVersion"], &view["hasShadow"]), (&json!(2), &json!(false)));
    assert_eq!(view["mapping"]["mappingId"], mapped["mapping"]["mappingId"]);

    let status = of("/mapping-status");
    plant
        .until("several values came", &status, |status| status["received"].as_u64() > Some(2))
        .await;

    // Recorded values of the published mapping's variable, each with every intermediate value.
    let body = json!({ "on": "HISTORY", "mapping": scaled(2.0) });
    let (status, text) =
        plant.call(reqwest::Method::POST, &of("/trial"), Some(body.to_string())).await;
    assert!(status.is_success(), "{text}");
    let dry_run: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert!(
        dry_run["values"].as_u64() > Some(1) && dry_run["runsTotal"] == dry_run["values"],
        "{dry_run:#}"
    );
    assert_eq!(dry_run["runs"][0]["steps"][0]["function"], "scale");

    let view = plant.post(&of("/versions/1/rollback"), json!({})).await;
    assert_eq!(view["mappingVersion"], 3);
    let versions = plant.get(&field_versions()).await;
    let versions = versions["items"].as_array().expect("a page");
    assert_eq!(versions.len(), 3);
    assert_eq!(
        (&versions[0]["note"], &versions[0]["author"]),
        (&json!("as version 1"), &json!("engineer"))
    );
    assert_eq!(versions[0]["mapping"], versions[2]["mapping"]);
    assert_eq!(versions[1]["changes"][0]["before"], json!(1.0), "{versions:#?}");
    let status = plant.get(&of("/mapping-status")).await;
    assert_eq!(status["faults"], 0);
    let survey = plant.get("/mappings/survey?limit=0").await;
    assert_eq!(
        (&survey["counts"]["well"], &survey["items"]),
        (&json!(1), &json!([])),
        "{survey:#}"
    );
}

fn field_versions() -> String {
    format!("{}/versions", field("temperature"))
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn mappings_are_exported_and_imported_and_series_are_filled() {
    let fields =
        (1..=3).map(|n| json!({ "name": format!("axis{n}"), "type": 11 })).collect::<Vec<_>>();
    let plant = Plant::start(fields.into()).await;
    let node = plant.node("Mill1", "Spindle.Temperature").replace("Temperature", "Axis1");
    plant.map("axis1", mapping(&node, json!([{ "function": "scale", "factor": 1 }]))).await;

    // A series of like variables, from the one that is mapped.
    let template = json!({ "templateId": "axis", "parameters": { "n": "1" } });
    let mut template = plant.post(&format!("{}/template", field("axis1")), template).await;
    template["mapping"]["steps"] = json!([{ "function": "scale", "factor": 7 }]);
    plant.put("/mapping-templates/axis", template).await;
    let filled = plant
        .post("/mapping-templates/axis/fill?dryRun=true", json!({ "patterns": { "n": "1..3" } }))
        .await;
    assert_eq!((&filled["published"], &filled["proposed"]), (&json!(1), &json!(2)), "{filled:#}");
    plant.post("/mapping-templates/axis/fill", json!({ "patterns": { "n": "1..3" } })).await;
    let refused = json!({ "patterns": { "n": "1..4" } });
    let (status, text) = plant
        .call(reqwest::Method::POST, "/mapping-templates/axis/fill", Some(refused.to_string()))
        .await;
    assert!(status == 422 && text.contains("axis4"), "{text}");

    for form in ["file", "csv"] {
        let (_, text) =
            plant.call(reqwest::Method::GET, &format!("/mappings/export?form={form}"), None).await;
        assert!(text.contains("axis3") && text.contains("Axis2"), "{text}");
        let back = plant.import(form, &text, false).await.expect("taken");
        assert_eq!((&back["unchanged"], &back["templates"]), (&json!(3), &json!(0)), "{back:#}");
        let changed = text.replace("Axis2", "Axis9");
        let back = plant.import(form, &changed, false).await.expect("taken");
        assert_eq!((&back["unchanged"], &back["proposed"]), (&json!(2), &json!(1)), "{back:#}");
        plant.import(form, &text, false).await.expect("taken");

        // All faults at once, and nothing is taken.
        let wrong = changed.replace("axis1", "axis8").replace("axis3", "axis7");
        let problem = plant.import(form, &wrong, true).await.expect_err("refused");
        assert_eq!(problem["faults"].as_array().map(Vec::len), Some(2), "{problem:#}");
        assert_eq!(plant.import(form, &text, true).await.expect("taken")["unchanged"], 3);
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_script_is_checked_published_and_corrected_without_losing_its_count() {
    let plant = Plant::start(json!([{ "name": "label", "type": 12 }])).await;
    let node = plant.node("Mill1", "Spindle.Temperature");
    let script = |source: &str| mapping(&node, json!([{ "function": "script", "source": source }]));
    let wrong = json!({ "mappingState": "MAPPED", "valueSource": "MAPPING", "mapping": script("(v) => {\n  return v +;\n}") });
    let path = format!("{}/decision", field("label"));
    let (status, text) = plant.call(reqwest::Method::PUT, &path, Some(wrong.to_string())).await;
    assert!(status == 422 && text.contains("/mapping/steps/0/source"), "{text}");

    let counting =
        |word: &str| script(&format!("(v, ctx) => `{word} ${{ctx.state = (ctx.state ?? 0) + 1}}`"));
    plant.map("label", counting("first")).await;
    let count = |status: &serde_json::Value, word: &str| -> Option<u64> {
        status["lastCandidate"]["value"].as_str()?.strip_prefix(word)?.trim().parse().ok()
    };
    let path = format!("{}/mapping-status", field("label"));
    let before = plant.until("it counts", &path, |status| count(status, "first") > Some(3)).await;
    let counted = count(&before, "first").expect("just seen");
    plant.map("label", counting("second")).await;
    let after = plant
        .until("the corrected one runs", &path, |status| count(status, "second").is_some())
        .await;
    assert!(count(&after, "second") >= Some(counted), "{before:#} {after:#}");
    let body = json!({ "mapping": counting("third") });
    let dry_run = plant.post(&format!("{}/trial", field("label")), body).await;
    let tried = dry_run["runs"][0]["candidate"]["value"]
        .as_str()
        .and_then(|text| text.strip_prefix("third "));
    assert!(tried.and_then(|count| count.parse::<u64>().ok()) > Some(counted), "{dry_run:#}");

    plant.map("label", script("(v) => { throw new Error('out of order') }")).await;
    let fails = |survey: &serde_json::Value| survey["counts"]["failing"] == 1;
    let survey = plant.until("it is seen to fail", "/mappings/survey?health=FAILING", fails).await;
    let known = &survey["items"][0]["status"];
    assert_eq!(known["target"]["fieldName"], "label", "{survey:#}");
    assert!(
        known["lastFault"]["message"].as_str().is_some_and(|text| text.contains("out of order")),
        "{survey:#}"
    );
}

/// A source that is removed takes its values along, and brings them back when it is added again:
/// the mapping needs no decision in between.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_source_that_is_removed_and_added_again_brings_its_mappings_back() {
    let plant = Plant::start(json!([{ "name": "temperature", "type": 11 }])).await;
    let node = plant.node("Mill1", "Spindle.Temperature");
    let mapped = plant.map("temperature", mapping(&node, json!([]))).await;
    let path = field("temperature");
    let is_good = |view: &serde_json::Value| view["value"]["status"] == "Good";
    plant.until("a value came", &path, is_good).await;

    let (status, _) = plant.call(reqwest::Method::DELETE, "/sources/Mill1", None).await;
    assert_eq!(status, 204);
    plant.until("the value is gone", &path, |view| !is_good(view)).await;

    let endpoint = plant.machines.machine("Mill1").expect("a machine").endpoint_url().to_owned();
    let source =
        json!({ "sourceId": "Mill1", "endpointUrl": endpoint, "security": { "choice": "none" } });
    plant.post("/sources", source).await;
    let view = plant.until("values come again", &path, is_good).await;
    for member in ["mappingState", "decisionTime", "mappingVersion"] {
        assert_eq!(view[member], mapped[member], "{member} of {view:#}");
    }
}
