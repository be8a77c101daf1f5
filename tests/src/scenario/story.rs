//! The steps of the frame order, each of which may be taken again: what is there already is left as
//! it is, so that the demo's second start goes on where the first stopped.

use std::time::Duration;

use anyhow::Context as _;
use reqwest::StatusCode;
use serde_json::{Value, json};

pub use super::decisions::{StoryDecision, decisions, machines, node};
use crate::frame_order::{
    BUYER, COLLABORATION, HAMBURG, INSPECTOR, MAKER, MUNICH, NETWORK, operation_network,
};
use crate::{
    harness::{Api, ApiError, eventually},
    world::World,
};

/// Time that any single step may take on a busy machine.
const PATIENCE: Duration = Duration::from_secs(30);

/// True for "that exists already".
fn is_conflict(error: &anyhow::Error) -> bool {
    error.downcast_ref::<ApiError>().is_some_and(|error| error.status == StatusCode::CONFLICT)
}

async fn add(api: &Api, path: &str, body: Value) -> anyhow::Result<()> {
    match api.post::<Value>(path, &body).await {
        Err(error) if !is_conflict(&error) => Err(error),
        _ => Ok(()),
    }
}

/// Three organisations, two factories and the collaboration they signed.
///
/// # Errors
/// When the platform refuses.
pub async fn found_collaboration(platform: &Api) -> anyhow::Result<String> {
    let organisations = [
        (BUYER, "Acme Aero"),
        (MAKER, "Frames Munich GmbH"),
        (INSPECTOR, "Inspection Hamburg GmbH"),
    ];
    for (id, name) in organisations {
        add(platform, "/api/v1/organisations", json!({ "organisationId": id, "name": name }))
            .await?;
    }
    for (id, owner, name) in
        [(MUNICH, MAKER, "Munich works"), (HAMBURG, INSPECTOR, "Hamburg works")]
    {
        add(
            platform,
            "/api/v1/factories",
            json!({ "factoryId": id, "organisationId": owner, "name": name }),
        )
        .await?;
    }
    add(
        platform,
        "/api/v1/collaborations",
        json!({ "collaborationId": COLLABORATION, "name": "Frame order 4711",
                "members": [BUYER, MAKER, INSPECTOR], "factories": [MUNICH, HAMBURG] }),
    )
    .await?;
    Ok(format!("{} organisations, 2 factories", organisations.len()))
}

/// Enrols a factory's connector with a single-use token, unless an earlier start did, and starts
/// it.
///
/// # Errors
/// When token or connector fail.
pub async fn join_factory(
    world: &mut World,
    platform: &Api,
    factory_id: &str,
) -> anyhow::Result<String> {
    let enrolled = world.places.folder.join(format!("enrolled-{factory_id}"));
    let is_enrolled = enrolled.exists();
    let token = if is_enrolled {
        None
    } else {
        let token: Value = platform
            .post(&format!("/api/v1/factories/{factory_id}/enrolment-tokens"), &json!({}))
            .await?;
        Some(token["token"].as_str().context("the platform gave no token")?.to_owned())
    };
    world.start_connector(factory_id, token.as_deref()).await?;
    std::fs::write(enrolled, "")?;
    Ok(if is_enrolled {
        "enrolled before".into()
    } else {
        "enrolled with a single-use token".into()
    })
}

/// Waits until a connector says that its link is up.
///
/// # Errors
/// When it does not come up.
pub async fn link_is_up(connector: &Api) -> anyhow::Result<String> {
    eventually("the link is up", PATIENCE, || async {
        let status: Value = connector.get("/api/v1/status").await.map_err(|e| format!("{e:#}"))?;
        match status["link"]["state"].as_str() {
            Some(state) if state.eq_ignore_ascii_case("up") => Ok(String::new()),
            _ => Err(status["link"].to_string()),
        }
    })
    .await
}

/// Connects a factory's connector to its machines and waits until it reads from them.
///
/// # Errors
/// When a source is refused or stays away.
pub async fn add_sources(
    world: &World,
    connector: &Api,
    factory_id: &str,
) -> anyhow::Result<String> {
    let ports = world.places.factory(factory_id)?.machines;
    for (machine, port) in machines(factory_id).into_iter().zip(ports) {
        let source = json!({ "sourceId": machine, "name": machine, "endpointUrl": format!("opc.tcp://127.0.0.1:{port}"),
                             "security": { "choice": "none" } });
        add(connector, "/api/v1/sources", source).await?;
    }
    eventually("all sources are connected", PATIENCE, || async {
        let status: Value = connector.get("/api/v1/status").await.map_err(|e| format!("{e:#}"))?;
        let sources = status["sources"].as_array().cloned().unwrap_or_default();
        let is_live = |source: &Value| {
            source["state"].as_str().is_some_and(|state| {
                ["connected", "live", "up"].contains(&state.to_lowercase().as_str())
            })
        };
        if sources.len() >= 3 && sources.iter().all(is_live) {
            Ok(format!("{} machines", sources.len()))
        } else {
            Err(status["sources"].to_string())
        }
    })
    .await
}

/// Sends the network and waits until both factories have accepted their part.
///
/// # Errors
/// When the platform or a factory refuses it.
pub async fn send_network(platform: &Api) -> anyhow::Result<String> {
    let path = format!("/api/v1/operation-networks/{NETWORK}");
    if platform.get::<Value>(&path).await.is_err() {
        let network = operation_network(time::OffsetDateTime::now_utc());
        let body = json!({ "collaborationId": COLLABORATION, "operationNetwork": network });
        platform.put::<Value>(&path, &body).await?;
    }
    parts_are_accepted(platform).await
}

/// Waits until both factories have accepted their part of the newest revision.
///
/// # Errors
/// When a factory refuses it, or does not answer.
pub async fn parts_are_accepted(platform: &Api) -> anyhow::Result<String> {
    let path = format!("/api/v1/operation-networks/{NETWORK}");
    eventually("both factories accept their part", PATIENCE, || async {
        let view: Value = platform.get(&path).await.map_err(|e| format!("{e:#}"))?;
        let parts = view["parts"].as_array().cloned().unwrap_or_default();
        let is_answered = |part: &Value| {
            ["ACCEPTED", "UNCHANGED"].contains(&part["state"].as_str().unwrap_or_default())
        };
        if parts.len() == 2 && parts.iter().all(is_answered) {
            Ok(format!("revision {}", view["revision"]))
        } else {
            Err(view["parts"].to_string())
        }
    })
    .await
}

/// Returns the path of a field in a connector's API.
#[must_use]
pub fn field_path(operation: &str, request: &str, field: &str) -> String {
    format!("/api/v1/fields/{NETWORK}/{operation}/{request}/{field}")
}

/// Takes those of the decisions that are one factory's engineer's through the API that the page uses; decided fields stay
/// as they are.
///
/// # Errors
/// When the connector refuses one.
pub async fn decide(
    connector: &Api,
    factory_id: &str,
    decisions: &[StoryDecision],
) -> anyhow::Result<String> {
    let inbox: Value = connector.get(&format!("/api/v1/operation-networks/{NETWORK}")).await?;
    let (mut mapped, mut refused) = (0, 0);
    for story in decisions.iter().filter(|story| story.factory_id == factory_id) {
        let path = field_path(story.operation, story.request, story.field);
        let is_pending = field_state(&inbox, story.field).is_none_or(|state| state == "PENDING");
        if is_pending {
            connector
                .put::<Value>(&format!("{path}/decision"), &story.decision)
                .await
                .with_context(|| format!("deciding {}", story.field))?;
        }
        if story.decision["mappingState"] == "REFUSED" { refused += 1 } else { mapped += 1 }
    }
    Ok(format!("{mapped} fields mapped, {refused} refused"))
}

/// Finds the state of a field anywhere in a JSON document of the connector.
fn field_state(document: &Value, name: &str) -> Option<String> {
    match document {
        Value::Array(items) => items.iter().find_map(|item| field_state(item, name)),
        Value::Object(members) => {
            let names_field =
                members.get("name").or_else(|| members.get("fieldName")).is_some_and(|n| n == name);
            if names_field && let Some(state) = members.get("mappingState").and_then(Value::as_str)
            {
                return Some(state.to_owned());
            }
            members.values().find_map(|member| field_state(member, name))
        }
        _ => None,
    }
}

/// Returns the platform's view of a field: mapping state, value, status and sequence.
///
/// # Errors
/// When the platform does not answer or does not know the field.
pub async fn platform_field(platform: &Api, field: &str) -> anyhow::Result<Value> {
    let view: Value = platform.get(&format!("/api/v1/operation-networks/{NETWORK}")).await?;
    let fields = view["fields"].as_array().cloned().unwrap_or_default();
    fields
        .into_iter()
        .find(|f| f["key"]["fieldName"] == field || f["fieldName"] == field)
        .with_context(|| format!("the platform knows no field {field}"))
}

/// Waits until the platform shows a value for every mapped field that a machine feeds.
///
/// # Errors
/// When one stays away.
pub async fn values_flow(platform: &Api, decisions: &[StoryDecision]) -> anyhow::Result<String> {
    let fed: Vec<&str> = decisions
        .iter()
        .filter(|story| story.decision["valueSource"] == "MAPPING")
        .map(|story| story.field)
        .collect();
    eventually("every mapped field has a value on the platform", PATIENCE, || async {
        for field in &fed {
            let shown = platform_field(platform, field).await.map_err(|e| format!("{e:#}"))?;
            if shown["value"].is_null() {
                return Err(format!("{field}: {shown}"));
            }
        }
        Ok(format!("{} fields", fed.len()))
    })
    .await
}

/// Waits until no report of a factory is missing at the platform, but for announced gaps. Returns the number of those received.
///
/// # Errors
/// When some stay away.
pub async fn none_missing(platform: &Api, factory_id: &str) -> anyhow::Result<u64> {
    eventually("no report is missing", PATIENCE, || async {
        let path = format!("/api/v1/factories/{factory_id}/writers");
        let writers = platform.list(&path).await.map_err(|e| format!("{e:#}"))?;
        let is_whole = |writer: &Value| writer["missingCount"].as_u64() == Some(0);
        if writers.is_empty() || !writers.iter().all(is_whole) {
            return Err(Value::from(writers).to_string());
        }
        Ok(writers.iter().filter_map(|writer| writer["received"].as_u64()).sum())
    })
    .await
}
