//! Clock as an argument, so that tests can set the time.

use std::{fmt, sync::Arc, time::SystemTime};

use asi_model::DateTime;

use crate::opaque_id::OpaqueId;

/// Source of the current time. Clones share it.
#[derive(Clone)]
pub struct Clock(Arc<dyn Fn() -> DateTime + Send + Sync>);

impl Clock {
    /// Returns the machine's clock.
    #[expect(clippy::disallowed_methods, reason = "the clock of the platform")]
    #[must_use]
    pub fn system() -> Self {
        Self(Arc::new(|| SystemTime::now().into()))
    }

    /// Makes a clock that a test sets.
    #[must_use]
    pub fn from_fn(now: impl Fn() -> DateTime + Send + Sync + 'static) -> Self {
        Self(Arc::new(now))
    }

    /// Returns the time of this clock: the machine's, or the one that a test sets.
    #[must_use]
    pub fn now(&self) -> DateTime {
        (self.0)()
    }
}

impl fmt::Debug for Clock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Clock")
    }
}

/// Makes a random id of an access log or of an agent in it: 32 hexadecimal digits.
#[must_use]
pub fn new_access_id() -> String {
    uuid::Uuid::new_v4().simple().to_string()
}

/// Makes the random id of a row that members see.
#[must_use]
pub fn new_opaque_id() -> OpaqueId {
    OpaqueId::new(rand::random())
}

/// Makes a new message id: a UUIDv7, so that ids sort by time.
#[expect(clippy::disallowed_methods, reason = "the ids of the platform")]
#[must_use]
pub fn new_message_id() -> asi_model::MessageId {
    uuid::Uuid::now_v7().into()
}
