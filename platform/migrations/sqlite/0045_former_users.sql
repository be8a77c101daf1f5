-- Names of people who have left: the record of who did what names people by them, so that nobody gets one again.
CREATE TABLE former_user (
    user_name TEXT PRIMARY KEY
) STRICT, WITHOUT ROWID;
-- However an account ends.
CREATE TRIGGER user_account_is_former AFTER DELETE ON user_account BEGIN
    INSERT INTO former_user (user_name) VALUES (OLD.user_name) ON CONFLICT DO NOTHING;
END;
-- Those who left a former version, as far as what stays names them.
INSERT INTO former_user (user_name)
SELECT agent_name FROM audit_entry WHERE agent_kind = 'USER' AND agent_name NOT IN (SELECT user_name FROM user_account)
UNION SELECT author_id FROM comment
WHERE is_from_factory = 0 AND author_id NOT IN (SELECT user_name FROM user_account);
