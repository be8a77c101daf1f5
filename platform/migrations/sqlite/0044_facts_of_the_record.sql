-- Facts of who changed what, as a list: ids, roles and numbers, never a secret and never a value of a plant.
ALTER TABLE audit_entry ADD COLUMN detail TEXT NOT NULL DEFAULT '[]';
