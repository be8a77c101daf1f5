-- Time at which a factory's connector first signed a message, or enrolled with a key that signs. From then on an
-- unsigned message of the factory changes nothing.
ALTER TABLE factory ADD COLUMN signs_since INTEGER;
-- Ed25519 public keys whose signatures count for a factory, the newest with the highest number: the one that its
-- connector first signed with, or those of its newest enrolments.
CREATE TABLE signing_key (
    signing_key_id INTEGER PRIMARY KEY AUTOINCREMENT,
    factory_id TEXT NOT NULL REFERENCES factory (factory_id),
    public_key BLOB NOT NULL,
    pinned_at INTEGER NOT NULL,
    UNIQUE (factory_id, public_key)
) STRICT;
-- Signature that the message came with; a replay is verified like any other message.
ALTER TABLE dead_letter ADD COLUMN signature TEXT;
