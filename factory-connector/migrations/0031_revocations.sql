-- When the platform said that it holds a report, and in which message it left last.
ALTER TABLE report ADD COLUMN receipted_at INTEGER;
ALTER TABLE report ADD COLUMN message_id TEXT;
-- Reports that were taken back, for the case that the link had let one go at the same moment.
CREATE INDEX report_taken_back ON report (message) WHERE state = 'DONE' AND sent_at IS NULL;

-- Receipts of ended consents: signed statements of the last sequence numbers that were delivered.
CREATE TABLE revocation (
    revocation_id TEXT PRIMARY KEY,
    revoked_at INTEGER NOT NULL,
    -- The signed text, JSON.
    content TEXT NOT NULL,
    signature BLOB NOT NULL,
    public_key BLOB NOT NULL
) STRICT, WITHOUT ROWID;
CREATE INDEX revocation_by_time ON revocation (revoked_at, revocation_id);
