//! Ends of the chains: signed with every entry, so that not even the newest can be cut off
//! unnoticed.

use std::collections::HashMap;

use asi_model::OrganisationId;
use ledger::{Head, Heads, SignedHead};
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use crate::store::{
    error::StoreError,
    query::{all, query},
    row::{Columns as _, signed},
    statement::write_rows,
};

const READ: &str = "read the ends of the ledger";

/// Lists the recipients that have a chain, by their ids.
pub(super) async fn recipients(
    connection: &mut SqliteConnection,
) -> Result<Vec<String>, StoreError> {
    let query = query("SELECT recipient FROM ledger_head ORDER BY recipient");
    all(connection, query, READ, |row| row.column("recipient")).await
}

/// Reads the ends of the chains as signed; as found where none is signed yet, as after an update
/// from a version without signatures.
pub(super) async fn load(connection: &mut SqliteConnection) -> Result<Heads, StoreError> {
    // The recursion jumps from recipient to recipient by the primary key: a GROUP BY would read
    // every entry.
    let sql = "WITH RECURSIVE chain (recipient) AS (
                   SELECT min(recipient) FROM ledger_entry
                   UNION ALL
                   SELECT (SELECT min(recipient) FROM ledger_entry
                           WHERE recipient > chain.recipient)
                   FROM chain WHERE chain.recipient IS NOT NULL)
               SELECT e.recipient, e.number, e.hash
               FROM chain JOIN ledger_entry e ON e.recipient = chain.recipient
                   AND e.number = (SELECT max(number) FROM ledger_entry
                                   WHERE recipient = chain.recipient)";
    let found = all(connection, query(sql), READ, head).await?;
    let sql = "SELECT recipient, number, hash FROM ledger_head";
    let signed = all(connection, query(sql), READ, head).await?;
    let known: HashMap<OrganisationId, Head> = found.iter().cloned().collect();
    for (recipient, head) in &signed {
        if known.get(recipient).is_some_and(|found| found != head) {
            tracing::error!(
                %recipient,
                "The ledger does not end as was signed; run `factory-connector ledger verify`."
            );
        }
    }
    Ok(Heads::new(found.into_iter().chain(signed)))
}

fn head(row: &SqliteRow) -> Result<(OrganisationId, Head), StoreError> {
    let hash = row
        .column::<Vec<u8>>("hash")?
        .try_into()
        .map_err(|_| "a hash has 32 bytes")
        .map_err(StoreError::unreadable("hash"))?;
    Ok((row.parsed("recipient")?, Head { number: row.number("number")?, hash }))
}

/// Stores the signed ends of chains that grew.
pub(in crate::store) fn write(
    connection: &Connection,
    heads: &[SignedHead],
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO ledger_head (recipient, number, hash, signature, public_key)
         VALUES (?, ?, ?, ?, ?)
         ON CONFLICT (recipient) DO UPDATE SET
             number = excluded.number, hash = excluded.hash, signature = excluded.signature,
             public_key = excluded.public_key",
        heads,
        |head| {
            let number = signed(head.number);
            (head.recipient.as_str(), number, &head.hash, &head.signature, &head.public_key)
        },
    )
}
