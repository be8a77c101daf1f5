-- Receipts of revocations as the factories signed them, for the organisations that received the values.
CREATE TABLE revocation (
    revocation_number INTEGER PRIMARY KEY,
    message_id TEXT NOT NULL,
    factory_id TEXT NOT NULL REFERENCES factory (factory_id),
    operation_network_id TEXT NOT NULL,
    operation_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    signed_text TEXT NOT NULL,
    signature TEXT NOT NULL,
    public_key TEXT NOT NULL,
    received_at INTEGER NOT NULL,
    UNIQUE (factory_id, message_id)
) STRICT;
CREATE INDEX revocation_by_network ON revocation (operation_network_id, revocation_number);

-- Who may read a receipt: the organisations that the factory named, and its own.
CREATE TABLE revocation_reader (
    revocation_number INTEGER NOT NULL REFERENCES revocation (revocation_number),
    organisation_id TEXT NOT NULL,
    PRIMARY KEY (revocation_number, organisation_id)
) STRICT, WITHOUT ROWID;
