-- Fair turns: what one factory keeps the platform busy with leaves room for the others.

-- Time of the last receipt about a writer, so that those that wait longest come first.
ALTER TABLE data_set_writer ADD COLUMN receipted_at INTEGER NOT NULL DEFAULT 0;
