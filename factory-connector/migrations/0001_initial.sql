-- The connector's durable file: identity, networks, decisions, ledger and spool. Times are microseconds since 1970
-- (UTC), JSON is text, ids are those of the wire contract.

-- Who this connector is. One row.
CREATE TABLE identity (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    factory_id TEXT NOT NULL,
    -- Tells this store from a restored copy of it: compared with a file beside it at every start.
    generation TEXT NOT NULL,
    created_at INTEGER NOT NULL
) STRICT;

-- How to reach the platform's broker, given by enrolment. One row.
CREATE TABLE enrolment (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    factory_id TEXT NOT NULL,
    broker_url TEXT NOT NULL,
    profile TEXT NOT NULL,
    user_name TEXT NOT NULL,
    password TEXT NOT NULL,
    root_certificate_pem TEXT,
    enrolled_at INTEGER NOT NULL
) STRICT;

-- Operation networks as last received. A withdrawn one stays as a tombstone: state WITHDRAWN, no message.
CREATE TABLE network (
    operation_network_id TEXT PRIMARY KEY,
    revision INTEGER NOT NULL,
    state TEXT NOT NULL CHECK (state IN ('ACTIVE', 'WITHDRAWN')),
    message TEXT,
    received_at INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- Requested fields: the decision about each, and where its values stand.
CREATE TABLE field (
    id INTEGER PRIMARY KEY,
    operation_network_id TEXT NOT NULL,
    operation_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    field_name TEXT NOT NULL,
    mapping_state TEXT NOT NULL,
    value_source TEXT,
    reason TEXT,
    decided_by TEXT,
    decided_at INTEGER,
    -- The mapping in force, or the one to offer again after a change of the request.
    mapping TEXT,
    policy TEXT NOT NULL,
    consent_version INTEGER NOT NULL,
    UNIQUE (operation_network_id, operation_id, dynamic_data_request_id, field_name)
) STRICT;

-- Where a field's values stand: disclosed and waiting values of its gate, and the state of its transform. Written with
-- every batch of reports.
CREATE TABLE field_value (
    field_id INTEGER PRIMARY KEY REFERENCES field (id) ON DELETE CASCADE,
    gate TEXT NOT NULL,
    transform TEXT
) STRICT;

-- Every consent ever given, for the ledger's entries to refer to.
CREATE TABLE consent (
    field TEXT NOT NULL,
    version INTEGER NOT NULL,
    mapping_state TEXT NOT NULL,
    value_source TEXT,
    policy TEXT NOT NULL,
    reason TEXT,
    decided_by TEXT,
    decided_at INTEGER NOT NULL,
    PRIMARY KEY (field, version)
) STRICT, WITHOUT ROWID;

-- DataSetWriters. A retired one keeps its id until it has rested.
CREATE TABLE writer (
    id INTEGER PRIMARY KEY CHECK (id BETWEEN 1 AND 65535),
    operation_network_id TEXT NOT NULL,
    operation_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    epoch INTEGER NOT NULL,
    minor_version INTEGER NOT NULL,
    next_sequence INTEGER NOT NULL,
    -- The mapped fields, in payload order, that the metadata in force describes.
    field_list TEXT NOT NULL,
    meta_data TEXT,
    retired_at INTEGER
) STRICT;

-- DataSetMessages that left or are about to: the spool (while state is WAITING, SENT or PARKED) and the side table of
-- the ledger's values. Retention empties body and salt; the chain stays provable.
CREATE TABLE report (
    id INTEGER PRIMARY KEY,
    -- The number of the NetworkMessage it travels in: that of the message's last row.
    message INTEGER NOT NULL,
    writer_id INTEGER NOT NULL,
    epoch INTEGER NOT NULL,
    sequence INTEGER NOT NULL,
    state TEXT NOT NULL CHECK (state IN ('WAITING', 'SENT', 'PARKED', 'DONE')),
    created_at INTEGER NOT NULL,
    sent_at INTEGER,
    sent_count INTEGER NOT NULL DEFAULT 0,
    attempts INTEGER NOT NULL DEFAULT 0,
    -- The consent ended after it was sent: it is not sent again.
    is_revoked INTEGER NOT NULL DEFAULT 0,
    recipients TEXT NOT NULL,
    bytes INTEGER NOT NULL,
    body TEXT,
    salt BLOB,
    UNIQUE (writer_id, epoch, sequence)
) STRICT;
CREATE INDEX report_waiting ON report (message) WHERE state = 'WAITING';
CREATE INDEX report_kept ON report (writer_id, epoch, sequence) WHERE state IN ('WAITING', 'SENT');
CREATE INDEX report_backlog ON report (state, created_at, bytes) WHERE state IN ('WAITING', 'SENT');

-- Control messages that wait to be sent: acknowledgements, decisions, gaps, comments, metadata.
CREATE TABLE control (
    id INTEGER PRIMARY KEY,
    message_id TEXT NOT NULL,
    subject TEXT NOT NULL,
    correlation_id TEXT,
    body TEXT NOT NULL,
    created_at INTEGER NOT NULL,
    ttl_ms INTEGER,
    attempts INTEGER NOT NULL DEFAULT 0,
    state TEXT NOT NULL DEFAULT 'WAITING' CHECK (state IN ('WAITING', 'PARKED'))
) STRICT;

-- One hash chain per recipient organisation.
CREATE TABLE ledger_entry (
    recipient TEXT NOT NULL,
    number INTEGER NOT NULL,
    recorded_at INTEGER NOT NULL,
    -- The report a QUEUED entry is about.
    report_id INTEGER,
    -- The hashed text, canonical JSON.
    content TEXT NOT NULL,
    hash BLOB NOT NULL,
    PRIMARY KEY (recipient, number)
) STRICT, WITHOUT ROWID;

-- Signed statements of all chains' heads.
CREATE TABLE ledger_checkpoint (
    number INTEGER PRIMARY KEY,
    recorded_at INTEGER NOT NULL,
    content TEXT NOT NULL,
    signature BLOB NOT NULL,
    public_key BLOB NOT NULL
) STRICT;

-- Ids of messages whose effect has been stored.
CREATE TABLE seen (
    message_id TEXT PRIMARY KEY,
    seen_at INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
CREATE INDEX seen_by_time ON seen (seen_at);

-- What was received or sent and rejected, for people to look at.
CREATE TABLE dead_letter (
    id INTEGER PRIMARY KEY,
    direction TEXT NOT NULL CHECK (direction IN ('RECEIVED', 'SENT')),
    message_id TEXT,
    subject TEXT NOT NULL,
    code TEXT NOT NULL,
    reason TEXT NOT NULL,
    body BLOB NOT NULL,
    occurred_at INTEGER NOT NULL
) STRICT;

-- Talk with the partners.
CREATE TABLE comment (
    id INTEGER PRIMARY KEY,
    message_id TEXT NOT NULL UNIQUE,
    operation_network_id TEXT NOT NULL,
    dynamic_data_request_id TEXT,
    field_name TEXT,
    author_id TEXT NOT NULL,
    is_own INTEGER NOT NULL,
    text TEXT NOT NULL,
    written_at INTEGER NOT NULL
) STRICT;
CREATE INDEX comment_by_network ON comment (operation_network_id, id);

-- OPC UA servers that values come from.
CREATE TABLE source (
    source_id TEXT PRIMARY KEY,
    config TEXT NOT NULL,
    password TEXT
) STRICT, WITHOUT ROWID;

-- People who may sign in, at the page and at the twin.
CREATE TABLE user (
    user_name TEXT PRIMARY KEY,
    role TEXT NOT NULL CHECK (role IN ('ENGINEER', 'OPERATOR', 'VIEWER')),
    password_hash TEXT NOT NULL,
    changed_at INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
