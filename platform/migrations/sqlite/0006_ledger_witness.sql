-- The logs of factories' ledgers as far as the platform has countersigned them: one log per factory, recipient and epoch.
-- The newest checkpoint of each is enough: it was accepted only with a proof that it extends all former ones.
CREATE TABLE ledger_log (
    factory_id TEXT NOT NULL REFERENCES factory (factory_id),
    -- The organisation whose values the log is about.
    organisation_id TEXT NOT NULL REFERENCES organisation (organisation_id),
    -- Number of the log among those that replaced each other, from 1.
    epoch INTEGER NOT NULL,
    -- The key of the log (C2SP signed-note), as it came with its first checkpoint.
    verifier_key TEXT NOT NULL,
    -- The newest checkpoint, with the signatures of the log and of the platform, and its size and root.
    checkpoint TEXT NOT NULL,
    size INTEGER NOT NULL,
    root BLOB NOT NULL,
    cosigned_at INTEGER NOT NULL,
    -- The first checkpoint that came: what was before it is only as good as the factory's word.
    first_size INTEGER NOT NULL,
    first_seen_at INTEGER NOT NULL,
    -- The last checkpoint that was refused since it contradicts the newest one, or has another key: evidence.
    refused_checkpoint TEXT,
    refused_at INTEGER,
    PRIMARY KEY (factory_id, organisation_id, epoch)
) STRICT, WITHOUT ROWID;
