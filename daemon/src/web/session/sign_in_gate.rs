//! Entrance of sign-ins: bounded waiting, and attempts that count before their password is checked.

use std::{
    collections::HashMap,
    net::IpAddr,
    num::NonZeroU64,
    time::{Duration, Instant},
};

use parking_lot::Mutex;
use tokio::sync::Notify;

use super::throttle::{Attempt, Hindrance, LoginThrottle, ThrottleConfig};
use crate::web::{address_range::AddressRange, problem::Problem};

/// Sign-ins under way or waiting at once.
const PLACES_MAX: usize = 64;
/// Share of one client's addresses, so that no single one keeps all others out.
const PLACES_PER_CLIENT_MAX: usize = 16;
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
    /// Places taken, by client.
    taken: HashMap<AddressRange, usize>,
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
}

impl SignInGate {
    pub(super) fn new(config: ThrottleConfig) -> Self {
        let state = GateState { throttle: LoginThrottle::new(config), taken: HashMap::new() };
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
        let Some(place) = self.place(client) else { return Err(busy()) };
        let begin = self.begin(client, user_name);
        match tokio::time::timeout(OUTCOME_WAIT_MAX, begin).await {
            Ok(Ok(attempt)) => Ok(OpenSignIn { place, attempt: Some(attempt) }),
            Ok(Err(wait)) => {
                count("throttled");
                Err(Problem::too_many("Too many attempts to sign in; wait a little.", wait))
            }
            Err(_) => Err(busy()),
        }
    }

    fn place(&self, client: IpAddr) -> Option<Place<'_>> {
        let client = AddressRange::of_client(client);
        let taken = &mut self.state.lock().taken;
        let own = taken.get(&client).copied().unwrap_or(0);
        if own >= PLACES_PER_CLIENT_MAX || taken.values().sum::<usize>() >= PLACES_MAX {
            return None;
        }
        taken.insert(client, own + 1);
        Some(Place { gate: self, client })
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
        let taken = &mut self.gate.state.lock().taken;
        if let Some(own) = taken.get_mut(&self.client) {
            *own -= 1;
            if *own == 0 {
                taken.remove(&self.client);
            }
        }
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
