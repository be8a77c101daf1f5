-- Shares of each factory, tool and organisation in what the platform keeps: what one exhausts, others do not feel.

-- Each address has dead letters of its own; the newest stay.
ALTER TABLE dead_letter ADD COLUMN bytes INTEGER NOT NULL DEFAULT 0;
UPDATE dead_letter SET bytes = LENGTH(body);
CREATE INDEX dead_letter_by_address ON dead_letter (address, dead_letter_id, bytes);

-- Up to this number, some of what counts as missing may be held: ranges were merged, as there were too many.
ALTER TABLE data_set_writer ADD COLUMN coarse_through INTEGER;
-- True where several gaps were merged into one, so that some numbers of it may be held.
ALTER TABLE sequence_gap ADD COLUMN is_coarse INTEGER NOT NULL DEFAULT 0;

-- To count the networks of an organisation.
CREATE INDEX operation_network_by_drawer ON operation_network (drawn_by);
