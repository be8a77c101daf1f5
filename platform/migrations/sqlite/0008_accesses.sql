-- Who read a factory's values: one transparency log per factory, whose leaves are the texts of its start and its entries.
CREATE TABLE access_log (
    factory_id TEXT NOT NULL PRIMARY KEY,
    -- Text of the first leaf.
    start TEXT NOT NULL,
    -- Number of the last entry, and the edge of the tree up to it, 32 bytes a hash.
    last_number INTEGER NOT NULL,
    edge BLOB NOT NULL,
    -- Number of the last entry that retention removed, and the hashes over the removed entries; empty without any.
    removed_number INTEGER NOT NULL,
    removed_edge BLOB NOT NULL,
    -- The last checkpoint, a signed note, and the number of the last entry that it covers; null before the first.
    checkpoint TEXT,
    checkpoint_number INTEGER
) STRICT;

-- Entries. Content is the text that is hashed; the other columns repeat parts of it for searches.
CREATE TABLE access_entry (
    factory_id TEXT NOT NULL REFERENCES access_log (factory_id),
    number INTEGER NOT NULL,
    recorded_at INTEGER NOT NULL,
    viewer_id TEXT NOT NULL,
    agent_id TEXT NOT NULL,
    operation_network_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    content TEXT NOT NULL,
    PRIMARY KEY (factory_id, number)
) STRICT;
CREATE INDEX access_entry_by_viewer ON access_entry (factory_id, viewer_id, number);
CREATE INDEX access_entry_by_request
    ON access_entry (factory_id, operation_network_id, dynamic_data_request_id, number);
CREATE INDEX access_entry_by_agent ON access_entry (factory_id, agent_id);

-- Persons and tools behind the pseudonyms of entries. Only their own organisation is shown the name.
CREATE TABLE access_agent (
    factory_id TEXT NOT NULL,
    organisation_id TEXT NOT NULL,
    kind TEXT NOT NULL CHECK (kind IN ('USER', 'TOOL')),
    name TEXT NOT NULL,
    agent_id TEXT NOT NULL,
    PRIMARY KEY (factory_id, organisation_id, kind, name)
) STRICT, WITHOUT ROWID;
CREATE UNIQUE INDEX access_agent_by_id ON access_agent (factory_id, agent_id);
