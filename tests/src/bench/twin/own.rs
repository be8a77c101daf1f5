//! The twin alone: memory, restore, readers, latency, bursts.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use anyhow::Context as _;
use opcua_stack::opcua::types::{NodeId, Variant};
use serde_json::Value;

use super::{
    client::{Client, instance},
    server::{Running, document, fields, new, node, now, released, text},
};
use crate::bench::figures::{figure, figures};

const NETWORKS: usize = 10_000;
const FIELDS_PER_NETWORK: usize = 10;
/// Time to wait for any notification.
const PATIENCE: Duration = Duration::from_secs(30);
/// Changes whose latency is measured.
const CHANGES: u64 = 1000;
/// Items of the burst, and how often each changes in one tick.
const ITEMS: usize = 50_000;
const ROUNDS: u64 = 3;
/// Browses whose median is taken.
const BROWSES: u32 = 500;

/// Bytes that the twin takes for a field with its document, and how long it takes to show
/// everything again from the stored messages.
pub(in crate::bench) fn fields_and_restore() -> anyhow::Result<Vec<Value>> {
    let folder = tempfile::tempdir()?;
    let stored: Vec<String> =
        (0..NETWORKS).map(|network| text(network, FIELDS_PER_NETWORK)).collect();
    // The key is made at the first start; a restart finds it.
    drop(new(folder.path())?);
    let before = resident()?;
    let start = Instant::now();
    let (twin, handle) = new(folder.path())?;
    for message in &stored {
        handle.apply(document(message)?);
    }
    let took = start.elapsed();
    let grown = resident()?.saturating_sub(before);
    drop(twin);
    let count = (NETWORKS * FIELDS_PER_NETWORK) as f64;
    Ok(vec![
        figure(
            "twin: memory of a field, its document included, 100 000 fields",
            grown as f64 / count,
            "bytes",
        ),
        figure(
            "twin: 100 000 fields parsed and shown again after a restart",
            took.as_secs_f64(),
            "s",
        ),
    ])
}

/// Measures a reader while 100 000 fields are added, and browsing one interface among 10 and among
/// 10 000.
pub(in crate::bench) async fn readers() -> anyhow::Result<Vec<Value>> {
    let folder = tempfile::tempdir()?;
    let twin = Running::start(folder.path()).await?;
    for network in 0..10 {
        twin.handle.apply(document(&text(NETWORKS + network, FIELDS_PER_NETWORK))?);
    }
    let client = Client::connect(&twin.url, folder.path()).await?;
    let among_few = browse(&client).await?;
    let documents: Vec<_> = (0..NETWORKS)
        .map(|network| document(&text(network, FIELDS_PER_NETWORK)))
        .collect::<Result<_, _>>()?;
    let is_done = Arc::new(AtomicBool::new(false));
    let adding = tokio::task::spawn_blocking({
        let (handle, is_done) = (twin.handle.clone(), Arc::clone(&is_done));
        move || {
            let start = Instant::now();
            for document in documents {
                handle.apply(document);
            }
            is_done.store(true, Ordering::Release);
            start.elapsed()
        }
    });
    let mut reads = Vec::new();
    while !is_done.load(Ordering::Acquire) {
        let start = Instant::now();
        client.read(&format!("network-{NETWORKS}#Revision")).await?;
        reads.push(start.elapsed());
    }
    let added = adding.await?;
    let late = reads.iter().filter(|read| **read > Duration::from_millis(20)).count();
    let among_many = browse(&client).await?;
    client.close().await?;
    twin.stop().await?;
    let mut results =
        vec![figure("twin: 100 000 fields added in 10 000 interfaces", added.as_secs_f64(), "s")];
    results.extend(figures("twin: a read meanwhile", reads));
    results.push(figure("twin: reads meanwhile that took over 20 ms", late as f64, "reads"));
    results.push(figure("twin: browsing an interface among 10, median", among_few, "ms"));
    results.push(figure("twin: browsing an interface among 10 000, median", among_many, "ms"));
    results.push(figure(
        "twin: browsing an interface among 10 000 against among 10",
        among_many / among_few,
        "times",
    ));
    Ok(results)
}

async fn browse(client: &Client) -> anyhow::Result<f64> {
    let mut times = Vec::new();
    for _ in 0..BROWSES {
        let start = Instant::now();
        client.browse(&format!("network-{NETWORKS}#OperationNetwork")).await?;
        times.push(start.elapsed());
    }
    times.sort_unstable();
    Ok(times[times.len() / 2].as_secs_f64() * 1000.0)
}

/// Measures the time from a change to its notification, with a publishing interval of 10 ms.
pub(in crate::bench) async fn latency() -> anyhow::Result<Vec<Value>> {
    let folder = tempfile::tempdir()?;
    let twin = Running::start(folder.path()).await?;
    let document = document(&text(0, 1))?;
    let key = fields(&document).pop().context("it has one field")?;
    twin.handle.apply(document);
    let client = Client::connect(&twin.url, folder.path()).await?;
    let mut changes = client.subscribe(&[instance(&node(&key))], Duration::from_millis(10)).await?;
    heard(&mut changes).await?;
    let mut times = Vec::new();
    for value in 2..2 + CHANGES {
        // Anywhere between two publishings.
        tokio::time::sleep(Duration::from_micros(1000 + (value * 137) % 9000)).await;
        let start = Instant::now();
        twin.handle.publish_values(vec![(key.clone(), released(value, now()))]);
        anyhow::ensure!(
            heard(&mut changes).await?.1.value == Some(value.into()),
            "values come in order"
        );
        times.push(start.elapsed());
    }
    client.close().await?;
    twin.stop().await?;
    Ok(figures("twin: change to notification at 10 ms publishing", times))
}

/// 50 000 items that change three times in one tick: what is lost, and when the last is heard.
pub(in crate::bench) async fn burst() -> anyhow::Result<Vec<Value>> {
    let folder = tempfile::tempdir()?;
    let twin = Running::start(folder.path()).await?;
    let mut keys = Vec::new();
    for network in 0..ITEMS / 500 {
        let document = document(&text(network, 500))?;
        keys.extend(fields(&document));
        twin.handle.apply(document);
    }
    let client = Client::connect(&twin.url, folder.path()).await?;
    let nodes: Vec<NodeId> = keys.iter().map(|key| instance(&node(key))).collect();
    let mut changes = client.subscribe(&nodes, Duration::from_millis(10)).await?;
    for _ in 0..ITEMS {
        heard(&mut changes).await?;
    }
    let start = Instant::now();
    for round in 2..2 + ROUNDS {
        twin.handle
            .publish_values(keys.iter().map(|key| (key.clone(), released(round, now()))).collect());
    }
    let mut last = vec![1_u64; ITEMS];
    let (mut received, mut out_of_order) = (0, 0);
    while received < ITEMS * ROUNDS as usize {
        let Ok((item, value)) = heard(&mut changes).await else { break };
        received += 1;
        match value.value {
            Some(Variant::UInt64(value)) if value == last[item] + 1 => last[item] = value,
            _ => out_of_order += 1,
        }
    }
    let took = start.elapsed();
    client.close().await?;
    twin.stop().await?;
    Ok(vec![
        figure(
            "twin: 150 000 changes of 50 000 items in one tick, until the last is heard",
            took.as_secs_f64(),
            "s",
        ),
        figure("twin: of these lost", (ITEMS * ROUNDS as usize - received) as f64, "changes"),
        figure("twin: of these out of order", f64::from(out_of_order), "changes"),
    ])
}

async fn heard<T>(changes: &mut tokio::sync::mpsc::UnboundedReceiver<T>) -> anyhow::Result<T> {
    let next = tokio::time::timeout(PATIENCE, changes.recv())
        .await
        .context("waiting for a notification")?;
    next.context("the subscription goes on")
}

/// Resident memory of this process in bytes.
fn resident() -> anyhow::Result<usize> {
    let statm = std::fs::read_to_string("/proc/self/statm")?;
    let pages: usize =
        statm.split(' ').nth(1).context("reading the memory of this process")?.parse()?;
    Ok(pages * 4096)
}
