//! Everything that the entries of the chains are checked against: anchors, signed statements, ends
//! and consents.

use std::collections::HashMap;

use ledger::{StoredConsent, StoredHead, StoredLog, StoredSeal, StoredStatement, Surroundings};
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::trusted::Trusted;
use crate::store::{
    error::StoreError,
    previews,
    query::{all, optional, query},
    row::Columns as _,
};

const READ: &str = "read the ledger's signed statements";
const ANCHORS: &str = "SELECT CAST(recipient AS BLOB) AS name, recorded_at,
                           CAST(content AS BLOB) AS content, signature, public_key
                       FROM ledger_anchor ORDER BY recipient";
const CHECKPOINTS: &str = "SELECT CAST(CAST(number AS TEXT) AS BLOB) AS name, recorded_at,
                               CAST(content AS BLOB) AS content, signature, public_key
                           FROM ledger_checkpoint ORDER BY number";
const SEAL: &str = "SELECT number, signature, public_key FROM ledger_seal";
const REVOCATIONS: &str = "SELECT CAST(revocation_id AS BLOB) AS name, revoked_at AS recorded_at,
                               CAST(content AS BLOB) AS content, signature, public_key
                           FROM revocation ORDER BY revocation_id";
const HEADS: &str =
    "SELECT CAST(recipient AS BLOB) AS recipient, number, hash, signature, public_key
                     FROM ledger_head ORDER BY ledger_head.recipient";
const LOGS: &str =
    "SELECT CAST(recipient AS BLOB) AS recipient, CAST(start AS BLOB) AS start, size, root,
                        leaves, CAST(checkpoint AS BLOB) AS checkpoint
                    FROM ledger_log ORDER BY ledger_log.recipient";
const CONSENTS: &str = "SELECT CAST(field AS BLOB) AS field, version,
                            CAST(mapping_state AS BLOB) AS mapping_state,
                            CAST(value_source AS BLOB) AS value_source,
                            CAST(policy AS BLOB) AS policy, CAST(grounds AS BLOB) AS basis,
                            CAST(decided_by AS BLOB) AS decided_by, decided_at
                        FROM consent";

pub(super) async fn surroundings(
    connection: &mut SqliteConnection,
    Trusted { key, checkpoints }: Trusted,
) -> Result<Surroundings, StoreError> {
    let identity = query("SELECT factory_id FROM identity");
    let factory = optional(connection, identity, READ, |row| row.column("factory_id")).await?;
    Ok(Surroundings {
        factory_id: factory.unwrap_or_default(),
        trusted_key: key,
        anchors: all(connection, query(ANCHORS), READ, statement).await?,
        checkpoints: all(connection, query(CHECKPOINTS), READ, statement).await?,
        seal: optional(connection, query(SEAL), READ, seal).await?,
        revocations: all(connection, query(REVOCATIONS), READ, statement).await?,
        heads: all(connection, query(HEADS), READ, head).await?,
        logs: all(connection, query(LOGS), READ, log).await?,
        kept_checkpoints: checkpoints,
        consents: consents(connection).await?,
        previews: previews::intact(connection).await?,
    })
}

async fn consents(
    connection: &mut SqliteConnection,
) -> Result<HashMap<(String, u32), StoredConsent>, StoreError> {
    let found = all(connection, query(CONSENTS), READ, |row| {
        // A damaged number names no consent: the entry that refers to it is the finding.
        let version = u32::try_from(row.column::<i64>("version")?).unwrap_or_default();
        let consent = StoredConsent {
            mapping_state: text(row, "mapping_state")?,
            value_source: optional_text(row, "value_source")?,
            policy: text(row, "policy")?,
            decided_by: optional_text(row, "decided_by")?,
            decided_at: row.column("decided_at")?,
            basis: optional_text(row, "basis")?,
        };
        Ok(((text(row, "field")?, version), consent))
    });
    Ok(found.await?.into_iter().collect())
}

fn statement(row: &SqliteRow) -> Result<StoredStatement, StoreError> {
    Ok(StoredStatement {
        name: text(row, "name")?,
        recorded_at: row.column("recorded_at")?,
        content: row.column("content")?,
        signature: row.column("signature")?,
        public_key: row.column("public_key")?,
    })
}

fn head(row: &SqliteRow) -> Result<StoredHead, StoreError> {
    Ok(StoredHead {
        recipient: text(row, "recipient")?,
        number: row.column("number")?,
        hash: row.column("hash")?,
        signature: row.column("signature")?,
        public_key: row.column("public_key")?,
    })
}

fn seal(row: &SqliteRow) -> Result<StoredSeal, StoreError> {
    Ok(StoredSeal {
        number: row.column("number")?,
        signature: row.column("signature")?,
        public_key: row.column("public_key")?,
    })
}

fn log(row: &SqliteRow) -> Result<StoredLog, StoreError> {
    Ok(StoredLog {
        recipient: text(row, "recipient")?,
        start: text(row, "start")?,
        size: row.column("size")?,
        root: row.column("root")?,
        leaves: row.column("leaves")?,
        checkpoint: text(row, "checkpoint")?,
    })
}

fn text(row: &SqliteRow, column: &'static str) -> Result<String, StoreError> {
    Ok(String::from_utf8_lossy(&row.column::<Vec<u8>>(column)?).into_owned())
}

fn optional_text(row: &SqliteRow, column: &'static str) -> Result<Option<String>, StoreError> {
    let bytes: Option<Vec<u8>> = row.column(column)?;
    Ok(bytes.map(|bytes| String::from_utf8_lossy(&bytes).into_owned()))
}
