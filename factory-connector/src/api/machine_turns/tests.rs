use std::sync::atomic::{AtomicUsize, Ordering};

use futures::future::join_all;

use super::*;

fn source(name: &str) -> SourceId {
    name.parse().expect("an id")
}

#[tokio::test]
async fn a_server_gets_two_requests_at_a_time_and_a_person_has_four() {
    let (turns, mill) = (MachineTurns::default(), source("Mill1"));
    let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let request = |person: &'static str| {
        let (turns, mill, now, most) = (&turns, &mill, &now, &most);
        async move {
            let turn = turns.take(mill, person).await?;
            most.fetch_max(now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            tokio::time::sleep(Duration::from_millis(20)).await;
            now.fetch_sub(1, Ordering::SeqCst);
            drop(turn);
            Ok::<_, Problem>(())
        }
    };
    let people = (0..100).map(|_| "vera").chain(["otto", "anna"]);
    let answers = join_all(people.map(request)).await;
    let answered = answers[..100].iter().filter(|answer| answer.is_ok()).count();
    assert_eq!((answered, most.into_inner()), (OF_A_PERSON_MAX, AT_A_TIME));
    let refusal = answers[99].as_ref().expect_err("beyond the share");
    assert_eq!(refusal.status, 429);
    assert!(answers[100].is_ok() && answers[101].is_ok(), "the others get their turn");
    let patience = Duration::from_secs(10);
    testkit::wait::until("all are forgotten", patience, || turns.0.lock().is_empty()).await;
}

#[tokio::test]
async fn a_server_gets_twenty_requests_a_second() {
    let (turns, mill) = (MachineTurns::default(), source("Mill1"));
    let begun = Instant::now();
    for number in 0..20 {
        // Several people: the turns of one would end too late for its next.
        let turn = turns.take(&mill, ["vera", "otto", "anna"][number % 3]).await;
        drop(turn.expect("a turn"));
    }
    // Two at once, and two more after each tenth of a second.
    let took = begun.elapsed();
    assert!(took >= Duration::from_millis(900), "{took:?}");
}

#[tokio::test]
async fn a_slow_server_holds_up_no_other_server() {
    let (turns, mill) = (MachineTurns::default(), source("Mill1"));
    let stuck = [turns.take(&mill, "vera").await, turns.take(&mill, "vera").await];
    assert!(turns.take(&source("Belt1"), "otto").await.is_ok());
    let waits = timeout(Duration::from_millis(50), turns.take(&mill, "otto")).await;
    assert!(waits.is_err(), "both turns are taken");
    drop(stuck);
    assert!(turns.take(&mill, "otto").await.is_ok());
}

#[tokio::test]
async fn servers_that_are_no_source_yet_are_asked_two_at_a_time_whatever_their_addresses() {
    let turns = MachineTurns::default();
    let asked = [turns.take_unsaved("vera").await, turns.take_unsaved("vera").await];
    let waits = timeout(Duration::from_millis(50), turns.take_unsaved("otto")).await;
    assert!(waits.is_err(), "both turns are taken");
    assert!(turns.take(&source("Mill1"), "otto").await.is_ok(), "sources have their own");
    drop(asked);
    assert!(turns.take_unsaved("otto").await.is_ok());
}

#[tokio::test]
async fn what_is_refused_of_servers_that_are_not_saved_yet_says_so() {
    let turns = MachineTurns::default();
    let asked = (0..=OF_A_PERSON_MAX)
        .map(|_| timeout(Duration::from_millis(50), turns.take_unsaved("vera")));
    let refused: Vec<Problem> =
        join_all(asked).await.into_iter().filter_map(|answer| answer.ok()?.err()).collect();
    let [refused] = &refused[..] else { panic!("one of them: {refused:?}") };
    assert!(refused.detail.contains("not saved"), "{}", refused.detail);
    assert!(Machine::Unsaved.has_no_turn().contains("not saved"));
}
