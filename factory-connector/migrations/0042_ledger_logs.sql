-- The log of each chain: a Merkle tree (RFC 6962) whose first leaf names the chain and whose further leaves are its entries.
CREATE TABLE ledger_log (
    recipient TEXT PRIMARY KEY,
    -- The text of the first leaf, JSON; empty until the connector has computed the log of a chain from before.
    start TEXT NOT NULL,
    -- Number of leaves, and the root over them.
    size INTEGER NOT NULL,
    root BLOB NOT NULL,
    -- The hashes of the largest perfect subtrees that cover all leaves: enough to append.
    leaves BLOB NOT NULL,
    -- The last checkpoint, a C2SP signed note.
    checkpoint TEXT NOT NULL
) STRICT, WITHOUT ROWID;
INSERT INTO ledger_log
WITH RECURSIVE chain (recipient) AS (
    SELECT min(recipient) FROM ledger_entry
    UNION ALL
    SELECT (SELECT min(recipient) FROM ledger_entry WHERE recipient > chain.recipient)
    FROM chain WHERE chain.recipient IS NOT NULL)
SELECT recipient, '', 0, x'', x'', '' FROM chain WHERE recipient IS NOT NULL
UNION SELECT recipient, '', 0, x'', x'', '' FROM ledger_head;
