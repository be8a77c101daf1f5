//! Properties of the state machine of the lease, without a platform.

use super::*;

fn at(seconds: i64) -> DateTime {
    DateTime::from_unix_micros(seconds * 1_000_000)
}

fn id(text: &str) -> MessageId {
    text.parse().expect("an id")
}

/// A lease, the moment it was made, and a number for its next request.
struct Bench {
    lease: LeaseMachine,
    start: Instant,
    requests: u32,
}

impl Bench {
    fn new() -> Self {
        let instance = ConnectorInstance {
            factory_id: "F".parse().expect("an id"),
            instance_id: "me".parse().expect("an id"),
            place: "here".parse().expect("an id"),
            host: "my machine".to_owned(),
            started_at: at(0),
        };
        Self { lease: LeaseMachine::new(instance, at(0)), start: Instant::now(), requests: 0 }
    }

    fn on(&mut self, input: LeaseInput, second: u64) -> Vec<LeaseAction> {
        self.requests += 1;
        let now = at(i64::try_from(second).expect("small"));
        self.lease.on(
            input,
            id(&format!("q{}", self.requests)),
            self.start + Duration::from_secs(second),
            now,
        )
    }

    /// Returns the id of the request that is the only action.
    fn asked(actions: &[LeaseAction]) -> MessageId {
        match actions {
            [LeaseAction::Ask(request)] => request.message_id.clone(),
            other => panic!("one request, not {other:?}"),
        }
    }
}

fn party(host: &str) -> LeaseParty {
    LeaseParty {
        instance_id: "other".parse().expect("an id"),
        host: host.to_owned(),
        since: at(1),
        last_heard_at: at(2),
    }
}

fn answer(request: &MessageId, result: LeaseResult) -> LeaseAnswer {
    let is_granted = result == LeaseResult::Granted;
    LeaseAnswer {
        message_id: id("a"),
        factory_id: "F".parse().expect("an id"),
        correlation_id: request.clone(),
        instance_id: "me".parse().expect("an id"),
        place: "here".parse().expect("an id"),
        host: "my machine".to_owned(),
        result,
        lease_number: 3,
        ask_again_ms: 10_000,
        holder: (!is_granted).then(|| party("their machine")),
        contender: None,
    }
}

fn answered(answer: LeaseAnswer) -> LeaseInput {
    LeaseInput::Answered(Box::new(answer))
}

#[test]
fn nothing_leaves_before_the_grant_of_each_connection() {
    let mut bench = Bench::new();
    assert_eq!(bench.on(LeaseInput::Tick, 0), [], "there is no connection");
    let first = Bench::asked(&bench.on(LeaseInput::Connected, 1));
    let granted = bench.on(answered(answer(&first, LeaseResult::Granted)), 1);
    assert_eq!(granted, [LeaseAction::Receive(true), LeaseAction::Open(3)]);
    assert_eq!((bench.lease.status().state, bench.lease.status().since), (LeaseState::Held, at(1)));

    let renewal = Bench::asked(&bench.on(LeaseInput::Tick, 11));
    assert_eq!(
        bench.on(answered(answer(&renewal, LeaseResult::Granted)), 11),
        [],
        "nothing changes"
    );

    assert_eq!(bench.on(LeaseInput::Disconnected, 12), []);
    let again = Bench::asked(&bench.on(LeaseInput::Connected, 13));
    assert_eq!(
        bench.on(answered(answer(&renewal, LeaseResult::Granted)), 13),
        [],
        "that was about the last connection"
    );
    let granted = bench.on(answered(answer(&again, LeaseResult::Granted)), 13);
    assert_eq!(granted, [LeaseAction::Receive(true), LeaseAction::Open(3)]);
    assert_eq!(bench.lease.status().since, at(1), "it was held all the time");
}

#[test]
fn a_lost_answer_is_requested_again_and_the_lease_stays() {
    let mut bench = Bench::new();
    let first = Bench::asked(&bench.on(LeaseInput::Connected, 0));
    bench.on(answered(answer(&first, LeaseResult::Granted)), 0);
    let mut second = 0;
    for _ in 0..8 {
        let wake_at = bench.lease.wake_at().expect("it waits for an answer");
        let pause = wake_at.duration_since(bench.start).as_secs() - second;
        assert!((2..=60).contains(&pause), "{pause}");
        second += pause;
        Bench::asked(&bench.on(LeaseInput::Tick, second));
        assert_eq!(bench.lease.status().lease_number, Some(3), "what may leave is as before");
    }
}

/// Lets the next request be due, and returns its second, its id and what is shown with it.
fn asks_in_vain(bench: &mut Bench) -> (u64, MessageId, (LeaseState, DateTime)) {
    let wake_at = bench.lease.wake_at().expect("it waits for an answer");
    let second = wake_at.duration_since(bench.start).as_secs();
    let request = Bench::asked(&bench.on(LeaseInput::Tick, second));
    let status = bench.lease.status();
    (second, request, (status.state, status.since))
}

#[test]
fn the_log_says_who_speaks_once_the_platform_says_so_and_not_when_a_silence_ends_otherwise() {
    let mut bench = Bench::new();
    let first = Bench::asked(&bench.on(LeaseInput::Connected, 0));
    assert_eq!(bench.lease.to_log(), None);
    bench.on(answered(answer(&first, LeaseResult::Granted)), 1);
    assert_eq!(bench.lease.to_log(), Some(LeaseState::Held));
    let falls_silent = |bench: &mut Bench| {
        while bench.lease.status().state != LeaseState::Unanswered {
            asks_in_vain(bench);
        }
        bench.lease.to_log()
    };
    assert_eq!(falls_silent(&mut bench), Some(LeaseState::Unanswered));
    let (second, _, _) = asks_in_vain(&mut bench);
    assert_eq!(bench.lease.to_log(), None, "once each");

    bench.on(LeaseInput::Disconnected, second + 1);
    assert_eq!(bench.lease.status().state, LeaseState::Held);
    assert_eq!(bench.lease.to_log(), None, "the link is down, and nobody has answered");
    let again = Bench::asked(&bench.on(LeaseInput::Connected, second + 2));
    bench.on(answered(answer(&again, LeaseResult::Granted)), second + 2);
    assert_eq!(bench.lease.to_log(), Some(LeaseState::Held), "the silence is over");

    assert_eq!(falls_silent(&mut bench), Some(LeaseState::Unanswered));
    let mut other = answer(&id("theirs"), LeaseResult::Granted);
    other.instance_id = "other".parse().expect("an id");
    other.place = "elsewhere".parse().expect("an id");
    bench.on(answered(other), second + 300);
    assert_eq!(bench.lease.status().state, LeaseState::Held);
    assert_eq!(bench.lease.to_log(), None, "it was an answer to another connector");
}

#[test]
fn a_platform_that_answers_nothing_is_shown_as_silent_until_it_answers() {
    let mut bench = Bench::new();
    let first = Bench::asked(&bench.on(LeaseInput::Connected, 0));
    bench.on(answered(answer(&first, LeaseResult::Granted)), 1);
    let (silent_since, _, held) = asks_in_vain(&mut bench);
    assert_eq!(held, (LeaseState::Held, at(1)));
    assert_eq!(asks_in_vain(&mut bench).2, held);
    assert_eq!(asks_in_vain(&mut bench).2, held, "three may be lost");
    let since = at(i64::try_from(silent_since).expect("small"));
    let (_, _, shown) = asks_in_vain(&mut bench);
    assert_eq!(shown, (LeaseState::Unanswered, since));
    let (second, request, still) = asks_in_vain(&mut bench);
    assert_eq!(still, shown, "it goes on asking");
    let granted = bench.on(answered(answer(&request, LeaseResult::Granted)), second);
    assert_eq!(granted, [], "it was open all the time");
    let status = bench.lease.status();
    assert_eq!((status.state, status.since), held);
    for _ in 0..3 {
        assert_eq!(asks_in_vain(&mut bench).2, held, "counted from the answer on");
    }
}

#[test]
fn a_platform_is_shown_as_silent_while_the_link_is_up_only() {
    let mut bench = Bench::new();
    bench.on(LeaseInput::Connected, 0);
    for _ in 0..3 {
        asks_in_vain(&mut bench);
    }
    assert_eq!(bench.lease.status().state, LeaseState::Unanswered, "before any answer, too");
    assert_eq!(bench.on(LeaseInput::Disconnected, 20), []);
    let status = bench.lease.status();
    assert_eq!((status.state, status.since), (LeaseState::Asking, at(0)));
    let again = Bench::asked(&bench.on(LeaseInput::Connected, 30));
    bench.on(answered(answer(&again, LeaseResult::Refused)), 30);
    bench.on(LeaseInput::Disconnected, 31);
    bench.on(LeaseInput::Connected, 40);
    for _ in 0..3 {
        asks_in_vain(&mut bench);
    }
    assert_eq!(bench.lease.status().state, LeaseState::Unanswered);
    let left = bench.on(LeaseInput::Disconnected, 60);
    assert_eq!(left, [LeaseAction::Receive(false)], "the lease is still another one's");
    assert_eq!(bench.lease.status().state, LeaseState::Refused);
}

#[test]
fn a_refused_connector_stays_silent_until_it_is_granted() {
    let mut bench = Bench::new();
    let first = Bench::asked(&bench.on(LeaseInput::Connected, 0));
    bench.on(answered(answer(&first, LeaseResult::Granted)), 0);
    let renewal = Bench::asked(&bench.on(LeaseInput::Tick, 10));
    let refused = bench.on(answered(answer(&renewal, LeaseResult::Refused)), 10);
    assert_eq!(refused, [LeaseAction::Close, LeaseAction::BackOff(Duration::from_secs(10))]);
    assert_eq!(
        bench.on(answered(answer(&renewal, LeaseResult::Refused)), 10),
        [],
        "the same once more"
    );
    let status = bench.lease.status();
    assert_eq!((status.state, status.lease_number), (LeaseState::Refused, None));
    assert_eq!(status.holder.as_ref().map(|holder| &*holder.host), Some("their machine"));
    assert_eq!(bench.on(LeaseInput::Tick, 100), [], "it backs off");
    assert_eq!(bench.on(LeaseInput::Disconnected, 10), [LeaseAction::Receive(false)]);

    let later = Bench::asked(&bench.on(LeaseInput::Connected, 20));
    assert_eq!(bench.lease.status().state, LeaseState::Refused, "as far as is known");
    let granted = bench.on(answered(answer(&later, LeaseResult::Granted)), 20);
    assert_eq!(granted, [LeaseAction::Receive(true), LeaseAction::Open(3)]);
    assert_eq!(
        (bench.lease.status().state, &bench.lease.status().holder),
        (LeaseState::Held, &None)
    );
}

#[test]
fn an_answer_to_another_connector_shows_that_there_are_two() {
    let mut bench = Bench::new();
    let first = Bench::asked(&bench.on(LeaseInput::Connected, 0));
    bench.on(answered(answer(&first, LeaseResult::Granted)), 0);
    let mut predecessors = answer(&id("old"), LeaseResult::Granted);
    predecessors.instance_id = "before".parse().expect("an id");
    assert_eq!(bench.on(answered(predecessors.clone()), 1), [], "that one is gone");
    assert_eq!(bench.lease.status().contender, None);

    let elsewhere = LeaseAnswer {
        place: "there".parse().expect("an id"),
        host: "their machine".into(),
        ..predecessors
    };
    assert_eq!(bench.on(answered(elsewhere.clone()), 2), []);
    let contender = bench.lease.status().contender.as_ref().map(|other| &*other.host);
    assert_eq!((bench.lease.status().state, contender), (LeaseState::Held, Some("their machine")));

    // Ours may have gone there, however often: it is asked for again and again soon.
    let wake_at = |bench: &Bench| {
        bench.lease.wake_at().expect("it waits").duration_since(bench.start).as_secs()
    };
    let mut second = 2;
    for _ in 0..8 {
        assert_eq!(bench.on(answered(elsewhere.clone()), second), []);
        second = wake_at(&bench);
        Bench::asked(&bench.on(LeaseInput::Tick, second));
        assert!(wake_at(&bench) <= second + 2, "{second}");
    }
    let mut granted =
        answer(&Bench::asked(&bench.on(LeaseInput::Tick, second + 2)), LeaseResult::Granted);
    granted.contender = Some(party("their machine, says the platform"));
    bench.on(answered(granted), second + 2);
    let contender = bench.lease.status().contender.as_ref().map(|other| &*other.host);
    assert_eq!(contender, Some("their machine, says the platform"));
}
