-- Secrets of second factors, sealed. The column `secret` is empty from the first start of this version on.
ALTER TABLE second_factor ADD COLUMN sealed_secret TEXT;
