//! Entrance of sign-ins: bounded waiting, and attempts that count before their password is checked.

use std::{
    collections::HashSet,
    net::IpAddr,
    num::NonZeroU64,
    time::{Duration, Instant},
};

use parking_lot::Mutex;
use tokio::sync::{Notify, Semaphore};
use tokio_util::sync::CancellationToken;

use super::{
    sign_in_places::{NoPlace, SignInPlaces},
    throttle::{Attempt, Hindrance, LoginThrottle, ThrottleConfig},
};
use crate::web::{address_range::AddressRange, problem::Problem};

/// Longest wait for the outcome of other attempts.
const OUTCOME_WAIT_MAX: Duration = Duration::from_secs(10);
/// Longest wait for a place.
const PLACE_WAIT_MAX: Duration = Duration::from_secs(10);
/// Networks that wait for a place at once, each with one sign-in. At fifty in a second, the last one has waited for five.
const LINE_MAX: usize = 256;
/// Time after which a place should be free again.
const RETRY_AFTER: Duration = Duration::from_secs(2);

/// Counts and bounds sign-ins.
pub(super) struct SignInGate {
    state: Mutex<GateState>,
    /// Notified at each outcome.
    outcome: Notify,
    /// Notified where a place is free again.
    freed: Notify,
    /// Permit of the first in the line for a place.
    first_in_line: Semaphore,
}

struct GateState {
    throttle: LoginThrottle,
    places: SignInPlaces,
    /// Networks that wait for a place.
    line: HashSet<AddressRange>,
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

/// A network in the line, which it leaves when this is dropped.
struct WaitingNetwork<'g> {
    gate: &'g SignInGate,
    network: AddressRange,
}

impl SignInGate {
    pub(super) fn new(config: ThrottleConfig) -> Self {
        let (throttle, places) = (LoginThrottle::new(config), SignInPlaces::default());
        let state = GateState { throttle, places, line: HashSet::new() };
        Self {
            state: Mutex::new(state),
            outcome: Notify::new(),
            freed: Notify::new(),
            first_in_line: Semaphore::new(1),
        }
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
        let place = self.place(client, user_name).await.map_err(|_| busy())?;
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

    /// Takes a place, in a line where each network has one already: else a few networks that come again and again would
    /// keep all others out.
    async fn place(&self, client: IpAddr, user_name: &str) -> Result<Place<'_>, NoPlace> {
        match self.free_place(client, user_name, false) {
            Err(NoPlace::Full) => {}
            taken_or_not => return taken_or_not,
        }
        let _in_line = self.stand_in_line(client)?;
        let next = self.next_place(client, user_name);
        tokio::time::timeout(PLACE_WAIT_MAX, next).await.unwrap_or(Err(NoPlace::Full))
    }

    /// Waits until all before have left the line, and for a place then.
    async fn next_place(&self, client: IpAddr, user_name: &str) -> Result<Place<'_>, NoPlace> {
        let _first = self.first_in_line.acquire().await.map_err(|_| NoPlace::Full)?;
        loop {
            let freed = self.freed.notified();
            match self.free_place(client, user_name, true) {
                Err(NoPlace::Full) => freed.await,
                taken_or_not => return taken_or_not,
            }
        }
    }

    fn free_place(
        &self,
        client: IpAddr,
        user_name: &str,
        is_first: bool,
    ) -> Result<Place<'_>, NoPlace> {
        let mut state = self.state.lock();
        let is_stranger = !state.throttle.is_usual(client, user_name);
        // A free place is for those who wait. Who comes of a network with fewer places than others takes one of those.
        let is_behind = is_stranger && !is_first && !state.line.is_empty();
        if is_behind && !state.places.is_full(is_stranger) {
            return Err(NoPlace::Full);
        }
        let client = AddressRange::of_client(client);
        let (number, displaced) = state.places.take(client, is_stranger)?;
        Ok(Place { gate: self, client, number, displaced })
    }

    fn stand_in_line(&self, client: IpAddr) -> Result<WaitingNetwork<'_>, NoPlace> {
        let network = AddressRange::of_client(client).network();
        let mut state = self.state.lock();
        if state.line.len() >= LINE_MAX || !state.line.insert(network) {
            return Err(NoPlace::Full);
        }
        Ok(WaitingNetwork { gate: self, network })
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
        self.gate.freed.notify_waiters();
    }
}

impl Drop for WaitingNetwork<'_> {
    fn drop(&mut self) {
        self.gate.state.lock().line.remove(&self.network);
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

    /// Lets an attempt in; none where it waits in the line, or is refused.
    async fn enter<'g>(gate: &'g SignInGate, number: u8, user: &str) -> Option<OpenSignIn<'g>> {
        let entered = gate.enter(client(number), user);
        tokio::time::timeout(Duration::from_millis(5), entered).await.ok()?.ok()
    }

    #[tokio::test]
    async fn four_clients_with_all_they_may_have_leave_a_place_to_a_fifth() {
        let gate = SignInGate::new(ThrottleConfig::default());
        let mut open = Vec::new();
        for number in 0..4 {
            for attempt in 0..16 {
                open.extend(enter(&gate, number, &format!("user{attempt}@{number}")).await);
            }
        }
        let mut waiting = Box::pin(gate.enter(client(3), "eve"));
        let waits = tokio::time::timeout(Duration::from_millis(5), &mut waiting).await;
        assert!(waits.is_err(), "its network has as many as the others");
        let fifth = tokio::time::timeout(Duration::from_secs(5), gate.enter(client(5), "ann"));
        let fifth = fifth.await.expect("before those who wait").expect("a place");
        drop(waiting);
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
            open.extend(enter(&gate, number, &format!("eve{number}")).await);
        }
        assert!(enter(&gate, 99, "eve").await.is_none(), "no stranger has a place");
        assert!(gate.enter(client(5), "ann").await.is_ok());
    }

    #[tokio::test]
    async fn forty_eight_networks_with_a_place_each_keep_no_stranger_out() {
        let moment = Duration::from_millis(20);
        let gate = SignInGate::new(ThrottleConfig::default());
        let mut open = Vec::new();
        for number in 0..48 {
            open.push(enter(&gate, number, &format!("eve{number}")).await.expect("a place"));
        }
        let mut ann = Box::pin(gate.enter(client(200), "ann"));
        assert!(tokio::time::timeout(moment, &mut ann).await.is_err(), "she waits in the line");
        let mut eve = Box::pin(gate.enter(client(1), "eve"));
        assert!(tokio::time::timeout(moment, &mut eve).await.is_err(), "behind her");
        assert!(gate.enter(client(1), "mallory").await.is_err(), "one of a network");
        drop(open.pop());
        assert!(tokio::time::timeout(moment, &mut eve).await.is_err(), "it is not her turn");
        let entered = tokio::time::timeout(Duration::from_secs(5), ann).await;
        let ann = entered.expect("it is Ann's").expect("a place");
        drop(open.pop());
        let entered = tokio::time::timeout(Duration::from_secs(5), eve).await;
        let eve = entered.expect("the next one").expect("a place");
        drop((ann, eve, open));
        let state = gate.state.lock();
        assert!(state.line.is_empty());
    }

    #[tokio::test]
    async fn who_gives_up_in_the_line_holds_up_nobody() {
        let gate = SignInGate::new(ThrottleConfig::default());
        let mut open = Vec::new();
        for number in 0..48 {
            open.push(enter(&gate, number, &format!("eve{number}")).await.expect("a place"));
        }
        assert!(enter(&gate, 200, "bob").await.is_none(), "he waits, and goes");
        drop(open.pop());
        assert!(enter(&gate, 201, "ann").await.is_some());
    }
}
