-- Users of a broker whose credentials were revoked: nothing of them counts and nothing is sent to them until they enrol
-- again. A broker of another make goes on to let them in until its administrator removes the account.
CREATE TABLE revoked_access (
    user_name TEXT PRIMARY KEY,
    revoked_at INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- The record of who changed what is bounded for each organisation by itself: what one does pushes out nothing of others.
DROP TRIGGER audit_entry_goes_last;
CREATE TRIGGER audit_entry_goes_last BEFORE DELETE ON audit_entry
WHEN EXISTS (SELECT 1 FROM audit_entry e
             WHERE e.organisation_id IS OLD.organisation_id AND e.audit_entry_id < OLD.audit_entry_id)
BEGIN SELECT RAISE(ABORT, 'only the oldest entries of the audit are removed'); END;
