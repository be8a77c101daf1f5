-- What people entered at the operator's page, in their own time. The id is made by the page, so that an entry that was
-- delivered twice has one effect.
CREATE TABLE operator_entry (
    operation_network_id TEXT NOT NULL,
    operation_id TEXT NOT NULL,
    entry_id TEXT NOT NULL,
    made_at INTEGER NOT NULL,
    received_at INTEGER NOT NULL,
    made_by TEXT NOT NULL,
    -- What was entered, as JSON.
    action TEXT NOT NULL,
    PRIMARY KEY (operation_network_id, operation_id, entry_id)
) STRICT, WITHOUT ROWID;
