-- What the platform has countersigned of the log of each chain, and whether it holds another history of it.
CREATE TABLE ledger_witness (
    recipient TEXT PRIMARY KEY,
    -- Name of the log that this is about; another one than that of ledger_log counts as nothing.
    origin TEXT NOT NULL,
    -- Number of leaves of the last countersigned checkpoint; 0 before the first.
    size INTEGER NOT NULL,
    -- The hashes of the largest perfect subtrees that cover them: enough to prove later checkpoints.
    leaves BLOB NOT NULL,
    -- That checkpoint, a C2SP signed note, with the key and the time of the witness; empty before the first.
    checkpoint TEXT NOT NULL,
    witness_key TEXT NOT NULL,
    cosigned_at INTEGER NOT NULL,
    -- The conflict that has not been settled, JSON.
    conflict TEXT
) STRICT, WITHOUT ROWID;
