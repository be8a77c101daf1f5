//! Signs of factories' lives for pages.
//!
//! Arrivals follow values: who knows when a report came concludes when something happened at the
//! machine. So the factory's own organisation hears of each arrival, and all others of signs alone
//! that come without regard to values, by the minute.

use std::{
    collections::HashMap,
    time::{Duration, Instant},
};

use asi_model::{DateTime, FactoryId};
use parking_lot::Mutex;

use crate::{
    live::{LiveEvent, Notification},
    store::{Heard, Store, StoreError},
};

/// Time between two events for the factory's own organisation.
const OWN_INTERVAL: Duration = Duration::from_secs(1);

/// Factories with what pages know of each.
#[derive(Debug, Default)]
pub(super) struct SignsOfLife(Mutex<HashMap<FactoryId, Published>>);

/// Last events about a factory.
#[derive(Debug, Default)]
struct Published {
    /// Time of the last event for its own organisation.
    own_at: Option<Instant>,
    /// Minute and state of the last event for others.
    sign: Option<(DateTime, Option<&'static str>)>,
}

impl Published {
    /// Notes an event for its own organisation; returns false where the last one is too recent.
    fn take_own(&mut self, heard: &Heard, now: Instant) -> bool {
        let is_due = heard.publisher_state.is_some()
            || self.own_at.is_none_or(|at| now.duration_since(at) >= OWN_INTERVAL);
        if is_due {
            self.own_at = Some(now);
        }
        is_due
    }

    /// Notes an event for others, and returns its time; `None` where they know the same already.
    fn take_sign(&mut self, heard: &Heard) -> Option<DateTime> {
        let sign_at = heard.sign_at?;
        let (known_at, known_state) = self.sign.unzip();
        let state = heard.publisher_state.or(known_state.flatten());
        let sign = Some((sign_at, state));
        if known_at.is_some() && sign == self.sign {
            return None;
        }
        self.sign = sign;
        Some(sign_at)
    }
}

impl SignsOfLife {
    /// Makes the events that are due after something of a factory arrived.
    ///
    /// # Errors
    /// [`StoreError`].
    pub(super) async fn events(
        &self,
        store: &Store,
        factory_id: FactoryId,
        heard: Heard,
    ) -> Result<Vec<Notification>, StoreError> {
        let (is_own_due, sign_at) = {
            let mut published = self.0.lock();
            let published = published.entry(factory_id.clone()).or_default();
            (published.take_own(&heard, Instant::now()), published.take_sign(&heard))
        };
        let own_at = heard.at.filter(|_| is_own_due);
        if own_at.is_none() && sign_at.is_none() {
            return Ok(Vec::new());
        }
        let mut work = store.reserved_reader().read().await?;
        let (own, others) = work.factories().concerned(&factory_id).await?;
        drop(work);
        let event = |last_seen_at: DateTime| LiveEvent::Factory {
            factory_id: factory_id.clone(),
            last_seen_at,
            publisher_state: heard.publisher_state.map(str::to_owned),
        };
        let for_own = own_at.map(|at| {
            let mut notification = event(at).to(own);
            // Administrators of other organisations hear what others hear.
            notification.is_structure = false;
            notification
        });
        Ok(for_own.into_iter().chain(sign_at.map(|at| event(at).to(others))).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(sign_minute: Option<i64>, publisher_state: Option<&'static str>) -> Heard {
        let at = |minute: i64| DateTime::from_unix_micros(minute * 60_000_000);
        let sign_at = sign_minute.map(at);
        Heard { at: Some(at(9)), report_at: None, sign_at, publisher_state }
    }

    #[test]
    fn others_hear_of_a_new_minute_or_state_alone() {
        let mut published = Published::default();
        let mut is_sent = |heard: &Heard| published.take_sign(heard).is_some();
        assert!(!is_sent(&heard(None, None)), "a report is no sign");
        assert!(is_sent(&heard(Some(1), None)));
        assert!(!is_sent(&heard(Some(1), None)));
        assert!(is_sent(&heard(Some(1), Some("Paused"))));
        assert!(!is_sent(&heard(Some(1), Some("Paused"))));
        assert!(!is_sent(&heard(Some(1), None)), "the state is still known");
        assert!(is_sent(&heard(Some(2), None)));
        assert!(!is_sent(&heard(None, None)));
    }

    #[test]
    fn its_own_organisation_hears_of_each_second() {
        let mut published = Published::default();
        let now = Instant::now();
        assert!(published.take_own(&heard(None, None), now));
        assert!(!published.take_own(&heard(None, None), now));
        assert!(published.take_own(&heard(None, Some("Paused")), now));
        assert!(published.take_own(&heard(None, None), now + OWN_INTERVAL));
    }
}
