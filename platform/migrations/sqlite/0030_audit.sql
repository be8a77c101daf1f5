-- Who changed what, and when: written in the transaction of the change. Names, ids and outcomes; never a value of a plant.
CREATE TABLE audit_entry (
    audit_entry_id INTEGER PRIMARY KEY AUTOINCREMENT,
    recorded_at INTEGER NOT NULL,
    agent_kind TEXT NOT NULL CHECK (agent_kind IN ('USER', 'TOOL', 'FACTORY', 'COMMAND')),
    agent_name TEXT NOT NULL,
    -- The organisation for which the agent acted; null for administrators without one.
    organisation_id TEXT,
    operation TEXT NOT NULL,
    subject TEXT NOT NULL,
    -- The organisation whose people, factory or tool the subject is; null for what is of several.
    concerned_id TEXT,
    outcome TEXT NOT NULL CHECK (outcome IN ('DONE', 'UNCHANGED'))
) STRICT;
CREATE INDEX audit_entry_by_organisation ON audit_entry (organisation_id, audit_entry_id);
CREATE INDEX audit_entry_by_concerned ON audit_entry (concerned_id, audit_entry_id);

-- Nobody changes an entry, and only the oldest are ever removed.
CREATE TRIGGER audit_entry_stays BEFORE UPDATE ON audit_entry
BEGIN SELECT RAISE(ABORT, 'entries of the audit are never changed'); END;
CREATE TRIGGER audit_entry_goes_last BEFORE DELETE ON audit_entry
WHEN EXISTS (SELECT 1 FROM audit_entry e WHERE e.audit_entry_id < OLD.audit_entry_id)
BEGIN SELECT RAISE(ABORT, 'only the oldest entries of the audit are removed'); END;
