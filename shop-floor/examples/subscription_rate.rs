//! Rate of changes through bare subscriptions, from a server in the same process to the consumer.
//!
//! `cargo run --release -p shop-floor --example subscription_rate -- [inputs] [changes per second]
//! [seconds]`

#![allow(clippy::disallowed_methods, reason = "measured by the machine's clock")]

use std::{
    io::Write as _,
    time::{Duration, Instant},
};

use shop_floor::{
    Config, InputKey, MonitorOptions, MonitorRequest, SecurityChoice, ShopFloor, SourceConfig,
    SourceId,
};
use simulator::{MachineConfig, MachineKind, Simulator};
use tokio_util::sync::CancellationToken;

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u32>());
    let mut next = |standard| arguments.next().unwrap_or(Ok(standard));
    let (inputs, offered, seconds) = (next(10_000)?, next(100_000)?, next(10)?);

    let directory = tempfile::tempdir()?;
    let mut bank = MachineConfig::new("Bank", MachineKind::Bank);
    (bank.variables, bank.changes_per_second, bank.relay) = (inputs, f64::from(offered), false);
    let mut simulation = simulator::Config::of(vec![bank]);
    simulation.pki_directory = directory.path().join("machines");
    simulation.update_interval_ms = 10;
    let (simulator, machines) = Simulator::new(simulation).await?;
    let stop = CancellationToken::new();
    tokio::spawn(simulator.run(stop.clone()));
    let machine = machines.machines().next().expect("one is configured");

    let config =
        Config::new(directory.path().join("shop-floor"), "throughput", "urn:verbund:throughput");
    let (floor, handle, mut changes) = ShopFloor::new(config);
    tokio::spawn(floor.run(stop.clone()));
    let mut source = SourceConfig::new(SourceId::new("bank")?, machine.endpoint_url());
    (source.security, source.publishing_interval_ms) = (SecurityChoice::None, 50);
    let id = source.source_id.clone();
    let requests = (0..inputs).map(|index| MonitorRequest {
        input: InputKey(u64::from(index)),
        source: id.clone(),
        node_id: machine.node_id(&format!("Counter{index}")).expect("a bank has its counters"),
        options: MonitorOptions { sampling_interval_ms: Some(0.0), ..MonitorOptions::default() },
    });
    handle.monitor_many(requests.collect())?;
    let begun = Instant::now();
    handle.put_source(source)?;
    while handle.states().first().is_none_or(|state| state.live < inputs as usize) {
        let _ = tokio::time::timeout(Duration::from_millis(20), changes.recv()).await;
    }
    let live_after = begun.elapsed();

    let (mut received, mut age, begun) = (0_u64, Duration::ZERO, Instant::now());
    while begun.elapsed() < Duration::from_secs(u64::from(seconds)) {
        let Some(batch) = changes.recv().await else { break };
        let now = asi_model::DateTime::from(std::time::SystemTime::now());
        let newest = batch.last().and_then(|change| change.value.source_timestamp);
        age = age.max(newest.map_or(Duration::ZERO, |at| now.since(at)));
        received += batch.len() as u64;
    }
    let rate = received as f64 / begun.elapsed().as_secs_f64();
    let mut out = std::io::stdout();
    writeln!(out, "{inputs} inputs live after {live_after:.1?}")?;
    writeln!(
        out,
        "{rate:.0} of {offered} changes per second, the newest of a batch at most {age:.0?} old"
    )?;
    stop.cancel();
    Ok(())
}
