//! Members of a collaboration against each other.

use anyhow::Context as _;
use serde_json::{Value, json};

use crate::{
    frame_order::{BUYER, COLLABORATION, INSPECTOR, MAKER, MUNICH, NETWORK},
    harness::{Api, ApiError},
};

const PASSWORD: &str = "a planner of their own";

/// Adds a planner of a member, and signs in.
pub(super) async fn planner(platform: &Api, organisation: &str) -> anyhow::Result<Api> {
    let name = format!("planner-{organisation}");
    let body = json!({ "password": PASSWORD, "role": "PLANNER", "organisationId": organisation });
    let _: Value = platform.put(&format!("/api/v1/users/{name}"), &body).await?;
    let mut api = Api::new(platform.base())?;
    api.sign_in(&name, PASSWORD).await?;
    Ok(api)
}

fn path() -> String {
    format!("/api/v1/operation-networks/{NETWORK}")
}

/// Puts the buyer's request under the maker's name.
pub(super) async fn takes_a_request_over(platform: Api, planner: Api) -> anyhow::Result<String> {
    let before: Value = platform.get(&path()).await?;
    let mut network = before["network"].clone();
    let operations = network["operationList"].as_array_mut().context("operations")?;
    let requests = operations
        .iter_mut()
        .filter_map(|operation| operation["dynamicDataRequestList"].as_array_mut())
        .flatten();
    let mut count = 0;
    for request in requests {
        request["requesterId"] = json!(MAKER);
        request["recipientList"] = json!([MAKER]);
        count += 1;
    }
    anyhow::ensure!(count > 0, "there is no request to take over");
    let document = json!({ "collaborationId": COLLABORATION, "operationNetwork": network });
    let refused = planner.put::<Value>(&path(), &document).await;
    let said = refusal(refused)?;
    let after: Value = platform.get(&path()).await?;
    anyhow::ensure!(before["network"] == after["network"], "the network changed");
    Ok(said)
}

/// Withdraws the network that the buyer drew.
pub(super) async fn withdraws_the_network(planner: Api) -> anyhow::Result<String> {
    refusal(planner.delete::<Value>(&path()).await)
}

/// Reads what the maker released to the buyer, as the inspector.
pub(super) async fn reads_of_others(platform: Api, inspector: Api) -> anyhow::Result<String> {
    let of = |who: &str| format!("/api/v1/reports?operationNetworkId={NETWORK}&limit=500{who}");
    let buyers: Value = platform.get(&of("")).await?;
    let shown = buyers["items"].as_array().map_or(0, Vec::len);
    anyhow::ensure!(shown > 0, "the buyer reads nothing either");
    let seen: Value = inspector.get(&of("")).await?;
    let items = seen["items"].as_array().context("reports")?;
    anyhow::ensure!(items.is_empty(), "{INSPECTOR} reads {} reports", items.len());
    Ok(format!("the buyer reads {shown}, another member none"))
}

/// Returns the status and code of a refusal.
fn refusal(answer: anyhow::Result<Value>) -> anyhow::Result<String> {
    let Err(error) = answer else { anyhow::bail!("it was taken") };
    let Some(problem) = error.downcast_ref::<ApiError>() else { return Err(error) };
    let code = problem.problem["code"].as_str().unwrap_or_default();
    let faults = problem.problem["faults"].as_array().cloned().unwrap_or_default();
    let codes: std::collections::BTreeSet<_> =
        faults.iter().filter_map(|fault| fault["code"].as_str()).collect();
    // A document that is refused for its form alone proves nothing.
    let is_refused = code == "FORBIDDEN" || codes.iter().any(|code| code.starts_with("FOREIGN_"));
    anyhow::ensure!(is_refused, "answered {problem}");
    Ok(format!("{} {code} {}", problem.status.as_u16(), Vec::from_iter(codes).join(" ")))
}

/// Takes ids of networks in another collaboration: those that are in use, and those that are another organisation's to
/// give. The answers say no more than that they cannot be had.
pub(super) async fn ids_of_others(platform: Api) -> anyhow::Result<String> {
    const OUTSIDER: &str = "probe-outsider";
    const FACTORY: &str = "OUT_SIDE";
    const OWN: &str = "probe-collaboration";
    let body = json!({ "organisationId": OUTSIDER, "name": OUTSIDER });
    let _: Value = platform.post("/api/v1/organisations", &body).await?;
    let body = json!({ "factoryId": FACTORY, "organisationId": OUTSIDER, "name": FACTORY });
    let _: Value = platform.post("/api/v1/factories", &body).await?;
    let body = json!({ "collaborationId": OWN, "name": OWN, "members": [OUTSIDER],
        "factories": [FACTORY] });
    let _: Value = platform.post("/api/v1/collaborations", &body).await?;
    let outsider = planner(&platform, OUTSIDER).await?;
    let answer = async |id: &str| {
        let network = json!({ "operationNetworkId": id, "operationList": [ { "operationId": "Op",
            "operationType": "PRODUCTION", "owningFactoryId": FACTORY } ] });
        let body = json!({ "collaborationId": OWN, "operationNetwork": network });
        let taken = outsider.put::<Value>(&format!("/api/v1/operation-networks/{id}"), &body).await;
        let Err(error) = taken else { return Ok(None) };
        let problem = error.downcast::<ApiError>()?;
        anyhow::Ok(Some((problem.status, problem.problem.to_string().replace(id, "ID"))))
    };
    let (status, text) = answer(NETWORK).await?.context("the id of another network was taken")?;
    let named = [COLLABORATION, BUYER, MAKER, INSPECTOR, MUNICH].into_iter();
    let named: Vec<_> = named.filter(|secret| text.contains(secret)).collect();
    anyhow::ensure!(named.is_empty(), "the refusal has {named:?}: {text}");
    let shown = outsider.get::<Value>(&format!("/api/v1/operation-networks/{NETWORK}")).await;
    anyhow::ensure!(shown.is_err(), "the outsider sees the network");
    // Ids that end in `@` and an organisation are that organisation's, in use or not.
    let reserved =
        [format!("free@{BUYER}"), format!("other@{BUYER}"), "x@nobody-at-all".to_owned()];
    let mut answers = Vec::new();
    for id in &reserved {
        answers.push(answer(id).await?.with_context(|| format!("{id} was taken"))?);
    }
    let first = answers.first().map(|(status, text)| (*status, text.replace(BUYER, "ORG")));
    let are_alike = answers.iter().all(|(status, text)| {
        let text = text.replace(BUYER, "ORG").replace("nobody-at-all", "ORG");
        first == Some((*status, text))
    });
    anyhow::ensure!(are_alike, "the refusals show what is in use: {answers:?}");
    anyhow::ensure!(answer("probe-own").await?.is_none(), "an id of one's own is refused");
    Ok(format!("{status} without a word on whose it is; reserved ids are all alike"))
}
