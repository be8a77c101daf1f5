use super::*;
use crate::web::shares::{OrganisationShare, PersonShare};

fn number(value: u32) -> NonZeroU32 {
    NonZeroU32::new(value).expect("not zero")
}

/// Shares of 4 requests of a person and 6 of an organisation, one of each back in a second.
fn shares() -> FairShares {
    FairShares::new(FairShareConfig {
        person: PersonShare {
            requests_per_second: number(1),
            requests_at_once: number(4),
            downloads: number(2),
            streams: number(2),
            body_mib: number(2),
        },
        organisation: OrganisationShare {
            requests_per_second: number(1),
            requests_at_once: number(6),
            downloads: number(3),
            streams: number(3),
            body_mib: number(3),
        },
    })
}

fn member(person: &str, organisation: Option<&str>) -> Member {
    Member { person: person.to_owned(), organisation: organisation.map(str::to_owned) }
}

/// Sends requests until one is refused, and returns how many passed.
fn exhaust(shares: &FairShares, member: &Member, now: Instant) -> usize {
    (0..100).take_while(|_| shares.take_request(member, now).is_ok()).count()
}

#[test]
fn a_person_has_a_share_and_so_has_its_organisation() {
    let (shares, now) = (shares(), Instant::now());
    assert_eq!(exhaust(&shares, &member("ann", Some("a")), now), 4);
    assert_eq!(exhaust(&shares, &member("amy", Some("a")), now), 2, "what Ann left of the six");
    assert_eq!(exhaust(&shares, &member("bob", Some("b")), now), 4, "another organisation");
    assert_eq!(exhaust(&shares, &member("eve", None), now), 4, "none at all");
}

#[test]
fn requests_come_back_with_time_and_the_answer_says_when() {
    let (shares, now) = (shares(), Instant::now());
    let ann = member("ann", None);
    assert_eq!(exhaust(&shares, &ann, now), 4);
    let problem = shares.take_request(&ann, now).expect_err("used up");
    assert_eq!((problem.status, &*problem.code), (429, "TOO_MANY_REQUESTS"));
    assert_eq!(problem.retry_after_seconds.map(NonZeroU64::get), Some(1));
    assert_eq!(exhaust(&shares, &ann, now + Duration::from_secs(2)), 2);
    assert_eq!(exhaust(&shares, &ann, now + Duration::from_secs(60)), 4, "never more than at once");
}

#[test]
fn what_was_refused_takes_nothing_off_the_organisation() {
    let (shares, now) = (shares(), Instant::now());
    let ann = member("ann", Some("a"));
    exhaust(&shares, &ann, now);
    for _ in 0..100 {
        shares.take_request(&ann, now).expect_err("used up");
    }
    assert_eq!(exhaust(&shares, &member("amy", Some("a")), now), 2);
}

#[test]
fn a_place_is_free_again_once_it_is_dropped() {
    let (shares, now) = (shares(), Instant::now());
    let (ann, amy) = (member("ann", Some("a")), member("amy", Some("a")));
    let hold = |who: &Member| shares.hold(Share::Downloads, who, now);
    let first = hold(&ann).expect("free");
    let _second = hold(&ann).expect("free");
    let problem = hold(&ann).expect_err("two are taken");
    assert_eq!((problem.status, &*problem.code), (429, "TOO_MANY_DOWNLOADS"));
    let _third = hold(&amy).expect("the organisation's last");
    hold(&amy).expect_err("three are taken");
    let _other = hold(&member("bob", Some("b"))).expect("of another organisation");
    shares.hold(Share::Streams, &ann, now).expect("streams have places of their own");
    drop(first);
    hold(&amy).expect("free again");
}

#[test]
fn usage_is_forgotten_once_it_is_as_good_as_none() {
    let (shares, now) = (shares(), Instant::now());
    let place = shares.hold(Share::Streams, &member("ann", Some("a")), now).expect("free");
    for number in 0..1_000 {
        let person = member(&format!("p{number}"), Some("b"));
        drop(shares.take_request(&person, now));
    }
    let known = || {
        let usages = shares.0.usage.lock();
        (usages.persons.len(), usages.organisations.len())
    };
    assert_eq!(known(), (1_001, 2));
    let later = now + Duration::from_secs(60);
    shares.take_request(&member("bob", Some("c")), later).expect("passed");
    assert_eq!(known(), (2, 2), "Ann, who holds a place, and Bob");
    drop(place);
    let later = later + Duration::from_secs(60);
    shares.take_request(&member("bob", Some("c")), later).expect("passed");
    assert_eq!(known(), (1, 1));
}
