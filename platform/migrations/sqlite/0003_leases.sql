-- Which of a factory's running connectors speaks for it.
CREATE TABLE lease (
    factory_id TEXT NOT NULL PRIMARY KEY REFERENCES factory (factory_id),
    -- Counts up whenever the lease passes to another place.
    lease_number INTEGER NOT NULL,
    -- The holder, as JSON.
    holder TEXT NOT NULL,
    -- Who else asked and was refused, as a JSON list, whoever was heard last first.
    contenders TEXT NOT NULL
) STRICT;
