//! Signed number of the checkpoints.

use ledger::CheckpointSeal;
use rusqlite::Connection;

use crate::store::{row::signed, statement::write_rows};

/// Stores the seal in place of the former one.
pub(in crate::store) fn write(
    connection: &Connection,
    seal: Option<&CheckpointSeal>,
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO ledger_seal (id, number, signature, public_key) VALUES (1, ?, ?, ?)
         ON CONFLICT (id) DO UPDATE SET number = excluded.number,
             signature = excluded.signature, public_key = excluded.public_key",
        seal,
        |seal| (signed(seal.number), &seal.signature, &seal.public_key),
    )
}
