//! Decisions, receipts of revocations and revisions of the network, as both sides have them.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use serde_json::Value;
use sqlx::{AssertSqlSafe, Row as _, sqlite::SqliteRow};

use super::{connector_store, open, platform_store};
use crate::scenario::load;

/// Field of a request.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::chaos) struct FieldId {
    pub request: String,
    pub field: String,
}

/// Decision about a field.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::chaos) struct Decided {
    pub state: String,
    pub reason: Option<String>,
    /// Time of the decision, in microseconds since 1970.
    pub at: Option<i64>,
}

/// Decisions, receipts and network of one side.
#[derive(Debug)]
pub(in crate::chaos) struct Side {
    pub decisions: BTreeMap<FieldId, Decided>,
    /// Ids of the receipts.
    pub revocations: BTreeSet<String>,
    /// Revision and description of the network's part.
    pub network: (i64, String),
}

/// State of a field that changes all the time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::chaos) enum Toggled {
    Closed,
    /// Its values are disclosed, with this rounding step or unchanged.
    Open(Option<f64>),
}

/// Both sides: connector and platform.
#[derive(Debug)]
pub(in crate::chaos) struct Controls {
    pub here: Side,
    pub there: Side,
    /// State of the toggled field, of which the connector alone has the policy.
    pub toggled: Toggled,
}

const DECISION: &str = "dynamic_data_request_id, field_name, mapping_state, reason, decided_at";
/// Ticks of 100 ns from 1601 to 1970.
const TICKS_TO_1970: i64 = 116_444_736_000_000_000;

/// Reads what both sides have about a factory.
pub(in crate::chaos) async fn controls(folder: &Path, factory: &str) -> anyhow::Result<Controls> {
    Ok(Controls {
        here: of_connector(folder, factory).await?,
        there: of_platform(folder, factory).await?,
        toggled: toggled(folder, factory).await?,
    })
}

async fn toggled(folder: &Path, factory: &str) -> anyhow::Result<Toggled> {
    let mut store = open(&connector_store(folder, factory)).await?;
    let sql = "SELECT mapping_state, policy FROM field \
               WHERE dynamic_data_request_id = ? AND field_name = ?";
    let row = sqlx::query(sql)
        .bind(load::toggled_request(factory))
        .bind(load::TOGGLED)
        .fetch_one(&mut store)
        .await?;
    let policy: Value = serde_json::from_str(row.get("policy"))?;
    let is_open = row.get::<&str, _>("mapping_state") == "MAPPED";
    Ok(if is_open { Toggled::Open(policy["roundingStep"].as_f64()) } else { Toggled::Closed })
}

fn decided(row: &SqliteRow, micros: impl Fn(i64) -> i64) -> (FieldId, Decided) {
    let field =
        FieldId { request: row.get("dynamic_data_request_id"), field: row.get("field_name") };
    let at = row.get::<Option<i64>, _>("decided_at").map(micros);
    (field, Decided { state: row.get("mapping_state"), reason: row.get("reason"), at })
}

fn description(document: &str) -> anyhow::Result<String> {
    let document: Value = serde_json::from_str(document)?;
    let network = document.get("operationNetwork").unwrap_or(&document);
    Ok(network["description"].as_str().unwrap_or_default().to_owned())
}

async fn of_connector(folder: &Path, factory: &str) -> anyhow::Result<Side> {
    let mut store = open(&connector_store(folder, factory)).await?;
    let sql = format!("SELECT {DECISION} FROM field");
    let rows = sqlx::query(AssertSqlSafe(sql)).fetch_all(&mut store).await?;
    let decisions = rows.iter().map(|row| decided(row, |micros| micros)).collect();
    let rows =
        sqlx::query("SELECT revocation_id AS id FROM revocation").fetch_all(&mut store).await?;
    let revocations = rows.iter().map(|row| row.get("id")).collect();
    let row = sqlx::query("SELECT revision, message FROM network").fetch_one(&mut store).await?;
    Ok(Side {
        decisions,
        revocations,
        network: (row.get("revision"), description(row.get("message"))?),
    })
}

async fn of_platform(folder: &Path, factory: &str) -> anyhow::Result<Side> {
    let mut store = open(&platform_store(folder)).await?;
    let sql = format!("SELECT {DECISION} FROM request_field WHERE factory_id = ?");
    let rows = sqlx::query(AssertSqlSafe(sql)).bind(factory).fetch_all(&mut store).await?;
    let decisions =
        rows.iter().map(|row| decided(row, |ticks| (ticks - TICKS_TO_1970) / 10)).collect();
    let rows = sqlx::query("SELECT signed_text FROM revocation WHERE factory_id = ?")
        .bind(factory)
        .fetch_all(&mut store)
        .await?;
    let mut revocations = BTreeSet::new();
    for row in rows {
        let text: Value = serde_json::from_str(row.get("signed_text"))?;
        revocations.insert(text["revocationId"].as_str().unwrap_or_default().to_owned());
    }
    let row = sqlx::query("SELECT revision, document FROM network_part WHERE factory_id = ?")
        .bind(factory)
        .fetch_one(&mut store)
        .await?;
    Ok(Side {
        decisions,
        revocations,
        network: (row.get("revision"), description(row.get("document"))?),
    })
}
