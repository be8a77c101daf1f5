-- Partners that tell each other what they get, and caps of the information that partners get: every version is kept.
CREATE TABLE alliance_version (
    alliance_id TEXT NOT NULL,
    version INTEGER NOT NULL,
    document TEXT NOT NULL,
    changed_by TEXT NOT NULL,
    changed_at INTEGER NOT NULL,
    PRIMARY KEY (alliance_id, version)
) STRICT, WITHOUT ROWID;

CREATE TABLE cap_version (
    cap_id TEXT NOT NULL,
    version INTEGER NOT NULL,
    document TEXT NOT NULL,
    changed_by TEXT NOT NULL,
    changed_at INTEGER NOT NULL,
    PRIMARY KEY (cap_id, version)
) STRICT, WITHOUT ROWID;
