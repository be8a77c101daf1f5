-- Policies and standing rules as documents of their own: every version is kept.
CREATE TABLE policy_version (
    policy_id TEXT NOT NULL,
    version INTEGER NOT NULL,
    document TEXT NOT NULL,
    changed_by TEXT NOT NULL,
    changed_at INTEGER NOT NULL,
    PRIMARY KEY (policy_id, version)
) STRICT, WITHOUT ROWID;

CREATE TABLE rule_version (
    rule_id TEXT NOT NULL,
    version INTEGER NOT NULL,
    document TEXT NOT NULL,
    changed_by TEXT NOT NULL,
    changed_at INTEGER NOT NULL,
    PRIMARY KEY (rule_id, version)
) STRICT, WITHOUT ROWID;

-- The policy that holds for everything one recipient gets; without one where policy_id is null. The newest version of
-- each recipient holds.
CREATE TABLE recipient_policy (
    recipient TEXT NOT NULL,
    version INTEGER NOT NULL,
    policy_id TEXT,
    changed_by TEXT NOT NULL,
    changed_at INTEGER NOT NULL,
    PRIMARY KEY (recipient, version)
) STRICT, WITHOUT ROWID;

-- What rules have decided by themselves.
CREATE TABLE rule_decision (
    id INTEGER PRIMARY KEY,
    field TEXT NOT NULL,
    action TEXT NOT NULL,
    -- The rules with their versions, as JSON.
    rules TEXT NOT NULL,
    -- The consent that the decision made.
    consent_version INTEGER NOT NULL,
    decided_at INTEGER NOT NULL,
    undone_by TEXT,
    undone_at INTEGER
) STRICT;
CREATE INDEX rule_decision_by_field ON rule_decision (field, consent_version);

-- Which rules gave a consent, and which named policy it took, as JSON.
ALTER TABLE consent ADD COLUMN grounds TEXT;
-- The same of the decision in force.
ALTER TABLE field ADD COLUMN grounds TEXT;
