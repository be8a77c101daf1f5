-- Gaps that were announced to the platform, until a receipt covers them: a broker may lose the announcement.
CREATE TABLE announced_gap (
    writer_id INTEGER NOT NULL,
    epoch INTEGER NOT NULL,
    first_sequence INTEGER NOT NULL,
    last_sequence INTEGER NOT NULL,
    cause TEXT NOT NULL,
    announced_at INTEGER NOT NULL,
    PRIMARY KEY (writer_id, epoch, first_sequence, last_sequence)
) STRICT, WITHOUT ROWID;
