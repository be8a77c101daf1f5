-- Fair turns: what one factory keeps the platform busy with leaves room for the others.

-- Time of the last receipt about a writer, so that those that wait longest come first.
ALTER TABLE data_set_writer ADD COLUMN receipted_at INTEGER NOT NULL DEFAULT 0;

-- The recipients of reports of before they were stored with each, so that one index finds what was released to a member.
UPDATE report SET recipient_set_id = (SELECT r.recipient_set_id FROM former_report_recipients r
    WHERE r.operation_network_id = report.operation_network_id
      AND r.dynamic_data_request_id = report.dynamic_data_request_id
      AND r.factory_id = report.factory_id AND report.report_id <= r.last_report_id)
WHERE recipient_set_id IS NULL AND EXISTS (SELECT 1 FROM former_report_recipients);
CREATE INDEX recipient_set_by_member ON recipient_set_member (organisation_id, recipient_set_id);
CREATE INDEX report_by_recipients ON report (recipient_set_id, report_id);
CREATE INDEX report_by_recipients_and_request
    ON report (recipient_set_id, operation_network_id, dynamic_data_request_id, report_id);
CREATE INDEX asked_request_by_id ON asked_request (dynamic_data_request_id, operation_network_id);
