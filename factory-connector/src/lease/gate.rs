//! Lets what waits leave, or not.

use parking_lot::Mutex;

/// Shared by the link's end, which asks, and the keeper of the lease, which opens and closes.
/// Closed at first.
#[derive(Debug, Default)]
pub struct LeaseGate(Mutex<Option<u64>>);

impl LeaseGate {
    /// What waits may leave under the lease with this number.
    pub fn open(&self, number: u64) {
        *self.0.lock() = Some(number);
    }

    /// Nothing may leave.
    pub fn close(&self) {
        *self.0.lock() = None;
    }

    /// The lease under which messages may leave; none where nothing may.
    #[must_use]
    pub fn number(&self) -> Option<u64> {
        *self.0.lock()
    }
}
