//! Turns of members at a store: it has few readers and one writer, so that one person and one organisation use some of
//! the first and wait in a line of their own for the other, and the rest is there for everybody else.

use std::{num::NonZeroU64, time::Duration};

use axum::http::StatusCode;
use tokio::time::{Instant, timeout_at};

use super::{
    member::Member,
    refusals::{ShareOwner, count_refusal},
};
use crate::{
    turns::{Turn, Turns},
    web::problem::Problem,
};

/// Requests of one person that wait for their turn; a page has some ten.
const WAITING_MAX: usize = 100;
/// Longest time that a request waits for its turn.
const WAIT_MAX: Duration = Duration::from_secs(10);
/// Time after which another attempt makes sense.
const RETRY_AFTER: Duration = Duration::from_secs(2);

/// Use of a store that comes in turns.
#[derive(Debug)]
pub(super) struct TurnKind {
    /// Value of the metric's label `share`.
    label: &'static str,
    /// Code of the refusal.
    code: &'static str,
    /// Requests of one person at a time.
    of_person: usize,
    /// Requests of all people of an organisation at a time.
    of_organisation: usize,
    /// Longest time that a request waits for its turn.
    wait_max: Duration,
    /// Words for the requests and for what is done with them.
    words: [&'static str; 2],
}

/// Pages that are read.
pub(super) const READS: TurnKind = TurnKind {
    label: "reads",
    code: "TOO_MANY_READS",
    of_person: 2,
    of_organisation: 4,
    wait_max: WAIT_MAX,
    words: ["pages", "read"],
};

/// Changes at the one writer. A second of an organisation is prepared while the first is written.
pub(super) const CHANGES: TurnKind = TurnKind {
    label: "changes",
    code: "TOO_MANY_CHANGES",
    of_person: 1,
    of_organisation: 2,
    wait_max: WAIT_MAX,
    words: ["changes", "made"],
};

/// Turns of one kind, of all members.
#[derive(Debug)]
pub(super) struct MemberTurns {
    kind: &'static TurnKind,
    persons: Turns,
    organisations: Turns,
}

/// Turn of a request, which ends when this is dropped.
#[derive(Debug)]
pub struct MemberTurn {
    _of_person: Option<Turn>,
    _of_organisation: Option<Turn>,
}

impl MemberTurns {
    pub(super) fn new(kind: &'static TurnKind) -> Self {
        let (persons, organisations) =
            (Turns::new(kind.of_person), Turns::new(kind.of_organisation));
        Self { kind, persons, organisations }
    }

    /// Waits for the turn of a member's request. In the line of an organisation stand those alone that have the turn of
    /// their person, so that one of its people holds up no other.
    ///
    /// # Errors
    /// 429 where too many requests of the person wait, or where the turn does not come in time.
    pub(super) async fn take(&self, member: &Member) -> Result<MemberTurn, Problem> {
        let (person, end) = (member.person.as_str(), Instant::now() + self.kind.wait_max);
        let of_person = timeout_at(end, self.persons.take(person, WAITING_MAX)).await;
        let Ok(Some(of_person)) = of_person else {
            return Err(self.refused(ShareOwner::Person(person)));
        };
        let of_organisation = match &member.organisation {
            Some(id) => match timeout_at(end, self.organisations.take(id, usize::MAX)).await {
                Ok(turn) => turn,
                Err(_) => return Err(self.refused(ShareOwner::Organisation(id))),
            },
            None => None,
        };
        Ok(MemberTurn { _of_person: Some(of_person), _of_organisation: of_organisation })
    }

    /// Waits for the turn of a portion of an answer that has begun, however long. Answers that last are few: they have
    /// places of their own.
    pub(super) async fn wait(&self, member: &Member) -> MemberTurn {
        let of_person = self.persons.take(&member.person, usize::MAX).await;
        let of_organisation = match &member.organisation {
            Some(id) => self.organisations.take(id, usize::MAX).await,
            None => None,
        };
        MemberTurn { _of_person: of_person, _of_organisation: of_organisation }
    }

    fn refused(&self, owner: ShareOwner<'_>) -> Problem {
        count_refusal(self.kind.label, owner);
        let TurnKind { code, of_person, of_organisation, words: [what, done], .. } = self.kind;
        let detail = format!(
            "At most {of_person} {what} of a person and {of_organisation} of an organisation are {done} at the same \
             time, and the others wait; too many of yours or of your organisation's do, or they take too long."
        );
        Problem {
            retry_after_seconds: NonZeroU64::new(RETRY_AFTER.as_secs()),
            ..Problem::new(StatusCode::TOO_MANY_REQUESTS, code, detail)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use tokio::{task::JoinHandle, time::timeout};

    use super::*;

    fn member(person: &str, organisation: Option<&str>) -> Member {
        Member { person: person.to_owned(), organisation: organisation.map(str::to_owned) }
    }

    /// Takes a turn that is free; none where it has to be waited for.
    async fn free(
        turns: &MemberTurns,
        person: &str,
        organisation: Option<&str>,
    ) -> Option<MemberTurn> {
        let member = member(person, organisation);
        let taken = timeout(Duration::from_millis(100), turns.take(&member)).await;
        taken.ok().map(|turn| turn.expect("few wait"))
    }

    #[tokio::test]
    async fn a_person_and_its_organisation_leave_turns_to_others() {
        for kind in [&READS, &CHANGES] {
            let turns = MemberTurns::new(kind);
            let mut of_ann = Vec::new();
            for _ in 0..kind.of_person {
                of_ann.push(free(&turns, "ann", Some("a")).await.expect("free"));
            }
            assert!(free(&turns, "ann", Some("a")).await.is_none(), "all of a person");
            let mut of_amy = Vec::new();
            for _ in 0..kind.of_person {
                of_amy.push(free(&turns, "amy", Some("a")).await.expect("a colleague"));
            }
            assert!(free(&turns, "zoe", Some("a")).await.is_none(), "all of an organisation");
            let of_bob = free(&turns, "bob", Some("b")).await.expect("another organisation");
            let of_eve = free(&turns, "eve", None).await.expect("none at all");
            drop(of_ann.pop());
            let of_zoe = free(&turns, "zoe", Some("a")).await.expect("free again");
            drop((of_ann, of_amy, of_bob, of_eve, of_zoe));
        }
    }

    /// Lets as many of Ann's requests wait as may.
    async fn all_wait(turns: &Arc<MemberTurns>) -> Vec<JoinHandle<Result<(), Problem>>> {
        let waiting = (0..WAITING_MAX).map(|_| {
            let turns = Arc::clone(turns);
            tokio::spawn(async move { turns.take(&member("ann", Some("a"))).await.map(drop) })
        });
        let waiting = waiting.collect();
        // Each time some of those that were spawned come.
        for _ in 0..10 * WAITING_MAX {
            tokio::task::yield_now().await;
        }
        waiting
    }

    #[tokio::test]
    async fn who_waits_holds_up_no_colleague_and_has_its_turn() {
        for (kind, code) in [(&READS, "TOO_MANY_READS"), (&CHANGES, "TOO_MANY_CHANGES")] {
            let turns = Arc::new(MemberTurns::new(kind));
            let mut held = Vec::new();
            for _ in 0..kind.of_person {
                held.push(free(&turns, "ann", Some("a")).await.expect("free"));
            }
            let waiting = all_wait(&turns).await;
            let problem = turns.take(&member("ann", Some("a"))).await.expect_err("too many wait");
            assert_eq!((problem.status, &*problem.code), (429, code));
            drop(free(&turns, "amy", Some("a")).await.expect("a colleague"));
            let ann = member("ann", Some("a"));
            let portion = timeout(Duration::from_millis(50), turns.wait(&ann)).await;
            assert!(portion.is_err(), "it waits, too");
            drop(held);
            for one in waiting {
                one.await.expect("it ends").expect("its turn came");
            }
        }
    }

    #[tokio::test]
    async fn who_waits_too_long_is_refused_and_takes_no_turn() {
        const IMPATIENT: TurnKind = TurnKind { wait_max: Duration::from_millis(50), ..CHANGES };
        let turns = MemberTurns::new(&IMPATIENT);
        let of_ann = free(&turns, "ann", Some("a")).await.expect("free");
        let of_amy = free(&turns, "amy", Some("a")).await.expect("free");
        for person in ["ann", "zoe"] {
            let problem = turns.take(&member(person, Some("a"))).await.expect_err("none comes");
            assert_eq!((problem.status, &*problem.code), (429, "TOO_MANY_CHANGES"));
        }
        drop((of_ann, of_amy));
        assert!(free(&turns, "zoe", Some("a")).await.is_some());
    }
}
