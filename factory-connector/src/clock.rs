//! Clock and random numbers of this machine, for the state, which has neither.

use std::time::Duration;

use asi_model::{DateTime, MessageId};
use connector_state::{IdSource, operator::EntryId};
use ledger::SALT_BYTES;
use rand::RngCore as _;

/// Returns a new message id, of random bytes: it tells no time.
#[must_use]
pub fn new_message_id() -> MessageId {
    let mut random = [0; 16];
    rand::rng().fill_bytes(&mut random);
    MessageId::from(uuid::Builder::from_random_bytes(random).into_uuid())
}

/// Returns the id of an operator entry that the API makes, ordered by time. It leaves in no message.
pub(crate) fn new_entry_id() -> EntryId {
    EntryId::try_from(new_uuid().to_string()).expect("a UUID is an id")
}

/// Returns the id of a preview, ordered by time. It leaves in no message.
pub(crate) fn new_preview_id() -> String {
    new_uuid().to_string()
}

#[expect(clippy::disallowed_methods, reason = "ids within the connector")]
fn new_uuid() -> uuid::Uuid {
    uuid::Uuid::now_v7()
}

/// Step of the connector's clock. What partners read of its times, in reports and in the ledger, is no
/// finer.
const STEP: Duration = Duration::from_millis(1);

/// Reads the machine's clock.
#[expect(clippy::disallowed_methods, reason = "the clock of the connector")]
#[must_use]
pub fn now() -> DateTime {
    DateTime::from(std::time::SystemTime::now()).floor_to(STEP)
}

/// Returns random bytes for the hashes of a report.
pub(crate) fn salt() -> [u8; SALT_BYTES] {
    let mut salt = [0; SALT_BYTES];
    rand::rng().fill_bytes(&mut salt);
    salt
}

/// Returns a source of ids that never repeats those of another run.
pub(crate) fn id_source() -> IdSource {
    let mut seed = [0; 32];
    rand::rng().fill_bytes(&mut seed);
    IdSource::new(seed)
}
