-- A request may name its tool before the tool is known here, so the reference is looked up when reports are forwarded.
DROP TABLE request_tool;
CREATE TABLE request_tool (
    operation_network_id TEXT NOT NULL REFERENCES operation_network (operation_network_id),
    dynamic_data_request_id TEXT NOT NULL,
    tool_id TEXT NOT NULL,
    PRIMARY KEY (operation_network_id, dynamic_data_request_id)
) STRICT;
INSERT INTO request_tool (operation_network_id, dynamic_data_request_id, tool_id)
SELECT n.operation_network_id, json_extract(r.value, '$.dynamicDataRequestId'),
    json_extract(r.value, '$.dynamicDataRequestPublisherId')
FROM operation_network n, json_each(n.document, '$.operationList') o,
    json_each(o.value, '$.dynamicDataRequestList') r
WHERE json_extract(r.value, '$.dynamicDataRequestPublisherId') IS NOT NULL AND n.withdrawn_at IS NULL;
