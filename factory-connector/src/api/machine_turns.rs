//! Turns at local servers: what people look at there takes little of a machine that has a plant to run, and what one
//! person looks at does not hold up the others.

use std::{collections::HashMap, sync::Arc, time::Duration};

use daemon::web::{
    Problem,
    shares::{ShareOwner, count_refusal},
};
use parking_lot::Mutex;
use shop_floor::SourceId;
use tokio::{
    sync::{OwnedSemaphorePermit, Semaphore},
    time::{Instant, sleep_until, timeout},
};

/// Requests to one server at a time.
const AT_A_TIME: usize = 2;
/// Time that a turn takes at least, so that a server gets 20 requests a second.
const TURN_MIN: Duration = Duration::from_millis(100);
/// Requests of one person to one server at a time, those that wait for their turn included.
const OF_A_PERSON_MAX: usize = 4;
/// Longest time that a request waits for its turn.
const WAIT_MAX: Duration = Duration::from_secs(10);
/// Time after which another attempt makes sense.
const RETRY_AFTER: Duration = Duration::from_secs(1);

/// Turns of all servers; clones share them. Servers and people without a request are forgotten.
#[derive(Clone, Default)]
pub(super) struct MachineTurns(Arc<Mutex<HashMap<Machine, OfServer>>>);

/// Server that has turns. All that are no source yet have them together: an address is quickly given, and asking many at
/// a time would be a search of the plant's network.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Machine {
    Source(SourceId),
    Unsaved,
}

impl Machine {
    /// Says that a person asks too much of it.
    const fn asked_too_much(&self) -> &'static str {
        match self {
            Self::Source(_) => {
                "You look at too much of this server at a time; wait until some of it is there."
            }
            Self::Unsaved => {
                "You ask too many servers at a time that are not saved yet; wait until one has answered."
            }
        }
    }

    /// Says that the turn of a request did not come in time.
    const fn has_no_turn(&self) -> &'static str {
        match self {
            Self::Source(_) => "The server is slow, and others look at it; try again in a moment.",
            Self::Unsaved => {
                "Servers that are not saved yet are asked one after the other, and those before this one are slow; try \
                 again in a moment."
            }
        }
    }
}

struct OfServer {
    turns: Arc<Semaphore>,
    /// Requests of each person.
    persons: HashMap<String, usize>,
}

impl Default for OfServer {
    fn default() -> Self {
        Self { turns: Arc::new(Semaphore::new(AT_A_TIME)), persons: HashMap::new() }
    }
}

/// Turn at a server, which ends when this is dropped.
pub(super) struct MachineTurn {
    permit: Option<OwnedSemaphorePermit>,
    place: Option<Place>,
    ends_not_before: Instant,
}

/// Request of a person among those of its server.
struct Place {
    turns: MachineTurns,
    machine: Machine,
    person: String,
}

impl MachineTurns {
    /// Waits for the turn of a person's request.
    ///
    /// # Errors
    /// 429 `TOO_MANY_REQUESTS` where the person has too many requests to this server, or where the turn does not come in
    /// time.
    pub async fn take(&self, source: &SourceId, person: &str) -> Result<MachineTurn, Problem> {
        self.take_of(Machine::Source(source.clone()), person).await
    }

    /// Waits for the turn of a person's request to a server that is no source yet.
    ///
    /// # Errors
    /// As [`Self::take`].
    pub async fn take_unsaved(&self, person: &str) -> Result<MachineTurn, Problem> {
        self.take_of(Machine::Unsaved, person).await
    }

    async fn take_of(&self, machine: Machine, person: &str) -> Result<MachineTurn, Problem> {
        let refused = |owner, detail| {
            count_refusal("machine_requests", owner);
            Problem::too_many(detail, RETRY_AFTER)
        };
        let (too_much, no_turn) = (machine.asked_too_much(), machine.has_no_turn());
        let (place, turns) = self
            .place(machine, person)
            .ok_or_else(|| refused(ShareOwner::Person(person), too_much))?;
        // The turns of a server are those of all who look at it.
        let permit = timeout(WAIT_MAX, turns.acquire_owned()).await;
        let permit = permit.map_err(|_| refused(ShareOwner::All, no_turn))?;
        let permit = permit.expect("the semaphore is never closed");
        let ends_not_before = Instant::now() + TURN_MIN;
        Ok(MachineTurn { permit: Some(permit), place: Some(place), ends_not_before })
    }

    fn place(&self, machine: Machine, person: &str) -> Option<(Place, Arc<Semaphore>)> {
        let mut servers = self.0.lock();
        let server = servers.entry(machine.clone()).or_default();
        let count = server.persons.entry(person.to_owned()).or_default();
        if *count >= OF_A_PERSON_MAX {
            return None;
        }
        *count += 1;
        let turns = Arc::clone(&server.turns);
        let place = Place { turns: self.clone(), machine, person: person.to_owned() };
        Some((place, turns))
    }
}

impl Drop for MachineTurn {
    fn drop(&mut self) {
        let (permit, place, end) = (self.permit.take(), self.place.take(), self.ends_not_before);
        if Instant::now() < end {
            // The answer does not wait for the end of its turn.
            tokio::spawn(async move {
                sleep_until(end).await;
                drop((permit, place));
            });
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut servers = self.turns.0.lock();
        let Some(server) = servers.get_mut(&self.machine) else { return };
        if let Some(count) = server.persons.get_mut(&self.person) {
            *count -= 1;
            if *count == 0 {
                server.persons.remove(&self.person);
            }
        }
        if server.persons.is_empty() {
            servers.remove(&self.machine);
        }
    }
}

#[cfg(test)]
mod tests;
