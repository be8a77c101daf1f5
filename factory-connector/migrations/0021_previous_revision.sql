-- The revision before the one in force, so that an engineer sees what is new.
ALTER TABLE network ADD COLUMN previous_message TEXT;
