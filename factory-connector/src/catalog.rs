//! Which variables the local servers have: listed when somebody asks, and kept while the session
//! lasts.
//!
//! Suggestions and search look through names of whole servers. Walking through an address space
//! takes a server's time, so it is done once per session and quarter of an hour, whoever asks
//! meanwhile, and never without being asked.

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

use crate::coordinator::now;

/// Most nodes visited per server.
pub const NODES_MAX: usize = 200_000;
/// Longest walk through one server.
const WALK_MAX: Duration = Duration::from_secs(120);
/// A list is made anew after so long.
const AGE_MAX: Duration = Duration::from_secs(15 * 60);
/// A walk that failed is tried again after so long.
const RETRY_AFTER: Duration = Duration::from_secs(5);
/// Questions that wait for the service.
const QUESTIONS_MAX: usize = 64;

/// What became of a walk through a server.
#[derive(Debug, Clone)]
pub struct Listing {
    /// Its variables; empty where it failed.
    pub list: Arc<VariableList>,
    /// When it ended.
    pub listed_at: DateTime,
    /// Why there is no list, in words.
    pub problem: Option<String>,
}

/// The service; [`run`](Self::run) it.
pub struct Catalog {
    shop_floor: ShopFloorHandle,
    questions: mpsc::Receiver<Question>,
    shelves: HashMap<SourceId, Shelf>,
}

/// Asks the [`Catalog`].
#[derive(Clone)]
pub struct CatalogHandle {
    questions: mpsc::Sender<Question>,
}

type Answer = watch::Receiver<Option<Listing>>;

struct Question {
    source: SourceId,
    reply: tokio::sync::oneshot::Sender<Answer>,
}

/// One server's list, or the walk that makes it.
struct Shelf {
    answer: Answer,
    begun: Instant,
    /// The session it was made in.
    sessions: u64,
}

impl Catalog {
    /// A catalog of these servers, and its handle.
    #[must_use]
    pub fn new(shop_floor: ShopFloorHandle) -> (Self, CatalogHandle) {
        let (sender, questions) = mpsc::channel(QUESTIONS_MAX);
        (
            Self { shop_floor, questions, shelves: HashMap::new() },
            CatalogHandle { questions: sender },
        )
    }

    /// Answers until shutdown.
    pub async fn run(mut self, shutdown: CancellationToken) {
        let mut walks = JoinSet::new();
        loop {
            tokio::select! {
                () = shutdown.cancelled() => break,
                Some(ended) = walks.join_next() => if let Err(error) = ended {
                    tracing::error!(error = &error as &dyn std::error::Error, "A walk through a server failed.");
                },
                question = self.questions.recv() => match question {
                    // Who asked may have gone; the walk goes on for the next one.
                    Some(Question { source, reply }) => drop(reply.send(self.answer(source, &mut walks))),
                    None => break,
                },
            }
        }
        walks.shutdown().await;
    }

    fn answer(&mut self, source: SourceId, walks: &mut JoinSet<()>) -> Answer {
        let states = self.shop_floor.states();
        self.shelves.retain(|id, _| states.iter().any(|status| status.source_id == *id));
        let sessions = states
            .iter()
            .find(|status| status.source_id == source)
            .map_or(0, |status| status.sessions);
        if let Some(shelf) = self.shelves.get(&source).filter(|shelf| shelf.is_fresh(sessions)) {
            return shelf.answer.clone();
        }
        let (sender, answer) = watch::channel(None);
        walks.spawn(walk(self.shop_floor.clone(), source.clone(), sender));
        self.shelves
            .insert(source, Shelf { answer: answer.clone(), begun: Instant::now(), sessions });
        answer
    }
}

impl Shelf {
    fn is_fresh(&self, sessions: u64) -> bool {
        let listing = self.answer.borrow();
        match &*listing {
            // A walk that died with its task leaves nobody who could answer.
            None => self.answer.has_changed().is_ok(),
            Some(Listing { problem: Some(_), .. }) => self.begun.elapsed() < RETRY_AFTER,
            Some(_) => self.sessions == sessions && self.begun.elapsed() < AGE_MAX,
        }
    }
}

async fn walk(
    shop_floor: ShopFloorHandle,
    source: SourceId,
    sender: watch::Sender<Option<Listing>>,
) {
    let walked = timeout(WALK_MAX, shop_floor.variables(&source, NODES_MAX)).await;
    let (list, problem) = match walked {
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
            Some(format!("the server was not through within {} s", WALK_MAX.as_secs())),
        ),
    };
    sender.send_replace(Some(Listing { list, listed_at: now(), problem }));
}

impl CatalogHandle {
    /// The list of a server, waited for no longer than `patience`; `None` while it is being made.
    pub async fn list(&self, source: &SourceId, patience: Duration) -> Option<Listing> {
        let (reply, answer) = tokio::sync::oneshot::channel();
        self.questions.send(Question { source: source.clone(), reply }).await.ok()?;
        let mut listing = answer.await.ok()?;
        timeout(patience, listing.wait_for(Option::is_some)).await.ok()?.ok()?.clone()
    }
}
