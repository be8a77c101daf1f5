//! Catalog of the variables of local servers: listed on request, cached for the session with a
//! server and at most 15 minutes.
//!
//! Suggestions and search look through the names of whole servers. Browsing an address space costs
//! a server time, so all requests of that period share one browse, and none is made unasked.

use std::{
    collections::HashMap,
    sync::Arc,
    time::{Duration, Instant},
};

use asi_model::DateTime;
use shop_floor::{ShopFloorError, ShopFloorHandle, SourceId, VariableList};
use tokio::{
    sync::{mpsc, watch},
    task::JoinSet,
    time::timeout,
};
use tokio_util::sync::CancellationToken;

use crate::clock::now;

/// Most nodes visited per server. A server may have millions; the search then says that its list is
/// incomplete.
pub const NODES_MAX: usize = 200_000;
/// Longest time to browse one server.
const BROWSE_TIMEOUT: Duration = Duration::from_secs(120);
/// Age beyond which a list is made again.
const AGE_MAX: Duration = Duration::from_secs(15 * 60);
/// Time after the start of a failed browse before another is tried. Several pages that wait for one
/// server must not each start a browse.
const RETRY_AFTER: Duration = Duration::from_secs(5);
/// Requests that wait for the service.
const REQUESTS_MAX: usize = 64;

/// Result of browsing one server.
#[derive(Debug, Clone)]
pub struct Listing {
    /// The server's variables; empty where browsing failed.
    pub list: Arc<VariableList>,
    pub listed_at: DateTime,
    /// Reason, as a sentence, for which there is no list.
    pub problem: Option<String>,
}

/// Service that browses servers and caches their lists. It answers while [`run`](Self::run) is
/// polled.
pub struct Catalog {
    shop_floor: ShopFloorHandle,
    requests: mpsc::Receiver<ListRequest>,
    lists: HashMap<SourceId, CachedList>,
}

/// Requests lists of the [`Catalog`].
#[derive(Clone)]
pub struct CatalogHandle {
    requests: mpsc::Sender<ListRequest>,
}

type ListingReceiver = watch::Receiver<Option<Listing>>;

struct ListRequest {
    source: SourceId,
    reply: tokio::sync::oneshot::Sender<ListingReceiver>,
}

/// One server's list, or the browse that makes it.
struct CachedList {
    answer: ListingReceiver,
    begun: Instant,
    /// Number of the session with the server in which it was made.
    sessions: u64,
}

impl Catalog {
    /// Makes a catalog of these servers, and its handle.
    #[must_use]
    pub fn new(shop_floor: ShopFloorHandle) -> (Self, CatalogHandle) {
        let (sender, requests) = mpsc::channel(REQUESTS_MAX);
        (Self { shop_floor, requests, lists: HashMap::new() }, CatalogHandle { requests: sender })
    }

    /// Answers requests until shutdown.
    pub async fn run(mut self, shutdown: CancellationToken) {
        let mut browses = JoinSet::new();
        loop {
            tokio::select! {
                () = shutdown.cancelled() => break,
                Some(ended) = browses.join_next() => if let Err(error) = ended {
                    tracing::error!(error = &error as &dyn std::error::Error, "Browsing a server failed.");
                },
                request = self.requests.recv() => match request {
                    // The caller may have gone; the browse goes on for the next one.
                    Some(ListRequest { source, reply }) => drop(reply.send(self.answer(source, &mut browses))),
                    None => break,
                },
            }
        }
        browses.shutdown().await;
    }

    fn answer(&mut self, source: SourceId, browses: &mut JoinSet<()>) -> ListingReceiver {
        let states = self.shop_floor.states();
        self.lists.retain(|id, _| states.iter().any(|status| status.source_id == *id));
        let sessions = states
            .iter()
            .find(|status| status.source_id == source)
            .map_or(0, |status| status.sessions);
        if let Some(cached) = self.lists.get(&source).filter(|cached| cached.is_fresh(sessions)) {
            return cached.answer.clone();
        }
        let (sender, answer) = watch::channel(None);
        browses.spawn(browse(self.shop_floor.clone(), source.clone(), sender));
        self.lists
            .insert(source, CachedList { answer: answer.clone(), begun: Instant::now(), sessions });
        answer
    }
}

impl CachedList {
    fn is_fresh(&self, sessions: u64) -> bool {
        let listing = self.answer.borrow();
        match &*listing {
            // A browse whose task panicked will never answer.
            None => self.answer.has_changed().is_ok(),
            Some(Listing { problem: Some(_), .. }) => self.begun.elapsed() < RETRY_AFTER,
            // A server that was connected again may have other nodes.
            Some(_) => self.sessions == sessions && self.begun.elapsed() < AGE_MAX,
        }
    }
}

async fn browse(
    shop_floor: ShopFloorHandle,
    source: SourceId,
    sender: watch::Sender<Option<Listing>>,
) {
    let browsed = timeout(BROWSE_TIMEOUT, shop_floor.variables(&source, NODES_MAX)).await;
    let (list, problem) = match browsed {
        Ok(Ok(list)) => (Arc::new(list), None),
        Ok(Err(error @ (ShopFloorError::UnknownSource(_) | ShopFloorError::NotConnected(_)))) => {
            (Arc::default(), Some(error.to_string()))
        }
        Ok(Err(error)) => {
            tracing::info!(source.id = %source, error = &error as &dyn std::error::Error, "A server's variables could not be listed.");
            (Arc::default(), Some(error.to_string()))
        }
        Err(_) => (
            Arc::default(),
            Some(format!("the server was not through within {} s", BROWSE_TIMEOUT.as_secs())),
        ),
    };
    sender.send_replace(Some(Listing { list, listed_at: now(), problem }));
}

impl CatalogHandle {
    /// Returns a server's list, waited for at most `patience`; `None` while it is being made.
    pub async fn list(&self, source: &SourceId, patience: Duration) -> Option<Listing> {
        let (reply, answer) = tokio::sync::oneshot::channel();
        self.requests.send(ListRequest { source: source.clone(), reply }).await.ok()?;
        let mut listing = answer.await.ok()?;
        timeout(patience, listing.wait_for(Option::is_some)).await.ok()?.ok()?.clone()
    }
}
