-- Decisions whether a recipient that was added later sees what had left for others before. What is shown stands in the
-- ledger, too.
CREATE TABLE past_decision (
    id INTEGER PRIMARY KEY,
    operation_network_id TEXT NOT NULL,
    operation_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    recipient TEXT NOT NULL,
    is_released INTEGER NOT NULL,
    -- The newest report that was decided about; later ones are asked about again.
    through_report INTEGER NOT NULL,
    report_count INTEGER NOT NULL,
    -- The root over the values of the reports that are shown, hexadecimal.
    root TEXT,
    reason TEXT,
    decided_by TEXT NOT NULL,
    decided_at INTEGER NOT NULL
) STRICT;
