//! Measures the reports per second that ingest stores, from bytes to the commit. `cargo run --release -p
//! platform --example ingest_rate [reports per message] [messages per batch] [batches]`.

#![allow(clippy::disallowed_methods, reason = "measured by the machine's clock")]

use std::{io::Write, sync::Arc, time::Instant};

use access_log::AccessLogKey;
use anyhow::Context;
use asi_model::DateTime;
use daemon::telemetry::Metrics;
use messaging::{Delivery, Envelope, Inbox, LogicalAddress, Settlement};
use platform::{
    accesses::AccessRecorder,
    broker_access::BrokerAccess,
    clock::Clock,
    config::PlatformConfig,
    ingest::{Ingest, IngestConfig, RoomConfig},
    live::LiveLog,
    networks::{Author, PutNetwork, put},
    principal::Principal,
    progress_notifier::ProgressNotifier,
    store::{Collaboration, Organisation, Role, Store, User},
    witness::WitnessKey,
};
use tokio_util::sync::CancellationToken;

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let mut numbers = std::env::args().skip(1).map(|argument| argument.parse::<u32>());
    let mut number =
        |default: u32| numbers.next().transpose().map(|given| given.unwrap_or(default));
    let (reports, messages, batches) = (number(10)?, number(100)?, number(100)?);

    let folder = tempfile::tempdir()?;
    let _metrics = Metrics::install()?;
    let store = Store::open(&folder.path().join("platform.sqlite")).await?;
    set_up(&store).await?;
    let live = LiveLog::new(1_000, 1);
    let (_board, progress) = ProgressNotifier::new(store.clone(), live.clone());
    let key = AccessLogKey::from_secret(&[1; 32]);
    let wait = std::time::Duration::from_secs(60);
    let witness = Arc::new(WitnessKey::open(folder.path())?);
    let (ingest, handle) = Ingest::new(
        IngestConfig {
            resend_after: wait,
            silence: wait,
            witness,
            room: RoomConfig::of(&PlatformConfig::default()),
        },
        store.clone(),
        live,
        BrokerAccess::new(Vec::new()),
        progress,
        AccessRecorder::new(Arc::new(store.clone()), key, Clock::system()),
        Clock::system(),
    )
    .await?;
    let shutdown = CancellationToken::new();
    let running = tokio::spawn(ingest.run(shutdown.clone()));

    let address = Arc::new(LogicalAddress::FactoryIngress("F".parse()?));
    let all: Vec<Vec<Delivery>> = (0..batches)
        .map(|batch| {
            (0..messages).map(|index| message(batch * messages + index, reports)).collect()
        })
        .collect::<anyhow::Result<_>>()?;
    let bytes: usize = all.iter().flatten().map(|delivery| delivery.envelope.body.len()).sum();

    let started = Instant::now();
    for batch in all {
        let settlements = handle.receive(&address, batch).await;
        anyhow::ensure!(
            settlements.iter().all(|settlement| *settlement == Settlement::Accept),
            "not all were stored"
        );
    }
    let seconds = started.elapsed().as_secs_f64();
    let count = f64::from(reports * messages * batches);
    writeln!(
        std::io::stdout(),
        "{reports} reports per message, {messages} messages per batch: {:.0} reports/s, {:.0} messages/s, {:.1} MB/s",
        count / seconds,
        f64::from(messages * batches) / seconds,
        f64::from(u32::try_from(bytes / 1000)?) / 1000.0 / seconds
    )?;
    shutdown.cancel();
    running.await??;
    Ok(())
}

async fn set_up(store: &Store) -> anyhow::Result<()> {
    let now = DateTime::from_unix_micros(0);
    let mut work = store.begin().await?;
    let organisation =
        Organisation { organisation_id: "o".parse()?, name: "o".into(), created_at: now };
    work.organisations().add(&organisation).await?;
    work.factories().add(&"F".parse()?, &"o".parse()?, "F", now).await?;
    let collaboration = Collaboration {
        collaboration_id: "c".parse()?,
        name: "c".into(),
        created_at: now,
        members: vec!["o".parse()?],
        factories: vec!["F".parse()?],
    };
    work.collaborations().add(&collaboration).await?;
    let network = serde_json::from_value(
        serde_json::json!({ "operationNetworkId": "net", "operationList": [
        { "operationId": "op", "operationType": "PRODUCTION", "owningFactoryId": "F", "dynamicDataRequestList": [
            { "dynamicDataRequestId": "req", "requesterId": "o", "recipientList": ["o"], "purpose": "to measure",
              "reportDataFormat": { "reportName": "r", "reportFieldList": [
                { "name": "count", "type": 9 }, { "name": "state", "type": 12 }, { "name": "power", "type": 11 } ] } } ] } ] }),
    )?;
    let user = User { user_name: "u".into(), role: Role::Administrator, organisation_id: None };
    let author = Author::user(&Principal { user }, now);
    let change = PutNetwork { collaboration_id: "c".parse()?, network, expected_revision: None };
    put(&mut work, change, &author, std::time::Duration::from_secs(60))
        .await
        .context("putting the network")?;
    Ok(work.commit().await?)
}

fn message(number: u32, reports: u32) -> anyhow::Result<Delivery> {
    let parts: Vec<serde_json::Value> = (0..reports)
        .map(|index| {
            serde_json::json!({ "DataSetWriterId": 1, "SequenceNumber": number * reports + index,
                "MetaDataVersion": { "MajorVersion": 1, "MinorVersion": 1 }, "Timestamp": "2019-04-18T18:20:30Z",
                "Payload": {
                    "reportName": { "Type": 12, "Body": "r" }, "dynamicDataRequestId": { "Type": 12, "Body": "req" },
                    "operationId": { "Type": 12, "Body": "op" }, "operationNetworkId": { "Type": 12, "Body": "net" },
                    "shopfloorTimestamp": { "Type": 13, "Body": "2019-04-18T18:20:05Z" },
                    "recipientList": { "Type": 12, "Body": ["o"] },
                    "count": { "Type": 9, "Body": index.to_string() }, "state": { "Type": 12, "Body": "Running" },
                    "power": { "Type": 11, "Body": 4.2 } } })
        })
        .collect();
    let id = format!("m{number}");
    let body = serde_json::json!({ "MessageId": id, "MessageType": "ua-data", "PublisherId": "F", "Messages": parts });
    Ok(Delivery {
        envelope: Envelope::new(id.parse()?, "ua-data", body.to_string().into_bytes()),
        is_redelivered: false,
        delivery_count: 0,
        received_at: time::OffsetDateTime::now_utc(),
    })
}
