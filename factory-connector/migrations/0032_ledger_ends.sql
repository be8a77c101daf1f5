-- The signed end of each chain, written with every entry: not even the newest entries can be cut off unnoticed.
CREATE TABLE ledger_head (
    recipient TEXT PRIMARY KEY,
    number INTEGER NOT NULL,
    hash BLOB NOT NULL,
    signature BLOB NOT NULL,
    public_key BLOB NOT NULL
) STRICT, WITHOUT ROWID;

-- What stands in the place of entries that retention removed: their last number and hash, signed.
CREATE TABLE ledger_anchor (
    recipient TEXT PRIMARY KEY,
    recorded_at INTEGER NOT NULL,
    content TEXT NOT NULL,
    signature BLOB NOT NULL,
    public_key BLOB NOT NULL
) STRICT, WITHOUT ROWID;
CREATE INDEX ledger_by_report ON ledger_entry (report_id) WHERE report_id IS NOT NULL;
