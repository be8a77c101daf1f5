//! Turns to read: a store has few readers, so that the pages of one person or one organisation hold some of them, and
//! the others are there for everybody else.

use std::{collections::HashMap, num::NonZeroU64, sync::Arc, time::Duration};

use axum::http::StatusCode;
use parking_lot::Mutex;
use tokio::{
    sync::{OwnedSemaphorePermit, Semaphore},
    time::timeout,
};

use crate::web::problem::Problem;

/// Requests of one person that read at a time.
const OF_A_PERSON: usize = 2;
/// Requests of all people of an organisation that read at a time.
const OF_AN_ORGANISATION: usize = 4;
/// Requests of one person that wait for their turn; a page has some ten.
const WAITING_MAX: usize = 100;
/// Longest time that a request waits for its turn.
const WAIT_MAX: Duration = Duration::from_secs(10);
/// Time after which another attempt makes sense.
const RETRY_AFTER: Duration = Duration::from_secs(2);

/// Turns of all; clones share them. People and organisations without a request are forgotten.
#[derive(Debug, Clone, Default)]
pub(super) struct ReadTurns(Arc<Mutex<Lines>>);

#[derive(Debug, Default)]
struct Lines {
    persons: HashMap<String, Line>,
    organisations: HashMap<String, Line>,
}

/// Requests of a person, or of an organisation, in the order in which they came.
#[derive(Debug)]
struct Line {
    turns: Arc<Semaphore>,
    /// Requests that have their turn or wait for it.
    requests: usize,
}

/// Turn to read, which ends when this is dropped.
#[derive(Debug)]
pub(super) struct ReadTurn {
    _permits: Vec<OwnedSemaphorePermit>,
    /// Dropped last: who is forgotten has no permits any more.
    _place: PlaceInLine,
}

/// Request in the line of its person and in that of the organisation.
#[derive(Debug)]
struct PlaceInLine {
    turns: ReadTurns,
    person: String,
    organisation: Option<String>,
}

impl ReadTurns {
    /// Waits for the turn of a person's request. In the line of an organisation stand those alone that have the turn of
    /// their person, so that one of its people holds up no other.
    ///
    /// # Errors
    /// 429 `TOO_MANY_READS` where too many requests of the person wait, or where the turn does not come in time.
    pub(super) async fn take(
        &self,
        person: &str,
        organisation: Option<&str>,
    ) -> Result<ReadTurn, Problem> {
        let (place, lines) = self.line_up(person, organisation).ok_or_else(refused)?;
        let permits = async move {
            let mut permits = Vec::with_capacity(lines.len());
            for line in lines {
                permits.push(line.acquire_owned().await.expect("a line is never closed"));
            }
            permits
        };
        let permits = timeout(WAIT_MAX, permits).await.map_err(|_| refused())?;
        Ok(ReadTurn { _permits: permits, _place: place })
    }

    /// Enters a request, and returns the lines in which it waits, one after the other; none where its person has too
    /// many.
    fn line_up(
        &self,
        person: &str,
        organisation: Option<&str>,
    ) -> Option<(PlaceInLine, Vec<Arc<Semaphore>>)> {
        let mut all = self.0.lock();
        let Lines { persons, organisations } = &mut *all;
        let of_person = persons.entry(person.to_owned()).or_insert_with(|| Line::of(OF_A_PERSON));
        if of_person.requests >= OF_A_PERSON + WAITING_MAX {
            return None;
        }
        let mut lines = vec![of_person.enter()];
        if let Some(id) = organisation {
            let of_organisation =
                organisations.entry(id.to_owned()).or_insert_with(|| Line::of(OF_AN_ORGANISATION));
            lines.push(of_organisation.enter());
        }
        let place = PlaceInLine {
            turns: self.clone(),
            person: person.to_owned(),
            organisation: organisation.map(str::to_owned),
        };
        Some((place, lines))
    }
}

impl Line {
    fn of(turns: usize) -> Self {
        Self { turns: Arc::new(Semaphore::new(turns)), requests: 0 }
    }

    fn enter(&mut self) -> Arc<Semaphore> {
        self.requests += 1;
        Arc::clone(&self.turns)
    }
}

impl Drop for PlaceInLine {
    fn drop(&mut self) {
        let mut all = self.turns.0.lock();
        leave(&mut all.persons, &self.person);
        if let Some(organisation) = &self.organisation {
            leave(&mut all.organisations, organisation);
        }
    }
}

fn leave(lines: &mut HashMap<String, Line>, name: &str) {
    let Some(line) = lines.get_mut(name) else { return };
    line.requests -= 1;
    if line.requests == 0 {
        lines.remove(name);
    }
}

fn refused() -> Problem {
    let detail = format!(
        "At most {OF_A_PERSON} pages of a person and {OF_AN_ORGANISATION} of an organisation are read at the same \
         time, and the others wait; too many of yours do."
    );
    Problem {
        retry_after_seconds: NonZeroU64::new(RETRY_AFTER.as_secs()),
        ..Problem::new(StatusCode::TOO_MANY_REQUESTS, "TOO_MANY_READS", detail)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Takes a turn that is free; none where it has to be waited for.
    async fn free(turns: &ReadTurns, person: &str, organisation: Option<&str>) -> Option<ReadTurn> {
        let taken = timeout(Duration::from_millis(100), turns.take(person, organisation)).await;
        taken.ok().map(|turn| turn.expect("few wait"))
    }

    #[tokio::test]
    async fn a_person_and_its_organisation_leave_turns_to_others() {
        let turns = ReadTurns::default();
        let first = free(&turns, "ann", Some("a")).await.expect("free");
        let second = free(&turns, "ann", Some("a")).await.expect("free");
        assert!(free(&turns, "ann", Some("a")).await.is_none(), "two of a person");
        let of_amy = free(&turns, "amy", Some("a")).await.expect("a colleague");
        let other_of_amy = free(&turns, "amy", Some("a")).await.expect("a colleague");
        assert!(free(&turns, "zoe", Some("a")).await.is_none(), "four of an organisation");
        let of_bob = free(&turns, "bob", Some("b")).await.expect("another organisation");
        let of_eve = free(&turns, "eve", None).await.expect("none at all");
        drop(first);
        let of_zoe = free(&turns, "zoe", Some("a")).await.expect("free again");
        drop((second, of_amy, other_of_amy, of_bob, of_eve, of_zoe));
        let all = turns.0.lock();
        assert!(all.persons.is_empty() && all.organisations.is_empty(), "{all:?}");
    }

    #[tokio::test]
    async fn who_waits_holds_up_no_colleague_and_has_its_turn_in_order() {
        let turns = ReadTurns::default();
        let mut held = Vec::new();
        for _ in 0..OF_A_PERSON {
            held.push(free(&turns, "ann", Some("a")).await.expect("free"));
        }
        let waiting: Vec<_> = (0..WAITING_MAX)
            .map(|_| {
                let turns = turns.clone();
                tokio::spawn(async move { turns.take("ann", Some("a")).await.map(drop) })
            })
            .collect();
        let all_wait = async {
            while turns.0.lock().persons["ann"].requests < OF_A_PERSON + WAITING_MAX {
                tokio::task::yield_now().await;
            }
        };
        timeout(Duration::from_secs(5), all_wait).await.expect("all wait");
        let problem = turns.take("ann", Some("a")).await.expect_err("too many wait");
        assert_eq!((problem.status, &*problem.code), (429, "TOO_MANY_READS"));
        drop(free(&turns, "amy", Some("a")).await.expect("a colleague"));
        drop(held);
        for one in waiting {
            one.await.expect("it ends").expect("its turn came");
        }
    }

    #[tokio::test]
    async fn who_gives_up_leaves_its_place() {
        let turns = ReadTurns::default();
        let first = free(&turns, "ann", Some("a")).await.expect("free");
        let second = free(&turns, "ann", Some("a")).await.expect("free");
        for _ in 0..3 {
            assert!(free(&turns, "ann", Some("a")).await.is_none());
        }
        assert_eq!(turns.0.lock().persons["ann"].requests, 2);
        drop((first, second));
        assert!(free(&turns, "ann", Some("a")).await.is_some());
    }
}
