-- What was disclosed of fields until their consents ended, for as long as a policy's period or an hour can depend on it.
CREATE TABLE former_disclosure (
    id INTEGER PRIMARY KEY,
    ended_at INTEGER NOT NULL,
    document TEXT NOT NULL
) STRICT;
