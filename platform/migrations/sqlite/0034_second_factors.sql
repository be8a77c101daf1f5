-- Second factors of people: codes by time (RFC 6238) and recovery codes.
CREATE TABLE second_factor (
    user_name TEXT NOT NULL PRIMARY KEY REFERENCES user_account (user_name) ON DELETE CASCADE,
    secret BLOB NOT NULL,
    -- 0 until a code of the authenticator app has come back.
    is_confirmed INTEGER NOT NULL CHECK (is_confirmed IN (0, 1)),
    -- Newest time step whose code was used; a code is good once.
    last_step INTEGER NOT NULL,
    -- Digests of the recovery codes that are left, a JSON array.
    recovery_digests TEXT NOT NULL
) STRICT;
