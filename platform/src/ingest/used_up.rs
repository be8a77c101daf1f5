//! Count of the times at which a factory or tool had used a share up.

use daemon::web::shares::{ShareOwner, count_refusal};

use crate::store::Holder;

/// Counts that a sender has used a share up.
pub(super) fn count_used_up(share: &'static str, sender: &Holder) {
    let owner = match sender {
        Holder::Factory(id) => ShareOwner::Factory(id.as_str()),
        Holder::Tool(id) => ShareOwner::Tool(id.as_str()),
    };
    count_refusal(share, owner);
}
