-- Passwords sealed under a key outside of the store. The columns in plain text are emptied at the first start, which has
-- the key; they stay for stores of before only.
ALTER TABLE enrolment ADD COLUMN sealed_password TEXT;
ALTER TABLE source ADD COLUMN sealed_password TEXT;
