-- Passkeys of people (WebAuthn). Recovery codes are in `second_factor`, for codes of an app and passkeys alike.
CREATE TABLE passkey (
    passkey_id TEXT NOT NULL PRIMARY KEY,
    user_name TEXT NOT NULL REFERENCES user (user_name) ON DELETE CASCADE,
    name TEXT NOT NULL,
    credential_id BLOB NOT NULL UNIQUE,
    -- Name by which authenticators know the user: random.
    user_handle BLOB NOT NULL,
    -- Ways to the authenticator, public key, and counter with flags, in the encoding of webauthn_rp 0.3.
    transports INTEGER NOT NULL,
    static_state BLOB NOT NULL,
    dynamic_state BLOB NOT NULL,
    created_at INTEGER NOT NULL,
    last_used_at INTEGER
) STRICT, WITHOUT ROWID;
CREATE INDEX passkey_by_user ON passkey (user_name);
