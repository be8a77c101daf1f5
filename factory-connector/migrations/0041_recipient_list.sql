-- Reports name their recipients from now on, in a member before their fields: every writer begins a new epoch. Reports that
-- wait keep theirs.
UPDATE identity SET must_begin_epochs = 1;
