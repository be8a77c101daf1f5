-- Time of the removal of who or what left. The rows stay for what happened with them, and so that nobody gets their ids again.
ALTER TABLE organisation ADD COLUMN removed_at INTEGER;
ALTER TABLE factory ADD COLUMN removed_at INTEGER;
ALTER TABLE tool ADD COLUMN removed_at INTEGER;
