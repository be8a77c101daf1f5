//! Anchors: signed statements in the place of entries that retention removed.

use ledger::{Anchor, LedgerKey};
use rusqlite::Connection;

use crate::store::statement::run;

/// Signs an anchor and stores it in place of the chain's former one.
pub(super) fn write(
    connection: &Connection,
    anchor: &Anchor,
    key: &LedgerKey,
) -> rusqlite::Result<()> {
    let content = anchor.canonical();
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
            &content,
            key.sign(&content),
            key.public(),
        ),
    )
    .map(drop)
}
