//! Results of use cases, taken apart into value and changes.

use crate::ChangeSet;

/// Result of a use case: changes, with or without a value, that may have failed. A failed use case
/// has no changes.
pub trait IntoChanges {
    /// The value for the caller.
    type Value;

    /// Returns the value for the caller and the changes to commit; no changes where the use case
    /// failed, so that its caller need not wait for a commit.
    fn into_changes(self) -> (Self::Value, Option<ChangeSet>);
}

impl IntoChanges for ChangeSet {
    type Value = ();

    fn into_changes(self) -> ((), Option<ChangeSet>) {
        ((), Some(self))
    }
}

impl<T> IntoChanges for (T, ChangeSet) {
    type Value = T;

    fn into_changes(self) -> (T, Option<ChangeSet>) {
        let (value, changes) = self;
        (value, Some(changes))
    }
}

impl<R: IntoChanges, E> IntoChanges for Result<R, E> {
    type Value = Result<R::Value, E>;

    fn into_changes(self) -> (Self::Value, Option<ChangeSet>) {
        match self {
            Ok(result) => {
                let (value, changes) = result.into_changes();
                (Ok(value), changes)
            }
            Err(error) => (Err(error), None),
        }
    }
}
