//! Requests under way of clients behind a proxy. Their connections are the proxy's, so that none of them
//! has a bound of its own there.

use std::{collections::HashMap, sync::Arc, time::Duration};

use axum::{
    extract::Request,
    middleware::Next,
    response::{IntoResponse, Response},
};
use parking_lot::Mutex;

use super::{address_range::AddressRange, held_body::HeldBody, problem::Problem};

/// Requests of one client under way, answers that are being sent included: as many as it would have
/// connections without the proxy.
const PER_CLIENT_MAX: usize = 256;
/// Time after which another attempt makes sense.
const RETRY_AFTER: Duration = Duration::from_secs(2);

/// Requests under way by client. Clones share them.
#[derive(Clone, Default)]
pub(super) struct InFlight(Arc<Mutex<HashMap<AddressRange, usize>>>);

/// Place of a request, free again once its answer has ended.
struct RequestPlace {
    of: InFlight,
    client: AddressRange,
}

impl InFlight {
    /// Serves a request of a client that has not too many of them.
    pub(super) async fn serve(
        &self,
        client: AddressRange,
        request: Request,
        next: Next,
    ) -> Response {
        let Some(place) = self.take(client) else {
            metrics::counter!("verbund_open_requests_refused_total").increment(1);
            let detail = "Too many requests of your address are under way; wait a little.";
            return Problem::too_many(detail, RETRY_AFTER).into_response();
        };
        next.run(request).await.map(|body| HeldBody::wrap(body, place))
    }

    fn take(&self, client: AddressRange) -> Option<RequestPlace> {
        let mut clients = self.0.lock();
        let count = clients.entry(client).or_default();
        if *count >= PER_CLIENT_MAX {
            return None;
        }
        *count += 1;
        Some(RequestPlace { of: self.clone(), client })
    }
}

impl Drop for RequestPlace {
    fn drop(&mut self) {
        let mut clients = self.of.0.lock();
        if let Some(count) = clients.get_mut(&self.client) {
            *count -= 1;
            if *count == 0 {
                clients.remove(&self.client);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_client_has_a_bounded_number_and_others_do_not_feel_it() {
        let of = InFlight::default();
        let client = |last| AddressRange::of_client([10, 0, 0, last].into());
        let held: Vec<_> = (0..1_000).map_while(|_| of.take(client(1))).collect();
        assert_eq!(held.len(), PER_CLIENT_MAX);
        assert!(of.take(client(2)).is_some());
        drop(held);
        assert!(of.0.lock().is_empty());
        assert!(of.take(client(1)).is_some());
    }
}
