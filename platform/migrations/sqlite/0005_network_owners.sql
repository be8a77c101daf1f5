-- The organisation that drew a network: it belongs to it. Without one, only administrators own it.
ALTER TABLE operation_network ADD COLUMN drawn_by TEXT REFERENCES organisation (organisation_id);
UPDATE operation_network SET drawn_by = COALESCE(
    (SELECT u.organisation_id FROM operation_network_revision v JOIN user_account u ON u.user_name = v.created_by
     WHERE v.operation_network_id = operation_network.operation_network_id AND v.revision = 1),
    (SELECT u.organisation_id FROM user_account u WHERE u.user_name = operation_network.updated_by));

-- The organisation that added an operation, be it to its own factory or to another's.
CREATE TABLE operation_drawer (
    operation_network_id TEXT NOT NULL REFERENCES operation_network (operation_network_id),
    operation_id TEXT NOT NULL,
    organisation_id TEXT NOT NULL,
    PRIMARY KEY (operation_network_id, operation_id)
) STRICT, WITHOUT ROWID;

-- The first requester of each request id. Rows are never removed, so that no other organisation gets the id again.
CREATE TABLE request_requester (
    operation_network_id TEXT NOT NULL REFERENCES operation_network (operation_network_id),
    dynamic_data_request_id TEXT NOT NULL,
    requester_id TEXT NOT NULL,
    PRIMARY KEY (operation_network_id, dynamic_data_request_id)
) STRICT, WITHOUT ROWID;
INSERT INTO request_requester (operation_network_id, dynamic_data_request_id, requester_id)
SELECT v.operation_network_id, json_extract(r.value, '$.dynamicDataRequestId'), json_extract(r.value, '$.requesterId')
FROM operation_network_revision v, json_each(v.document, '$.operationList') o,
    json_each(o.value, '$.dynamicDataRequestList') r
WHERE true ORDER BY v.revision
ON CONFLICT DO NOTHING;

-- Which factories' operations an organisation sees in the revision in force, in full or as stubs. The drawer sees all
-- and needs no rows.
CREATE TABLE network_viewer (
    operation_network_id TEXT NOT NULL REFERENCES operation_network (operation_network_id),
    organisation_id TEXT NOT NULL,
    factory_id TEXT NOT NULL,
    PRIMARY KEY (operation_network_id, organisation_id, factory_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX network_viewer_by_organisation ON network_viewer (organisation_id);
WITH operation (network_id, operation_id, factory_id, organisation_id, document) AS (
    SELECT n.operation_network_id, json_extract(o.value, '$.operationId'), f.factory_id, f.organisation_id, o.value
    FROM operation_network n, json_each(n.document, '$.operationList') o
    JOIN factory f ON f.factory_id = json_extract(o.value, '$.owningFactoryId')
), neighbour (network_id, one, other) AS (
    SELECT n.operation_network_id, json_extract(r.value, '$.predecessorOperationId'),
        json_extract(r.value, '$.successorOperationId')
    FROM operation_network n, json_each(n.document, '$.operationRelationList') r
    UNION SELECT n.operation_network_id, json_extract(r.value, '$.successorOperationId'),
        json_extract(r.value, '$.predecessorOperationId')
    FROM operation_network n, json_each(n.document, '$.operationRelationList') r
    UNION SELECT network_id, operation_id, json_extract(document, '$.inspectedOperationId') FROM operation
)
INSERT INTO network_viewer (operation_network_id, organisation_id, factory_id)
SELECT network_id, organisation_id, factory_id FROM operation
UNION SELECT a.network_id, a.organisation_id, b.factory_id FROM operation a
    JOIN neighbour x ON x.network_id = a.network_id AND x.one = a.operation_id
    JOIN operation b ON b.network_id = x.network_id AND b.operation_id = x.other
UNION SELECT o.network_id, json_extract(r.value, '$.requesterId'), o.factory_id
    FROM operation o, json_each(o.document, '$.dynamicDataRequestList') r
UNION SELECT o.network_id, c.value, o.factory_id
    FROM operation o, json_each(o.document, '$.dynamicDataRequestList') r, json_each(r.value, '$.recipientList') c;

-- Who may read what: queries and events ask the same views.
CREATE VIEW network_reader (operation_network_id, organisation_id) AS
SELECT n.operation_network_id, m.organisation_id
FROM operation_network n JOIN collaboration_member m ON m.collaboration_id = n.collaboration_id
WHERE n.drawn_by = m.organisation_id OR EXISTS (
    SELECT 1 FROM network_viewer v
    WHERE v.operation_network_id = n.operation_network_id AND v.organisation_id = m.organisation_id);

-- A part with its faults is for the factory and the drawer; others see the state of factories whose operations they see.
CREATE VIEW network_part_reader (operation_network_id, factory_id, organisation_id, is_whole) AS
SELECT p.operation_network_id, p.factory_id, r.organisation_id,
    CASE WHEN n.drawn_by = r.organisation_id OR f.organisation_id = r.organisation_id THEN 1 ELSE 0 END
FROM network_part p
JOIN operation_network n ON n.operation_network_id = p.operation_network_id
JOIN factory f ON f.factory_id = p.factory_id
JOIN network_reader r ON r.operation_network_id = p.operation_network_id
WHERE n.drawn_by = r.organisation_id OR f.organisation_id = r.organisation_id OR EXISTS (
    SELECT 1 FROM network_viewer v WHERE v.operation_network_id = p.operation_network_id
    AND v.organisation_id = r.organisation_id AND v.factory_id = p.factory_id);

-- A comment about a request is for the requester and the factory; one about the network for the drawer and the factory.
CREATE VIEW comment_reader (comment_id, organisation_id) AS
SELECT c.comment_id, r.organisation_id
FROM comment c
JOIN operation_network n ON n.operation_network_id = c.operation_network_id
JOIN factory f ON f.factory_id = c.factory_id
JOIN network_reader r ON r.operation_network_id = c.operation_network_id
WHERE f.organisation_id = r.organisation_id
   OR (c.dynamic_data_request_id IS NULL AND n.drawn_by = r.organisation_id)
   OR EXISTS (SELECT 1 FROM request_requester q WHERE q.operation_network_id = c.operation_network_id
       AND q.dynamic_data_request_id = c.dynamic_data_request_id AND q.requester_id = r.organisation_id);
