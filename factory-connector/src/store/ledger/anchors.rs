//! Anchors: signed statements in the place of entries that retention removed.

use std::collections::BTreeMap;

use asi_model::OrganisationId;
use ledger::Anchor;
use rusqlite::Connection;
use sqlx::SqliteConnection;

use crate::store::{
    AnchorRow,
    error::StoreError,
    query::{all, query},
    row::Columns as _,
    statement::run,
};

/// Reads the number of the last entry that each chain's anchor stands for.
pub(super) async fn numbers(
    connection: &mut SqliteConnection,
) -> Result<BTreeMap<OrganisationId, u64>, StoreError> {
    let query = query("SELECT content FROM ledger_anchor");
    let read = all(connection, query, "read the anchors", |row| row.document::<Anchor>("content"));
    Ok(read.await?.into_iter().map(|anchor| (anchor.recipient, anchor.number)).collect())
}

/// Stores an anchor in place of the chain's former one.
pub(super) fn write(connection: &Connection, anchor: &AnchorRow) -> rusqlite::Result<()> {
    run(
        connection,
        "INSERT INTO ledger_anchor (recipient, recorded_at, content, signature, public_key)
         VALUES (?, ?, ?, ?, ?)
         ON CONFLICT (recipient) DO UPDATE SET
             recorded_at = excluded.recorded_at, content = excluded.content,
             signature = excluded.signature, public_key = excluded.public_key",
        (
            anchor.recipient.as_str(),
            anchor.recorded_at.unix_micros(),
            &anchor.content,
            &anchor.signature,
            &anchor.public_key,
        ),
    )
    .map(drop)
}
