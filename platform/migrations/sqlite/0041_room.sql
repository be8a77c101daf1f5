-- Rows and bytes that are kept of each sender's messages, to hold them against its room in the store: the messages as
-- they came, and the reports of a factory. What is beside the bodies counts as 200 bytes a row.
CREATE TABLE kept_of_sender (
    address TEXT PRIMARY KEY,
    number INTEGER NOT NULL,
    bytes INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

INSERT INTO kept_of_sender (address, number, bytes)
SELECT address, SUM(number), SUM(bytes) FROM (
    SELECT address, COUNT(*) AS number, SUM(octet_length(body) + 200) AS bytes FROM inbox_message GROUP BY address
    UNION ALL
    SELECT 'factory.' || factory_id || '.ingress', COUNT(*), SUM(octet_length(fields) + 200) FROM report GROUP BY factory_id
) GROUP BY address;

CREATE TRIGGER inbox_message_is_kept AFTER INSERT ON inbox_message BEGIN
    INSERT INTO kept_of_sender (address, number, bytes) VALUES (NEW.address, 1, octet_length(NEW.body) + 200)
    ON CONFLICT (address) DO UPDATE SET number = number + 1, bytes = bytes + octet_length(NEW.body) + 200;
END;
CREATE TRIGGER inbox_message_is_forgotten AFTER DELETE ON inbox_message BEGIN
    UPDATE kept_of_sender SET number = number - 1, bytes = bytes - octet_length(OLD.body) - 200
    WHERE address = OLD.address;
END;
CREATE TRIGGER report_is_kept AFTER INSERT ON report BEGIN
    INSERT INTO kept_of_sender (address, number, bytes)
    VALUES ('factory.' || NEW.factory_id || '.ingress', 1, octet_length(NEW.fields) + 200)
    ON CONFLICT (address) DO UPDATE SET number = number + 1, bytes = bytes + octet_length(NEW.fields) + 200;
END;
CREATE TRIGGER report_is_forgotten AFTER DELETE ON report BEGIN
    UPDATE kept_of_sender SET number = number - 1, bytes = bytes - octet_length(OLD.fields) - 200
    WHERE address = 'factory.' || OLD.factory_id || '.ingress';
END;
