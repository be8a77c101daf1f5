-- Shares in the record of who changed what: what an organisation does pushes out nothing but its own. What administrators
-- and commands do is in no share: it is kept its whole time.
DROP TRIGGER audit_entry_stays;
ALTER TABLE audit_entry ADD COLUMN share TEXT;
UPDATE audit_entry SET share = organisation_id
WHERE NOT (agent_kind = 'USER' AND agent_name IN (SELECT user_name FROM user_account WHERE role = 'ADMINISTRATOR'));
CREATE TRIGGER audit_entry_stays BEFORE UPDATE ON audit_entry
BEGIN SELECT RAISE(ABORT, 'entries of the audit are never changed'); END;
CREATE INDEX audit_entry_by_share ON audit_entry (share, audit_entry_id);
-- The entries that say of an organisation that older ones than its share holds were forgotten.
CREATE INDEX audit_entry_of_forgetting ON audit_entry (concerned_id, recorded_at)
WHERE operation = 'forgetAuditEntries';
DROP TRIGGER audit_entry_goes_last;
CREATE TRIGGER audit_entry_goes_last BEFORE DELETE ON audit_entry
WHEN EXISTS (SELECT 1 FROM audit_entry e WHERE e.share IS OLD.share AND e.audit_entry_id < OLD.audit_entry_id)
BEGIN SELECT RAISE(ABORT, 'only the oldest entries of the audit are removed'); END;

-- Answers that wait for a factory or tool: who never reads them gets no more.
CREATE INDEX outbox_of_answers ON outbox (address) WHERE correlation_id IS NOT NULL;

-- What is kept of a sender beside its messages and reports counts against its room in the store, too: announced gaps,
-- releases of the past, logs of its ledger, and answers that it does not read.
CREATE VIEW kept_beside (address, bytes) AS
SELECT 'factory.' || factory_id || '.ingress', 200 FROM sequence_gap
UNION ALL SELECT 'factory.' || factory_id || '.ingress', 200 FROM past_release
UNION ALL SELECT 'factory.' || factory_id || '.ingress',
    octet_length(checkpoint) + COALESCE(octet_length(refused_checkpoint), 0) + 200 FROM ledger_log
UNION ALL SELECT 'factory.' || substr(address, 9, length(address) - 17) || '.ingress', octet_length(body) + 200
    FROM outbox WHERE correlation_id IS NOT NULL AND address LIKE 'factory.%.requests'
UNION ALL SELECT 'factory.' || substr(address, 9, length(address) - 15) || '.ingress', octet_length(body) + 200
    FROM outbox WHERE correlation_id IS NOT NULL AND address LIKE 'factory.%.leases'
UNION ALL SELECT 'tool.' || substr(address, 6, length(address) - 13) || '.requests', octet_length(body) + 200
    FROM outbox WHERE correlation_id IS NOT NULL AND address LIKE 'tool.%.reports';
INSERT INTO kept_of_sender (address, number, bytes)
SELECT address, COUNT(*), SUM(bytes) FROM kept_beside WHERE true GROUP BY address
ON CONFLICT (address) DO UPDATE SET number = number + excluded.number, bytes = bytes + excluded.bytes;
DROP VIEW kept_beside;

CREATE TRIGGER sequence_gap_is_kept AFTER INSERT ON sequence_gap BEGIN
    INSERT INTO kept_of_sender (address, number, bytes) VALUES ('factory.' || NEW.factory_id || '.ingress', 1, 200)
    ON CONFLICT (address) DO UPDATE SET number = number + 1, bytes = bytes + 200;
END;
CREATE TRIGGER sequence_gap_is_forgotten AFTER DELETE ON sequence_gap BEGIN
    UPDATE kept_of_sender SET number = number - 1, bytes = bytes - 200
    WHERE address = 'factory.' || OLD.factory_id || '.ingress';
END;
CREATE TRIGGER past_release_is_kept AFTER INSERT ON past_release BEGIN
    INSERT INTO kept_of_sender (address, number, bytes) VALUES ('factory.' || NEW.factory_id || '.ingress', 1, 200)
    ON CONFLICT (address) DO UPDATE SET number = number + 1, bytes = bytes + 200;
END;
CREATE TRIGGER past_release_is_forgotten AFTER DELETE ON past_release BEGIN
    UPDATE kept_of_sender SET number = number - 1, bytes = bytes - 200
    WHERE address = 'factory.' || OLD.factory_id || '.ingress';
END;
CREATE TRIGGER ledger_log_is_kept AFTER INSERT ON ledger_log BEGIN
    INSERT INTO kept_of_sender (address, number, bytes) VALUES ('factory.' || NEW.factory_id || '.ingress', 1,
        octet_length(NEW.checkpoint) + COALESCE(octet_length(NEW.refused_checkpoint), 0) + 200)
    ON CONFLICT (address) DO UPDATE SET number = number + 1, bytes = bytes + excluded.bytes;
END;
CREATE TRIGGER ledger_log_is_changed AFTER UPDATE ON ledger_log BEGIN
    UPDATE kept_of_sender SET bytes = bytes
        + octet_length(NEW.checkpoint) + COALESCE(octet_length(NEW.refused_checkpoint), 0)
        - octet_length(OLD.checkpoint) - COALESCE(octet_length(OLD.refused_checkpoint), 0)
    WHERE address = 'factory.' || NEW.factory_id || '.ingress';
END;
CREATE TRIGGER ledger_log_is_forgotten AFTER DELETE ON ledger_log BEGIN
    UPDATE kept_of_sender SET number = number - 1, bytes = bytes
        - octet_length(OLD.checkpoint) - COALESCE(octet_length(OLD.refused_checkpoint), 0) - 200
    WHERE address = 'factory.' || OLD.factory_id || '.ingress';
END;
CREATE TRIGGER answer_is_kept AFTER INSERT ON outbox WHEN NEW.correlation_id IS NOT NULL BEGIN
    INSERT INTO kept_of_sender (address, number, bytes) VALUES (CASE
            WHEN NEW.address LIKE 'factory.%.requests'
                THEN 'factory.' || substr(NEW.address, 9, length(NEW.address) - 17) || '.ingress'
            WHEN NEW.address LIKE 'factory.%.leases'
                THEN 'factory.' || substr(NEW.address, 9, length(NEW.address) - 15) || '.ingress'
            ELSE 'tool.' || substr(NEW.address, 6, length(NEW.address) - 13) || '.requests' END,
        1, octet_length(NEW.body) + 200)
    ON CONFLICT (address) DO UPDATE SET number = number + 1, bytes = bytes + excluded.bytes;
END;
CREATE TRIGGER answer_is_forgotten AFTER DELETE ON outbox WHEN OLD.correlation_id IS NOT NULL BEGIN
    UPDATE kept_of_sender SET number = number - 1, bytes = bytes - octet_length(OLD.body) - 200
    WHERE address = CASE
            WHEN OLD.address LIKE 'factory.%.requests'
                THEN 'factory.' || substr(OLD.address, 9, length(OLD.address) - 17) || '.ingress'
            WHEN OLD.address LIKE 'factory.%.leases'
                THEN 'factory.' || substr(OLD.address, 9, length(OLD.address) - 15) || '.ingress'
            ELSE 'tool.' || substr(OLD.address, 6, length(OLD.address) - 13) || '.requests' END;
END;

-- What those left behind who left a former version; large amounts go in portions once the platform runs.
CREATE INDEX past_release_by_factory ON past_release (factory_id);
CREATE TEMPORARY TABLE left_factory AS SELECT factory_id FROM factory WHERE removed_at IS NOT NULL;
CREATE TEMPORARY TABLE left_tool AS SELECT tool_id FROM tool WHERE removed_at IS NOT NULL;
CREATE TEMPORARY TABLE left_address AS
SELECT 'factory.' || factory_id || '.ingress' AS address FROM left_factory
UNION ALL SELECT 'factory.' || factory_id || '.requests' FROM left_factory
UNION ALL SELECT 'factory.' || factory_id || '.leases' FROM left_factory
UNION ALL SELECT 'tool.' || tool_id || '.requests' FROM left_tool
UNION ALL SELECT 'tool.' || tool_id || '.reports' FROM left_tool;
DELETE FROM enrolment_token WHERE factory_id IN (SELECT factory_id FROM left_factory);
DELETE FROM signing_key WHERE factory_id IN (SELECT factory_id FROM left_factory);
DELETE FROM writer_meta_data WHERE factory_id IN (SELECT factory_id FROM left_factory);
DELETE FROM asset_offer WHERE factory_id IN (SELECT factory_id FROM left_factory);
DELETE FROM lease WHERE factory_id IN (SELECT factory_id FROM left_factory);
DELETE FROM past_release WHERE factory_id IN (SELECT factory_id FROM left_factory);
DELETE FROM outbox WHERE address IN (SELECT address FROM left_address);
DELETE FROM dead_letter WHERE address IN (SELECT address FROM left_address);
DELETE FROM revoked_access WHERE user_name IN (
    SELECT 'factory.' || factory_id FROM left_factory UNION ALL SELECT 'tool.' || tool_id FROM left_tool);
DELETE FROM network_viewer WHERE organisation_id IN (SELECT organisation_id FROM organisation WHERE removed_at IS NOT NULL);
DELETE FROM seen_revision WHERE organisation_id IN (SELECT organisation_id FROM organisation WHERE removed_at IS NOT NULL);
DELETE FROM revocation_reader WHERE organisation_id IN (
    SELECT organisation_id FROM organisation WHERE removed_at IS NOT NULL);
DROP TABLE left_address;
DROP TABLE left_tool;
DROP TABLE left_factory;
