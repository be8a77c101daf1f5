//! Sizes of requests: limits of the server and of this client.

use crate::ShopFloorError;

/// Most operations per request, also where the server declares no limit or a higher one.
const OPERATIONS_MAX: usize = 1000;
/// Most values in one request of a caller.
const VALUES_MAX: usize = 100_000;

/// Returns the number of operations that go into one request.
pub(super) fn per_request(server_limit: Option<u32>) -> usize {
    server_limit
        .map_or(OPERATIONS_MAX, |limit| usize::try_from(limit).unwrap_or(OPERATIONS_MAX))
        .clamp(1, OPERATIONS_MAX)
}

pub(super) fn check_count(count: usize) -> Result<(), ShopFloorError> {
    if count > VALUES_MAX {
        let what = "values in one request";
        return Err(ShopFloorError::LimitReached { what, limit: VALUES_MAX });
    }
    Ok(())
}
