//! Time from a request sent to its nodes in the address space, as an OPC UA client of the plant
//! sees it.

use std::time::{Duration, Instant};

use anyhow::Context as _;
use asi_model::NodeId;
use serde_json::{Value, json};
use shop_floor::{
    Config, Identity, SecurityChoice, ShopFloor, ShopFloorHandle, SourceConfig, SourceId,
    TrustState,
};
use tokio_util::sync::CancellationToken;

use crate::{
    frame_order::{BUYER, MUNICH, NETWORK},
    harness::{Api, eventually},
    world::{ENGINEER, PASSWORD, World},
};

/// Adds requests one by one and waits for the node of each.
pub(super) async fn measure(
    world: &World,
    platform: &Api,
    times: u32,
) -> anyhow::Result<Vec<Duration>> {
    let config = Config::new(
        world.places.folder.join("bench-pki"),
        "Verbund benchmark",
        "urn:verbund:bench",
    );
    let (floor, handle, _changes) = ShopFloor::new(config);
    let shutdown = CancellationToken::new();
    let running = tokio::spawn(floor.run(shutdown.clone()));
    let twin = connect(world, &handle).await?;
    let mut latencies = Vec::new();
    for number in 0..times {
        let request = format!("ReqBench{number}");
        let node: NodeId =
            format!("nsu=urn:verbund:cpt:{MUNICH};s={NETWORK}/op/MakeFrame1/req/{request}")
                .parse()?;
        let start = Instant::now();
        let body = json!({ "dynamicDataRequestId": request, "requesterId": BUYER, "recipientList": [BUYER],
            "purpose": "Benchmark", "reportDataFormat": { "reportName": "R", "reportFieldList": [
                { "name": "f", "type": 9 } ] } });
        platform
            .post::<Value>(
                &format!("/api/v1/operation-networks/{NETWORK}/operations/MakeFrame1/requests"),
                &body,
            )
            .await?;
        loop {
            if handle.browse(&twin, Some(&node)).await.is_ok_and(|children| !children.is_empty()) {
                latencies.push(start.elapsed());
                break;
            }
            anyhow::ensure!(
                start.elapsed() < Duration::from_secs(10),
                "the nodes of {request} stayed away"
            );
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    }
    shutdown.cancel();
    running.await.context("ending the OPC UA client")?;
    Ok(latencies)
}

async fn connect(world: &World, handle: &ShopFloorHandle) -> anyhow::Result<SourceId> {
    let id = SourceId::new("twin")?;
    let mut source =
        SourceConfig::new(id.clone(), &format!("opc.tcp://127.0.0.1:{}", world.places.munich.twin));
    source.security = SecurityChoice::Strongest;
    source.identity =
        Identity::UserName { user_name: ENGINEER.to_owned(), password: PASSWORD.into() };
    handle.put_source(source)?;
    eventually("the benchmark's OPC UA client is connected", Duration::from_secs(30), || async {
        for certificate in handle.certificates().await.map_err(|error| error.to_string())? {
            handle
                .set_trust(&certificate.thumbprint, TrustState::Trusted)
                .await
                .map_err(|error| error.to_string())?;
        }
        handle.browse(&id, None).await.map(|_| ()).map_err(|error| error.to_string())
    })
    .await?;
    Ok(id)
}
