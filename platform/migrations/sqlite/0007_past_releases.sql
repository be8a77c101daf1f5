-- Reports that a factory showed to one more recipient after they had left for others. The recipients of a report are stored
-- with it; these rows are for reports that are still on their way, and say which factory decided what when.
CREATE TABLE past_release (
    past_release_id INTEGER PRIMARY KEY AUTOINCREMENT,
    operation_network_id TEXT NOT NULL,
    operation_id TEXT NOT NULL,
    dynamic_data_request_id TEXT NOT NULL,
    factory_id TEXT NOT NULL,
    organisation_id TEXT NOT NULL,
    data_set_writer_id INTEGER NOT NULL,
    epoch INTEGER NOT NULL,
    first_sequence INTEGER NOT NULL,
    last_sequence INTEGER NOT NULL,
    -- Time of the decision, by the connector's clock.
    decided_at INTEGER NOT NULL,
    UNIQUE (operation_network_id, dynamic_data_request_id, factory_id, operation_id, organisation_id,
        data_set_writer_id, epoch, first_sequence, last_sequence)
) STRICT;
