//! Share of requests without a session, by the address of the client: what anybody may ask costs little, and
//! not much of it at a time.

use std::{
    collections::HashMap,
    num::NonZeroU32,
    sync::Arc,
    time::{Duration, Instant},
};

use axum::{
    extract::{Request, State},
    middleware::Next,
    response::{IntoResponse, Response},
};
use parking_lot::Mutex;

use super::{bucket::Bucket, config::Rate};
use crate::web::{address_range::AddressRange, client_address::ClientAddress, problem::Problem};

/// Requests of one client. A plant with hundreds of people may be one.
const RATE: Rate = Rate::new(
    NonZeroU32::new(10).expect("it is no zero"),
    NonZeroU32::new(200).expect("it is no zero"),
);
/// Most clients that are counted; those that come beyond are as many as their connections permit.
const CLIENTS_MAX: usize = 10_000;
/// Pause between two searches for clients that can be forgotten.
const TIDY_INTERVAL: Duration = Duration::from_secs(1);

/// Requests of clients without a session. Clones share them.
#[derive(Clone, Default)]
pub(crate) struct StrangerShares(Arc<Mutex<Clients>>);

#[derive(Default)]
struct Clients {
    buckets: HashMap<AddressRange, Bucket>,
    tidied_at: Option<Instant>,
}

impl StrangerShares {
    /// Refuses a client whose share is spent, and takes nothing off it.
    pub(crate) fn check(&self, client: AddressRange, now: Instant) -> Result<(), Problem> {
        let clients = self.0.lock();
        let wait =
            clients.buckets.get(&client).map_or(Duration::ZERO, |bucket| bucket.wait(RATE, now));
        drop(clients);
        if wait > Duration::ZERO { Err(refused(wait)) } else { Ok(()) }
    }

    /// Takes a request off the share of its client.
    ///
    /// # Errors
    /// 429 `TOO_MANY_REQUESTS` where it is spent.
    pub(crate) fn take(&self, client: AddressRange, now: Instant) -> Result<(), Problem> {
        let mut clients = self.0.lock();
        clients.tidy(now);
        if clients.buckets.len() >= CLIENTS_MAX && !clients.buckets.contains_key(&client) {
            return Ok(());
        }
        let bucket = clients.buckets.entry(client).or_default();
        let wait = bucket.wait(RATE, now);
        if wait > Duration::ZERO {
            drop(clients);
            return Err(refused(wait));
        }
        bucket.take(RATE, now);
        Ok(())
    }
}

fn refused(wait: Duration) -> Problem {
    metrics::counter!("verbund_open_requests_refused_total").increment(1);
    Problem::too_many("Too many requests come from your address; wait a little.", wait)
}

impl Clients {
    /// Forgets clients whose buckets are full again.
    fn tidy(&mut self, now: Instant) {
        if self.tidied_at.is_none_or(|at| now.saturating_duration_since(at) >= TIDY_INTERVAL) {
            self.tidied_at = Some(now);
            self.buckets.retain(|_, bucket| !bucket.is_full(now));
        }
    }
}

/// Passes requests within the share of their client. For `axum::middleware::from_fn_with_state`.
pub(crate) async fn within_share_of_client(
    State(shares): State<StrangerShares>,
    address: ClientAddress,
    request: Request,
    next: Next,
) -> Response {
    match shares.take(AddressRange::of_client(address.0), Instant::now()) {
        Ok(()) => next.run(request).await,
        Err(problem) => problem.into_response(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn client(number: u32) -> AddressRange {
        AddressRange::of_client(std::net::IpAddr::from(number.to_be_bytes()))
    }

    /// Asks until refused.
    fn asked(shares: &StrangerShares, number: u32, now: Instant) -> usize {
        (0..1_000).take_while(|_| shares.take(client(number), now).is_ok()).count()
    }

    #[test]
    fn a_client_asks_so_often_and_others_do_not_feel_it() {
        let (shares, now) = (StrangerShares::default(), Instant::now());
        assert_eq!(asked(&shares, 1, now), 200);
        assert_eq!(asked(&shares, 2, now), 200);
        assert_eq!(asked(&shares, 1, now + Duration::from_secs(1)), 10);
        assert_eq!(asked(&shares, 1, now + Duration::from_secs(3_600)), 200);
    }

    #[test]
    fn clients_are_forgotten_and_bounded() {
        let (shares, now) = (StrangerShares::default(), Instant::now());
        for number in 0..20_000 {
            assert!(shares.take(client(number), now).is_ok());
        }
        assert_eq!(shares.0.lock().buckets.len(), CLIENTS_MAX);
        let later = now + Duration::from_secs(60);
        assert!(shares.take(client(1), later).is_ok());
        assert_eq!(shares.0.lock().buckets.len(), 1);
    }
}
