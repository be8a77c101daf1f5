-- What ledger entries are about, taken from their hashed text: it can be looked up and cannot differ from the text.
ALTER TABLE ledger_entry ADD COLUMN event ANY AS (CASE WHEN json_valid(content) THEN content ->> '$.event' END);
ALTER TABLE ledger_entry ADD COLUMN operation_network_id ANY
    AS (CASE WHEN json_valid(content) THEN content ->> '$.field.operationNetworkId' END);
ALTER TABLE ledger_entry ADD COLUMN operation_id ANY
    AS (CASE WHEN json_valid(content) THEN content ->> '$.field.operationId' END);
ALTER TABLE ledger_entry ADD COLUMN dynamic_data_request_id ANY
    AS (CASE WHEN json_valid(content) THEN content ->> '$.field.dynamicDataRequestId' END);
ALTER TABLE ledger_entry ADD COLUMN field_name ANY
    AS (CASE WHEN json_valid(content) THEN content ->> '$.field.fieldName' END);
ALTER TABLE ledger_entry ADD COLUMN writer_id ANY
    AS (CASE WHEN json_valid(content) THEN content ->> '$.dataSetWriterId' END);
ALTER TABLE ledger_entry ADD COLUMN epoch ANY AS (CASE WHEN json_valid(content) THEN content ->> '$.epoch' END);
ALTER TABLE ledger_entry ADD COLUMN last_sequence ANY
    AS (CASE WHEN json_valid(content) THEN content ->> '$.lastSequence' END);
CREATE INDEX ledger_by_kind ON ledger_entry (recipient, event, number, recorded_at);
CREATE INDEX ledger_by_field ON ledger_entry
    (recipient, operation_network_id, operation_id, dynamic_data_request_id, field_name, number, recorded_at)
    WHERE operation_network_id IS NOT NULL;
CREATE INDEX ledger_by_writer ON ledger_entry (recipient, writer_id, epoch, event, number, recorded_at, last_sequence)
    WHERE writer_id IS NOT NULL;

-- Entries about reports name the writer only, whose id is given to another request one day: the fields that each writer
-- carried in each epoch, from which sequence number on.
CREATE TABLE carried_field (
    operation_network_id TEXT NOT NULL,
    operation_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    field_name TEXT NOT NULL,
    writer_id INTEGER NOT NULL,
    epoch INTEGER NOT NULL,
    first_sequence INTEGER NOT NULL,
    PRIMARY KEY (operation_network_id, operation_id, dynamic_data_request_id, field_name, writer_id, epoch)
) STRICT, WITHOUT ROWID;
-- Of what was queued before, only the present epochs are known to belong to the writers' present requests.
INSERT INTO carried_field
SELECT w.operation_network_id, w.operation_id, w.dynamic_data_request_id, carried.key, w.id, w.epoch, min(e.last_sequence)
FROM ledger_entry e CROSS JOIN writer w ON w.id = e.writer_id AND w.epoch = e.epoch
    CROSS JOIN json_each(e.content, '$.consents') AS carried
WHERE e.event = 'QUEUED' GROUP BY w.id, carried.key;
