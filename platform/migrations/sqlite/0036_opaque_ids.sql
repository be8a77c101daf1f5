-- Random ids of what members see. The numbers count over all members: the gaps between those of one's own would say how
-- much others do.
ALTER TABLE comment ADD COLUMN opaque_id TEXT NOT NULL DEFAULT '';
UPDATE comment SET opaque_id = lower(hex(randomblob(16)));
CREATE UNIQUE INDEX comment_by_opaque_id ON comment (opaque_id);

ALTER TABLE revocation ADD COLUMN opaque_id TEXT NOT NULL DEFAULT '';
UPDATE revocation SET opaque_id = lower(hex(randomblob(16)));
CREATE UNIQUE INDEX revocation_by_opaque_id ON revocation (opaque_id);

-- Entries of before get their ids here, once; from then on nobody changes one again.
DROP TRIGGER audit_entry_stays;
ALTER TABLE audit_entry ADD COLUMN opaque_id TEXT NOT NULL DEFAULT '';
UPDATE audit_entry SET opaque_id = lower(hex(randomblob(16)));
CREATE UNIQUE INDEX audit_entry_by_opaque_id ON audit_entry (opaque_id);
CREATE TRIGGER audit_entry_stays BEFORE UPDATE ON audit_entry
BEGIN SELECT RAISE(ABORT, 'entries of the audit are never changed'); END;
