//! Messages of a foreign AMQP client, and the answers to them.

use std::{path::PathBuf, time::Duration};

use serde_json::{Value, json};

use crate::{
    frame_order::{MUNICH, NETWORK},
    harness::{eventually, python},
    scenario::Cast,
    world::{OBSERVER, OBSERVER_PASSWORD, World},
};

/// Bodies that no connector may take, with the code that their first fault has.
fn rubbish_bodies() -> Vec<(&'static str, Vec<u8>)> {
    let network = |relations: Value, field_type: Value| {
        let operation = |id: &str| {
            json!({ "operationId": id, "operationType": "PRODUCTION", "dynamicDataRequestList": [
                { "dynamicDataRequestId": format!("r{id}"), "requesterId": "acme-aero", "recipientList": ["acme-aero"],
                  "purpose": "p", "reportDataFormat": { "reportName": "R", "reportFieldList": [
                    { "name": "f", "type": field_type } ] } } ] })
        };
        json!({ "messageType": "operation-network", "messageId": format!("rubbish-{}", uuid::Uuid::new_v4()),
            "factoryId": MUNICH, "collaborationId": "c", "revision": 99,
            "operationNetwork": { "operationNetworkId": NETWORK, "operationList": [operation("A"), operation("B")],
                "operationRelationList": relations } })
    };
    let relation = |id: &str, from: &str, to: &str| {
        json!({ "operationRelationId": id, "relationType": "FINISH_TO_START", "predecessorOperationId": from,
                "successorOperationId": to })
    };
    let cycle = network(json!([relation("x", "A", "B"), relation("y", "B", "A")]), json!(9));
    let nesting = format!("{}1{}", "[".repeat(100_000), "]".repeat(100_000));
    vec![
        ("not JSON", b"certainly not JSON".to_vec()),
        ("wrong schema", br#"{"messageType":"operation-network","revision":"three"}"#.to_vec()),
        ("a cycle", cycle.to_string().into_bytes()),
        ("an unknown type", network(json!([]), json!(77)).to_string().into_bytes()),
        ("200 KB of nesting", nesting.into_bytes()),
    ]
}

async fn send(world: &World, files: &[PathBuf]) -> anyhow::Result<(Vec<Value>, bool)> {
    let url = format!("amqp://127.0.0.1:{}", world.places.broker_plain);
    let address = format!("factory.{MUNICH}.requests");
    let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let mut arguments = vec![
        "--url",
        &url,
        "--user",
        OBSERVER,
        "--password",
        OBSERVER_PASSWORD,
        "--send",
        &address,
        "--subject",
        "operation-network",
    ];
    for file in &files {
        arguments.extend(["--body", file]);
    }
    python("amqp/exchange.py", &arguments, Duration::from_secs(40)).await
}

/// Sends invalid messages: each is answered and stored as a dead letter, and the network does not
/// change.
pub(super) async fn rubbish(world: &World, cast: &Cast) -> anyhow::Result<String> {
    let path = format!("/api/v1/operation-networks/{NETWORK}");
    let before: Value = cast.munich.get(&path).await?;
    let letters: Value = cast.munich.get("/api/v1/dead-letters").await?;
    let known = letters["items"].as_array().map_or(0, Vec::len);
    let mut files = Vec::new();
    for (place, (_, body)) in rubbish_bodies().into_iter().enumerate() {
        let file = world.places.folder.join(format!("rubbish-{place}.json"));
        std::fs::write(&file, body)?;
        files.push(file);
    }
    let (lines, is_well) = send(world, &files).await?;
    anyhow::ensure!(is_well, "the broker did not take it: {lines:?}");
    let count = files.len();
    let codes = eventually("each is answered", Duration::from_secs(10), || async {
        let letters: Value =
            cast.munich.get("/api/v1/dead-letters").await.map_err(|e| format!("{e:#}"))?;
        let items = letters["items"].as_array().cloned().unwrap_or_default();
        if items.len() >= known + count {
            Ok(items[..count]
                .iter()
                .filter_map(|l| l["code"].as_str().map(str::to_owned))
                .collect::<Vec<_>>())
        } else {
            Err(format!("{} of {} dead letters", items.len() - known, count))
        }
    })
    .await?;
    let after: Value = cast.munich.get(&path).await?;
    anyhow::ensure!(
        before["message"] == after["message"] && before["revision"] == after["revision"],
        "it changed"
    );
    Ok(codes.join(", "))
}

/// Puts a foreign client in the part of the stopped platform: it sends a request and reads
/// acknowledgement and reports. What it took away from the platform is sent again later, since the
/// platform never receipted it.
pub(super) async fn in_the_platforms_place(world: &World) -> anyhow::Result<String> {
    let message_id = uuid::Uuid::new_v4().to_string();
    let request = json!({ "messageType": "operation-network", "messageId": message_id, "factoryId": MUNICH,
        "collaborationId": "proton", "revision": 1, "operationNetwork": { "operationNetworkId": "proton-1",
            "operationList": [ { "operationId": "P1", "operationType": "PRODUCTION", "dynamicDataRequestList": [
                { "dynamicDataRequestId": "ReqProton", "requesterId": "acme-aero", "recipientList": ["acme-aero"],
                  "purpose": "Speak AMQP", "reportDataFormat": { "reportName": "R", "reportFieldList": [
                    { "name": "f", "type": 9 } ] } } ] } ] } });
    let file = world.places.folder.join("proton.json");
    std::fs::write(&file, request.to_string())?;
    let (url, file) =
        (format!("amqp://127.0.0.1:{}", world.places.broker_plain), file.display().to_string());
    let [requests, leases, ingress] =
        ["requests", "leases", "ingress"].map(|role| format!("factory.{MUNICH}.{role}"));
    let arguments = [
        "--url",
        &url,
        "--user",
        OBSERVER,
        "--password",
        OBSERVER_PASSWORD,
        "--send",
        &requests,
        "--subject",
        "operation-network",
        "--body",
        &file,
        "--leases",
        &leases,
        "--receive",
        &ingress,
        "--count",
        "8",
    ];
    let seen = eventually(
        "Proton exchanges messages with the connector",
        Duration::from_secs(60),
        || async {
            let (lines, _) = python("amqp/exchange.py", &arguments, Duration::from_secs(40))
                .await
                .map_err(|e| format!("{e:#}"))?;
            let received: Vec<Value> = lines
                .iter()
                .filter_map(|line| serde_json::from_str(line["received"]["body"].as_str()?).ok())
                .collect();
            if received.is_empty() { Err(format!("{lines:?}")) } else { Ok(received) }
        },
    )
    .await?;
    let is_answer = |m: &&Value| {
        m["messageType"] == "acknowledgement" && m["correlationId"] == message_id.as_str()
    };
    let answer = seen.iter().find(is_answer);
    anyhow::ensure!(
        answer.is_some_and(|m| m["result"] != "REJECTED"),
        "no acknowledgement in {seen:?}"
    );
    let reports = seen.iter().filter(|message| message["MessageType"] == "ua-data").count();
    anyhow::ensure!(reports > 0, "no report in {seen:?}");
    Ok(format!("{reports} reports read"))
}

/// More than a request may have.
pub(super) async fn oversize(world: &World) -> anyhow::Result<String> {
    let file = world.places.folder.join("oversize.json");
    std::fs::write(&file, vec![b' '; 3 * 1024 * 1024])?;
    let (lines, is_well) = send(world, &[file]).await?;
    let refusal = lines.iter().find_map(|line| {
        let is_refused = line["outcome"] == "rejected"
            || line.get("linkError").is_some()
            || line.get("failed").is_some();
        let reason = [&line["condition"], &line["linkError"], &line["failed"]];
        is_refused
            .then(|| reason.into_iter().find_map(Value::as_str).unwrap_or_default().to_owned())
    });
    match refusal {
        Some(reason) if reason.contains("size") => Ok(reason),
        other => anyhow::bail!("ended {is_well}, refusal {other:?}: {lines:?}"),
    }
}
