-- What members see of a factory and of a network follows from what is theirs to know, and from nothing else.

-- Minute of the last sign of life that does not follow values: a renewal of the lease, or a status. Other members see
-- this one alone.
ALTER TABLE factory ADD COLUMN last_sign_at INTEGER;

-- What of a writer was released to a set of recipients: each of them sees these numbers and no others.
ALTER TABLE writer_recipient_set ADD COLUMN first_sequence INTEGER;
ALTER TABLE writer_recipient_set ADD COLUMN through_sequence INTEGER;
ALTER TABLE writer_recipient_set ADD COLUMN received INTEGER NOT NULL DEFAULT 0;
ALTER TABLE writer_recipient_set ADD COLUMN last_report_at INTEGER;
ALTER TABLE writer_recipient_set ADD COLUMN operation_network_id TEXT;
ALTER TABLE writer_recipient_set ADD COLUMN dynamic_data_request_id TEXT;
INSERT INTO writer_recipient_set (factory_id, data_set_writer_id, epoch, recipient_set_id, first_sequence,
    through_sequence, received, last_report_at, operation_network_id, dynamic_data_request_id)
SELECT p.factory_id, p.data_set_writer_id, p.epoch, COALESCE(p.recipient_set_id, r.recipient_set_id), MIN(p.sequence),
    MAX(p.sequence), COUNT(*), MAX(p.received_at), MAX(p.operation_network_id), MAX(p.dynamic_data_request_id)
FROM report p LEFT JOIN former_report_recipients r ON r.operation_network_id = p.operation_network_id
    AND r.dynamic_data_request_id = p.dynamic_data_request_id AND r.factory_id = p.factory_id
    AND p.report_id <= r.last_report_id
WHERE COALESCE(p.recipient_set_id, r.recipient_set_id) IS NOT NULL
GROUP BY 1, 2, 3, 4
ON CONFLICT (factory_id, data_set_writer_id, epoch, recipient_set_id) DO UPDATE SET
    first_sequence = excluded.first_sequence, through_sequence = excluded.through_sequence, received = excluded.received,
    last_report_at = excluded.last_report_at, operation_network_id = excluded.operation_network_id,
    dynamic_data_request_id = excluded.dynamic_data_request_id;

-- The organisations that any revision named as recipients of a request. A factory's receipts are for these alone.
CREATE TABLE named_recipient (
    operation_network_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    organisation_id TEXT NOT NULL,
    PRIMARY KEY (operation_network_id, dynamic_data_request_id, organisation_id)
) STRICT, WITHOUT ROWID;
INSERT OR IGNORE INTO named_recipient (operation_network_id, dynamic_data_request_id, organisation_id)
SELECT v.operation_network_id, json_extract(r.value, '$.dynamicDataRequestId'), c.value
FROM operation_network_revision v, json_each(v.document, '$.operationList') o,
    json_each(o.value, '$.dynamicDataRequestList') r, json_each(r.value, '$.recipientList') c;
INSERT OR IGNORE INTO named_recipient (operation_network_id, dynamic_data_request_id, organisation_id)
SELECT operation_network_id, dynamic_data_request_id, organisation_id FROM request_recipient;

-- The organisation of who made a revision; null for an administrator without one.
ALTER TABLE operation_network ADD COLUMN author_organisation TEXT;
UPDATE operation_network SET author_organisation = COALESCE(
    (SELECT u.organisation_id FROM user_account u WHERE u.user_name = operation_network.updated_by),
    (SELECT t.organisation_id FROM tool t WHERE 'tool.' || t.tool_id = operation_network.updated_by));

-- The last revision that changed what an organisation sees of a network.
CREATE TABLE seen_revision (
    operation_network_id TEXT NOT NULL REFERENCES operation_network (operation_network_id),
    organisation_id TEXT NOT NULL,
    revision INTEGER NOT NULL,
    updated_at INTEGER NOT NULL,
    updated_by TEXT NOT NULL,
    author_organisation TEXT,
    PRIMARY KEY (operation_network_id, organisation_id)
) STRICT, WITHOUT ROWID;
INSERT INTO seen_revision (operation_network_id, organisation_id, revision, updated_at, updated_by, author_organisation)
SELECT n.operation_network_id, v.organisation_id, n.revision, n.updated_at, n.updated_by, n.author_organisation
FROM operation_network n JOIN (
    SELECT operation_network_id, organisation_id FROM network_viewer
    UNION SELECT operation_network_id, drawn_by FROM operation_network WHERE drawn_by IS NOT NULL) v
    ON v.operation_network_id = n.operation_network_id;
