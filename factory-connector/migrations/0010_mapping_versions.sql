-- Versions of mappings, shadows that run beside them, and templates for series of machines.

-- Each mapping that was published for a field, numbered from 1. Goes with its field; the oldest go beyond a limit.
CREATE TABLE mapping_version (
    field_id INTEGER NOT NULL REFERENCES field (id) ON DELETE CASCADE,
    version INTEGER NOT NULL,
    mapping TEXT NOT NULL,
    author TEXT,
    note TEXT,
    published_at INTEGER NOT NULL,
    PRIMARY KEY (field_id, version)
) STRICT, WITHOUT ROWID;

-- What flowed before versions were kept is the first of them.
INSERT INTO mapping_version (field_id, version, mapping, author, published_at)
SELECT id, 1, mapping, decided_by, coalesce(decided_at, 0) FROM field
WHERE mapping IS NOT NULL AND mapping_state = 'MAPPED' AND value_source = 'MAPPING';

-- A mapping that runs beside the published one and writes nothing.
CREATE TABLE mapping_shadow (
    field_id INTEGER PRIMARY KEY REFERENCES field (id) ON DELETE CASCADE,
    mapping TEXT NOT NULL,
    author TEXT NOT NULL,
    started_at INTEGER NOT NULL
) STRICT;

-- Mappings with gaps, filled once per machine of a series.
CREATE TABLE mapping_template (
    template_id TEXT PRIMARY KEY,
    template TEXT NOT NULL,
    author TEXT NOT NULL,
    changed_at INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
