-- Where the store was used last. One that is used elsewhere was moved or copied.
ALTER TABLE identity ADD COLUMN place TEXT;
-- 1 from a start that finds the store restored, moved or copied until every writer has begun a new epoch.
ALTER TABLE identity ADD COLUMN must_begin_epochs INTEGER NOT NULL DEFAULT 0;
-- The place at which this connector was granted its factory's lease last; null once it was refused.
ALTER TABLE identity ADD COLUMN leased_place TEXT;
