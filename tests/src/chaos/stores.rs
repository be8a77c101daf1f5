//! Stores of the programs, read and spoilt from outside.

pub(super) mod control;
pub(super) mod given_up;
mod units;

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

use anyhow::Context as _;
use serde_json::Value;
use sqlx::{
    ConnectOptions as _, Connection as _, Row as _, SqliteConnection,
    sqlite::{SqliteConnectOptions, SqliteRow},
};

use super::content::{Content, shown_fields};
use crate::frame_order::{HAMBURG, MUNICH};

/// One DataSetMessage of a factory.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ReportKey {
    pub factory: String,
    pub writer: i64,
    pub epoch: i64,
    pub sequence: i64,
}

/// A comment, from or to a factory.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Comment {
    pub factory: String,
    pub is_from_factory: bool,
    pub text: String,
}

/// Row of a report in a connector's store.
#[derive(Debug, Clone)]
pub(super) struct Left {
    /// Number in the order in which they were made.
    pub id: i64,
    /// WAITING, SENT, PARKED or DONE.
    pub state: String,
    /// Number of partners it was for.
    pub recipients: usize,
    pub content: Content,
}

/// Row of a report in the platform's store.
#[derive(Debug, Clone)]
pub(super) struct Arrived {
    pub is_replay: bool,
    pub content: Content,
}

const BROKER_FILES: [&str; 3] = ["broker.sqlite", "broker.sqlite-wal", "broker.sqlite-shm"];

async fn open(file: &Path) -> anyhow::Result<SqliteConnection> {
    let options =
        SqliteConnectOptions::new().filename(file).busy_timeout(std::time::Duration::from_secs(10));
    options.connect().await.with_context(|| format!("opening {}", file.display()))
}

fn connector_store(folder: &Path, factory: &str) -> PathBuf {
    folder.join(format!("connector-{factory}/connector.sqlite"))
}

fn platform_store(folder: &Path) -> PathBuf {
    folder.join("platform/platform.sqlite")
}

/// State of a report without a receipt, as its connector knows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ReportState {
    /// The broker has not accepted it, or its answer is not stored yet.
    Waiting,
    Sent,
}

/// A report without a receipt.
#[derive(Debug, Clone)]
pub(super) struct Unreceipted {
    pub key: ReportKey,
    /// Number in the order in which they were made.
    pub id: i64,
    pub state: ReportState,
}

/// Returns the reports that the platform has not receipted.
pub(super) async fn unreceipted_reports(
    folder: &Path,
    factory: &str,
) -> anyhow::Result<Vec<Unreceipted>> {
    let mut store = open(&connector_store(folder, factory)).await?;
    let rows = sqlx::query(
        "SELECT id, writer_id, epoch, sequence, state FROM report WHERE state IN ('SENT', 'WAITING')",
    )
    .fetch_all(&mut store)
    .await?;
    Ok(rows
        .iter()
        .map(|row| {
            let key = ReportKey {
                factory: factory.to_owned(),
                writer: row.get("writer_id"),
                epoch: row.get("epoch"),
                sequence: row.get("sequence"),
            };
            let is_sent = row.get::<&str, _>("state") == "SENT";
            let state = if is_sent { ReportState::Sent } else { ReportState::Waiting };
            Unreceipted { key, id: row.get("id"), state }
        })
        .collect())
}

/// Reports of a connector that no receipt covers so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpoolSample {
    pub bytes: i64,
    /// Number of the oldest one; that of the next report where there is none.
    pub first: i64,
    /// Number of the newest report of all.
    pub last: i64,
}

/// Returns what waits for a receipt in a connector's spool.
pub(super) async fn spool(folder: &Path, factory: &str) -> anyhow::Result<SpoolSample> {
    let mut store = open(&connector_store(folder, factory)).await?;
    let sql = "SELECT coalesce(sum(bytes), 0) AS bytes, min(id) AS first, \
               (SELECT coalesce(max(id), 0) FROM report) AS last \
               FROM report WHERE state IN ('SENT', 'WAITING')";
    let row = sqlx::query(sql).fetch_one(&mut store).await?;
    let last: i64 = row.get("last");
    let first: Option<i64> = row.get("first");
    Ok(SpoolSample { bytes: row.get("bytes"), first: first.unwrap_or(last + 1), last })
}

/// Returns the number of gaps that were announced and that no receipt covered so far.
pub(super) async fn unsettled_gaps(folder: &Path, factory: &str) -> anyhow::Result<i64> {
    let mut store = open(&connector_store(folder, factory)).await?;
    let sql = "SELECT count(*) AS count FROM announced_gap";
    Ok(sqlx::query(sql).fetch_one(&mut store).await?.get("count"))
}

/// Removes the broker's store.
pub(super) fn remove_broker_store(folder: &Path) -> anyhow::Result<()> {
    for file in BROKER_FILES {
        let file = folder.join("platform").join(file);
        if file.exists() {
            std::fs::remove_file(&file).with_context(|| format!("removing {}", file.display()))?;
        }
    }
    Ok(())
}

/// Exchanges the broker's store for the one that was put aside the last time. The first time a copy
/// is put aside, and the store stays.
pub(super) fn exchange_broker_store(folder: &Path) -> anyhow::Result<()> {
    let (here, aside) = (folder.join("platform"), folder.join("broker-aside"));
    let old = folder.join("broker-old");
    let has_old = aside.exists();
    if has_old {
        std::fs::rename(&aside, &old)?;
    }
    std::fs::create_dir(&aside)?;
    for file in BROKER_FILES.into_iter().filter(|file| here.join(file).exists()) {
        std::fs::copy(here.join(file), aside.join(file))?;
    }
    if has_old {
        remove_broker_store(folder)?;
        for file in BROKER_FILES.into_iter().filter(|file| old.join(file).exists()) {
            std::fs::copy(old.join(file), here.join(file))?;
        }
        std::fs::remove_dir_all(&old)?;
    }
    Ok(())
}

/// Returns every message that waits at the broker, with the name of its queue.
pub(super) async fn queued(folder: &Path) -> anyhow::Result<Vec<(String, Vec<u8>)>> {
    let file = folder.join("platform/broker.sqlite");
    if !file.exists() {
        return Ok(Vec::new());
    }
    let mut store = open(&file).await?;
    let sql = "SELECT q.name, m.body FROM messages m JOIN queues q ON q.id = m.queue_id";
    let rows = match sqlx::query(sql).fetch_all(&mut store).await {
        Ok(rows) => rows,
        // A broker killed in its first instant has no tables yet.
        Err(sqlx::Error::Database(error)) if error.message().contains("no such table") => {
            Vec::new()
        }
        Err(error) => return Err(error.into()),
    };
    store.close().await?;
    Ok(rows.iter().map(|row| (row.get("name"), row.get("body"))).collect())
}

/// Doubles every message that waits at the broker.
pub(super) async fn double_queued(folder: &Path) -> anyhow::Result<()> {
    let file = folder.join("platform/broker.sqlite");
    if !file.exists() {
        return Ok(());
    }
    let mut store = open(&file).await?;
    // A broker killed in its first instant has no tables yet.
    let tables = sqlx::query("SELECT 1 FROM sqlite_schema WHERE name = 'messages'")
        .fetch_optional(&mut store)
        .await?;
    if tables.is_some() {
        sqlx::query(
            "INSERT INTO messages (queue_id, bytes, expires_at_ms, delivery_count, body) \
             SELECT queue_id, bytes, expires_at_ms, delivery_count, body FROM messages ORDER BY id",
        )
        .execute(&mut store)
        .await?;
    }
    Ok(store.close().await?)
}

/// Returns everything that ever left a connector.
pub(super) async fn left(
    folder: &Path,
    factory: &str,
) -> anyhow::Result<BTreeMap<ReportKey, Left>> {
    let mut store = open(&connector_store(folder, factory)).await?;
    let rows = sqlx::query(
        "SELECT id, writer_id, epoch, sequence, state, recipients, body FROM report ORDER BY id",
    )
    .fetch_all(&mut store)
    .await?;
    // Now and not some time later: the last one who closes a store removes its log, and another store may lie there by then.
    store.close().await?;
    rows.iter()
        .map(|row| {
            let key = ReportKey {
                factory: factory.to_owned(),
                writer: row.get("writer_id"),
                epoch: row.get("epoch"),
                sequence: row.get("sequence"),
            };
            let readers: Vec<String> = serde_json::from_str(row.get("recipients"))?;
            let body: Value = serde_json::from_str(row.get("body"))
                .with_context(|| format!("the body of {key:?}"))?;
            let left = Left {
                id: row.get("id"),
                state: row.get("state"),
                recipients: readers.len(),
                content: Content::of_message(&body, readers.into_iter().collect())
                    .with_context(|| format!("the body of {key:?}"))?,
            };
            Ok((key, left))
        })
        .collect()
}

/// Returns the number of reports in all chains of a connector's ledger.
pub(super) async fn ledger_entries(folder: &Path, factory: &str) -> anyhow::Result<usize> {
    let mut store = open(&connector_store(folder, factory)).await?;
    let row =
        sqlx::query("SELECT count(*) AS entries FROM ledger_entry WHERE report_id IS NOT NULL")
            .fetch_one(&mut store)
            .await?;
    Ok(usize::try_from(row.get::<i64, _>("entries"))?)
}

/// Returns the reports of a factory that the platform stored, in the order of arrival.
pub(super) async fn arrived(
    folder: &Path,
    factory: &str,
) -> anyhow::Result<Vec<(ReportKey, Arrived)>> {
    let mut store = open(&platform_store(folder)).await?;
    let rows = sqlx::query(
        "SELECT data_set_writer_id, epoch, sequence, is_replay, fields, shopfloor_timestamp, \
         report_timestamp, dynamic_data_request_id, report_name, \
         (SELECT json_group_array(m.organisation_id) FROM recipient_set_member m \
          WHERE m.recipient_set_id = report.recipient_set_id) AS readers \
         FROM report WHERE factory_id = ? ORDER BY report_id",
    )
    .bind(factory)
    .fetch_all(&mut store)
    .await?;
    let units = units::of_requests(&mut store, factory).await?;
    rows.iter()
        .map(|row| {
            let key = ReportKey {
                factory: factory.to_owned(),
                writer: row.get("data_set_writer_id"),
                epoch: row.get("epoch"),
                sequence: row.get("sequence"),
            };
            let readers: BTreeSet<String> = serde_json::from_str(row.get("readers"))?;
            let request: String = row.get("dynamic_data_request_id");
            let fields = shown_fields(&serde_json::from_str(row.get("fields"))?)?;
            let content = Content {
                units: units.of(&request, fields.keys()),
                request,
                report_name: row.get("report_name"),
                readers,
                report_time: row.get("report_timestamp"),
                shopfloor_time: row.get("shopfloor_timestamp"),
                fields,
            };
            Ok((key, Arrived { is_replay: row.get::<i64, _>("is_replay") != 0, content }))
        })
        .collect()
}

/// Returns which of a factory's newest reports the platform has stored, as many as can be on their way.
pub(super) async fn held(folder: &Path, factory: &str) -> anyhow::Result<Vec<ReportKey>> {
    const NEWEST: i64 = 20_000;
    let mut store = open(&platform_store(folder)).await?;
    let rows = sqlx::query(
        "SELECT data_set_writer_id, epoch, sequence FROM report WHERE factory_id = ? \
         ORDER BY report_id DESC LIMIT ?",
    )
    .bind(factory)
    .bind(NEWEST)
    .fetch_all(&mut store)
    .await?;
    let key = |row: &SqliteRow| ReportKey {
        factory: factory.to_owned(),
        writer: row.get("data_set_writer_id"),
        epoch: row.get("epoch"),
        sequence: row.get("sequence"),
    };
    Ok(rows.iter().map(key).collect())
}

/// Returns the comments from and to a factory: those in its connector's store, and those in the
/// platform's.
pub(super) async fn comments(
    folder: &Path,
    factory: &str,
) -> anyhow::Result<(Vec<Comment>, Vec<Comment>)> {
    let comment = |row: &SqliteRow| Comment {
        factory: factory.to_owned(),
        is_from_factory: row.get::<i64, _>("is_from_factory") != 0,
        text: row.get("text"),
    };
    let mut store = open(&connector_store(folder, factory)).await?;
    let here = sqlx::query("SELECT is_own AS is_from_factory, text FROM comment")
        .fetch_all(&mut store)
        .await?;
    let mut store = open(&platform_store(folder)).await?;
    let there = sqlx::query("SELECT is_from_factory, text FROM comment WHERE factory_id = ?")
        .bind(factory)
        .fetch_all(&mut store)
        .await?;
    Ok((here.iter().map(comment).collect(), there.iter().map(comment).collect()))
}

/// Number of repeats that the platform has discarded, and of messages that it or a connector could not use.
pub(super) async fn repeats_and_dead_letters(folder: &Path) -> anyhow::Result<(u64, u64)> {
    let mut store = open(&platform_store(folder)).await?;
    let repeats = sqlx::query("SELECT coalesce(sum(duplicates), 0) AS count FROM data_set_writer")
        .fetch_one(&mut store)
        .await?;
    let mut letters = 0;
    for file in
        [platform_store(folder), connector_store(folder, MUNICH), connector_store(folder, HAMBURG)]
    {
        let mut store = open(&file).await?;
        // An answer about the lease has a life: none reads it while its connector is down.
        let sql = "SELECT count(*) AS count FROM dead_letter WHERE code <> 'EXPIRED' OR subject <> 'lease'";
        letters += sqlx::query(sql).fetch_one(&mut store).await?.get::<i64, _>("count");
    }
    Ok((u64::try_from(repeats.get::<i64, _>("count"))?, u64::try_from(letters)?))
}
