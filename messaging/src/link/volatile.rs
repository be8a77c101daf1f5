//! Ids of messages that do not come from the spool.

use crate::spool::RowId;

/// First id of such messages; the others follow downwards.
pub(super) const VOLATILE_FROM: RowId = RowId(-1);

/// True for messages that do not come from the spool.
pub(super) fn is_volatile(id: RowId) -> bool {
    id <= VOLATILE_FROM
}
