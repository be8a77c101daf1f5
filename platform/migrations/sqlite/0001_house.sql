-- The platform's house. Times are OPC UA ticks (100 ns since 1601-01-01T00:00:00Z), documents are JSON texts. The
-- statements that use these tables are written for SQLite and PostgreSQL alike; only this folder is a dialect's own.

CREATE TABLE organisation (
    organisation_id TEXT NOT NULL PRIMARY KEY,
    name TEXT NOT NULL,
    created_at INTEGER NOT NULL
) STRICT;

CREATE TABLE user_account (
    user_name TEXT NOT NULL PRIMARY KEY,
    password_hash TEXT NOT NULL,
    role TEXT NOT NULL CHECK (role IN ('ADMINISTRATOR', 'PLANNER', 'VIEWER')),
    organisation_id TEXT REFERENCES organisation (organisation_id),
    created_at INTEGER NOT NULL
) STRICT;

CREATE TABLE session (
    session_id TEXT NOT NULL PRIMARY KEY,
    user_name TEXT NOT NULL REFERENCES user_account (user_name) ON DELETE CASCADE,
    csrf_token TEXT NOT NULL,
    expires_at INTEGER NOT NULL
) STRICT;
CREATE INDEX session_by_expiry ON session (expires_at);

CREATE TABLE factory (
    factory_id TEXT NOT NULL PRIMARY KEY,
    organisation_id TEXT NOT NULL REFERENCES organisation (organisation_id),
    name TEXT NOT NULL,
    created_at INTEGER NOT NULL,
    enrolled_at INTEGER,
    last_heard_at INTEGER,
    last_report_at INTEGER,
    publisher_state TEXT
) STRICT;

CREATE TABLE tool (
    tool_id TEXT NOT NULL PRIMARY KEY,
    organisation_id TEXT NOT NULL REFERENCES organisation (organisation_id),
    name TEXT NOT NULL,
    created_at INTEGER NOT NULL
) STRICT;

-- Single-use tokens; only their hashes are known.
CREATE TABLE enrolment_token (
    token_hash BLOB NOT NULL PRIMARY KEY,
    factory_id TEXT NOT NULL REFERENCES factory (factory_id),
    created_at INTEGER NOT NULL,
    expires_at INTEGER NOT NULL,
    used_at INTEGER
) STRICT;

-- What connectors and tools sign in to the broker with; only hashes of secrets of 256 random bits are known.
CREATE TABLE broker_credential (
    credential_id INTEGER PRIMARY KEY AUTOINCREMENT,
    holder_kind TEXT NOT NULL CHECK (holder_kind IN ('FACTORY', 'TOOL')),
    holder_id TEXT NOT NULL,
    secret_hash BLOB NOT NULL,
    created_at INTEGER NOT NULL
) STRICT;
CREATE INDEX broker_credential_by_holder ON broker_credential (holder_kind, holder_id, credential_id);

CREATE TABLE collaboration (
    collaboration_id TEXT NOT NULL PRIMARY KEY,
    name TEXT NOT NULL,
    created_at INTEGER NOT NULL
) STRICT;

CREATE TABLE collaboration_member (
    collaboration_id TEXT NOT NULL REFERENCES collaboration (collaboration_id),
    organisation_id TEXT NOT NULL REFERENCES organisation (organisation_id),
    PRIMARY KEY (collaboration_id, organisation_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX collaboration_member_by_organisation ON collaboration_member (organisation_id);

CREATE TABLE collaboration_factory (
    collaboration_id TEXT NOT NULL REFERENCES collaboration (collaboration_id),
    factory_id TEXT NOT NULL REFERENCES factory (factory_id),
    PRIMARY KEY (collaboration_id, factory_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX collaboration_factory_by_factory ON collaboration_factory (factory_id);

-- The newest revision of each network; a withdrawn one stays as a tombstone.
CREATE TABLE operation_network (
    operation_network_id TEXT NOT NULL PRIMARY KEY,
    collaboration_id TEXT NOT NULL REFERENCES collaboration (collaboration_id),
    name TEXT,
    revision INTEGER NOT NULL,
    document TEXT NOT NULL,
    updated_at INTEGER NOT NULL,
    updated_by TEXT NOT NULL,
    withdrawn_at INTEGER
) STRICT;
CREATE INDEX operation_network_by_collaboration ON operation_network (collaboration_id);

CREATE TABLE operation_network_revision (
    operation_network_id TEXT NOT NULL REFERENCES operation_network (operation_network_id),
    revision INTEGER NOT NULL,
    document TEXT NOT NULL,
    created_at INTEGER NOT NULL,
    created_by TEXT NOT NULL,
    PRIMARY KEY (operation_network_id, revision)
) STRICT;

-- What each factory was sent of a network, and what became of it.
CREATE TABLE network_part (
    operation_network_id TEXT NOT NULL REFERENCES operation_network (operation_network_id),
    factory_id TEXT NOT NULL REFERENCES factory (factory_id),
    revision INTEGER NOT NULL,
    is_withdrawal INTEGER NOT NULL,
    document TEXT NOT NULL,
    message_id TEXT NOT NULL,
    state TEXT NOT NULL CHECK (state IN ('SENT', 'ACCEPTED', 'UNCHANGED', 'REJECTED')),
    fault_list TEXT NOT NULL,
    sent_at INTEGER NOT NULL,
    sent_count INTEGER NOT NULL,
    resend_at INTEGER NOT NULL,
    acknowledged_at INTEGER,
    PRIMARY KEY (operation_network_id, factory_id)
) STRICT;
CREATE INDEX network_part_by_resend ON network_part (state, resend_at);
CREATE INDEX network_part_by_message ON network_part (factory_id, message_id);

-- The fields that are asked for, with what was decided about them. A row goes when a revision no longer asks.
CREATE TABLE request_field (
    operation_network_id TEXT NOT NULL REFERENCES operation_network (operation_network_id),
    operation_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    field_name TEXT NOT NULL,
    factory_id TEXT NOT NULL,
    position INTEGER NOT NULL,
    mapping_state TEXT NOT NULL,
    reason TEXT,
    disclosure TEXT,
    decided_at INTEGER,
    PRIMARY KEY (operation_network_id, dynamic_data_request_id, field_name)
) STRICT;
CREATE INDEX request_field_by_factory ON request_field (factory_id);

-- Who may see a request's answers, now or for reports that came while it was asked.
CREATE TABLE request_recipient (
    operation_network_id TEXT NOT NULL REFERENCES operation_network (operation_network_id),
    dynamic_data_request_id TEXT NOT NULL,
    organisation_id TEXT NOT NULL,
    PRIMARY KEY (operation_network_id, dynamic_data_request_id, organisation_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX request_recipient_by_organisation ON request_recipient (organisation_id);

-- Tools that posted a request and receive its reports.
CREATE TABLE request_tool (
    operation_network_id TEXT NOT NULL REFERENCES operation_network (operation_network_id),
    dynamic_data_request_id TEXT NOT NULL,
    tool_id TEXT NOT NULL REFERENCES tool (tool_id),
    PRIMARY KEY (operation_network_id, dynamic_data_request_id, tool_id)
) STRICT, WITHOUT ROWID;

-- Messages as they came, kept for a while. The key discards repeats.
CREATE TABLE inbox_message (
    inbox_message_id INTEGER PRIMARY KEY AUTOINCREMENT,
    address TEXT NOT NULL,
    message_id TEXT NOT NULL,
    message_type TEXT NOT NULL,
    received_at INTEGER NOT NULL,
    body TEXT NOT NULL,
    UNIQUE (address, message_id)
) STRICT;
CREATE INDEX inbox_message_by_time ON inbox_message (received_at);

-- One row per DataSetMessage. The key discards repeats.
CREATE TABLE report (
    report_id INTEGER PRIMARY KEY AUTOINCREMENT,
    factory_id TEXT NOT NULL,
    data_set_writer_id INTEGER NOT NULL,
    epoch INTEGER NOT NULL,
    sequence INTEGER NOT NULL,
    operation_network_id TEXT NOT NULL,
    operation_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    report_name TEXT NOT NULL,
    shopfloor_timestamp INTEGER,
    report_timestamp INTEGER,
    received_at INTEGER NOT NULL,
    is_replay INTEGER NOT NULL,
    fields TEXT NOT NULL,
    UNIQUE (factory_id, data_set_writer_id, epoch, sequence)
) STRICT;
CREATE INDEX report_by_request ON report (operation_network_id, dynamic_data_request_id, report_id);

-- The value of a field with the highest epoch and sequence.
CREATE TABLE field_value (
    operation_network_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    field_name TEXT NOT NULL,
    operation_id TEXT NOT NULL,
    epoch INTEGER NOT NULL,
    sequence INTEGER NOT NULL,
    value TEXT NOT NULL,
    built_in_type INTEGER NOT NULL,
    status INTEGER NOT NULL,
    source_timestamp INTEGER,
    report_timestamp INTEGER,
    received_at INTEGER NOT NULL,
    PRIMARY KEY (operation_network_id, dynamic_data_request_id, field_name)
) STRICT;

-- What is held of each writer within an epoch: all up to the highest but for the missing ranges.
CREATE TABLE data_set_writer (
    factory_id TEXT NOT NULL REFERENCES factory (factory_id),
    data_set_writer_id INTEGER NOT NULL,
    epoch INTEGER NOT NULL,
    through_sequence INTEGER,
    missing TEXT NOT NULL,
    received INTEGER NOT NULL,
    duplicates INTEGER NOT NULL,
    operation_network_id TEXT,
    dynamic_data_request_id TEXT,
    last_report_at INTEGER,
    last_keep_alive_at INTEGER,
    needs_receipt INTEGER NOT NULL,
    PRIMARY KEY (factory_id, data_set_writer_id, epoch)
) STRICT;
CREATE INDEX data_set_writer_by_receipt ON data_set_writer (needs_receipt, factory_id);

CREATE TABLE sequence_gap (
    sequence_gap_id INTEGER PRIMARY KEY AUTOINCREMENT,
    factory_id TEXT NOT NULL REFERENCES factory (factory_id),
    data_set_writer_id INTEGER NOT NULL,
    epoch INTEGER NOT NULL,
    first_sequence INTEGER NOT NULL,
    last_sequence INTEGER NOT NULL,
    cause TEXT NOT NULL,
    received_at INTEGER NOT NULL
) STRICT;
CREATE INDEX sequence_gap_by_writer ON sequence_gap (factory_id, data_set_writer_id, epoch);

CREATE TABLE writer_meta_data (
    factory_id TEXT NOT NULL REFERENCES factory (factory_id),
    data_set_writer_id INTEGER NOT NULL,
    received_at INTEGER NOT NULL,
    body TEXT NOT NULL,
    PRIMARY KEY (factory_id, data_set_writer_id)
) STRICT;

CREATE TABLE asset_offer (
    factory_id TEXT NOT NULL REFERENCES factory (factory_id),
    asset_id TEXT NOT NULL,
    kind_list TEXT NOT NULL,
    description TEXT NOT NULL,
    received_at INTEGER NOT NULL,
    PRIMARY KEY (factory_id, asset_id)
) STRICT;

CREATE TABLE comment (
    comment_id INTEGER PRIMARY KEY AUTOINCREMENT,
    operation_network_id TEXT NOT NULL REFERENCES operation_network (operation_network_id),
    factory_id TEXT NOT NULL,
    dynamic_data_request_id TEXT,
    field_name TEXT,
    author_id TEXT NOT NULL,
    is_from_factory INTEGER NOT NULL,
    text TEXT NOT NULL,
    created_at INTEGER NOT NULL
) STRICT;
CREATE INDEX comment_by_network ON comment (operation_network_id, comment_id);

-- What was received and could not be used, with the reason.
CREATE TABLE dead_letter (
    dead_letter_id INTEGER PRIMARY KEY AUTOINCREMENT,
    address TEXT NOT NULL,
    message_id TEXT,
    subject TEXT NOT NULL,
    code TEXT NOT NULL,
    reason TEXT NOT NULL,
    received_at INTEGER NOT NULL,
    body BLOB NOT NULL,
    content_encoding TEXT,
    replayed_at INTEGER
) STRICT;

-- Messages that wait to be sent; written in the transaction of what they tell.
CREATE TABLE outbox (
    outbox_id INTEGER PRIMARY KEY AUTOINCREMENT,
    address TEXT NOT NULL,
    message_id TEXT NOT NULL,
    subject TEXT NOT NULL,
    correlation_id TEXT,
    created_at INTEGER NOT NULL,
    time_to_live_ms INTEGER,
    content_encoding TEXT,
    body BLOB NOT NULL,
    attempts INTEGER NOT NULL,
    parked_code TEXT,
    parked_reason TEXT
) STRICT;
CREATE INDEX outbox_by_address ON outbox (address);
CREATE INDEX outbox_by_message ON outbox (message_id);
