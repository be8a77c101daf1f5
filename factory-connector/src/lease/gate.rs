//! Permission for the spool's messages to leave.

use parking_lot::Mutex;

/// Permission shared by the link's spool, which reads it, and the lease client, which opens and
/// closes it. Closed at first.
#[derive(Debug, Default)]
pub struct LeaseGate(Mutex<Option<u64>>);

impl LeaseGate {
    /// Permits messages to leave under the lease with this number.
    pub fn open(&self, number: u64) {
        *self.0.lock() = Some(number);
    }

    /// Forbids messages to leave.
    pub fn close(&self) {
        *self.0.lock() = None;
    }

    /// Returns the number of the lease under which messages may leave; `None` while closed.
    #[must_use]
    pub fn number(&self) -> Option<u64> {
        *self.0.lock()
    }
}
