//! Caps and alliances over HTTP: what they refuse and hold back, with the figures.

use reqwest::Method;
use serde_json::{Value, json};

use crate::plant::{Plant, field};

fn decision(values: u32) -> Value {
    json!({ "mappingState": "MAPPED", "valueSource": "MAPPING",
        "disclosure": { "rateLimits": [{ "values": values, "periodMs": 3_600_000 }] } })
}

async fn refused(plant: &Plant, path: &str, body: Value) -> Value {
    let (status, text) = plant.call(Method::PUT, path, Some(body.to_string())).await;
    assert_eq!(status, 422, "{path}: {text}");
    serde_json::from_str(&text).expect("a problem")
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn caps_refuse_and_hold_back() {
    let plant =
        Plant::start(json!([{ "name": "count", "type": 9 }, { "name": "scrap", "type": 9 }])).await;
    let (part, other) = (
        plant.node("Mill1", "Production.PartCounter"),
        plant.node("Mill1", "Production.ScrapCounter"),
    );
    let mapped = |node: &str, values: u32| {
        let mut decision = decision(values);
        decision["mapping"] = json!({ "inputs":
            [{ "name": "a", "sourceId": "Mill1", "nodeId": node }], "steps": [] });
        decision
    };
    let path = |name: &str| format!("{}/decision", field(name));
    plant.put(&path("count"), mapped(&part, 8)).await;
    let budget = plant.get("/leak-budgets?partner=acme").await;
    let leaks = &budget["items"][0];
    let one = leaks["bitsPerHourMax"].as_f64().expect("bounded");
    assert_eq!(leaks["variables"][0]["variable"]["nodeId"], json!(part), "{leaks:#}");
    assert_eq!(leaks["variables"][0]["bitsPerHourMax"].as_f64(), Some(one));

    let cap = |most: f64| json!({ "name": "Acme", "subject": { "partner": "acme" }, "bitsPerHourMax": most });
    let stored = plant.put("/caps/acme", cap(1.5 * one)).await;
    assert_eq!(stored, json!({ "id": "acme", "version": 1, "heldBack": [] }));
    let draft = plant.post(&format!("{}/preview", field("scrap")), mapped(&other, 8)).await;
    let excess = &draft["capExcesses"][0];
    assert_eq!(excess["bitsPerHourNow"].as_f64(), Some(one), "{draft:#}");
    let problem = refused(&plant, &path("scrap"), mapped(&other, 8)).await;
    assert_eq!(
        (&problem["code"], &problem["faults"][0]["pointer"]),
        (&json!("OVER_CAP"), &json!("/disclosure"))
    );
    let text = problem["faults"][0]["message"].as_str().expect("a text");
    assert!(text.contains(&format!("allows {:.1} bits", 1.5 * one)), "{text}");
    assert_eq!(plant.get(&field("scrap")).await["mappingState"], "PENDING");
    plant.put(&path("scrap"), mapped(&other, 2)).await;

    let both = plant.get("/caps").await["items"][0]["bitsPerHour"].as_f64().expect("bounded");
    assert!(one < both && both < 1.5 * one, "{both}");
    let preview = plant.post("/caps/acme/preview", cap(one)).await;
    assert_eq!(preview["items"][0]["key"]["fieldName"], "scrap", "{preview:#}");
    assert_eq!(preview["items"][0]["excesses"][0]["bitsPerHourThen"].as_f64(), Some(both));
    let stored = plant.put("/caps/acme", cap(one)).await;
    assert_eq!(stored["heldBack"][0]["fieldName"], "scrap", "{stored:#}");
    let listed = plant.get("/caps").await;
    assert_eq!(listed["items"][0]["heldBack"], stored["heldBack"], "{listed:#}");
    let scrap = plant.get(&field("scrap")).await;
    assert_eq!(
        (&scrap["mappingState"], &scrap["decidedBy"]),
        (&json!("PENDING"), &json!("engineer"))
    );

    let of_variable = json!({ "name": "Scrap", "subject": { "partner": "acme" }, "bitsPerHourMax": 0,
        "variable": { "sourceId": "Mill1", "nodeId": other } });
    plant.put("/caps/scrap", of_variable).await;
    let (_, file) = plant.call(Method::GET, "/mappings/export?form=file", None).await;
    let file = file.replace("PartCounter", "ScrapCounter");
    for is_dry_run in [true, false] {
        let problem = plant.import("file", &file, is_dry_run).await;
        let problem = problem.expect_err("the variable may not be told");
        let fault = &problem["faults"][0];
        assert_eq!(
            (&fault["code"], &fault["pointer"]),
            (&json!("OVER_CAP"), &json!("/mappings/0/inputs/0/nodeId")),
            "{problem:#}"
        );
    }
    assert_eq!(plant.post("/ledger/verification", json!({})).await["valid"], true);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn allies_are_counted_together() {
    let plant = Plant::start(json!([{ "name": "count", "type": 9 }])).await;
    let mut manual = decision(8);
    manual["valueSource"] = json!("MANUAL");
    plant.put(&format!("{}/decision", field("count")), manual).await;
    let alliance = json!({ "name": "Yard", "memberList": ["hull", "acme"] });
    plant.put("/alliances/yard", alliance.clone()).await;
    let budgets = plant.get("/leak-budgets/alliances").await;
    let yard = &budgets["items"][0];
    assert_eq!(yard["alliance"]["memberList"], json!(["acme", "hull"]), "{budgets:#}");
    assert_eq!(yard["fields"].as_array().map(Vec::len), Some(1), "{budgets:#}");
    assert_eq!(yard["variables"], json!([]), "people type it");

    let cap = json!({ "name": "Keel", "subject": { "partner": "keel" }, "bitsPerHourMax": 1 });
    plant.put("/caps/keel", cap).await;
    let larger = json!({ "name": "Yard", "memberList": ["acme", "hull", "keel"] });
    let problem = refused(&plant, "/alliances/yard", larger).await;
    assert_eq!(problem["code"], "OVER_CAP", "keel would learn of it: {problem}");
    let twice = json!({ "name": "Dock", "memberList": ["acme", "mast"] });
    let problem = refused(&plant, "/alliances/dock", twice).await;
    assert_eq!(problem["faults"][0]["pointer"], "/memberList/0", "{problem}");
    let versions = plant.get("/alliances/yard/versions").await;
    assert_eq!(versions["items"].as_array().map(Vec::len), Some(1), "{versions:#}");
    let (status, _) = plant.call_if_match(Method::PUT, "/alliances/yard", "\"7\"", alliance).await;
    assert_eq!(status, 409);
}
