//! Entrance of sign-ins: bounded waiting, and attempts that count before their password is checked.

use std::{
    net::IpAddr,
    num::NonZeroU64,
    time::{Duration, Instant},
};

use parking_lot::Mutex;
use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;

use super::{
    sign_in_places::SignInPlaces,
    throttle::{Attempt, Hindrance, LoginThrottle, ThrottleConfig},
};
use crate::web::{address_range::AddressRange, problem::Problem};

/// Longest wait for the outcome of other attempts.
const OUTCOME_WAIT_MAX: Duration = Duration::from_secs(10);
/// Time after which a place should be free again.
const RETRY_AFTER: Duration = Duration::from_secs(2);

/// Counts and bounds sign-ins.
pub(super) struct SignInGate {
    state: Mutex<GateState>,
    /// Notified at each outcome.
    outcome: Notify,
}

struct GateState {
    throttle: LoginThrottle,
    places: SignInPlaces,
}

/// A sign-in that was let in. Dropped without an outcome it counts as failed: the client has gone, and
/// what it would have learnt is nobody's knowledge.
pub(super) struct OpenSignIn<'g> {
    place: Place<'g>,
    attempt: Option<Attempt>,
}

/// A place that is free again when this is dropped.
struct Place<'g> {
    gate: &'g SignInGate,
    client: AddressRange,
    number: u64,
    /// Cancelled once another sign-in has this place.
    displaced: CancellationToken,
}

impl SignInGate {
    pub(super) fn new(config: ThrottleConfig) -> Self {
        let (throttle, places) = (LoginThrottle::new(config), SignInPlaces::default());
        let state = GateState { throttle, places };
        Self { state: Mutex::new(state), outcome: Notify::new() }
    }

    /// Lets an attempt in, once those before it have left enough to try.
    ///
    /// # Errors
    /// 429 after too many failures, 503 where too many wait.
    pub(super) async fn enter(
        &self,
        client: IpAddr,
        user_name: &str,
    ) -> Result<OpenSignIn<'_>, Problem> {
        let Some(place) = self.place(client, user_name) else { return Err(busy()) };
        let begin = tokio::time::timeout(OUTCOME_WAIT_MAX, self.begin(client, user_name));
        let began = tokio::select! {
            began = begin => began,
            () = place.displaced.cancelled() => return Err(busy()),
        };
        match began {
            Ok(Ok(attempt)) => Ok(OpenSignIn { place, attempt: Some(attempt) }),
            Ok(Err(wait)) => {
                count("throttled");
                Err(Problem::too_many("Too many attempts to sign in; wait a little.", wait))
            }
            Err(_) => Err(busy()),
        }
    }

    /// Notes that a user has signed in from a client before.
    pub(super) fn remember(&self, client: IpAddr, user_name: &str) {
        self.state.lock().throttle.remember(client, user_name, Instant::now());
    }

    fn place(&self, client: IpAddr, user_name: &str) -> Option<Place<'_>> {
        let mut state = self.state.lock();
        let is_stranger = !state.throttle.is_usual(client, user_name);
        let client = AddressRange::of_client(client);
        let (number, displaced) = state.places.take(client, is_stranger)?;
        Some(Place { gate: self, client, number, displaced })
    }

    /// Begins the attempt, or returns the time left to wait.
    async fn begin(&self, client: IpAddr, user_name: &str) -> Result<Attempt, Duration> {
        loop {
            let outcome = self.outcome.notified();
            let began = self.state.lock().throttle.begin(client, user_name, Instant::now());
            match began {
                Ok(attempt) => return Ok(attempt),
                Err(Hindrance::Wait(wait)) => return Err(wait),
                Err(Hindrance::Undecided) => outcome.await,
            }
        }
    }
}

impl OpenSignIn<'_> {
    /// Does work of the attempt, unless another sign-in takes its place meanwhile.
    ///
    /// # Errors
    /// Those of the work, and 503.
    pub(super) async fn unless_displaced<T>(
        &self,
        work: impl Future<Output = Result<T, Problem>>,
    ) -> Result<T, Problem> {
        tokio::select! {
            done = work => done,
            () = self.place.displaced.cancelled() => Err(busy()),
        }
    }

    /// Counts the attempt as right.
    pub(super) fn succeeded(self) {
        self.end(|throttle, attempt| throttle.succeeded(attempt, Instant::now()));
    }

    /// Gives the attempt back: what failed says nothing about the password.
    pub(super) fn withdrawn(self) {
        self.end(LoginThrottle::withdrawn);
    }

    fn end(mut self, outcome: impl FnOnce(&mut LoginThrottle, Attempt)) {
        if let Some(attempt) = self.attempt.take() {
            outcome(&mut self.place.gate.state.lock().throttle, attempt);
        }
    }
}

impl Drop for OpenSignIn<'_> {
    fn drop(&mut self) {
        let gate = self.place.gate;
        if let Some(attempt) = self.attempt.take() {
            gate.state.lock().throttle.failed(attempt, Instant::now());
        }
        gate.outcome.notify_waiters();
    }
}

impl Drop for Place<'_> {
    fn drop(&mut self) {
        self.gate.state.lock().places.release(&self.client, self.number);
    }
}

/// Counts a sign-in by its result.
pub(super) fn count(result: &'static str) {
    metrics::counter!("verbund_sign_ins_total", "result" => result).increment(1);
}

/// Returns the problem of a sign-in for which there is no place.
pub(super) fn busy() -> Problem {
    count("busy");
    Problem {
        retry_after_seconds: NonZeroU64::new(RETRY_AFTER.as_secs()),
        ..Problem::unavailable("BUSY", "Too many people are signing in; try again in a moment.")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn client(number: u8) -> IpAddr {
        IpAddr::from([192, 0, 2, number])
    }

    #[tokio::test]
    async fn four_clients_with_all_they_may_have_leave_a_place_to_a_fifth() {
        let gate = SignInGate::new(ThrottleConfig::default());
        let mut open = Vec::new();
        for number in 0..4 {
            for attempt in 0..16 {
                let user = format!("user{attempt}@{number}");
                open.extend(gate.enter(client(number), &user).await);
            }
        }
        let fifth = gate.enter(client(5), "ann").await.expect("a place");
        assert!(fifth.unless_displaced(std::future::ready(Ok(()))).await.is_ok());
        let mut ended = 0;
        for one in &open {
            let pending = one.unless_displaced(std::future::pending::<Result<(), Problem>>());
            let pending = tokio::time::timeout(Duration::from_millis(5), pending).await;
            ended += usize::from(pending.is_ok_and(|done| done.is_err()));
        }
        assert_eq!(open.len() + 1 - ended, 48, "those of strangers");
        fifth.succeeded();
        // From now on Ann is known there.
        for number in 10..80 {
            open.extend(gate.enter(client(number), &format!("eve{number}")).await);
        }
        assert!(gate.enter(client(99), "eve").await.is_err(), "no stranger has a place");
        assert!(gate.enter(client(5), "ann").await.is_ok());
    }
}
