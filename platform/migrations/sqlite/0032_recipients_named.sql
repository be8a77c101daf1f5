-- Arrival of the first report of a factory that said to whom it was released, or of metadata that describes the member.
-- From then on, a report of the factory that does not say it is for nobody.
ALTER TABLE factory ADD COLUMN names_recipients_since INTEGER;
UPDATE factory SET names_recipients_since = (SELECT MIN(m.received_at) FROM writer_meta_data m
    WHERE m.factory_id = factory.factory_id AND m.body LIKE '%"recipientList"%');
