-- Names of people who left a former version and are named by other records than those of 0045: of who read values, of whom
-- something was changed of, and of networks.
INSERT OR IGNORE INTO former_user (user_name)
SELECT name FROM (
    SELECT name FROM access_agent WHERE kind = 'USER'
    -- As users/anna and users/anna/second-factor.
    UNION SELECT substr(subject, 7, instr(substr(subject, 7) || '/', '/') - 1) FROM audit_entry WHERE subject LIKE 'users/_%'
    UNION SELECT updated_by FROM operation_network WHERE updated_by NOT LIKE 'tool.%'
    UNION SELECT created_by FROM operation_network_revision WHERE created_by NOT LIKE 'tool.%'
    UNION SELECT updated_by FROM seen_revision WHERE updated_by NOT LIKE 'tool.%'
)
WHERE name NOT IN (SELECT user_name FROM user_account);
