-- Retention states in the chains what it empties and removes. What former versions emptied and removed without a statement
-- is stated once, at the first start.
ALTER TABLE identity ADD COLUMN must_state_retention INTEGER NOT NULL DEFAULT 0;
UPDATE identity SET must_state_retention = 1;

-- The signed number of the checkpoints: not even the newest can be deleted unnoticed. One row.
CREATE TABLE ledger_seal (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    number INTEGER NOT NULL,
    signature BLOB NOT NULL,
    public_key BLOB NOT NULL
) STRICT;

-- Previews that decisions were made on. The ledger has a salted hash of each; they have values of machines and never leave.
CREATE TABLE preview (
    hash TEXT PRIMARY KEY,
    text TEXT NOT NULL,
    salt BLOB NOT NULL
) STRICT, WITHOUT ROWID;
