-- Collaborations that have ended: what was agreed in them stays, and their ids are never given again.
ALTER TABLE collaboration ADD COLUMN removed_at INTEGER;
