-- Who may read what is settled with each report, and stored with it. Each set of organisations is stored once; a report
-- without one is for nobody, but for those of before (former_report_recipients).
CREATE TABLE recipient_set (
    recipient_set_id INTEGER PRIMARY KEY AUTOINCREMENT,
    -- The ids of its members in ascending order, as a JSON list.
    members TEXT NOT NULL UNIQUE
) STRICT;

CREATE TABLE recipient_set_member (
    recipient_set_id INTEGER NOT NULL REFERENCES recipient_set (recipient_set_id),
    organisation_id TEXT NOT NULL,
    PRIMARY KEY (recipient_set_id, organisation_id)
) STRICT, WITHOUT ROWID;

ALTER TABLE report ADD COLUMN recipient_set_id INTEGER REFERENCES recipient_set (recipient_set_id);
ALTER TABLE field_value ADD COLUMN recipient_set_id INTEGER REFERENCES recipient_set (recipient_set_id);

-- Time of the first consent of the factory under which the organisation was a recipient; null before it. Reports of
-- connectors that do not name their recipients are for those whose consent is older than the report.
ALTER TABLE request_recipient ADD COLUMN consented_at INTEGER;
UPDATE request_recipient SET consented_at = (
    SELECT MIN(f.decided_at) FROM request_field f
    JOIN network_part p ON p.operation_network_id = f.operation_network_id AND p.factory_id = f.factory_id
    WHERE f.operation_network_id = request_recipient.operation_network_id
      AND f.dynamic_data_request_id = request_recipient.dynamic_data_request_id
      AND f.mapping_state = 'MAPPED' AND p.state IN ('ACCEPTED', 'UNCHANGED'));

-- Which factory is asked, or was ever asked, for which request of which operation. A factory writes under no other.
CREATE TABLE asked_request (
    operation_network_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    factory_id TEXT NOT NULL,
    operation_id TEXT NOT NULL,
    PRIMARY KEY (operation_network_id, dynamic_data_request_id, factory_id, operation_id)
) STRICT, WITHOUT ROWID;
INSERT OR IGNORE INTO asked_request (operation_network_id, dynamic_data_request_id, factory_id, operation_id)
SELECT n.operation_network_id, json_extract(r.value, '$.dynamicDataRequestId'),
    json_extract(o.value, '$.owningFactoryId'), json_extract(o.value, '$.operationId')
FROM operation_network_revision n, json_each(n.document, '$.operationList') o,
    json_each(o.value, '$.dynamicDataRequestList') r
WHERE json_extract(o.value, '$.owningFactoryId') IS NOT NULL;
INSERT OR IGNORE INTO asked_request (operation_network_id, dynamic_data_request_id, factory_id, operation_id)
SELECT operation_network_id, dynamic_data_request_id, factory_id, operation_id FROM request_field;

-- What is stored already is for the recipients in effect, as it was until now; but for reports of factories that were
-- never asked. The reports themselves are many and stay as they are: these rows say whose those are that have no set and
-- a number up to the last one of before.
CREATE TABLE former_report_recipients (
    operation_network_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    factory_id TEXT NOT NULL,
    last_report_id INTEGER NOT NULL,
    recipient_set_id INTEGER NOT NULL REFERENCES recipient_set (recipient_set_id),
    PRIMARY KEY (operation_network_id, dynamic_data_request_id, factory_id)
) STRICT, WITHOUT ROWID;
CREATE TABLE recipients_in_effect (
    operation_network_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    members TEXT NOT NULL,
    PRIMARY KEY (operation_network_id, dynamic_data_request_id)
) STRICT, WITHOUT ROWID;
INSERT INTO recipients_in_effect (operation_network_id, dynamic_data_request_id, members)
SELECT operation_network_id, dynamic_data_request_id, json_group_array(organisation_id ORDER BY organisation_id)
FROM request_recipient GROUP BY operation_network_id, dynamic_data_request_id;
INSERT INTO recipient_set (members) SELECT DISTINCT members FROM recipients_in_effect;
INSERT INTO recipient_set_member (recipient_set_id, organisation_id)
SELECT s.recipient_set_id, m.value FROM recipient_set s, json_each(s.members) m;
INSERT INTO former_report_recipients
    (operation_network_id, dynamic_data_request_id, factory_id, last_report_id, recipient_set_id)
SELECT DISTINCT a.operation_network_id, a.dynamic_data_request_id, a.factory_id,
    (SELECT COALESCE(MAX(report_id), 0) FROM report), s.recipient_set_id
FROM asked_request a
JOIN recipients_in_effect e ON e.operation_network_id = a.operation_network_id
    AND e.dynamic_data_request_id = a.dynamic_data_request_id
JOIN recipient_set s ON s.members = e.members;
UPDATE field_value SET recipient_set_id = (
    SELECT s.recipient_set_id FROM recipients_in_effect e JOIN recipient_set s ON s.members = e.members
    WHERE e.operation_network_id = field_value.operation_network_id
      AND e.dynamic_data_request_id = field_value.dynamic_data_request_id);
DROP TABLE recipients_in_effect;

-- Only open fields have a current value.
DELETE FROM field_value WHERE NOT EXISTS (
    SELECT 1 FROM request_field f WHERE f.operation_network_id = field_value.operation_network_id
      AND f.dynamic_data_request_id = field_value.dynamic_data_request_id
      AND f.field_name = field_value.field_name AND f.mapping_state = 'MAPPED');

-- To whom any report of a writer was released: who asks for a writer's numbers is found without its history.
CREATE TABLE writer_recipient_set (
    factory_id TEXT NOT NULL,
    data_set_writer_id INTEGER NOT NULL,
    epoch INTEGER NOT NULL,
    recipient_set_id INTEGER NOT NULL REFERENCES recipient_set (recipient_set_id),
    PRIMARY KEY (factory_id, data_set_writer_id, epoch, recipient_set_id)
) STRICT, WITHOUT ROWID;
INSERT INTO writer_recipient_set (factory_id, data_set_writer_id, epoch, recipient_set_id)
SELECT w.factory_id, w.data_set_writer_id, w.epoch, r.recipient_set_id FROM data_set_writer w
JOIN former_report_recipients r ON r.operation_network_id = w.operation_network_id
    AND r.dynamic_data_request_id = w.dynamic_data_request_id AND r.factory_id = w.factory_id
WHERE EXISTS (SELECT 1 FROM report p WHERE p.factory_id = w.factory_id
    AND p.data_set_writer_id = w.data_set_writer_id AND p.epoch = w.epoch);
