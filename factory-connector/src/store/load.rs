//! Reading everything back: first start, restart and recovery from a failed transaction take this
//! one way.

use std::collections::HashMap;

use asi_model::{
    DateTime, FieldKey, FieldName, OperationNetworkId, OrganisationId, RequestKey,
    messages::{MappingState, OperationNetworkMessage, ValueSource},
};
use futures::TryStreamExt as _;
use serde::de::DeserializeOwned;
use sqlx::{Row, SqliteConnection, sqlite::SqliteRow};

use super::{
    FieldRow, FieldValueRow, MappingShelf, SourceRow, Store, StoreError, WriterRow, policies,
};
use crate::{books::RecipientPolicy, operator::OperatorEntry};
use disclosure::{NamedPolicy, Rule, Versioned};
use ledger::{Head, Heads};

/// A stored network.
#[derive(Debug, Clone)]
pub struct StoredNetwork {
    /// Its id.
    pub operation_network_id: OperationNetworkId,
    /// Its revision.
    pub revision: u64,
    /// As received; `None` once withdrawn.
    pub message: Option<OperationNetworkMessage>,
    /// When.
    pub received_at: DateTime,
}

/// Everything that the desk keeps in memory.
#[derive(Debug, Default)]
pub struct Snapshot {
    /// All networks, withdrawn ones included.
    pub networks: Vec<StoredNetwork>,
    /// All fields with where their values stand.
    pub fields: Vec<(FieldRow, Option<FieldValueRow>)>,
    /// All writers.
    pub writers: Vec<(u16, WriterRow)>,
    /// The heads of the ledger's chains.
    pub heads: Heads,
    /// The number of the last checkpoint and when it was made.
    pub last_checkpoint: Option<(u64, DateTime)>,
    /// The greatest number ever given in the spool.
    pub last_row: i64,
    /// What people entered about operations.
    pub operator_entries: Vec<OperatorEntry>,
    /// The sources.
    pub sources: Vec<SourceRow>,
    /// Versions and shadows of mappings.
    pub mappings: MappingShelf,
    /// Named policies in their newest version.
    pub policies: Vec<Versioned<NamedPolicy>>,
    /// Standing rules in their newest version.
    pub rules: Vec<Versioned<Rule>>,
    /// The policies set for recipients.
    pub recipient_policies: Vec<(OrganisationId, RecipientPolicy)>,
    /// The greatest number ever given to a decision of rules.
    pub last_rule_decision: i64,
}

impl Store {
    /// Reads everything that the desk keeps in memory.
    ///
    /// # Errors
    /// [`StoreError`] where a table or a document cannot be read.
    pub async fn load(&mut self) -> Result<Snapshot, StoreError> {
        let connection = &mut self.reader;
        Ok(Snapshot {
            networks: all(
                connection,
                "SELECT operation_network_id, revision, message, received_at FROM network",
                network,
            )
            .await?,
            fields: all(
                connection,
                "SELECT f.id, f.operation_network_id, f.operation_id, f.dynamic_data_request_id, f.field_name, \
                 f.mapping_state, f.value_source, f.reason, f.decided_by, f.decided_at, f.mapping, f.policy, \
                 f.consent_version, f.grounds, v.gate, v.transform FROM field f LEFT JOIN field_value v ON v.field_id = f.id",
                field,
            )
            .await?,
            writers: all(
                connection,
                "SELECT id, operation_network_id, operation_id, dynamic_data_request_id, epoch, minor_version, \
                 next_sequence, field_list, retired_at FROM writer",
                writer,
            )
            .await?,
            heads: heads(connection).await?,
            last_checkpoint: all(
                connection,
                "SELECT number, recorded_at FROM ledger_checkpoint ORDER BY number DESC LIMIT 1",
                |row| Ok((unsigned(get(row, 0)?), DateTime::from_unix_micros(get(row, 1)?))),
            )
            .await?
            .pop(),
            last_row: last_row(connection).await?,
            operator_entries: all(connection, super::operator::LOAD, super::operator::entry).await?,
            sources: all(connection, "SELECT source_id, config, password FROM source", |row| {
                Ok(SourceRow { source_id: get(row, 0)?, config: get(row, 1)?, password: get(row, 2)? })
            })
            .await?,
            mappings: super::mappings::load(connection).await?,
            policies: policies::newest_policies(connection).await?,
            rules: policies::newest_rules(connection).await?,
            recipient_policies: policies::newest_recipient_policies(connection).await?,
            last_rule_decision: policies::last_rule_decision(connection).await?,
        })
    }
}

/// The ends of the chains as signed; as found where none is signed yet, as after an update from a
/// version without.
async fn heads(connection: &mut SqliteConnection) -> Result<Heads, StoreError> {
    let found = all(
        connection,
        "WITH RECURSIVE chain (recipient) AS (SELECT min(recipient) FROM ledger_entry UNION ALL \
         SELECT (SELECT min(recipient) FROM ledger_entry WHERE recipient > chain.recipient) FROM chain \
         WHERE chain.recipient IS NOT NULL) \
         SELECT e.recipient, e.number, e.hash FROM chain JOIN ledger_entry e ON e.recipient = chain.recipient \
         AND e.number = (SELECT max(number) FROM ledger_entry WHERE recipient = chain.recipient)",
        head,
    )
    .await?;
    let signed = all(connection, "SELECT recipient, number, hash FROM ledger_head", head).await?;
    let known: HashMap<OrganisationId, Head> = found.iter().cloned().collect();
    for (recipient, head) in &signed {
        if known.get(recipient).is_some_and(|found| found != head) {
            tracing::error!(%recipient, "The ledger does not end as was signed; run `factory-connector ledger verify`.");
        }
    }
    Ok(Heads::new(found.into_iter().chain(signed)))
}

fn head(row: &SqliteRow) -> Result<(OrganisationId, Head), StoreError> {
    let hash: Vec<u8> = get(row, 2)?;
    let hash = hash
        .try_into()
        .map_err(|_| "a hash has 32 bytes")
        .map_err(StoreError::unreadable("ledger entry"))?;
    Ok((id::<OrganisationId>(row, 0)?, Head { number: unsigned(get(row, 1)?), hash }))
}

/// The greatest number of control messages and reports. Those of deleted control messages may come
/// again after a start, when nothing of them is under way any more.
async fn last_row(connection: &mut SqliteConnection) -> Result<i64, StoreError> {
    let rows = all(
        connection,
        "SELECT max(coalesce((SELECT max(id) FROM report), 0), coalesce((SELECT max(id) FROM control), 0))",
        |row| get::<i64>(row, 0),
    )
    .await?;
    Ok(rows.into_iter().next().unwrap_or(0))
}

/// All rows of a query.
pub(super) async fn all<T>(
    connection: &mut SqliteConnection,
    sql: &'static str,
    read: impl Fn(&SqliteRow) -> Result<T, StoreError>,
) -> Result<Vec<T>, StoreError> {
    // One after the other: all rows of a large table together would take more memory than what is
    // made of them.
    let mut rows = sqlx::query(sql).fetch(connection);
    let mut found = Vec::new();
    while let Some(row) =
        rows.try_next().await.map_err(StoreError::while_doing("read the store's tables"))?
    {
        found.push(read(&row)?);
    }
    Ok(found)
}

/// A column.
pub(super) fn get<'r, T>(row: &'r SqliteRow, column: usize) -> Result<T, StoreError>
where
    T: sqlx::Decode<'r, sqlx::Sqlite> + sqlx::Type<sqlx::Sqlite>,
{
    row.try_get(column).map_err(StoreError::while_doing("read a column"))
}

/// A column with an identifier.
pub(super) fn id<T: std::str::FromStr<Err: std::fmt::Display>>(
    row: &SqliteRow,
    column: usize,
) -> Result<T, StoreError> {
    get::<String>(row, column)?.parse().map_err(StoreError::unreadable("identifier"))
}

/// A column with a JSON document.
pub(super) fn json<T: DeserializeOwned>(text: &str, what: &'static str) -> Result<T, StoreError> {
    serde_json::from_str(text).map_err(StoreError::unreadable(what))
}

pub(super) fn unsigned<T: TryFrom<i64> + Default>(number: i64) -> T {
    T::try_from(number).unwrap_or_default()
}

pub(super) fn time(micros: Option<i64>) -> Option<DateTime> {
    micros.map(DateTime::from_unix_micros)
}

fn network(row: &SqliteRow) -> Result<StoredNetwork, StoreError> {
    let message: Option<String> = get(row, 2)?;
    Ok(StoredNetwork {
        operation_network_id: id(row, 0)?,
        revision: unsigned(get(row, 1)?),
        message: message.map(|text| json(&text, "network")).transpose()?,
        received_at: DateTime::from_unix_micros(get(row, 3)?),
    })
}

pub(super) fn request_key(row: &SqliteRow, from: usize) -> Result<RequestKey, StoreError> {
    Ok(RequestKey {
        operation_network_id: id(row, from)?,
        operation_id: id(row, from + 1)?,
        dynamic_data_request_id: id(row, from + 2)?,
    })
}

fn field(row: &SqliteRow) -> Result<(FieldRow, Option<FieldValueRow>), StoreError> {
    let state: String = get(row, 5)?;
    let source: Option<String> = get(row, 6)?;
    let gate: Option<String> = get(row, 14)?;
    let transform = get(row, 15)?;
    let field = FieldRow {
        id: get(row, 0)?,
        key: FieldKey { request: request_key(row, 1)?, field_name: id::<FieldName>(row, 4)? },
        mapping_state: name::<MappingState>(&state)?,
        value_source: source.as_deref().map(name::<ValueSource>).transpose()?,
        reason: get(row, 7)?,
        decided_by: get(row, 8)?,
        decided_at: time(get(row, 9)?),
        mapping: get(row, 10)?,
        policy: get(row, 11)?,
        consent_version: unsigned(get(row, 12)?),
        grounds: get(row, 13)?,
    };
    Ok((field, gate.map(|gate| FieldValueRow { gate, transform })))
}

/// A name of the wire contract.
fn name<T: DeserializeOwned>(text: &str) -> Result<T, StoreError> {
    serde_json::from_value(serde_json::Value::from(text))
        .map_err(StoreError::unreadable("decision"))
}

fn writer(row: &SqliteRow) -> Result<(u16, WriterRow), StoreError> {
    let fields: String = get(row, 7)?;
    let writer = WriterRow {
        request: request_key(row, 1)?,
        epoch: unsigned(get(row, 4)?),
        minor_version: unsigned(get(row, 5)?),
        next_sequence: unsigned(get(row, 6)?),
        fields: json(&fields, "writer")?,
        retired_at: time(get(row, 8)?),
    };
    Ok((unsigned(get(row, 0)?), writer))
}
