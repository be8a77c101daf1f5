//! Views and rights of a foreign OPC UA client.

use std::time::Duration;

use anyhow::Context as _;
use serde_json::Value;

use crate::{
    frame_order::{MUNICH, NETWORK},
    harness::{Api, eventually, python},
    scenario::story,
    world::{ENGINEER, PASSWORD, World},
};

fn field_node(field: &str) -> String {
    format!("nsu=urn:verbund:cpt:{MUNICH};s={NETWORK}/op/MakeFrame1/req/ReqResponse1/{field}")
}

async fn asyncua(world: &World, command: &[&str]) -> anyhow::Result<Value> {
    let endpoint = format!("opc.tcp://127.0.0.1:{}", world.places.munich.twin);
    let pki = world.places.folder.join("asyncua").display().to_string();
    let mut arguments =
        vec![endpoint.as_str(), "--user", ENGINEER, "--password", PASSWORD, "--pki", pki.as_str()];
    arguments.extend(command);
    let (lines, _) = python("opcua/asyncua_client.py", &arguments, Duration::from_secs(40)).await?;
    lines.into_iter().next().context("asyncua printed no line")
}

/// Browses the nodes below an operation of the network.
pub(super) async fn browse(world: &World) -> anyhow::Result<String> {
    let node = format!("nsu=urn:verbund:cpt:{MUNICH};s={NETWORK}/op/MakeFrame1");
    let answer = asyncua(world, &["browse", &node]).await?;
    let text = answer.to_string();
    anyhow::ensure!(answer["ok"] == true && text.contains("/req/ReqResponse1"), "{text}");
    let value = asyncua(world, &["read", &field_node("progressStatus")]).await?;
    anyhow::ensure!(value["ok"] == true && value["status"] == "Good", "{value}");
    Ok("Basic256Sha256, SignAndEncrypt, named user".into())
}

/// Writes a value that is accepted, and that the platform then shows.
pub(super) async fn write_external(world: &World, platform: &Api) -> anyhow::Result<String> {
    let note = "Tool changed, going on";
    let answer =
        asyncua(world, &["write", &field_node("note"), "String", &format!("\"{note}\"")]).await?;
    anyhow::ensure!(answer["status"] == "Good", "{answer}");
    eventually("the platform shows the written value", Duration::from_secs(10), || async {
        let field = story::platform_field(platform, "note").await.map_err(|e| format!("{e:#}"))?;
        if field["value"] == note { Ok(String::new()) } else { Err(field.to_string()) }
    })
    .await
}

/// Writes a value to a mapped field, which is refused.
pub(super) async fn write_mapped(world: &World) -> anyhow::Result<String> {
    let answer = asyncua(world, &["write", &field_node("progressStatus"), "UInt64", "7"]).await?;
    anyhow::ensure!(answer["status"] == "BadNotWritable", "{answer}");
    Ok("BadNotWritable".into())
}
